// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "campaign/drive/decide.hpp"

// What the tests of decisions start from: an attempt that runs as job 77 since step 100.
namespace grouser {

inline constexpr double kNow = 1000.0;

inline Policy policy() {
  Policy p;
  p.retries = 3;
  p.grace = 60.0;
  p.looks = 2;
  p.end_looks = 1;
  p.linger = 60.0;
  return p;
}

inline AttemptRow running_attempt() {
  AttemptRow attempt;
  attempt.token = "abc123def456";
  attempt.job = "77";
  attempt.state = State::kRunning;
  attempt.start_step = 100;
  return attempt;
}

inline RunRow running_run() {
  RunRow run;
  run.label = "r";
  run.state = State::kRunning;
  run.step = 100;
  return run;
}

inline Outcome outcome(EngineCode code, std::int64_t step, double time) {
  Outcome o;
  o.token = "abc123def456";
  o.code = code;
  o.reason = word_of(code);
  o.step = step;
  o.time = time;
  o.checkpoint = "c.h5";
  o.state_hash = "hash";
  return o;
}

inline JobRecord exit_record(int code) { return {"abc123def456", "77", "host", code}; }

inline JobStatus job(JobPhase phase, JobEnd end = JobEnd::kNone, int code = -1) {
  return {"gabc123def456", "77", phase, end, code, "WORD"};
}

inline Evidence answered() {
  Evidence evidence;
  evidence.scheduler_answered = true;
  return evidence;
}

inline CheckpointManifest checkpoint(std::int64_t step) {
  CheckpointManifest manifest;
  manifest.file = "m.h5";
  manifest.step = step;
  manifest.time = static_cast<double>(step) * 1e-3;
  manifest.state_hash = "newest";
  return manifest;
}

}  // namespace grouser
