// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>
#include <vector>

#include "base/check.hpp"
#include "campaign/store/rows.hpp"

namespace grouser {

// The columns of each table are listed once, by a function `columns(visitor, row)`; reading,
// inserting and updating are visitors of that list.

template <class Visitor, class Row>
void columns_of_campaign(Visitor& v, Row& r) {
  v("name", r.name), v("title", r.title), v("source", r.source), v("settings", r.settings);
  v("engine", r.engine), v("created_at", r.created_at);
}

template <class Visitor, class Row>
void columns_of_run(Visitor& v, Row& r) {
  v("label", r.label), v("kind", r.kind), v("directory", r.directory), v("key", r.key);
  v("in_plan", r.in_plan), v("bed_id", r.bed), v("state", r.state), v("reason", r.reason),
      v("request", r.request);
  v("requested_at", r.requested_at), v("failures", r.failures), v("not_before", r.not_before);
  v("step", r.step), v("time", r.time), v("end_time", r.end_time);
  v("checkpoint", r.checkpoint), v("state_hash", r.state_hash), v("particles", r.particles);
  v("engine_hash", r.engine_hash);
}

template <class Visitor, class Row>
void columns_of_chunk(Visitor& v, Row& r) {
  v("run_id", r.run), v("position", r.position), v("until_time", r.until_time);
  v("state", r.state), v("step", r.step), v("time", r.time);
}

template <class Visitor, class Row>
void columns_of_attempt(Visitor& v, Row& r) {
  v("run_id", r.run), v("chunk_id", r.chunk), v("number", r.number), v("token", r.token);
  v("job", r.job), v("state", r.state), v("code", r.code), v("has_outcome", r.has_outcome);
  v("outcome_class", r.outcome_class), v("reason", r.reason), v("created_at", r.created_at);
  v("submitted_at", r.submitted_at), v("running_at", r.running_at), v("outcome_at", r.outcome_at),
      v("ended_at", r.ended_at);
  v("start_step", r.start_step), v("step", r.step), v("time", r.time);
  v("steps_done", r.steps_done), v("particles", r.particles), v("ranks", r.ranks);
  v("threads", r.threads);
  v("wall_seconds", r.wall_seconds), v("compute_seconds", r.compute_seconds);
  v("checkpoint_seconds", r.checkpoint_seconds), v("checkpoint", r.checkpoint);
  v("state_hash", r.state_hash), v("engine_hash", r.engine_hash), v("absences", r.absences);
  v("absent_since", r.absent_since), v("absent_step", r.absent_step);
  v("host", r.host), v("progress_step", r.progress_step), v("progress_at", r.progress_at);
  v("slowest_checkpoint", r.slowest_checkpoint), v("useful_seconds", r.useful_seconds);
  v("lost_seconds", r.lost_seconds), v("hung_seconds", r.hung_seconds);
}

/// Names of the columns.
class ColumnNames {
 public:
  template <class Value>
  void operator()(const char* name, const Value&) {
    names.emplace_back(name);
  }
  std::vector<std::string> names;
};

/// Binds the values in order, from `at` on.
class ColumnBinder {
 public:
  explicit ColumnBinder(SQLite::Statement& statement) : statement_(statement) {}
  void operator()(const char*, const std::string& value) { statement_.bind(next_++, value); }
  void operator()(const char*, const std::filesystem::path& value) {
    statement_.bind(next_++, value.string());
  }
  void operator()(const char*, const std::int64_t& value) { statement_.bind(next_++, value); }
  void operator()(const char*, const int& value) { statement_.bind(next_++, value); }
  void operator()(const char*, const double& value) { statement_.bind(next_++, value); }
  void operator()(const char*, const bool& value) { statement_.bind(next_++, value ? 1 : 0); }
  void operator()(const char*, const State& value) { statement_.bind(next_++, word_of(value)); }
  void operator()(const char*, const RunKind& value) { statement_.bind(next_++, word_of(value)); }
  template <class Table>
  void operator()(const char*, const RowId<Table>& value) {
    statement_.bind(next_++, value.value);
  }
  template <class Value>
  void operator()(const char* name, const std::optional<Value>& value) {
    if (value)
      (*this)(name, *value);
    else
      statement_.bind(next_++);
  }
  int next() const { return next_; }

 private:
  SQLite::Statement& statement_;
  int next_ = 1;
};

/// Reads the values in order, from column `at` on.
class ColumnReader {
 public:
  ColumnReader(const SQLite::Statement& statement, int at) : statement_(statement), next_(at) {}
  void operator()(const char*, std::string& value) { value = take().getString(); }
  void operator()(const char*, std::filesystem::path& value) { value = take().getString(); }
  void operator()(const char*, std::int64_t& value) { value = take().getInt64(); }
  void operator()(const char*, int& value) { value = take().getInt(); }
  void operator()(const char*, double& value) { value = take().getDouble(); }
  void operator()(const char*, bool& value) { value = take().getInt() != 0; }
  void operator()(const char*, State& value) { value = state_from(take().getString()); }
  void operator()(const char*, RunKind& value) {
    value = take().getString() == "bed" ? RunKind::kBed : RunKind::kWheel;
  }
  template <class Table>
  void operator()(const char*, RowId<Table>& value) {
    value.value = take().getInt64();
  }
  template <class Value>
  void operator()(const char* name, std::optional<Value>& value) {
    if (statement_.getColumn(next_).isNull()) {
      value.reset();
      ++next_;
    } else {
      (*this)(name, value.emplace());
    }
  }

 private:
  SQLite::Column take() { return statement_.getColumn(next_++); }

  const SQLite::Statement& statement_;
  int next_;
};

}  // namespace grouser
