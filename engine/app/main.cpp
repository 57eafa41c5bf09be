// SPDX-License-Identifier: BSD-3-Clause
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <optional>

#include "base/atomic_file.hpp"
#include "base/check.hpp"
#include "base/errors.hpp"
#include "base/log.hpp"
#include "base/yaml.hpp"
#include "engine/app/run.hpp"
#include "engine/core/agree.hpp"
#include "engine/terrain/shapes.hpp"

namespace grouser {
namespace {

void on_signal(int) { signal_stop(); }

// Every rank reads the input itself; when one cannot, all refuse.
Case read_frozen_case(const Communicator& ranks, const std::filesystem::path& file) {
  std::vector<Problem> problems;
  Case input;
  try {
    input = read_case(load_yaml(file), problems);
    // The surface file's path counts from the run directory, as a campaign freezes it.
    if (input.wheel.profile == "stl")
      input.wheel.stl_file = (file.parent_path() / input.wheel.stl_file).string();
    if (problems.empty() && input.has_wheel) wheel_mesh(input.wheel).check_closed("wheel");
  } catch (const ConfigError& error) {
    problems = error.problems();
  } catch (const StorageError& error) {
    problems = {Problem{file.string(), 0, 0, "", error.what(), ""}};
  }
  if (ranks.max(std::int64_t{problems.empty() ? 0 : 1}) == 0) return input;
  if (problems.empty())
    problems = {Problem{file.string(), 0, 0, "", "another rank could not use the input", ""}};
  throw ConfigError(problems);
}

// The fence's text without white space at its end, when its first word is the token; else "".
std::string claim_of(const EngineOptions& options) {
  const auto text = read_file(options.run_directory / run_files::kFence);
  if (!text || text->substr(0, text->find_first_of(" \n\r\t")) != options.token) return "";
  return text->substr(0, text->find_last_not_of(" \n\r\t") + 1);
}

// @param run what there was of it when it failed
Outcome failed(const EngineOptions& options, const std::optional<Run>& run, EngineCode code,
               const std::string& reason) {
  Outcome out = run ? run->outcome(code) : Outcome{};
  out.token = options.token;
  out.code = code;
  out.reason = reason;
  return out;
}

// One of the two places that catch (the other is the campaign manager's main). What is caught here
// was thrown by every rank alike.
Outcome run(const Communicator& ranks, EngineOptions options, Run::Clock::time_point started) {
  std::optional<Run> run;
  try {
    const Case input = read_frozen_case(ranks, options.run_directory / run_files::kCase);
    on_first_rank(ranks, [&] { options.claim = claim_of(options); });
    options.claim = ranks.from_first(options.claim);
    if (options.claim.empty())
      return failed(options, run, EngineCode::kFenceLost, "another attempt owns the run");
    return run.emplace(ranks, options, input, started).execute();
  } catch (const ConfigError& error) {
    return failed(options, run, EngineCode::kInputRefused, error.what());
  } catch (const FormatError& error) {
    return failed(options, run, EngineCode::kCheckpointRefused, error.what());
  } catch (const StorageError& error) {
    return failed(options, run, EngineCode::kStorageFailed, error.what());
  }
}

constexpr int kMostThreads = 1024;

// OMP_NUM_THREADS may be a list, one number for each depth; the first counts.
int usual_threads() {
  const char* const text = std::getenv("OMP_NUM_THREADS");
  const int given = text == nullptr ? 1 : std::atoi(text);
  return std::clamp(given, 1, kMostThreads);
}

int report(const Communicator& ranks, const EngineOptions& options, const Outcome& outcome) {
  const int code = static_cast<int>(outcome.code);
  if (ranks.rank() != 0) return code;
  spdlog::info("app {} step={} time={} s state={}: {}", word_of(outcome.code), outcome.step,
               outcome.time, outcome.state_hash, outcome.reason);
  if (outcome.code == EngineCode::kFenceLost) return code;  // the run is another's: write nothing
  try {
    write_atomic(options.run_directory / run_files::outcome(options.token), to_json(outcome));
  } catch (const StorageError& error) {
    spdlog::error("app the outcome could not be written: {}", error.what());
  }
  return code;
}

}  // namespace
}  // namespace grouser

int main(int argc, char** argv) {
  using namespace grouser;
  const auto started = Run::Clock::now();
  const ParallelSession session(&argc, &argv);
  const Communicator ranks;
  set_up_log(ranks.rank());

  EngineOptions options;
  CLI::App app{"grouser-engine: grains and wheels, one attempt of one run"};
  app.add_option("--run-dir", options.run_directory, "run directory with case.yaml")->required();
  app.add_option("--token", options.token, "token of this attempt, as in the fence file")
      ->required();
  app.add_option("--bed", options.bed, "run directory of the settled bed");
  app.add_option("--until-time", options.until_time, "simulated time at which the chunk ends [s]");
  app.add_option("--max-seconds", options.max_seconds,
                 "wall time after which the engine has ended [s]");
  app.add_option("--checkpoint-seconds", options.checkpoint_seconds,
                 "wall time between checkpoints, in place of output.checkpoint_interval [s]")
      ->check(CLI::PositiveNumber);
  options.threads = usual_threads();
  app.add_option("--threads", options.threads,
                 "threads of each rank; without it OMP_NUM_THREADS, else 1")
      ->check(CLI::Range(1, kMostThreads));
  std::string restart = "auto";
  app.add_option("--restart", restart,
                 "auto: continue from the newest good checkpoint, or start; "
                 "required: continue, or refuse")
      ->check(CLI::IsMember({"auto", "required"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int shown = ranks.rank() == 0 ? app.exit(error) : error.get_exit_code();
    return shown == 0 ? 0 : static_cast<int>(EngineCode::kInputRefused);
  }
  options.must_continue = restart == "required";
  std::signal(SIGTERM, on_signal);
  std::signal(SIGUSR1, on_signal);
  std::signal(SIGUSR2, on_signal);
  try {
    const int code = report(ranks, options, run(ranks, options, started));
    // HDF5 keeps files it could not write and crashes over them in MPI_Finalize.
    if (code == static_cast<int>(EngineCode::kStorageFailed)) leave_at_once(ranks, code);
    return code;
  } catch (const std::exception& error) {
    // Perhaps on this rank alone: the others wait for it, so all must go.
    spdlog::critical("app defect: {}", error.what());
    abort_all_ranks(static_cast<int>(EngineCode::kDefect));
  }
}
