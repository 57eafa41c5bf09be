// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace grouser {

/// All a job script is made of.
struct JobSpec {
  std::string campaign;
  std::string label;  ///< of the run
  std::string token;
  std::filesystem::path root;           ///< of the campaign, absolute
  std::filesystem::path run_directory;  ///< absolute
  std::string home;                     ///< of the user who submits
  std::vector<std::string> engine;      ///< program and its arguments, without ranks
  std::int64_t ranks = 1;
  std::int64_t threads = 1;  ///< of each rank
  std::int64_t nodes = 0;    ///< 0 = the scheduler decides
  double walltime = 0.0;     ///< of the job [s]; 0 = none
  std::string memory;        ///< per node
  std::string partition;
  std::string account;
  std::string qos;
  std::string launcher;                     ///< words before the engine; "" = the backend's own
  std::string setup_file;                   ///< shell file read first; "" = none
  std::vector<std::string> excluded_hosts;  ///< not to be used (Slurm only)
  bool is_array_member = false;             ///< its script is started by that of an array
  std::string chain;  ///< "prologue", "epilogue", or anything else for neither
};

/// Several jobs that ask for the same and are handed over as one.
struct ArraySpec {
  JobSpec common;                              ///< what each of them asks for
  std::string name;                            ///< job name of all of them
  std::vector<std::filesystem::path> scripts;  ///< of the members, absolute, by their index
  std::int64_t at_once = 0;                    ///< at work at one time; 0 = all
};

/// What the `{name}`s in a launcher stand for; there are no others. Pure.
std::map<std::string, std::string> launcher_values(const JobSpec& spec);

/// The job scripts, as pure functions of the job. Each script goes to the run directory, leaves at
/// once when the fence names another attempt, starts the engine in the background, turns TERM and
/// USR1 into the engine's stop file, and writes attempts/TOKEN.started and attempts/TOKEN.exit.
std::string make_local_script(const JobSpec& spec);
std::string make_slurm_script(const JobSpec& spec);
std::string make_pbs_script(const JobSpec& spec);

/// The script of a whole array: starts the member's own script.
std::string make_slurm_array_script(const ArraySpec& spec);

/// The script that carries the campaign on from inside a job: ROOT/wake.sh.
std::string make_wake_script(const std::filesystem::path& grouser,
                             const std::filesystem::path& root);
inline constexpr const char* kWakeScript = "wake.sh";

/// Seconds before the end of a job's walltime at which its engine must have ended: 5 %, at least
/// 30 s and at most 10 min, never more than half. 0 for no walltime. Local.
double stop_margin(double walltime);

/// Names below a run directory that scripts and manager share.
namespace attempt_files {
inline constexpr const char* kDirectory = "attempts";
std::string script(const std::string& token);   ///< attempts/TOKEN.sh
std::string log(const std::string& token);      ///< attempts/TOKEN.log
std::string started(const std::string& token);  ///< attempts/TOKEN.started
std::string exit(const std::string& token);     ///< attempts/TOKEN.exit
}  // namespace attempt_files

/// attempts/TOKEN.started and attempts/TOKEN.exit: the job script's own word about itself.
struct JobRecord {
  std::string token;
  std::string job;  ///< scheduler's id as the job's environment tells it
  std::string host;
  int code = -1;  ///< exit code of the engine; -1 in the started record
};
/// @throws FormatError naming `source`.
JobRecord job_record_from_json(const std::string& text, const std::string& source);

}  // namespace grouser
