// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "campaign/store/rows.hpp"

namespace grouser {

/// Who may write: one process at a time, named so that others can tell whether it still lives.
struct LeaseHolder {
  std::string host;
  std::string boot;  ///< boot id of the host
  std::int64_t pid = 0;
  std::int64_t start = 0;  ///< start time of the process [clock ticks since boot]
  std::int64_t beat = 0;   ///< grows while the holder works
  auto operator<=>(const LeaseHolder&) const = default;
};

/// A run to be added together with its chunks; `row.id` is ignored, `bed` is found by `bed_key`.
struct NewRun {
  RunRow row;
  std::string bed_key;  ///< key of the bed run it needs, or ""
  std::vector<std::optional<double>> chunk_ends;
};

/// Chunks of a run that has not begun or begins anew. Chunks that attempts refer to stay, so that
/// the history stays whole, and are planned again; the others become those of `ends`.
struct Recut {
  RunId run;
  std::vector<std::optional<double>> ends;
};

/// What a new plan makes of a campaign, to be written together or not at all.
struct PlanChange {
  CampaignRow campaign;
  std::vector<RunRow> runs;   ///< that are there and change, axes included; a label may pass from
                              ///< one to another or to an added run
  std::vector<NewRun> added;  ///< beds first
  std::vector<Recut> recut;
};

/// Rows to be written together or not at all.
struct Change {
  std::optional<RunRow> run;
  std::optional<ChunkRow> chunk;
  std::optional<AttemptRow> attempt;
  std::optional<ChunkRow> chunk_after;  ///< inserted after `chunk`; later ones move up by one
  bool drop_planned_chunks = false;     ///< the run ended before its later chunks began
};

/// Answer of a read-only query in text form.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::vector<bool>> is_text;  ///< false for numbers and NULL; same shape as rows
};

/// Name of the journal in a campaign root; see rebuild.hpp.
inline constexpr const char* kJournalName = "grouser.journal";

/// Name of the frozen copy of the campaign's YAML in its root, beside the database.
inline constexpr const char* kFrozenCampaign = "campaign.yaml";

/// The campaign's database `grouser.db`. It is a record of what the manager decided and observed;
/// compute jobs never open it. All SQL of the program stands behind this class.
///
/// Every function throws StorageError when SQLite or the file system refuses and FormatError when
/// the file is not a database of ours or of a newer version.
class Store {
 public:
  /// Name of the database in a campaign root.
  static constexpr const char* kFileName = "grouser.db";

  /// Opens for reading only; a campaign being written at the same time is fine. Local.
  static Store open_read_only(const std::filesystem::path& file);
  /// Opens for writing, creating or migrating the schema. Local.
  static Store open(const std::filesystem::path& file);
  /// Opens an empty one that is filled from a journal by redo(); see rebuild.hpp. Local.
  static Store open_for_replay(const std::filesystem::path& file);
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();

  bool has_campaign() const;
  CampaignRow campaign() const;
  /// In the order of the plan, beds first.
  std::vector<RunRow> runs() const;
  RunRow run(RunId id) const;
  /// Of one run by position, or of all runs.
  std::vector<ChunkRow> chunks(std::optional<RunId> run = std::nullopt) const;
  /// Of one run by number, or of all runs.
  std::vector<AttemptRow> attempts(std::optional<RunId> run = std::nullopt) const;
  /// The `count` attempts that ended last, the last one first.
  std::vector<AttemptRow> ended_last(int count) const;
  /// How long all jobs together were at work; the views' occupied_seconds [s].
  double occupied_seconds() const;
  /// Attempts for which a job may exist.
  std::vector<AttemptRow> active_attempts() const;

  /// Runs one SELECT (or WITH, VALUES, EXPLAIN) statement of the user on a store opened for
  /// reading. @throws std::invalid_argument with SQLite's message when the statement is wrong or
  /// would write.
  Table query(const std::string& sql) const;

  /// Takes the lease for `me` unless another holds it and `may_replace` says no of that one.
  /// @return nothing when taken, else who holds it.
  std::optional<LeaseHolder> take_lease(const LeaseHolder& me,
                                        const std::function<bool(const LeaseHolder&)>& may_replace);
  /// Gives the lease back if it is still `me`'s.
  void release_lease(const LeaseHolder& me);

  /// The functions below need the lease. @throws LeaseLost when it is no longer ours.
  void replace_plan(const PlanChange& change);
  /// First transaction of a submission: writes the new attempt, its chunk and its run.
  /// @return the attempt's number. @throws StorageError when the run already has an active attempt.
  AttemptRow add_attempt(const AttemptRow& attempt, const RunRow& run, const ChunkRow& chunk);
  void apply(const Change& change);

  /// Does what a line of the journal tells; of a store opened for replay.
  void redo(const std::string& line);
  /// Of the last change, as the journal counts them.
  std::int64_t change_number() const;

 private:
  struct Impl;
  explicit Store(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Another process took over the campaign while this one worked; it must stop writing.
class LeaseLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace grouser
