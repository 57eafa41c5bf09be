// SPDX-License-Identifier: BSD-3-Clause
#include "targets.hpp"

#include "base/case.hpp"
#include "base/check.hpp"
#include "base/errors.hpp"
#include "base/run_contract.hpp"
#include "base/yaml.hpp"
#include "schedulers/pbs.hpp"
#include "schedulers/scripts.hpp"
#include "schedulers/slurm.hpp"

namespace grouser {
namespace {

// What was read once is read the same from what is written of it.
template <class Read>
void read_twice(const Read& read, const std::string& text) {
  try {
    const std::string written = to_json(read(text, "fuzz"));
    if (to_json(read(written, "fuzz")) != written) throw InternalError("not read the same again");
  } catch (const FormatError&) {
  }
}

}  // namespace

void read_yaml(const std::string& text) {
  try {
    emit_yaml(parse_yaml(text, "fuzz"));
  } catch (const ConfigError&) {
  }
}

void read_case_text(const std::string& text) {
  try {
    std::vector<Problem> problems;
    read_case(parse_yaml(text, "fuzz"), problems);
    for (const Problem& one : problems) one.text();
  } catch (const ConfigError&) {
  }
}

void read_event(const std::string& text) { read_twice(event_from_json, text); }

void read_outcome(const std::string& text) { read_twice(outcome_from_json, text); }

void read_manifest(const std::string& text) { read_twice(manifest_from_json, text); }

void read_job_record(const std::string& text) {
  try {
    job_record_from_json(text, "fuzz");
  } catch (const FormatError&) {
  }
}

void read_squeue(const std::string& text) {
  parse_squeue(text);
  parse_sbatch(text);
  judge_sbatch_failure(text);
}

void read_sacct(const std::string& text) { parse_sacct(text); }

void read_qstat(const std::string& text) {
  parse_qstat(text);
  parse_qsub(text);
  is_only_unknown_jobs(text);
}

}  // namespace grouser
