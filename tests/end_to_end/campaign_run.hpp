// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "campaign/store/store.hpp"
#include "schedulers/command.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {

/// A campaign of three wheel runs on one bed, driven by the real program with the stand-in engine.
class CampaignRun : public ::testing::Test {
 protected:
  CampaignRun();
  ~CampaignRun() override;

  /// Writes campaign.yaml with `head` between name and case.
  void write_campaign(const std::string& head);

  /// Runs grouser with the words and with `variables` in its environment, in the test's directory.
  CommandResult grouser(const std::vector<std::string>& words, double seconds = 120.0) const;

  /// Starts it in the background. @return its process, which leads a group of its own
  pid_t start(const std::vector<std::string>& words) const;

  /// SIGKILL to every process of every job of scheduler `local`.
  void kill_local_jobs() const;

  /// `submit` until the campaign ends.
  CommandResult submit() const;

  std::filesystem::path root() const { return directory_.path() / "runs" / "small"; }
  /// Whether a manager in the background has got as far as writing the runs down.
  bool has_runs() const;
  std::vector<RunRow> runs() const;
  std::vector<AttemptRow> attempts() const;
  RunRow run(const std::string& label) const;

  /// Label and final state hash of every run.
  std::map<std::string, std::string> final_hashes() const;

  /// The same as they come out when nothing disturbs the runs, computed here and at one go.
  std::map<std::string, std::string> undisturbed_hashes() const;

  /// All runs completed, with the undisturbed bits, and no run ever had two engines at once.
  void expect_undisturbed_result() const;

  /// Waits until `condition` holds. @return whether it came to hold
  static bool wait_for(const std::function<bool()>& condition, double seconds = 60.0);

  std::map<std::string, std::string> variables;
  TemporaryDirectory directory_;
};

}  // namespace grouser
