// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/atomic_file.hpp"
#include "campaign/drive/driver.hpp"
#include "campaign/drive/launch.hpp"
#include "campaign/drive/wishes.hpp"
#include "small_campaign.hpp"
#include "tests/support/temporary_directory.hpp"

// A campaign of two wheel runs on one bed, a scheduler in memory and a clock that tests turn.
namespace grouser {

inline const LeaseHolder kMe{"here", "boot", 1, 2, 0};

class TestClock : public Clock {
 public:
  double now() override { return time; }
  void sleep(double seconds) override { time += seconds; }
  double time = 1e9;
};

class TestScheduler : public Scheduler {
 public:
  SubmitAnswer submit(const JobRequest& request) override {
    requests.push_back(request);
    const bool takes = next_answer.kind == SubmitAnswer::Kind::kAccepted ||
                       (next_answer.kind == SubmitAnswer::Kind::kUnclear && takes_unclear);
    const std::string id = "j" + std::to_string(requests.size());
    if (takes)
      for (const std::string& task : tasks_of(request))
        jobs[request.name + task] = {request.name + task, id + task, JobPhase::kRunning,
                                     JobEnd::kNone,       -1,        ""};
    SubmitAnswer answer = next_answer;
    if (answer.kind == SubmitAnswer::Kind::kAccepted) answer.job = id;
    next_answer = {SubmitAnswer::Kind::kAccepted, "", ""};
    return answer;
  }
  QueryAnswer query(const std::vector<JobKey>& keys) override {
    QueryAnswer answer;
    answer.is_complete = can_be_asked;
    answer.why_not = can_be_asked ? "" : "down";
    if (!can_be_asked) return answer;
    for (const JobKey& key : keys)
      if (jobs.count(key.name) > 0) answer.jobs.push_back(jobs[key.name]);
    return answer;
  }
  std::string cancel(const JobKey& key, CancelMode mode) override {
    cancelled.emplace_back(key.name, mode);
    return "";
  }

  // "_0", "_1" ... of an array; "" of a single job.
  static std::vector<std::string> tasks_of(const JobRequest& request) {
    const std::string mark = "#SBATCH --array=0-";
    const std::string text = read_file(request.script).value_or("");
    const auto at = text.find(mark);
    if (at == std::string::npos) return {""};
    std::vector<std::string> tasks;
    for (int i = 0; i <= std::stoi(text.substr(at + mark.size())); ++i)
      tasks.push_back("_" + std::to_string(i));
    return tasks;
  }

  std::vector<JobRequest> requests;
  std::map<std::string, JobStatus> jobs;
  std::vector<std::pair<std::string, CancelMode>> cancelled;
  SubmitAnswer next_answer{SubmitAnswer::Kind::kAccepted, "", ""};
  bool takes_unclear = true;
  bool can_be_asked = true;
};

class Driving : public ::testing::Test {
 protected:
  explicit Driving(const std::string& head =
                       "campaign: small\nscheduler: slurm\n"
                       "resources: {walltime: 1h}\n") {
    root_ = directory_.path() / "root";
    std::filesystem::create_directories(root_);
    store_.emplace(open_store());
    launch(small_campaign(kTwoSlips, head));
  }

  std::filesystem::path yaml() const { return directory_.path() / "c.yaml"; }

  // As the manager that holds the lease.
  Store open_store() const {
    Store store = Store::open(root_ / Store::kFileName);
    store.take_lease(kMe, [](const LeaseHolder&) { return true; });
    return store;
  }

  // What `submit --update` does with such a file.
  void launch(const std::string& text) {
    write_atomic(yaml(), text);
    launch_again(*store_);
  }
  void launch_again(Store& store) {
    launch_plan(plan_campaign(yaml(), ""), yaml(), "/bin/true", root_, clock_.now(), store);
  }

  // Each tick is a manager process of its own.
  TickReport tick(double later = 40.0) {
    clock_.time += later;
    return Driver(root_, *store_, scheduler_, clock_).tick();
  }

  RunRow run(const std::string& start) const {
    for (const RunRow& one : store_->runs())
      if (one.label.rfind(start, 0) == 0) return one;
    throw std::runtime_error("no run " + start);
  }

  // What an engine that ended leaves behind.
  void end_engine(const std::string& label, EngineCode code, std::int64_t step, double time,
                  bool by_signal = false) {
    const RunRow of = run(label);
    const AttemptRow attempt = store_->attempts(of.id).back();
    Outcome outcome;
    outcome.token = attempt.token;
    outcome.code = code;
    outcome.by_signal = by_signal;
    outcome.step = step;
    outcome.time = time;
    outcome.checkpoint = "c.h5";
    write_atomic(root_ / of.directory / run_files::outcome(attempt.token), to_json(outcome));
    JobStatus& job = scheduler_.jobs[job_name(attempt.token)];
    job.phase = JobPhase::kEnded;
    job.end = code == EngineCode::kFinished ? JobEnd::kDone : JobEnd::kFailed;
    job.exit_code = static_cast<int>(code);
  }

  void settle_bed() {
    tick();
    end_engine("bed", EngineCode::kFinished, 50, 0.05);
    tick();
  }

  TemporaryDirectory directory_;
  std::filesystem::path root_;
  TestClock clock_;
  TestScheduler scheduler_;
  std::optional<Store> store_;
};

}  // namespace grouser
