// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "campaign/store/state.hpp"

namespace grouser {

/// Row number in one table; numbers of different tables do not mix.
template <class Table>
struct RowId {
  std::int64_t value = 0;
  auto operator<=>(const RowId&) const = default;
};
struct RunTable;
struct ChunkTable;
struct AttemptTable;
using RunId = RowId<RunTable>;
using ChunkId = RowId<ChunkTable>;
using AttemptId = RowId<AttemptTable>;

/// The campaign itself. Times are seconds since 1970 on the manager's host.
struct CampaignRow {
  std::string name;
  std::string title;
  std::filesystem::path source;  ///< absolute path of the YAML file it was made from; relative
                                 ///< paths in the YAML count from its directory
  std::string settings;          ///< scheduler, resources and retries as YAML
  std::string engine;            ///< absolute path of the engine
  double created_at = 0.0;
};

/// One sweep point of a run.
struct AxisLabel {
  std::string axis;
  std::string label;
  bool operator==(const AxisLabel&) const = default;
};

enum class RunKind { kBed, kWheel };
const char* word_of(RunKind kind);

struct RunRow {
  RunId id;
  std::string label;
  RunKind kind = RunKind::kWheel;
  std::filesystem::path directory;  ///< relative to the campaign root
  std::string key;                  ///< content_key of the case
  bool in_plan = true;              ///< the YAML has it; of others only the files are kept
  std::vector<AxisLabel> axes;      ///< in the order of the sweep; empty for a shared bed
  std::optional<RunId> bed;         ///< the run whose settled bed this one starts from
  State state = State::kPlanned;
  std::string reason;          ///< one sentence: why held, failed, waiting; else ""
  std::string request;         ///< "stop" or "cancel" while a person's wish is being carried out
  double requested_at = 0.0;   ///< when it was made [s]
  std::int64_t failures = 0;   ///< attempts in a row that brought no progress
  double not_before = 0.0;     ///< no submission before this time (back-off) [s]
  std::int64_t step = 0;       ///< last checkpointed step
  double time = 0.0;           ///< simulated time of that step [s]
  double end_time = 0.0;       ///< simulated time at which the run is done, 0 = unknown [s]
  std::string checkpoint;      ///< file name of the newest checkpoint
  std::string state_hash;      ///< of the state in it
  std::int64_t particles = 0;  ///< 0 = unknown
  std::string engine_hash;     ///< of the program that its state was computed with; "" = any
};

struct ChunkRow {
  ChunkId id;
  RunId run;
  std::int64_t position = 0;         ///< 0, 1, 2 ... within the run
  std::optional<double> until_time;  ///< simulated time of its end [s]; nothing = end of the run
  State state = State::kPlanned;
  std::int64_t step = 0;  ///< step reached
  double time = 0.0;      ///< simulated time reached [s]
};

/// One try of a chunk. Seconds of work are the engine's own; they are 0 when it left no outcome.
struct AttemptRow {
  AttemptId id;
  RunId run;
  ChunkId chunk;
  std::int64_t number = 0;  ///< 1, 2, 3 ... within the run
  std::string token;        ///< in the fence, the job name and the outcome's file name
  std::string job;          ///< scheduler's id, "" while not known
  State state = State::kSubmitting;
  std::optional<int> code;    ///< engine's code from the outcome, else the job's exit code
  bool has_outcome = false;   ///< the engine left its last word
  std::string outcome_class;  ///< DONE CONTINUE INFRA RESOURCE PHYSICS PLUMBING USER DEFECT, or ""
  std::string reason;
  double created_at = 0.0;    ///< [s]
  double submitted_at = 0.0;  ///< the scheduler took it; 0 = not yet [s]
  double running_at = 0.0;    ///< first seen running; 0 = not yet [s]
  double outcome_at = 0.0;    ///< its outcome was first seen; 0 = not yet [s]
  double ended_at = 0.0;      ///< found ended; 0 = not yet [s]
  std::int64_t start_step = 0;
  std::int64_t step = 0;
  double time = 0.0;  ///< simulated [s]
  std::int64_t steps_done = 0;
  std::int64_t particles = 0;
  int ranks = 0;
  int threads = 1;  ///< of each rank
  double wall_seconds = 0.0;
  double compute_seconds = 0.0;
  double checkpoint_seconds = 0.0;
  std::string checkpoint;
  std::string state_hash;
  std::string engine_hash;          ///< of the engine's program file at submission
  std::int64_t absences = 0;        ///< looks in a row at which the job was gone without an outcome
  double absent_since = 0.0;        ///< time of the first of them [s]
  std::int64_t absent_step = 0;     ///< step in progress.json then
  std::string host;                 ///< on which its job began, "" while not known
  std::int64_t progress_step = 0;   ///< step in progress.json when it was last seen to grow
  double progress_at = 0.0;         ///< and when that was [s]
  double slowest_checkpoint = 0.0;  ///< the longest that one took [s]
  double useful_seconds = 0.0;      ///< computing that is in the run's state [s]
  double lost_seconds = 0.0;        ///< computing that is not [s]
  double hung_seconds = 0.0;        ///< occupied without advancing [s]
};

}  // namespace grouser
