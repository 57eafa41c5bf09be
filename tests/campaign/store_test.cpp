// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/store.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "base/errors.hpp"
#include "campaign/drive/clock.hpp"
#include "campaign/drive/lease_guard.hpp"
#include "campaign/store/database.hpp"
#include "campaign/store/journal_mode.hpp"
#include "campaign/store/storage_advice.hpp"
#include "schedulers/command.hpp"
#include "schedulers/process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

const LeaseHolder kMe{"here", "boot", 1, 2, 0};

NewRun bed_run() {
  NewRun run;
  run.row.label = "bed";
  run.row.kind = RunKind::kBed;
  run.row.directory = "beds/bed";
  run.row.key = "k1";
  run.chunk_ends = {std::nullopt};
  return run;
}

NewRun wheel_run(const std::string& label) {
  NewRun run;
  run.row.label = label;
  run.row.directory = "runs/" + label;
  run.row.key = label;
  run.row.axes = {{"slip", label}, {"seed", "s1"}};
  run.bed_key = "k1";
  run.chunk_ends = {0.1, 0.2, std::nullopt};
  return run;
}

CampaignRow campaign() { return {"name", "title", "/x/c.yaml", "settings", "/bin/engine", 12.5}; }

class Database : public ::testing::Test {
 protected:
  Database() {
    store_.take_lease(kMe, [](const LeaseHolder&) { return false; });
    store_.replace_plan({campaign(), {}, {bed_run(), wheel_run("a"), wheel_run("b")}, {}});
  }
  AttemptRow start(const RunRow& run, const std::string& token) {
    const ChunkRow chunk = store_.chunks(run.id).front();
    AttemptRow attempt;
    attempt.run = run.id;
    attempt.chunk = chunk.id;
    attempt.token = token;
    return store_.add_attempt(attempt, run, chunk);
  }
  std::filesystem::path file() const { return directory_.path() / Store::kFileName; }

  TemporaryDirectory directory_;
  Store store_ = Store::open(file());
};

TEST_F(Database, RunsReadBackAsWritten) {
  const Store reader = Store::open_read_only(file());
  const auto runs = reader.runs();
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].kind, RunKind::kBed);
  EXPECT_EQ(runs[0].bed, std::nullopt);
  EXPECT_EQ(runs[2].bed, runs[0].id);
  EXPECT_EQ(runs[2].label, "b");
  EXPECT_TRUE(runs[2].in_plan);
  ASSERT_EQ(runs[2].axes.size(), 2u);
  EXPECT_EQ(runs[2].axes[0].axis, "slip");
  EXPECT_EQ(runs[2].axes[1].label, "s1");
  EXPECT_EQ(reader.chunks(runs[2].id).size(), 3u);
  EXPECT_EQ(reader.campaign().created_at, 12.5);
}

TEST_F(Database, AttemptsReadBackAsWritten) {
  AttemptRow attempt = start(store_.runs()[1], "t1");
  EXPECT_EQ(attempt.number, 1);
  attempt.state = State::kChunkDone;
  attempt.code = 10;
  attempt.has_outcome = true;
  attempt.wall_seconds = 0.1;
  attempt.state_hash = "abc";
  Change change;
  change.attempt = attempt;
  store_.apply(change);
  const AttemptRow back = store_.attempts().front();
  EXPECT_EQ(back.code, 10);
  EXPECT_TRUE(back.has_outcome);
  EXPECT_EQ(back.wall_seconds, 0.1);
  EXPECT_EQ(back.state_hash, "abc");
  EXPECT_EQ(start(store_.runs()[1], "t2").number, 2);
}

// Changing the journal's mode does not wait for locks by itself.
TEST_F(Database, ManyMayMakeItAtOnce) {
  const TemporaryDirectory directory;
  for (int round = 0; round < 40; ++round) {
    const std::filesystem::path file = directory.path() / ("new" + std::to_string(round) + ".db");
    std::vector<std::string> failures(8);
    std::vector<std::thread> makers;
    for (std::string& failure : failures)
      makers.emplace_back([&failure, &file] {
        try {
          open_database(file, true);
        } catch (const std::exception& error) {
          failure = error.what();
        }
      });
    for (std::thread& maker : makers) maker.join();
    for (const std::string& failure : failures) ASSERT_EQ(failure, "") << "round " << round;
  }
}

TEST_F(Database, RefusesASecondActiveAttemptOfARun) {
  start(store_.runs()[1], "t1");
  EXPECT_THROW(start(store_.runs()[1], "t2"), StorageError);
  EXPECT_EQ(store_.attempts().size(), 1u);
  start(store_.runs()[2], "t3");  // of another run it is fine
}

TEST_F(Database, AChangeHappensWhollyOrNotAtAll) {
  const RunRow run = store_.runs()[1];
  Change change;
  change.run = run;
  change.run->state = State::kHeld;
  change.chunk_after = store_.chunks(run.id).front();
  change.chunk_after->position = 0;
  change.attempt = AttemptRow{};  // there is no such attempt
  EXPECT_ANY_THROW(store_.apply(change));
  EXPECT_EQ(store_.run(run.id).state, State::kPlanned);
  EXPECT_EQ(store_.chunks(run.id).size(), 3u);
}

