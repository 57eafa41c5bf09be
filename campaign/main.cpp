// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <array>
#include <iostream>
#include <stdexcept>

#include "base/errors.hpp"
#include "base/log.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/drive/lease_guard.hpp"
#include "campaign/serve/serve.hpp"
#include "diagnosis/cli/verbs.hpp"

namespace grouser {
namespace {

// In the order of the help text: from making a campaign to reading its results.
constexpr std::array kVerbs{add_init,    add_validate, add_expand,     add_plan,     add_submit,
                            add_tick,    add_status,   add_show,       add_query,    add_logs,
                            add_stop,    add_cancel,   add_resume,     add_report,   add_fsck,
                            add_rebuild, add_schema,   add_recording,  add_diagnose, add_blind,
                            add_doctor,  add_serve,    add_completion, add_manual};

int parse(CLI::App& app, int argc, char** argv, int& code) {
  try {
    app.parse(argc, argv);
    return code;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& error) {
    app.exit(error);
    return exit_codes::kUsage;
  }
}

// A mistyped verb would only be told that a verb is missing.
bool is_verb_known(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return true;
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands(nullptr)) {
    if (verb->get_name() == argv[1]) return true;
    names.push_back(verb->get_name());
  }
  const std::string close = nearest(argv[1], names);
  std::cerr << "grouser: no verb is called '" << argv[1] << "'; "
            << (close.empty() ? "see grouser --help" : "did you mean '" + close + "'?") << "\n";
  return false;
}

int run(int argc, char** argv) {
  CLI::App app("Restartable DEM-LBM campaigns: runs, chunks, jobs and their results.", "grouser");
  app.set_version_flag("--version", GROUSER_VERSION);
  app.require_subcommand(1);
  int code = exit_codes::kOk;
  for (const auto& add_verb : kVerbs) add_verb(app, code);
  if (!is_verb_known(app, argc, argv)) return exit_codes::kUsage;
  return parse(app, argc, argv, code);
}

int complain(const std::exception& error, int code) {
  std::cout << std::flush;
  std::cerr << error.what() << "\n";
  return code;
}

std::string text_of(const std::filesystem::filesystem_error& error) {
  return (error.path1().empty() ? "the file system" : error.path1().string()) + ": " +
         error.code().message();
}

// What was printed may not have arrived: a full disk, say. Its reader must not take it for whole.
int checked(int code) {
  if (std::cout.flush() || (code != exit_codes::kOk && code != exit_codes::kAttention)) return code;
  return complain(StorageError("standard output cannot be written: is there room where it goes?"),
                  exit_codes::kStorage);
}

}  // namespace
}  // namespace grouser

int main(int argc, char** argv) {
  using namespace grouser;
  try {
    set_up_log(0);
    return checked(run(argc, argv));
  } catch (const ConfigError& error) {
    return complain(error, exit_codes::kInput);
  } catch (const FormatError& error) {
    return complain(error, exit_codes::kInput);
  } catch (const StorageError& error) {
    return complain(error, exit_codes::kStorage);
  } catch (const std::filesystem::filesystem_error& error) {
    return complain(StorageError(text_of(error)), exit_codes::kStorage);
  } catch (const CampaignBusy& error) {
    return complain(error, exit_codes::kBusy);
  } catch (const LeaseLost& error) {
    return complain(error, exit_codes::kBusy);
  } catch (const std::exception& error) {
    return complain(error, exit_codes::kDefect);
  }
}
