// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/scripts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/substitution.hpp"
#include "schedulers/scheduler.hpp"
#include "schedulers/shell.hpp"

namespace grouser {
namespace {

std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  char text[48];
  std::snprintf(text, sizeof text, "%02lld:%02lld:%02lld", whole / 3600, whole / 60 % 60,
                whole % 60);
  return text;
}

std::string slurm_clock(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  const long long days = whole / 86400;
  return std::to_string(days) + "-" + clock_text(static_cast<double>(whole % 86400));
}

std::string amount_of(const std::string& memory) {
  return memory.substr(0, memory.find_first_not_of("0123456789"));
}

// Upper-case first letter of the unit, "" when there is none.
std::string unit_of(const std::string& memory) {
  const auto at = memory.find_first_not_of("0123456789");
  return at == std::string::npos
             ? ""
             : std::string(1,
                           static_cast<char>(std::toupper(static_cast<unsigned char>(memory[at]))));
}

std::string launch_line(const JobSpec& spec, const std::string& backend_launcher) {
  std::string line;
  if (spec.launcher.empty()) {
    line = backend_launcher;
  } else {
    const auto values = launcher_values(spec);
    // Split before anything is put in: a value with a blank stays one word.
    for (const std::string& word : split_words(spec.launcher))
      line += (line.empty() ? "" : " ") + shell_quote(substitute(word, values));
  }
  return line + (line.empty() ? "" : " ") + shell_join(spec.engine);
}

// What every job script does after its directives; @WORDS@ are filled in.
constexpr const char* kBody = R"sh(@SETUP@
token=@TOKEN@
cd -- @DIRECTORY@ || exit 40
@PROLOGUE@
# A job that the batch system started over claims the run anew, so that its earlier life, which a
# lost node may still carry on, publishes nothing more.
claim=$token
owns_run() {
  [ "$(cat fence)" = "$claim" ]
}
if [ -e "attempts/$token.started" ]; then
  read -r owner life <fence || true
  claim="$token $((${life:-0} + 1))"
  if [ "$owner" = "$token" ]; then
    printf '%s' "$claim" >"fence.$token" && mv -f "fence.$token" fence
    rm -f "outcome-$token.json" "attempts/$token.exit" stop
  fi
fi

# The batch system wants the job to end: the engine is asked by its stop file, unless the run has
# gone over to another attempt.
ask_to_stop() {
  if owns_run && [ ! -e stop ]; then
    echo signal >stop
  fi
}
trap ask_to_stop TERM USR1

# The word of this script about itself; readers see a whole record or none.
record() {
  printf '{"token": "%s", "job": "%s", "host": "%s", "code": %d}\n' \
    "$token" "@JOB@" "$(uname -n)" "$2" >"attempts/$token.$1.tmp" &&
    mv -f "attempts/$token.$1.tmp" "attempts/$token.$1"
}

if ! owns_run; then
  echo "superseded: another attempt owns this run" >&2
  exit 22
fi
record started -1
@SUCCESSOR@@LAUNCH@ &
engine=$!
code=127
# A trapped signal ends `wait` early: wait again until the engine is gone.
while kill -0 "$engine" 2>/dev/null; do
  wait "$engine"
  code=$?
done
wait "$engine" 2>/dev/null
last=$?
[ "$last" -eq 127 ] || code=$last
if owns_run; then
  record exit "$code"
fi
@EPILOGUE@exit "$code"
)sh";

struct Backend {
  std::string job_variable;  ///< where the environment names the job
  std::string prologue;      ///< lines after the change of directory
  std::string launcher;      ///< words before the engine unless the user gives others
  std::string successor;     ///< command that queues @WAKE@ for after this job; "" = it cannot
};

// Small and short: it only looks and submits.
constexpr const char* kSlurmSuccessor =
    "sbatch --dependency=\"afterany:$SLURM_JOB_ID\" --job-name=gwake --ntasks=1 --time=10 "
    "--output=/dev/null@ACCOUNTING@ @WAKE@";
constexpr const char* kPbsSuccessor =
    "qsub -W depend=afterany:\"$PBS_JOBID\" -N gwake -l walltime=00:10:00 -j oe -o "
    "/dev/null@ACCOUNTING@ @WAKE@";

std::string chain_accounting(const JobSpec& spec, bool is_slurm) {
  const auto option = [&](const char* slurm, const char* pbs, const std::string& value) {
    if (value.empty()) return std::string();
    return is_slurm ? std::string(" --") + slurm + "=" + shell_quote(value)
                    : std::string(" -") + pbs + " " + shell_quote(value);
  };
  return option("partition", "q", spec.partition) + option("account", "A", spec.account) +
         (is_slurm ? option("qos", "", spec.qos) : "");
}