TEST_F(Database, AnInsertedChunkMovesTheLaterOnesUp) {
  const RunRow run = store_.runs()[1];
  const auto before = store_.chunks(run.id);
  Change change;
  change.chunk_after = before[0];
  change.chunk_after->position = 1;
  store_.apply(change);
  const auto after = store_.chunks(run.id);
  ASSERT_EQ(after.size(), 4u);
  EXPECT_EQ(after[0].id, before[0].id);
  EXPECT_EQ(after[2].id, before[1].id);
  EXPECT_EQ(after[3].id, before[2].id);
  for (std::size_t i = 0; i < after.size(); ++i)
    EXPECT_EQ(after[i].position, static_cast<std::int64_t>(i));
  EXPECT_EQ(store_.chunks(store_.runs()[2].id).size(), 3u);
}

TEST_F(Database, ALabelMayPassFromOneRunToAnother) {
  auto runs = store_.runs();
  std::swap(runs[1].label, runs[2].label);
  runs[1].in_plan = false;
  runs[2].axes = {{"drive", "towed"}};
  NewRun added = wheel_run("c");
  store_.replace_plan({campaign(), {runs[1], runs[2]}, {added}, {}});
  const auto after = store_.runs();
  ASSERT_EQ(after.size(), 4u);
  EXPECT_EQ(after[1].label, "b");
  EXPECT_FALSE(after[1].in_plan);
  EXPECT_EQ(after[2].label, "a");
  EXPECT_EQ(after[2].axes, (std::vector<AxisLabel>{{"drive", "towed"}}));
  EXPECT_EQ(after[3].bed, after[0].id);
}

TEST_F(Database, APlanIsReplacedWhollyOrNotAtAll) {
  RunRow left = store_.runs()[1];
  left.in_plan = false;
  left.label = "a-old";
  CampaignRow other = campaign();
  other.title = "other";
  // The added run's label is still taken.
  EXPECT_THROW(store_.replace_plan({other, {left}, {wheel_run("b")}, {}}), StorageError);
  EXPECT_EQ(store_.campaign().title, "title");
  EXPECT_EQ(store_.runs()[1].label, "a");
  EXPECT_TRUE(store_.runs()[1].in_plan);
}

TEST_F(Database, ChunksAreCutAnewButForThoseOfAttempts) {
  const RunRow run = store_.runs()[1];
  start(run, "t1");
  Change finish;  // early, so that the chunks after it were dropped
  finish.run = run;
  finish.chunk = store_.chunks(run.id).front();
  finish.chunk->state = State::kCompleted;
  finish.chunk->step = 9;
  finish.drop_planned_chunks = true;
  store_.apply(finish);
  ASSERT_EQ(store_.chunks(run.id).size(), 1u);
  store_.replace_plan({campaign(), {}, {}, {{run.id, {0.05, 0.15, std::nullopt}}}});
  const auto chunks = store_.chunks(run.id);
  ASSERT_EQ(chunks.size(), 3u);
  EXPECT_EQ(chunks[0].id, finish.chunk->id);
  EXPECT_EQ(chunks[0].until_time, 0.1);
  EXPECT_EQ(chunks[0].step, 0);
  EXPECT_EQ(chunks[1].until_time, 0.15);
  EXPECT_EQ(chunks[2].until_time, std::nullopt);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    EXPECT_EQ(chunks[i].state, State::kPlanned);
    EXPECT_EQ(chunks[i].position, static_cast<std::int64_t>(i));
  }
  const RunId untouched = store_.runs()[2].id;
  store_.replace_plan({campaign(), {}, {}, {{untouched, {std::nullopt}}}});
  EXPECT_EQ(store_.chunks(untouched).size(), 1u);
}

TEST_F(Database, WritingNeedsTheLease) {
  const LeaseHolder other{"there", "boot", 9, 9, 0};
  EXPECT_EQ(store_.take_lease(other, [](const LeaseHolder&) { return false; })->pid, 1);
  Store thief = Store::open(file());
  EXPECT_EQ(thief.take_lease(other, [](const LeaseHolder&) { return true; }), std::nullopt);
  Change change;
  change.run = store_.runs()[1];
  EXPECT_THROW(store_.apply(change), LeaseLost);
  EXPECT_NO_THROW(thief.apply(change));
  store_.release_lease(kMe);  // is not ours any more: stays
  EXPECT_TRUE(store_.take_lease(kMe, [](const LeaseHolder&) { return false; }).has_value());
}

