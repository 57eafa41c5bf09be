// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/units.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/report/recording.hpp"
#include "diagnosis/cli/verbs.hpp"
#include "diagnosis/recordings/admission.hpp"
#include "diagnosis/recordings/noise.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

void print_series(const diagnosis::SeriesRecording& recording) {
  for (const diagnosis::Condition& condition : recording.conditions) {
    std::cout << "  " << condition.name << " (" << condition.split
              << "): " << condition.times.size() << " samples, " << rounded(condition.times.front())
              << " to " << rounded(condition.times.back()) << " s";
    for (std::size_t c = 0; c < recording.channels.size(); ++c) {
      const diagnosis::SignalChannel& channel = recording.channels[c];
      std::cout << "; " << channel.name << " noise "
                << rounded(diagnosis::rough_noise_sd(condition.samples[c])) << " "
                << diagnosis::entry_of(channel.signal).unit
                << (channel.noise_sd > 0.0 ? " (stated " + rounded(channel.noise_sd) + ")" : "");
    }
    std::cout << "\n";
  }
}

int print_findings(const std::vector<diagnosis::Finding>& findings) {
  bool is_faulty = false;
  for (const diagnosis::Finding& finding : findings) {
    std::cout << (finding.is_fault ? "FAULT " : "note  ") << finding.condition
              << (finding.channel.empty() ? "" : " " + finding.channel) << " " << finding.kind
              << (finding.line > 0 ? " line " + std::to_string(finding.line) : "") << ": "
              << finding.text << "\n";
    is_faulty = is_faulty || finding.is_fault;
  }
  return is_faulty ? exit_codes::kAttention : exit_codes::kOk;
}

int validate(const fs::path& path) {
  std::vector<Problem> problems;
  const fs::path folder = fs::is_directory(path) ? path : path.parent_path();
  if (!diagnosis::is_series_recording(folder)) {
    const Recording values = read_recording(folder, problems);
    if (!problems.empty()) throw ConfigError(problems);
    std::cout << path.string() << ": good; " << values.points.size() << " values\n";
    return exit_codes::kOk;
  }
  const diagnosis::SeriesRecording recording = diagnosis::read_series_recording(path, problems);
  if (!problems.empty()) throw ConfigError(problems);
  std::cout << path.string() << ": good; " << recording.conditions.size() << " conditions of "
            << recording.experiment << "\n";
  print_series(recording);
  return print_findings(diagnosis::admit(recording));
}

}  // namespace

void add_recording(CLI::App& app, int& code) {
  auto where = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("recording", "look at measured data");
  verb->require_subcommand(1);
  CLI::App* check = verb->add_subcommand(
      "validate", "check a recording: all mistakes at once, then what its data say of the sensors");
  check->add_option("recording", *where, "recording.yaml or its folder")->required();
  check->callback([where, &code] { code = validate(*where); });
}

}  // namespace grouser
