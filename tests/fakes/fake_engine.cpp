// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for grouser-engine that keeps the contract of docs/reference/formats/run_directory.md
// with a number generator in place of physics. Environment variables make it fail:
//
//   FAKE_ONLY=TEXT             the faults below hit only run directories whose path contains TEXT
//   FAKE_STEP_MICROSECONDS=N   each step takes this long
//   FAKE_KILL_AT=A,B,...       dies by SIGKILL on reaching each of these steps, once per run
//   FAKE_END_AT=STEP:CODE      ends with this code on reaching the step, once per run
//   FAKE_END_ALWAYS=1          ... every time
//   FAKE_NO_OUTCOME=1          leaves no outcome
//   FAKE_HANG_AT=STEP          stops moving there
//   FAKE_EAT_MEMORY_AT=STEP    takes 400 MB there
//   FAKE_STUCK=1               pauses at once, without a step
//
// Two engines at once in one run directory leave the file `overlap` there.
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "base/atomic_file.hpp"
#include "base/case.hpp"
#include "base/hash.hpp"
#include "base/run_contract.hpp"
#include "tests/fakes/fake_physics.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

constexpr double kTimeStep = FakeState::kTimeStep;
constexpr std::int64_t kParticles = 100;

volatile sig_atomic_t is_terminated = 0;

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

struct Options {
  fs::path run_dir;
  std::string token;
  fs::path bed;
  double until_time = INFINITY;
  double max_seconds = INFINITY;
};

Options parse(int argc, char** argv) {
  std::map<std::string, std::string> given;
  for (int i = 1; i + 1 < argc; i += 2) given[argv[i]] = argv[i + 1];
  Options options;
  options.run_dir = given["--run-dir"];
  options.token = given["--token"];
  options.bed = given["--bed"];
  if (given.count("--until-time") > 0) options.until_time = std::stod(given["--until-time"]);
  if (given.count("--max-seconds") > 0) options.max_seconds = std::stod(given["--max-seconds"]);
  return options;
}

class FakeEngine {
 public:
  explicit FakeEngine(Options options) : options_(std::move(options)) {
    const std::string only = variable("FAKE_ONLY");
    has_faults_ = only.empty() || options_.run_dir.string().find(only) != std::string::npos;
    if (!variable("FAKE_STEP_MICROSECONDS").empty())
      pace_ = static_cast<useconds_t>(std::stoul(variable("FAKE_STEP_MICROSECONDS")));
  }

  int run() {
    claim_ = read_file(options_.run_dir / run_files::kFence).value_or("");
    if (claim_.substr(0, claim_.find(' ')) != options_.token)
      return static_cast<int>(EngineCode::kFenceLost);
    watch_for_overlap();
    read_input();
    restore();
    start_step_ = state_.step;
    start_series();
    write_event(options_.run_dir, event("started"));
    const EngineCode code = advance();
    finish(code);
    return static_cast<int>(code);
  }

 private:
  bool owns_fence() const { return read_file(options_.run_dir / run_files::kFence) == claim_; }

  void watch_for_overlap() const {
    const int lock = ::open((options_.run_dir / "engine.lock").c_str(), O_RDWR | O_CREAT, 0666);
    if (::flock(lock, LOCK_EX | LOCK_NB) != 0) write_atomic(options_.run_dir / "overlap", "");
  }

  void read_input() {
    std::vector<Problem> problems;
    input_ = read_case(load_yaml(options_.run_dir / run_files::kCase), problems);
    if (!problems.empty()) throw ConfigError(problems);
    key_ = content_key(input_);
    last_step_ = FakeState::last_step(input_);
    checkpoint_every_ =
        std::max<std::int64_t>(1, std::llround(input_.output.checkpoint_interval / kTimeStep));
  }