TEST_F(Database, ALeaseOfADeadProcessIsTakenOver) {
  store_.release_lease(kMe);
  const pid_t child = ::fork();
  if (child == 0) {
    const ProcessId self = this_process();
    Store own = Store::open(file());
    own.take_lease({self.host, self.boot, self.pid, self.start, 0},
                   [](const LeaseHolder&) { return false; });
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  SystemClock clock;
  EXPECT_NO_THROW(LeaseGuard(store_, clock, 0.0, false));
}

TEST_F(Database, ALeaseOfALivingProcessIsRespectedAndNamed) {
  store_.release_lease(kMe);
  SystemClock clock;
  Store second = Store::open(file());
  const ProcessId parent = [] {
    ProcessId id = this_process();
    id.pid = ::getppid();
    id.start = process_line(id.pid)->start;
    return id;
  }();
  second.take_lease({parent.host, parent.boot, parent.pid, parent.start, 0},
                    [](const LeaseHolder&) { return false; });
  try {
    LeaseGuard guard(store_, clock, 0.0, false);
    FAIL() << "took a lease that is held";
  } catch (const CampaignBusy& busy) {
    EXPECT_NE(std::string(busy.what()).find(std::to_string(parent.pid)), std::string::npos);
  }
}

TEST_F(Database, QueriesReadAndNothingElse) {
  const Store reader = Store::open_read_only(file());
  const Table table = reader.query("SELECT label, chunks, bed FROM v_runs");
  EXPECT_EQ(table.columns, (std::vector<std::string>{"label", "chunks", "bed"}));
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[1], (std::vector<std::string>{"a", "3", "bed"}));
  EXPECT_EQ(table.is_text[1], (std::vector<bool>{true, false, true}));
  for (const char* sql :
       {"DELETE FROM run", "UPDATE run SET state = 'HELD'", "DROP VIEW v_runs",
        "ATTACH 'x.db' AS x", "PRAGMA journal_mode", "SELECT 1; DELETE FROM run", "BEGIN",
        "CREATE TEMP TABLE t (x)", "VACUUM INTO 'x.db'", "SELECT nothing FROM v_runs", ""})
    EXPECT_THROW(reader.query(sql), std::invalid_argument) << sql;
}

TEST_F(Database, EveryViewCanBeRead) {
  start(store_.runs()[1], "t1");
  for (const char* view : {"v_status", "v_runs", "v_axes", "v_chunks", "v_attempts", "v_ledger"})
    EXPECT_FALSE(store_.query(std::string("SELECT * FROM ") + view).rows.empty()) << view;
}

TEST_F(Database, OneOfANewerVersionIsRefused) {
  ASSERT_EQ(run_command({"sqlite3", file().string(), "PRAGMA user_version = 99"}, 10.0).code, 0);
  EXPECT_THROW(Store::open(file()), FormatError);
  EXPECT_THROW(Store::open_read_only(file()), FormatError);
}

TEST_F(Database, AForeignOrDamagedFileIsRefused) {
  const auto other = directory_.path() / "other.db";
  ASSERT_EQ(run_command({"sqlite3", other.string(), "CREATE TABLE t (x)"}, 10.0).code, 0);
  EXPECT_THROW(Store::open(other), FormatError);
  std::ofstream(directory_.path() / "text.db") << std::string(4096, 'x');
  try {
    Store::open(directory_.path() / "text.db");
    FAIL() << "opened a text as a database";
  } catch (const StorageError& error) {
    EXPECT_NE(std::string(error.what()).find("grouser rebuild --yes"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(Store::open_read_only(directory_.path() / "none.db"), StorageError);
}

TEST_F(Database, AReaderIsNotHeldUpByAWriter) {
  const Store reader = Store::open_read_only(file());
  start(store_.runs()[1], "t1");
  EXPECT_EQ(reader.active_attempts().size(), 1u);
}

// SQLite's result codes; sqlite3.h stays behind its fence.
TEST(StorageAdvice, SaysWhatToDo) {
  constexpr int kError = 1, kBusy = 5, kReadOnly = 8, kInputOutput = 10, kCorrupt = 11, kFull = 13;
  constexpr int kShortRead = kInputOutput | (2 << 8);
  const auto says = [](int code, const char* part) {
    return storage_advice(code).find(part) != std::string::npos;
  };
  EXPECT_TRUE(says(kFull, "free some space, then the same command goes on"));
  EXPECT_TRUE(says(kBusy, "another program holds it"));
  EXPECT_TRUE(says(kCorrupt, "nothing in the run directories is lost"));
  EXPECT_TRUE(says(kShortRead, "the file system failed"));
  EXPECT_TRUE(says(kReadOnly, "may read and write"));
  EXPECT_EQ(storage_advice(kError), "");
}

TEST(JournalMode, SharedFileSystemsDoWithoutSharedMemory) {
  constexpr unsigned long kExt4 = 0xEF53;
  EXPECT_STREQ(journal_mode_for(kExt4).journal, "WAL");
  for (const unsigned long shared :
       {0x6969UL, 0x0BD00BD0UL, 0x47504653UL, 0x19830326UL, 0x65735546UL}) {
    EXPECT_STREQ(journal_mode_for(shared).journal, "DELETE");
    EXPECT_STREQ(journal_mode_for(shared).synchronous, "FULL");
  }
}

}  // namespace
}  // namespace grouser
