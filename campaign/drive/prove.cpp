// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/prove.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "campaign/drive/compare.hpp"
#include "campaign/drive/driver.hpp"
#include "campaign/store/rebuild.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

class Prover {
 public:
  Prover(fs::path root, const Store& store) : root_(std::move(root)), store_(store) {
    tick_ = "grouser tick -C " + root_.string();
    for (const AttemptRow& attempt : store.attempts()) attempts_[attempt.run].push_back(attempt);
    runs_ = store.runs();
  }

  std::vector<Difference> prove(Scheduler& scheduler) {
    compare_journal();
    for (const RunRow& run : runs_) compare_run(run);
    for (const char* folder : {"beds", "runs"}) look_for_strangers(folder);
    compare_scheduler(scheduler);
    return std::move(found_);
  }

 private:
  void add(const std::string& place, const std::string& what, const std::string& hint) {
    found_.push_back({place, what, hint});
  }

  void compare_journal() {
    const std::string hint =
        "the database counts; move the journal away, and the next tick begins "
        "another: mv " +
        (root_ / kJournalName).string() + " DIR";
    const fs::path made = root_ / ".fsck.db";
    for (const char* part : {"", "-journal"}) fs::remove(fs::path(made).concat(part));
    try {
      replay_journal(root_, made, store_.change_number());
      for (const std::string& one : row_differences(store_, Store::open_read_only(made)))
        add(kJournalName, one, hint);
    } catch (const FormatError& error) {
      add(kJournalName, error.what(), hint);
    }
    fs::remove(made);
  }

  void compare_run(const RunRow& run) {
    const fs::path directory = root_ / run.directory;
    if (is_directory_gone(directory)) {
      if (run.in_plan)
        add(run.directory, "its directory or its case.yaml is gone",
            "grouser submit " + store_.campaign().source.string() + " makes it again");
      return;
    }
    compare_case(run, directory);
    compare_fence(run, directory);
    compare_outcomes(run, directory);
    if (!is_active(run.state)) compare_checkpoint(run, directory);
  }

  void compare_case(const RunRow& run, const fs::path& directory) {
    std::vector<Problem> problems;
    try {
      const Case input = read_case(load_yaml(directory / run_files::kCase), problems);
      if (problems.empty() && content_key(input) == run.key) return;
    } catch (const ConfigError&) {
    }
    add(run.directory, "case.yaml is not the case with key " + run.key,
        "move the directory away; grouser submit " + store_.campaign().source.string() +
            " makes it again");
  }

  void compare_fence(const RunRow& run, const fs::path& directory) {
    const std::string fence = read_file(directory / run_files::kFence).value_or("");
    const std::string token = fence.substr(0, fence.find_first_of(" \n"));
    const auto& own = attempts_[run.id];
    const bool is_known = std::any_of(
        own.begin(), own.end(), [&](const AttemptRow& attempt) { return attempt.token == token; });
    if (!token.empty() && !is_known)
      add(run.directory, "the fence names attempt " + token + ", which the database does not know",
          "see that no job g" + token + " is at work; the next attempt takes the fence over");
    else if (!own.empty() && is_active(own.back().state) &&
             own.back().state != State::kSubmitting && own.back().token != token)
      add(run.directory, "the fence does not name the active attempt " + own.back().token, tick_);
  }