  std::optional<CheckpointManifest> newest(const fs::path& run_dir, FakeState& state) const {
    std::optional<CheckpointManifest> best;
    const fs::path directory = run_dir / run_files::kCheckpoints;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(directory, error)) {
      if (entry.path().extension() != ".json") continue;
      const auto manifest =
          manifest_from_json(read_file(entry.path()).value(), entry.path().string());
      const auto text = read_file(directory / manifest.file);
      if (!text || hash_text(*text) != manifest.state_hash) continue;
      if (best && best->step > manifest.step) continue;
      best = manifest;
      std::istringstream(*text) >> state.step >> state.value;
    }
    return best;
  }

  void restore() {
    if (newest(options_.run_dir, state_)) return;
    std::optional<FakeState> bed;
    if (input_.has_wheel) {
      const auto manifest = newest(options_.bed, bed.emplace());
      if (!manifest || !manifest->settled_bed) throw FormatError("the bed has not settled");
    }
    state_ = FakeState::start(input_, bed);
  }

  Event event(const std::string& kind) {
    Event one;
    one.token = options_.token;
    one.sequence = sequence_++;
    one.kind = kind;
    one.step = state_.step;
    one.time = state_.time();
    return one;
  }

  void checkpoint() {
    const std::string text = state_.text();
    CheckpointManifest manifest;
    manifest.file = "step-" + std::to_string(state_.step) + "-" + options_.token + ".h5";
    manifest.case_key = key_;
    manifest.step = state_.step;
    manifest.time = state_.time();
    manifest.state_hash = state_.hash();
    manifest.bytes = static_cast<std::int64_t>(text.size());
    manifest.settled_bed = !input_.has_wheel && state_.step == last_step_;
    if (!owns_fence()) std::exit(static_cast<int>(EngineCode::kFenceLost));
    const fs::path directory = options_.run_dir / run_files::kCheckpoints;
    write_atomic(directory / manifest.file, text);
    write_atomic(directory / fs::path(manifest.file).replace_extension(".json"), to_json(manifest));
    last_checkpoint_ = manifest;
  }

  // Rows up to the restart point are kept, later ones are computed again.
  void start_series() {
    const fs::path file = options_.run_dir / run_files::kSeries;
    std::istringstream old(read_file(file).value_or(""));
    std::string kept = std::string(kSeriesHeader) + "\n";
    std::string line;
    std::getline(old, line);
    while (std::getline(old, line))
      if (std::stoll(line) <= state_.step) kept += line + "\n";
    write_atomic(file, kept);
    series_.open(file, std::ios::app);
  }

  void write_row() {
    const double x = static_cast<double>(state_.value >> 11) * 0x1p-53;
    const double spin = input_.has_wheel
                            ? input_.wheel.forward_speed / (0.5 * input_.wheel.diameter) /
                                  std::max(1.0 - input_.wheel.slip, 0.01)
                            : 0.0;
    series_ << state_.step << "," << state_.time() << ","
            << (input_.has_wheel ? "driving" : "settling") << ","
            << state_.time() * input_.wheel.forward_speed << "," << 0.01 + 0.001 * x << ","
            << input_.wheel.slip << ",0," << spin << "," << input_.wheel.forward_speed << ",0,"
            << 100 * input_.wheel.slip + x << "," << input_.wheel.load << ",0," << 120 + x << ","
            << 20 + x << "," << 0.1 * x << "," << 0.2 * x << "," << 0.3 * x << ",1e-3,0.01,300\n"
            << std::flush;
  }

  void write_progress() {
    Progress progress;
    progress.token = options_.token;
    progress.step = state_.step;
    progress.time = state_.time();
    progress.end_time = input_.has_wheel ? run_duration(input_) : 0.0;
    progress.particle_steps_per_second = 1e5;
    progress.seconds_left = 1.0;
    progress.phase = input_.has_wheel ? "driving" : "settling";
    write_atomic(options_.run_dir / run_files::kProgress, to_json(progress));
  }

  // True once per run directory for each name.
  bool happens_once(const std::string& name) const {
    return create_exclusive(options_.run_dir / ("fake-" + name), "");
  }

  std::optional<EngineCode> fail_if_told() {
    if (!has_faults_) return std::nullopt;
    std::istringstream kills(variable("FAKE_KILL_AT"));
    for (std::string one; std::getline(kills, one, ',');)
      if (std::stoll(one) == state_.step && happens_once("kill-" + one)) ::raise(SIGKILL);
    if (variable("FAKE_HANG_AT") == std::to_string(state_.step))
      while (is_terminated == 0) ::pause();
    if (variable("FAKE_EAT_MEMORY_AT") == std::to_string(state_.step))
      memory_.assign(std::size_t{400} << 20, 'x');
    const std::string end = variable("FAKE_END_AT");
    const auto colon = end.find(':');
    if (colon != std::string::npos && std::stoll(end) == state_.step &&
        (!variable("FAKE_END_ALWAYS").empty() || happens_once("end")))
      return static_cast<EngineCode>(std::stoi(end.substr(colon + 1)));
    return std::nullopt;
  }

  EngineCode advance() {
    if (has_faults_ && !variable("FAKE_STUCK").empty()) return EngineCode::kPaused;
    while (state_.step < last_step_) {
      if (state_.time() >= options_.until_time || seconds() >= options_.max_seconds)
        return pause(EngineCode::kPaused);
      // The job script turns signals of the batch system into a stop file of its own.
      const auto stop = read_file(options_.run_dir / run_files::kStop);
      by_signal_ = is_terminated != 0 || (stop && stop->rfind("signal", 0) == 0);
      if (by_signal_) return pause(EngineCode::kPaused);
      if (stop) return pause(EngineCode::kStopped);
      if (const auto code = fail_if_told()) return *code;
      state_.advance();
      if (pace_ > 0) ::usleep(pace_);
      if (state_.step % 10 == 0) write_row();
      if (state_.step % 20 == 0) write_progress();
      if (state_.step % checkpoint_every_ == 0) checkpoint();
    }
    return pause(EngineCode::kFinished);
  }

  EngineCode pause(EngineCode code) {
    checkpoint();
    return code;
  }

  void finish(EngineCode code) {
    if (has_faults_ && !variable("FAKE_NO_OUTCOME").empty()) return;
    Outcome outcome;
    outcome.token = options_.token;
    outcome.code = code;
    outcome.by_signal = by_signal_;
    outcome.reason = std::string("fake engine: ") + word_of(code);
    outcome.step = state_.step;
    outcome.time = state_.time();
    outcome.end_time = static_cast<double>(last_step_) * kTimeStep;
    outcome.checkpoint = last_checkpoint_.file;
    outcome.state_hash = last_checkpoint_.state_hash;
    outcome.particles = kParticles;
    outcome.steps_done = state_.step - start_step_;
    outcome.wall_seconds = seconds();
    outcome.compute_seconds = 0.9 * seconds();
    outcome.checkpoint_seconds = 0.05 * seconds();
    write_atomic(options_.run_dir / run_files::outcome(options_.token), to_json(outcome));
  }

  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  }

  Options options_;
  std::string claim_;
  bool has_faults_ = true;
  bool by_signal_ = false;
  useconds_t pace_ = 0;
  Case input_;
  std::string key_;
  FakeState state_;
  std::int64_t start_step_ = 0;
  std::int64_t last_step_ = 0;
  std::int64_t checkpoint_every_ = 1;
  std::int64_t sequence_ = 0;
  CheckpointManifest last_checkpoint_;
  std::string memory_;
  std::ofstream series_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace
}  // namespace grouser

int main(int argc, char** argv) {
  for (const int number : {SIGTERM, SIGUSR1, SIGUSR2})
    ::signal(number, [](int) { grouser::is_terminated = 1; });
  try {
    return grouser::FakeEngine(grouser::parse(argc, argv)).run();
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return static_cast<int>(grouser::EngineCode::kInputRefused);
  }
}
