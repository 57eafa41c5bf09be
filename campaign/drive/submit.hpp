// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/plan/campaign_file.hpp"
#include "campaign/store/store.hpp"
#include "schedulers/table.hpp"

namespace grouser {

/// What all jobs of a campaign share.
struct JobSettings {
  std::filesystem::path root;  ///< absolute
  std::string campaign;
  std::string engine;                       ///< absolute path
  std::string engine_hash;                  ///< of the engine's program file
  std::string home;                         ///< of the user who submits
  std::vector<std::string> excluded_hosts;  ///< on which jobs kept failing
  double checkpoint_seconds = 0.0;  ///< wall time between checkpoints; 0 = the case decides [s]
  Settings settings;
};

/// The job of one attempt: engine arguments as docs/reference/formats/run_directory.md says. Pure.
/// @param bed  the run's bed, or nullptr
JobSpec job_spec(const JobSettings& shared, const RunRow& run, const ChunkRow& chunk,
                 const RunRow* bed, const std::string& token);

/// A new token: 12 characters a-z 0-9 from the system's random source. Local.
std::string make_token();

/// What is to be submitted.
struct Submission {
  RunRow run;
  ChunkRow chunk;
  const RunRow* bed = nullptr;  ///< of the run, if it starts from one
};

/// Submits one attempt, in an order that a crash at any point can be told apart later: the database
/// first (SUBMITTING), then fence and script, then the scheduler, then its answer.
/// @return what the scheduler answered. @throws StorageError, LeaseLost.
SubmitAnswer submit_attempt(const JobSettings& shared, const SchedulerKind& kind,
                            Scheduler& scheduler, Store& store, const Submission& submission,
                            double now);

/// The same for several attempts as one job array, at most `at_once` of them at work at one time
/// (0 = all). One whose files cannot be written is held and left out.
SubmitAnswer submit_array(const JobSettings& shared, const SchedulerKind& kind,
                          Scheduler& scheduler, Store& store,
                          const std::vector<Submission>& submissions, std::int64_t at_once,
                          double now);

}  // namespace grouser
