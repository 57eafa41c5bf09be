// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/verbs.hpp"
#include "campaign/cli/wish.hpp"

namespace grouser {

void add_resume(CLI::App& app, int& code) {
  auto options = std::make_shared<WishOptions>();
  CLI::App* verb =
      app.add_subcommand("resume", "go on with runs that are held, failed or cancelled");
  add_wish_options(*verb, *options);
  verb->callback([options, &code] {
    code = carry_out(*options, Wish::kResume, "goes on from its last checkpoint", 0.0);
  });
}

}  // namespace grouser