  void compare_outcomes(const RunRow& run, const fs::path& directory) {
    std::set<std::string> known;
    for (const AttemptRow& attempt : attempts_[run.id]) {
      known.insert(run_files::outcome(attempt.token));
      const Evidence evidence = read_evidence(directory, attempt.token);
      const std::string name = "attempt " + std::to_string(attempt.number);
      if (is_active(attempt.state)) {
        if (evidence.outcome) add(run.directory, name + " has ended", tick_);
      } else if (attempt.has_outcome != evidence.outcome.has_value()) {
        add(run.directory,
            name + (attempt.has_outcome ? ": its outcome file is gone"
                                        : " left an outcome after it was given up"),
            "nothing to do: the run goes on from its newest checkpoint");
      } else if (evidence.outcome && attempt.code != static_cast<int>(evidence.outcome->code)) {
        add(run.directory, name + ": its outcome file has another code than the database",
            "grouser rebuild --yes -C " + root_.string());
      }
    }
    for (const auto& entry : fs::directory_iterator(directory)) {
      const std::string name = entry.path().filename();
      if (name.rfind("outcome-", 0) == 0 && entry.path().extension() == ".json" &&
          known.count(name) == 0)
        add(run.directory, name + " is of an attempt that the database does not know",
            "grouser rebuild --yes -C " + root_.string());
    }
  }

  void compare_checkpoint(const RunRow& run, const fs::path& directory) {
    const auto newest = newest_checkpoint(directory);
    const std::string resume = "grouser resume " + run.label + " -C " + root_.string();
    if (!newest) {
      if (!run.checkpoint.empty())
        add(run.directory, "checkpoint " + run.checkpoint + " is gone and there is no other",
            "put it back from a copy, or move the directory away and submit again");
      return;
    }
    if (newest->file != run.checkpoint || newest->state_hash != run.state_hash)
      add(run.directory, "the newest checkpoint is " + newest->file + " and not " + run.checkpoint,
          is_terminal(run.state) ? "see who wrote it" : resume + " goes on from the newest");
    std::error_code error;
    const auto bytes = fs::file_size(directory / run_files::kCheckpoints / newest->file, error);
    if (error || static_cast<std::int64_t>(bytes) != newest->bytes)
      add(run.directory, newest->file + " has not the size its manifest tells",
          "the engine passes over it and takes the one before");
  }

  void look_for_strangers(const char* folder) {
    std::set<std::string> known;
    for (const RunRow& run : runs_) known.insert(run.directory.string());
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(root_ / folder, error)) {
      const std::string name = (fs::path(folder) / entry.path().filename()).string();
      if (known.count(name) == 0)
        add(name, "the database does not know this directory",
            "it is not used; move it away when it is not needed");
    }
  }

  // Of every run the newest attempt: an older one lost the fence to it.
  void compare_scheduler(Scheduler& scheduler) {
    std::map<std::string, std::pair<const RunRow*, AttemptRow>> asked;
    std::vector<AttemptRow> newest;
    for (const RunRow& run : runs_) {
      if (attempts_[run.id].empty()) continue;
      newest.push_back(attempts_[run.id].back());
      asked[job_name(newest.back().token)] = {&run, newest.back()};
    }
    const QueryAnswer answer = scheduler.query(keys_of(newest));
    if (!answer.is_complete) {
      add("scheduler", "cannot be asked: " + answer.why_not, "ask again later: grouser fsck");
      return;
    }
    std::set<std::string> alive;
    for (const JobStatus& job : answer.jobs)
      if (job.phase != JobPhase::kEnded) alive.insert(job.name);
    for (const auto& [name, one] : asked) {
      const auto& [run, attempt] = one;
      const bool is_alive = alive.count(name) > 0;
      if (is_active(attempt.state) && !is_alive)
        add(run->directory, "job " + name + " is not at work any more", tick_);
      if (!is_active(attempt.state) && is_alive)
        add(run->directory, "job " + name + " is at work although its attempt has ended",
            "it cannot write a checkpoint once another attempt begins; end it by hand: job " +
                attempt.job);
    }
  }

  fs::path root_;
  const Store& store_;
  std::string tick_;
  std::vector<RunRow> runs_;
  std::map<RunId, std::vector<AttemptRow>> attempts_;
  std::vector<Difference> found_;
};

}  // namespace

std::vector<Difference> prove(const fs::path& root, const Store& store, Scheduler& scheduler) {
  return Prover(root, store).prove(scheduler);
}

}  // namespace grouser
