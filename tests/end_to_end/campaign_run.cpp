// SPDX-License-Identifier: BSD-3-Clause
#include "campaign_run.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "base/atomic_file.hpp"
#include "campaign/plan/expand.hpp"
#include "schedulers/process.hpp"
#include "tests/campaign/small_campaign.hpp"
#include "tests/fakes/fake_physics.hpp"

namespace grouser {
namespace {

constexpr const char* kThreeSlips = R"(sweep:
  - axis: slip
    points:
      - {label: towed, set: {wheel.drive: towed}}
      - {label: slip_00, set: {wheel.slip: 0 %}}
      - {label: slip_20, set: {wheel.slip: 20 %}}
)";

}  // namespace

CampaignRun::CampaignRun() {
  variables["GROUSER_ENGINE"] = FAKE_ENGINE;
  write_campaign("chunks: {count: 3}\n");
}

// Jobs that a test left behind must not outlive it.
CampaignRun::~CampaignRun() { kill_local_jobs(); }

void CampaignRun::kill_local_jobs() const {
  std::error_code error;
  for (const auto& job : std::filesystem::directory_iterator(root() / ".local", error)) {
    std::int64_t pid = 0;
    std::istringstream(read_file(job.path() / "started").value_or("")) >> pid;
    if (pid <= 1) continue;
    for (const ProcessLine& line : session_processes(pid))
      ::kill(static_cast<pid_t>(line.pid), SIGKILL);
  }
}

void CampaignRun::write_campaign(const std::string& head) {
  write_atomic(directory_.path() / "campaign.yaml",
               small_campaign(kThreeSlips, "campaign: small\n" + head));
}

CommandResult CampaignRun::grouser(const std::vector<std::string>& words, double seconds) const {
  std::vector<std::string> all{"env"};
  for (const auto& [name, value] : variables) all.push_back(name + "=" + value);
  all.push_back(GROUSER_PROGRAM);
  all.insert(all.end(), words.begin(), words.end());
  return run_command(all, seconds, directory_.path());
}

pid_t CampaignRun::start(const std::vector<std::string>& words) const {
  const pid_t child = ::fork();
  if (child != 0) return child;
  ::setpgid(0, 0);
  for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
  std::vector<char*> arguments{const_cast<char*>(GROUSER_PROGRAM)};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  if (::chdir(directory_.path().c_str()) != 0 || std::freopen("/dev/null", "w", stdout) == nullptr)
    ::_exit(127);
  ::execv(GROUSER_PROGRAM, arguments.data());
  ::_exit(127);
}

CommandResult CampaignRun::submit() const {
  return grouser({"submit", "campaign.yaml", "--wait", "--every", "0.1", "--grace", "0.5"});
}

bool CampaignRun::has_runs() const {
  try {
    return !runs().empty();
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::vector<RunRow> CampaignRun::runs() const {
  return Store::open_read_only(root() / Store::kFileName).runs();
}

std::vector<AttemptRow> CampaignRun::attempts() const {
  return Store::open_read_only(root() / Store::kFileName).attempts();
}

RunRow CampaignRun::run(const std::string& label) const {
  for (const RunRow& one : runs())
    if (one.label == label) return one;
  throw std::runtime_error("no run " + label);
}

std::map<std::string, std::string> CampaignRun::final_hashes() const {
  std::map<std::string, std::string> hashes;
  for (const RunRow& one : runs()) hashes[one.label] = one.state_hash;
  return hashes;
}

std::map<std::string, std::string> CampaignRun::undisturbed_hashes() const {
  std::map<std::string, std::string> hashes;
  std::map<std::string, FakeState> beds;
  for (const PlannedRun& run : plan_campaign(directory_.path() / "campaign.yaml", "").runs) {
    std::optional<FakeState> bed;
    if (!run.bed_key.empty()) bed = beds.at(run.bed_key);
    const FakeState end = FakeState::end(run.input, bed);
    if (run.is_bed) beds[run.key] = end;
    hashes[run.label] = end.hash();
  }
  return hashes;
}

void CampaignRun::expect_undisturbed_result() const {
  EXPECT_EQ(final_hashes(), undisturbed_hashes());
  for (const RunRow& one : runs()) {
    EXPECT_EQ(one.state, State::kCompleted) << one.label << ": " << one.reason;
    EXPECT_FALSE(std::filesystem::exists(root() / one.directory / "overlap"))
        << one.label << " had two engines at once";
  }
}

bool CampaignRun::wait_for(const std::function<bool()>& condition, double seconds) {
  const auto end = std::chrono::steady_clock::now() +
                   std::chrono::milliseconds(static_cast<long>(1e3 * seconds));
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

}  // namespace grouser
