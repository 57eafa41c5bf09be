// SPDX-License-Identifier: BSD-3-Clause
#include "base/errors.hpp"
#include "base/schema.hpp"
#include "diagnosis/inference/diagnose.hpp"

namespace grouser::diagnosis {
namespace {

struct Term {
  std::string name;
  double amplitude = 0.0;
};

std::vector<std::string> amplitude_names() {
  std::vector<std::string> names;
  for (const SettingEntry& entry : kSettings)
    if (entry.kind == SettingKind::kAmplitude) names.emplace_back(entry.name);
  return names;
}

}  // namespace

Baseline default_baseline() {
  Baseline baseline;
  baseline.terms = default_values();
  baseline.terms[index_of(Setting::kDragInertia)] = 1.0;
  return baseline;
}

Baseline read_baseline(const std::string& file) {
  Baseline baseline;
  baseline.terms = default_values();
  std::int64_t version = 1;
  std::vector<Term> terms;
  std::vector<Problem> problems;
  read_fields(
      load_yaml(file),
      [&](FieldVisitor& v) {
        v.integer({"baseline", "version of this format"}, version, 1, 1);
        v.word({"model", "what computes it"}, baseline.model, {"sphere_ode"});
        v.list(
            {"terms", "physics that the baseline has", kOptional}, terms.size(),
            [&](std::size_t count) { terms.resize(count); },
            [&](FieldVisitor& inner, std::size_t i) {
              inner.word({"name", "of the term"}, terms[i].name, amplitude_names());
              inner.quantity({"amplitude", "0 = off, 1 = textbook"}, terms[i].amplitude, "1",
                             Range::closed(0.0, 1.0));
            });
      },
      problems);
  if (!problems.empty()) throw ConfigError(problems);
  for (const Term& term : terms)
    baseline.terms[index_of(*find_setting(term.name))] = term.amplitude;
  return baseline;
}

}  // namespace grouser::diagnosis
