// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/verbs.hpp"
#include "campaign/cli/wish.hpp"

namespace grouser {

void add_stop(CLI::App& app, int& code) {
  auto options = std::make_shared<WishOptions>();
  CLI::App* verb = app.add_subcommand("stop", "end runs in order, with a checkpoint; see resume");
  add_wish_options(*verb, *options);
  verb->callback([options, &code] {
    constexpr double kPatience = 5.0;
    code = carry_out(*options, Wish::kStop, "asked to stop", kPatience);
  });
}

}  // namespace grouser
