// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/attention.hpp"

#include <algorithm>
#include <iostream>

#include "campaign/cli/exit_codes.hpp"

namespace grouser {
namespace {

constexpr std::size_t kShown = 5;

}  // namespace

bool waits_for_person(State state) { return state == State::kHeld || state == State::kFailed; }

int report_waiting(const std::vector<RunRow>& runs, const std::filesystem::path& root) {
  std::vector<const RunRow*> waiting;
  for (const RunRow& run : runs)
    if (run.in_plan && waits_for_person(run.state)) waiting.push_back(&run);
  if (waiting.empty()) return exit_codes::kOk;
  std::cout << waiting.size() << (waiting.size() == 1 ? " run waits" : " runs wait")
            << " for a person:\n";
  for (std::size_t i = 0; i < std::min(waiting.size(), kShown); ++i)
    std::cout << "  " << waiting[i]->label << "  " << word_of(waiting[i]->state) << "  "
              << waiting[i]->reason << "\n";
  if (waiting.size() > kShown)
    std::cout << "  ... all of them: grouser status -C " << root.string() << "\n";
  std::cout << "when the cause is gone, go on with\n"
            << "  grouser resume --all -C " << root.string() << "\n";
  return exit_codes::kAttention;
}

}  // namespace grouser
