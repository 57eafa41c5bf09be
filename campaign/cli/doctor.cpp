// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "base/atomic_file.hpp"
#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/json_text.hpp"
#include "campaign/cli/text.hpp"
#include "campaign/cli/verbs.hpp"
#include "campaign/drive/clock.hpp"
#include "schedulers/command.hpp"
#include "schedulers/table.hpp"

namespace grouser {
namespace {

constexpr double kSeconds = 30.0;
constexpr double kRoom = 1e9;        // bytes under which a campaign is likely to fill the disk
constexpr double kClockApart = 5.0;  // seconds

struct Options {
  std::string directory = ".";
  std::string scheduler = "local";
  std::string engine;
  bool as_json = false;
};

// One thing looked at.
struct Finding {
  std::string what;
  bool is_good = true;
  std::string found;
  std::string hint;  // what to do when it is not good
};

// A lock that another process cannot take as well is one that SQLite can rely on.
bool has_locks(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) return false;
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  bool is_held = ::fcntl(descriptor, F_SETLK, &whole) == 0;
  if (is_held) {
    const auto other =
        run_command({"flock", "--nonblock", "--fcntl", file.string(), "true"}, kSeconds);
    const bool knows_fcntl = other.started && other.err.find("unrecognized") == std::string::npos;
    is_held = !knows_fcntl || other.code != 0;
  }
  ::close(descriptor);
  return is_held;
}

void look_at_files(const std::filesystem::path& directory, std::vector<Finding>& found) {
  const auto probe = directory / ".grouser-doctor";
  try {
    write_atomic(probe, "probe\n");
    found.push_back({"files", true, "can be written, synced and renamed", ""});
  } catch (const StorageError& error) {
    found.push_back({"files", false, error.what(), "give a directory that can be written"});
    return;
  }
  struct stat status {};
  ::stat(probe.c_str(), &status);
  const double apart = SystemClock().now() - static_cast<double>(status.st_mtime);
  found.push_back({"clock", std::abs(apart) < kClockApart,
                   short_number(apart, 3) + " s from the file server's",
                   "nothing depends on it; the dates of files do not fit together"});
  found.push_back({"locks", has_locks(probe), "of files between processes",
                   "mount the file system with locks (flock, local_lock=none); until then let one "
                   "manager at a time be at work"});
  struct statvfs room {};
  if (::statvfs(directory.c_str(), &room) == 0) {
    const double bytes = static_cast<double>(room.f_bavail) * static_cast<double>(room.f_frsize);
    found.push_back({"room", bytes > kRoom, short_number(1e-9 * bytes, 3) + " GB free",
                     "two checkpoints of every run must fit"});
    const bool counts = room.f_files > 0;
    found.push_back({"inodes", !counts || room.f_favail > 10000,
                     counts ? std::to_string(room.f_favail) + " free" : "not counted here",
                     "an attempt leaves about a dozen files"});
  }
  std::error_code ignored;
  std::filesystem::remove(probe, ignored);
}

Finding look_at_command(const std::vector<std::string>& words, const std::string& hint) {
  SystemClock clock;
  const double from = clock.now();
  const auto done = run_command(words, kSeconds);
  std::string text = done.out.empty() ? done.err : done.out;
  text = text.substr(0, text.find('\n'));
  const bool is_good = done.started && !done.timed_out && done.code == 0;
  if (is_good) text += " (" + short_number(clock.now() - from, 2) + " s)";
  return {words.front(), is_good, text, hint};
}

void look_at_scheduler(const std::string& scheduler, std::vector<Finding>& found) {
  if (scheduler == "slurm") {
    const std::string module = "load the site's module, or run on a login node";
    found.push_back(look_at_command({"sbatch", "--version"}, module));
    found.push_back(look_at_command({"scontrol", "ping"}, "the controller does not answer: later"));
    found.push_back(look_at_command({"squeue", "--noheader", "--name=grouser-doctor"}, module));
    found.push_back(look_at_command({"sacct", "--noheader", "--name=grouser-doctor"},
                                    "without accounting the jobs' own records decide"));
  }
  if (scheduler == "pbs") {
    found.push_back(look_at_command({"qstat", "--version"}, "load the site's module"));
    found.push_back(look_at_command({"qselect"}, "the server does not answer: later"));
    found.push_back(
        look_at_command({"qselect", "-x"}, "without job history the jobs' own records decide"));
  }
}

void look_at_engine(const std::string& given, std::vector<Finding>& found) {
  try {
    const auto engine = find_engine(given);
    found.push_back({"engine", true, engine.string(), ""});
    found.push_back(look_at_command({engine.string(), "--help"}, "its libraries are missing"));
    found.push_back(look_at_command({"mpirun", "-n", "1", "--oversubscribe", "true"},
                                    "give resources.launcher, or load MPI's module"));
  } catch (const ConfigError& error) {
    found.push_back({"engine", false, error.what(), "say --engine FILE"});
  }
  const char* const locking = std::getenv("HDF5_USE_FILE_LOCKING");
  found.push_back(
      {"HDF5 locks", true, locking == nullptr ? "as the library has them" : locking, ""});
}

int doctor(const Options& options) {
  std::vector<Finding> found;
  look_at_files(std::filesystem::absolute(options.directory), found);
  look_at_scheduler(options.scheduler, found);
  look_at_engine(options.engine, found);
  bool is_good = true;
  Json all = Json::array();
  std::vector<std::vector<std::string>> rows;
  for (const Finding& one : found) {
    is_good = is_good && one.is_good;
    all.push_back({{"what", one.what},
                   {"good", one.is_good},
                   {"found", one.found},
                   {"hint", one.is_good ? "" : one.hint}});
    rows.push_back(
        {one.what, one.is_good ? "good" : "look", one.found, one.is_good ? "" : one.hint});
  }
  if (options.as_json)
    std::cout << json_text(Json{{"schema", 1}, {"findings", all}});
  else
    std::cout << text_table({"WHAT", "", "FOUND", "WHAT TO DO"}, rows);
  return is_good ? exit_codes::kOk : exit_codes::kAttention;
}

}  // namespace

void add_doctor(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "doctor", "look whether file system, scheduler, engine and MPI do what campaigns need");
  verb->add_option("directory", options->directory, "where the campaign is to be");
  verb->add_option("--scheduler", options->scheduler, "local, slurm or pbs")
      ->check(CLI::IsMember(scheduler_names()));
  verb->add_option("--engine", options->engine, "the engine's program file");
  verb->add_flag("--json", options->as_json, "as JSON");
  verb->callback([options, &code] { code = doctor(*options); });
}

}  // namespace grouser
