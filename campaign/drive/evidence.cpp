// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/drive/evidence.hpp"

#include "base/atomic_file.hpp"
#include "base/errors.hpp"

namespace grouser {
namespace {

// Records are written atomically, so an unreadable one is damaged, and then no evidence.
template <class Record>
std::optional<Record> read_record(const std::filesystem::path& file,
                                  Record (*parse)(const std::string&, const std::string&)) {
  const auto text = read_file(file);
  if (!text) return std::nullopt;
  try {
    return parse(*text, file.string());
  } catch (const FormatError&) {
    return std::nullopt;
  }
}

template <class Record>
std::optional<Record> of_token(std::optional<Record> record, const std::string& token) {
  return record && record->token == token ? record : std::nullopt;
}

}  // namespace

std::optional<CheckpointManifest> newest_checkpoint(const std::filesystem::path& run_directory) {
  std::optional<CheckpointManifest> newest;
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(run_directory / run_files::kCheckpoints, error)) {
    if (entry.path().extension() != ".json") continue;
    const auto manifest = read_record<CheckpointManifest>(entry.path(), manifest_from_json);
    if (manifest && (!newest || manifest->step > newest->step)) newest = manifest;
  }
  return newest;
}

std::optional<Progress> read_progress(const std::filesystem::path& run_directory) {
  return read_record<Progress>(run_directory / run_files::kProgress, progress_from_json);
}

Evidence read_evidence(const std::filesystem::path& run_directory, const std::string& token) {
  Evidence evidence;
  const auto record = [&](const std::string& name) {
    return of_token(read_record<JobRecord>(run_directory / name, job_record_from_json), token);
  };
  // From the last to be written to the first: what comes before the exit record is there too.
  evidence.exit = record(attempt_files::exit(token));
  evidence.outcome = of_token(
      read_record<Outcome>(run_directory / run_files::outcome(token), outcome_from_json), token);
  evidence.started = record(attempt_files::started(token));
  evidence.newest = newest_checkpoint(run_directory);
  const auto progress = of_token(read_progress(run_directory), token);
  if (progress) evidence.progress_step = progress->step;
  return evidence;
}

}  // namespace grouser
