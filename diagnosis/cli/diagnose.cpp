// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/units.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "diagnosis/cli/verbs.hpp"
#include "diagnosis/hypotheses/table.hpp"
#include "diagnosis/inference/diagnose.hpp"
#include "diagnosis/report/json.hpp"
#include "diagnosis/report/page.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;
using namespace diagnosis;

struct Options {
  std::string recording;
  std::string baseline;
  std::string out;
  std::string id;
};

void print(const Diagnosis& d) {
  std::cout << sentence(d) << "\n\n";
  for (const Candidate& c : d.candidates) {
    if (c.probability < 1e-4 && c.id != "baseline" && c.id != "unknown") continue;
    std::cout << "  " << c.id << std::string(c.id.size() < 32 ? 32 - c.id.size() : 1, ' ')
              << rounded(c.probability) << "  ln evidence " << rounded(c.log_evidence) << "\n";
  }
  if (d.amplitude != 0.0)
    std::cout << "amplitude " << rounded(d.amplitude) << " +- " << rounded(d.amplitude_error)
              << " (theory 1)\n";
  for (const HeldOut& h : d.held_out)
    std::cout << "held out " << h.condition << ": error " << rounded(100.0 * h.baseline_error)
              << " % of the range before, " << rounded(100.0 * h.candidate_error) << " % after\n";
  for (const std::string& flag : d.flags) std::cout << "caution: " << flag << "\n";
  std::cout << d.runs << " model runs, " << rounded(d.seconds) << " s\n";
}

int run(const Options& options) {
  std::vector<grouser::Problem> problems;
  const SeriesRecording recording = read_series_recording(options.recording, problems);
  if (!problems.empty()) throw ConfigError(problems);
  const Baseline baseline =
      options.baseline.empty() ? default_baseline() : read_baseline(options.baseline);
  const Diagnosis d = diagnose(recording, baseline);
  const fs::path out = options.out.empty() ? fs::path("runs") / ("diagnosis_" + recording.name)
                                           : fs::path(options.out);
  fs::create_directories(out);
  write_atomic(out / "diagnosis.json", to_json(d));
  write_atomic(out / "diagnosis.html", page_html(d, recording));
  print(d);
  std::cout << "written: " << (out / "diagnosis.json").string() << ", "
            << (out / "diagnosis.html").string() << "\n";
  return exit_codes::kOk;
}

int explain(const std::string& id) {
  const Hypothesis* const h = find_hypothesis(id.c_str());
  if (h == nullptr) {
    std::vector<std::string> names;
    for (const Hypothesis& known : kHypotheses) names.emplace_back(known.id);
    std::string all;
    for (const std::string& name : names) all += " " + name;
    const std::string close = nearest(id, names);
    throw ConfigError({{"", 0, 0, id, "no hypothesis has this id",
                        close.empty() ? "they are:" + all : "did you mean '" + close + "'?"}});
  }
  std::cout << h->id << " (" << word_of(h->family) << "): " << h->title << "\n"
            << "  shows      " << h->explanation.where << "\n"
            << "  scaling    " << h->explanation.scaling << "\n"
            << "  confusers  " << h->explanation.confuser << "\n"
            << "  breaker    " << h->explanation.breaker << "\n";
  return exit_codes::kOk;
}

}  // namespace

void add_diagnose(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("diagnose", "say what a simulation left out, from a recording");
  verb->add_option("recording", options->recording, "recording.yaml or its folder");
  verb->add_option("--campaign", options->baseline, "YAML of the baseline");
  verb->add_option("--out", options->out, "folder of the result; runs/diagnosis_NAME");
  verb->require_subcommand(0, 1);
  CLI::App* tell = verb->add_subcommand("explain", "where a cause shows and how to tell it apart");
  tell->add_option("id", options->id, "of the hypothesis")->required();
  tell->callback([options, &code] { code = explain(options->id); });
  verb->callback([options, verb, &code] {
    if (!verb->get_subcommands().empty()) return;
    if (options->recording.empty()) throw CLI::RequiredError("recording");
    code = run(*options);
  });
}

}  // namespace grouser
