// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/verbs.hpp"
#include "campaign/cli/wish.hpp"

namespace grouser {

void add_resume(CLI::App& app, int& code) {
  auto options = std::make_shared<WishOptions>();
  CLI::App* verb =
      app.add_subcommand("resume", "go on with runs that are held, failed or cancelled");
  add_wish_options(*verb, *options);
  auto accept_engine = std::make_shared<bool>(false);
  verb->add_flag("--accept-engine", *accept_engine,
                 "although the engine's program file is not the one that computed the run so far");
  verb->callback([options, accept_engine, &code] {
    const Wish wish = *accept_engine ? Wish::kResumeWithEngine : Wish::kResume;
    code = carry_out(*options, wish, "goes on from its last checkpoint", 0.0);
  });
}

}  // namespace grouser
