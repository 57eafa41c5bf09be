// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/report/json.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

#include "base/units.hpp"
#include "diagnosis/hypotheses/table.hpp"

namespace grouser::diagnosis {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double share) {
  if (share > 0.999) return "over 99.9 %";
  return rounded(100.0 * share) + " %";
}

Json of(const Detection& d) {
  Json cells = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(8, d.cells.size()); ++i)
    cells.push_back({{"condition", d.cells[i].condition},
                     {"channel", d.cells[i].channel},
                     {"from", d.cells[i].from},
                     {"to", d.cells[i].to},
                     {"z", d.cells[i].z}});
  return {{"p", d.p},
          {"p_global", d.p_global},
          {"p_scan", d.p_scan},
          {"p_stress", d.p_stress},
          {"threshold", d.threshold},
          {"largest", cells}};
}

Json of(const Candidate& c, std::size_t shared) {
  Json values = Json::array();
  for (std::size_t j = 0; j < c.fit.coordinates.size(); ++j) {
    if (c.fit.coordinates[j].knot >= 0) continue;
    values.push_back({{"name", c.fit.coordinates[j].label},
                      {"value", c.fit.value(j)},
                      {"deviation", c.fit.deviation(j)},
                      {"prior_deviations", c.fit.p(static_cast<Eigen::Index>(j))},
                      {"is_own", j >= shared}});
  }
  return {{"id", c.id},
          {"family", word_of(c.family)},
          {"channel", c.channel},
          {"probability", c.probability},
          {"log_evidence", c.log_evidence},
          {"log_likelihood", c.fit.log_likelihood},
          {"log_prior", c.log_prior},
          {"values", values}};
}

std::string mask_text(const std::vector<bool>& mask) {
  std::string text;
  for (const bool on : mask) text += on ? '1' : '0';
  return text;
}

Json of(const Location& l) {
  return {{"condition", l.condition},  {"times", l.times},   {"size", l.size},
          {"mask", mask_text(l.mask)}, {"latent", l.latent}, {"latent_deviation", l.latent_error}};
}

constexpr const char* kNotCalibrated =
    " The method is not calibrated: its rates of error were not measured "
    "(docs/diagnosis/method.md).";

std::string verdict_text(const Diagnosis& d) {
  const std::string odds = percent(d.probability);
  std::string rest;
  for (const std::string& id : d.confusable)
    if (id != d.cause) rest += (rest.empty() ? "; as good as it: " : ", ") + id;
  switch (d.word) {
    case Word::kNoMismatch:
      return "No mismatch beyond noise and known uncertainties (chance " + rounded(d.detection.p) +
             ").";
    case Word::kNamed:
    case Word::kProvisional: {
      const Hypothesis* const h = find_hypothesis(d.cause.c_str());
      return std::string(d.word == Word::kProvisional ? "Provisionally: " : "") +
             (h != nullptr ? h->title : d.cause) +
             (d.channel.empty() ? "" : " (" + d.channel + ")") + ", " + odds + " of the odds" +
             rest + ".";
    }
    case Word::kNoneOfTheKnown:
      return std::string(d.is_calibrated ? "Recording" : "Provisionally: recording") +
             " and model differ, and none of the known causes explains it.";
  }
  return "";
}

}  // namespace

std::string sentence(const Diagnosis& d) {
  return verdict_text(d) + (d.is_calibrated ? "" : kNotCalibrated);
}

std::string to_json(const Diagnosis& d) {
  Json out{{"schema", 1},
           {"recording", d.recording},
           {"sentence", sentence(d)},
           {"calibrated", d.is_calibrated},
           {"verdict", word_of(d.word)},
           {"cause", d.cause},
           {"family", word_of(d.family)},
           {"channel", d.channel},
           {"probability", d.probability},
           {"set", d.set},
           {"confusable", d.confusable},
           {"conditions", d.fitted},
           {"amplitude",
            {{"value", d.amplitude},
             {"deviation", d.amplitude_error},
             {"conditions", d.amplitudes},
             {"condition_deviations", d.amplitude_errors},
             {"p_invariant", d.invariance}}},
           {"detection", of(d.detection)},
           {"check", of(d.check)},
           {"flags", d.flags},
           {"runs", d.runs},
           {"seconds", d.seconds}};
  Json findings = Json::array();
  for (const Finding& f : d.findings)
    findings.push_back({{"condition", f.condition},
                        {"channel", f.channel},
                        {"kind", f.kind},
                        {"is_fault", f.is_fault},
                        {"text", f.text}});
  out["findings"] = findings;
  Json held = Json::array();
  for (const HeldOut& h : d.held_out)
    held.push_back({{"condition", h.condition},
                    {"baseline_error", h.baseline_error},
                    {"candidate_error", h.candidate_error},
                    {"noise_error", h.noise},
                    {"log_gain", h.gain},
                    {"placebo_log_gain", h.placebo_gain}});
  out["held_out"] = held;
  Json candidates = Json::array();
  const std::size_t shared = [&] {
    for (const Candidate& c : d.candidates)
      if (c.id == "baseline") return c.fit.coordinates.size();
    return std::size_t{0};
  }();
  for (const Candidate& c : d.candidates) candidates.push_back(of(c, shared));
  out["candidates"] = candidates;
  Json locations = Json::array();
  for (const Location& l : d.locations) locations.push_back(of(l));
  out["locations"] = locations;
  return out.dump(1) + "\n";
}

}  // namespace grouser::diagnosis