// Before the engine: whatever becomes of this job, somebody looks after it.
std::string prologue_of(const JobSpec& spec, const Backend& backend) {
  if (spec.chain != "prologue" || backend.successor.empty()) return "";
  const bool is_slurm = backend.successor == kSlurmSuccessor;
  return fill(backend.successor, {{"ACCOUNTING", chain_accounting(spec, is_slurm)},
                                  {"WAKE", shell_quote((spec.root / kWakeScript).string())}}) +
         " >/dev/null || echo \"no successor could be queued\" >&2\n";
}

// After it: the campaign goes on from this job's last breath.
std::string epilogue_of(const JobSpec& spec) {
  if (spec.chain != "epilogue") return "";
  return "bash " + shell_quote((spec.root / kWakeScript).string()) + "\n";
}

std::string body(const JobSpec& spec, const Backend& backend) {
  return fill(kBody,
              {{"SETUP", spec.setup_file.empty() ? "" : "\n. " + shell_quote(spec.setup_file)},
               {"TOKEN", spec.token},
               {"DIRECTORY", shell_quote(spec.run_directory.string())},
               {"PROLOGUE", backend.prologue},
               {"JOB", backend.job_variable},
               {"SUCCESSOR", prologue_of(spec, backend)},
               {"EPILOGUE", epilogue_of(spec)},
               {"LAUNCH", launch_line(spec, backend.launcher)}});
}

std::string head_comment(const JobSpec& spec) {
  return "# Attempt " + spec.token + " of run " + spec.label + ", campaign " + spec.campaign +
         "; written by grouser.\n";
}

// mpirun would bind each rank, with all its threads, to one core.
std::string mpirun(const JobSpec& spec) {
  return "mpirun -n " + std::to_string(spec.ranks) +
         (spec.threads > 1 ? " --map-by slot:PE=" + std::to_string(spec.threads) + " --bind-to core"
                           : "");
}

std::string slurm_options(const JobSpec& spec, const std::string& name) {
  std::string text;
  const auto option = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) text += "#SBATCH --" + key + "=" + value + "\n";
  };
  option("job-name", name);
  option("ntasks", std::to_string(spec.ranks));
  if (spec.threads > 1) option("cpus-per-task", std::to_string(spec.threads));
  if (spec.nodes > 0) option("nodes", std::to_string(spec.nodes));
  if (spec.walltime > 0.0) {
    option("time", slurm_clock(spec.walltime));
    option("signal", "B:USR1@" + std::to_string(std::lround(0.5 * stop_margin(spec.walltime))));
  }
  if (!spec.memory.empty()) option("mem", amount_of(spec.memory) + unit_of(spec.memory));
  option("partition", spec.partition);
  option("account", spec.account);
  option("qos", spec.qos);
  std::string excluded;
  for (const std::string& host : spec.excluded_hosts)
    excluded += (excluded.empty() ? "" : ",") + host;
  option("exclude", excluded);
  // A job that was preempted or lost its node gets a successor of the manager's, under a token of
  // its own.
  return text + "#SBATCH --no-requeue\n";
}

std::string pbs_chunk(std::int64_t count, std::int64_t ranks, const JobSpec& spec) {
  std::string text = std::to_string(count) + ":ncpus=" + std::to_string(ranks * spec.threads) +
                     ":mpiprocs=" + std::to_string(ranks);
  if (spec.threads > 1) text += ":ompthreads=" + std::to_string(spec.threads);
  if (spec.memory.empty()) return text;
  std::string unit = unit_of(spec.memory);
  unit =
      unit.empty()
          ? "mb"
          : std::string(1, static_cast<char>(std::tolower(static_cast<unsigned char>(unit[0])))) +
                "b";
  return text + ":mem=" + amount_of(spec.memory) + unit;
}

// Ranks spread evenly; when they do not divide, the first nodes get one more.
std::string pbs_select(const JobSpec& spec) {
  if (spec.nodes == 0) return pbs_chunk(spec.ranks, 1, spec);
  const std::int64_t each = spec.ranks / spec.nodes;
  const std::int64_t more = spec.ranks % spec.nodes;
  if (more == 0) return pbs_chunk(spec.nodes, each, spec);
  return pbs_chunk(more, each + 1, spec) + "+" + pbs_chunk(spec.nodes - more, each, spec);
}

}  // namespace

std::map<std::string, std::string> launcher_values(const JobSpec& spec) {
  return {
      {"campaign", spec.campaign},  {"home", spec.home}, {"ranks", std::to_string(spec.ranks)},
      {"root", spec.root.string()}, {"run", spec.label}, {"threads", std::to_string(spec.threads)}};
}

std::string make_local_script(const JobSpec& spec) {
  // One rank needs no launcher, and does without its start-up time.
  const std::string launcher =
      spec.ranks == 1 ? ""
                      : "mpirun --oversubscribe --bind-to none -n " + std::to_string(spec.ranks);
  std::string prologue = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1\n";
  // Cores may be shared with others here: threads that wait leave them instead of turning round.
  if (spec.threads > 1) prologue += "export OMP_WAIT_POLICY=passive\n";
  return "#!/bin/bash\n" + head_comment(spec) +
         body(spec, {"${GROUSER_JOB:-}", prologue, launcher, ""});
}

