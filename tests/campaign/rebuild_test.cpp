// SPDX-License-Identifier: BSD-3-Clause
// The journal: a database made from it is the one that was lost, whenever the manager died.
#include "campaign/store/rebuild.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "campaign/drive/prove.hpp"
#include "driving.hpp"

namespace grouser {
namespace {

class Rebuilding : public Driving {
 protected:
  // A campaign in which much has happened.
  void live_for_a_while(unsigned seed) {
    std::mt19937 random(seed);
    settle_bed();
    for (int i = 0; i < 40; ++i) {
      scheduler_.can_be_asked = random() % 5 != 0;
      for (auto& [name, job] : scheduler_.jobs)
        if (job.phase == JobPhase::kRunning && random() % 6 == 0) {
          job.phase = JobPhase::kEnded;
          job.end = random() % 2 == 0 ? JobEnd::kNodeFailed : JobEnd::kPreempted;
        }
      tick(random() % 2 == 0 ? 1.0 : 200.0);
      for (const RunRow& one : store_->runs())
        if (random() % 9 == 0)
          make_wish(*store_, one, random() % 3 == 0 ? Wish::kStop : Wish::kResume, clock_.now());
    }
    launch(small_campaign(kTwoSlips,
                          "campaign: small\ntitle: other\nscheduler: slurm\n"
                          "resources: {walltime: 1h}\n"));
  }

  std::vector<std::string> differences_of_rebuilt() {
    const auto made = directory_.path() / ("made-" + std::to_string(++made_) + ".db");
    replay_journal(root_, made);
    return row_differences(*store_, Store::open_read_only(made));
  }

  std::filesystem::path journal() const { return root_ / kJournalName; }

  int made_ = 0;
};

TEST_F(Rebuilding, Scenario13TheDatabaseMadeFromTheJournalHasTheSameRows) {
  const unsigned seed = std::random_device{}();
  live_for_a_while(seed);
  EXPECT_EQ(differences_of_rebuilt(), std::vector<std::string>{}) << "seed " << seed;
}

TEST_F(Rebuilding, Scenario13AManagerGoesOnWithARebuiltDatabase) {
  live_for_a_while(1);
  const auto before = store_->attempts().size();
  store_.reset();
  std::filesystem::remove(root_ / Store::kFileName);
  EXPECT_THROW(Store::open(root_ / Store::kFileName), FormatError);
  EXPECT_EQ(rebuild_database(root_), "");
  store_.emplace(open_store());
  EXPECT_EQ(store_->attempts().size(), before);
  tick();
  EXPECT_EQ(differences_of_rebuilt(), std::vector<std::string>{});
}

TEST_F(Rebuilding, ALineThatNeverCountedIsReplacedByTheNext) {
  settle_bed();
  // What a manager leaves that is killed before its database commits.
  const std::int64_t next = store_->change_number() + 1;
  std::ofstream(journal(), std::ios::app)
      << "{\"n\":" << next << ",\"op\":\"change\",\"drop_planned_chunks\":false}\n{\"n\":" << next;
  tick();
  tick();
  EXPECT_EQ(differences_of_rebuilt(), std::vector<std::string>{});
}

TEST_F(Rebuilding, AJournalThatIsLostBeginsAnewWithAllRows) {
  live_for_a_while(2);
  std::filesystem::remove(journal());
  store_.reset();
  store_.emplace(open_store());
  EXPECT_EQ(differences_of_rebuilt(), std::vector<std::string>{});
  tick();
  EXPECT_EQ(differences_of_rebuilt(), std::vector<std::string>{});
}

TEST_F(Rebuilding, ADamagedLineIsNamedAndNothingIsInvented) {
  live_for_a_while(3);
  std::string text = read_file(journal()).value();
  const auto third = text.find('\n', text.find('\n', text.find('\n') + 1) + 1) + 1;
  text[third] = '#';
  write_atomic(journal(), text);
  try {
    differences_of_rebuilt();
    FAIL() << "went on over a damaged line";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("the lines between them are damaged"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(Rebuilding, AManagerStopsWhenItsDatabaseIsReplaced) {
  settle_bed();
  rebuild_database(root_);
  EXPECT_THROW(tick(), LeaseLost);
}

TEST_F(Rebuilding, DatabaseAndJournalAreForTheirOwnerAlone) {
  for (const auto& file : {root_ / Store::kFileName, journal()}) {
    struct stat answer {};
    ASSERT_EQ(::stat(file.c_str(), &answer), 0);
    EXPECT_EQ(answer.st_mode & 0777u, 0600u) << file;
  }
}

class Proving : public Rebuilding {
 protected:
  std::string found() {
    std::string text;
    for (const Difference& one : prove(root_, *store_, scheduler_))
      text += one.place + ": " + one.what + " [" + one.hint + "]\n";
    return text;
  }
  std::filesystem::path bed() { return root_ / run("bed").directory; }
};

TEST_F(Proving, AHealthyCampaignHasNoDifference) {
  EXPECT_EQ(found(), "");
  tick();
  EXPECT_EQ(found(), "");
}

TEST_F(Proving, EveryKindOfDifferenceIsNamedWithWhatToType) {
  tick();
  const std::string token = store_->attempts().back().token;
  const auto says = [&](const std::string& part) {
    const std::string text = found();
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  };
  scheduler_.jobs.clear();
  says("job g" + token + " is not at work any more [grouser tick");
  scheduler_.can_be_asked = false;
  says("scheduler: cannot be asked: down");
  scheduler_.can_be_asked = true;
  write_atomic(bed() / run_files::kFence, "another");
  says("the fence names attempt another, which the database does not know");
  write_atomic(bed() / run_files::outcome("stranger"), "{}");
  says("outcome-stranger.json is of an attempt that the database does not know");
  std::filesystem::create_directories(root_ / "runs" / "stranger");
  says("runs/stranger: the database does not know this directory");
  write_atomic(root_ / run("towed").directory / "case.yaml",
               read_file(bed() / "case.yaml").value());
  says("case.yaml is not the case with key");
  std::filesystem::remove_all(root_ / run("slip_20").directory);
  says("its directory or its case.yaml is gone [grouser submit");
}

TEST_F(Proving, AJobThatOutlivedItsAttemptIsNamed) {
  settle_bed();
  const auto token = store_->attempts(run("bed").id).back().token;
  scheduler_.jobs[job_name(token)].phase = JobPhase::kRunning;
  EXPECT_NE(found().find("is at work although its attempt has ended"), std::string::npos)
      << found();
}

}  // namespace
}  // namespace grouser