std::string make_slurm_script(const JobSpec& spec) {
  std::string text = "#!/bin/bash\n" + slurm_options(spec, job_name(spec.token));
  // Relative to the run directory, which sbatch is given as --chdir: a path here would need
  // quoting.
  const std::string log = attempt_files::log(spec.token);
  if (!spec.is_array_member) text += "#SBATCH --output=" + log + "\n#SBATCH --open-mode=append\n";
  const std::string own_log = spec.is_array_member ? "exec >>" + log + " 2>&1\n" : "";
  return text + head_comment(spec) +
         body(spec, {"${SLURM_ARRAY_TASK_ID:+${SLURM_ARRAY_JOB_ID}_}"
                     "${SLURM_ARRAY_TASK_ID:-${SLURM_JOB_ID:-}}",
                     own_log, mpirun(spec), kSlurmSuccessor});
}

std::string make_slurm_array_script(const ArraySpec& spec) {
  std::string text = "#!/bin/bash\n" + slurm_options(spec.common, spec.name);
  text += "#SBATCH --array=0-" + std::to_string(spec.scripts.size() - 1);
  if (spec.at_once > 0) text += "%" + std::to_string(spec.at_once);
  text += "\n#SBATCH --output=/dev/null\n# Several runs of campaign " + spec.common.campaign +
          "; written by grouser.\nscripts=(\n";
  for (const auto& script : spec.scripts) text += "  " + shell_quote(script.string()) + "\n";
  return text + ")\nexec bash \"${scripts[$SLURM_ARRAY_TASK_ID]}\"\n";
}

std::string make_wake_script(const std::filesystem::path& grouser,
                             const std::filesystem::path& root) {
  return "#!/bin/bash\n"
         "# Carries the campaign on when a job has ended; written by grouser.\n"
         "# What this job asked for must not reach the next one through its environment.\n"
         "for name in ${!SLURM_@} ${!SBATCH_@}; do\n"
         "  [ \"$name\" = SLURM_CONF ] || unset \"$name\"\n"
         "done\n"
         "exec " +
         shell_join({grouser.string(), "tick", "-C", root.string(), "--patience", "120", "--carry",
                     "480"}) +
         " >>" + shell_quote((root / "wake.log").string()) + " 2>&1\n";
}

std::string make_pbs_script(const JobSpec& spec) {
  std::string text = "#!/bin/bash\n";
  const auto option = [&](const std::string& name, const std::string& value) {
    text += "#PBS -" + name + " " + value + "\n";
  };
  option("N", job_name(spec.token));
  option("S", "/bin/bash");
  option("l", "select=" + pbs_select(spec));
  if (spec.nodes > 0) option("l", "place=scatter");
  if (spec.walltime > 0.0) option("l", "walltime=" + clock_text(spec.walltime));
  if (!spec.partition.empty()) option("q", spec.partition);
  if (!spec.account.empty()) option("A", spec.account);
  option("j", "oe");
  option("r", "n");
  // PBS copies its output file only at the end; the log is to be read while the job runs.
  return text + head_comment(spec) +
         body(spec, {"${PBS_JOBID:-}", "exec >>" + attempt_files::log(spec.token) + " 2>&1\n",
                     mpirun(spec) + " --hostfile \"$PBS_NODEFILE\"", kPbsSuccessor});
}

double stop_margin(double walltime) {
  return std::min(std::clamp(0.05 * walltime, 30.0, 600.0), 0.5 * walltime);
}

std::string job_name(const std::string& token) {
  if (token.size() <= kTokenLength + 1 || token[kTokenLength] != 'n') return "g" + token;
  return "g" + token.substr(0, kTokenLength) + "_" + token.substr(kTokenLength + 1);
}

std::string member_token(const std::string& array_token, std::size_t index) {
  return array_token + "n" + std::to_string(index);
}

std::string attempt_files::script(const std::string& token) {
  return std::string(kDirectory) + "/" + token + ".sh";
}
std::string attempt_files::log(const std::string& token) {
  return std::string(kDirectory) + "/" + token + ".log";
}
std::string attempt_files::started(const std::string& token) {
  return std::string(kDirectory) + "/" + token + ".started";
}
std::string attempt_files::exit(const std::string& token) {
  return std::string(kDirectory) + "/" + token + ".exit";
}

JobRecord job_record_from_json(const std::string& text, const std::string& source) {
  try {
    const auto json = nlohmann::json::parse(text);
    JobRecord record;
    json.at("token").get_to(record.token);
    json.at("job").get_to(record.job);
    json.at("host").get_to(record.host);
    json.at("code").get_to(record.code);
    return record;
  } catch (const nlohmann::json::exception& error) {
    throw FormatError(source + ": not a job record (" + error.what() + ")");
  }
}

}  // namespace grouser
