// SPDX-License-Identifier: BSD-3-Clause
#include "base/run_contract.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"

namespace grouser {
namespace {

using Json = nlohmann::json;

template <class Record>
Record parse(const std::string& text, const std::string& source,
             void (*fill)(const Json&, Record&)) {
  try {
    Record record;
    fill(Json::parse(text), record);
    return record;
  } catch (const Json::exception& error) {
    throw FormatError(source + ": not a valid record (" + error.what() + ")");
  }
}

EngineCode code_from(int number) {
  for (const EngineCode code :
       {EngineCode::kFinished, EngineCode::kPaused, EngineCode::kSteady, EngineCode::kStopped,
        EngineCode::kInputRefused, EngineCode::kCheckpointRefused, EngineCode::kFenceLost,
        EngineCode::kBrokeDown, EngineCode::kStorageFailed, EngineCode::kParallelFailed})
    if (static_cast<int>(code) == number) return code;
  return EngineCode::kDefect;
}

}  // namespace

const char* word_of(EngineCode code) {
  switch (code) {
    case EngineCode::kFinished:
      return "finished";
    case EngineCode::kPaused:
      return "paused";
    case EngineCode::kSteady:
      return "steady";
    case EngineCode::kStopped:
      return "stopped";
    case EngineCode::kInputRefused:
      return "input_refused";
    case EngineCode::kCheckpointRefused:
      return "checkpoint_refused";
    case EngineCode::kFenceLost:
      return "fence_lost";
    case EngineCode::kBrokeDown:
      return "broke_down";
    case EngineCode::kStorageFailed:
      return "storage_failed";
    case EngineCode::kParallelFailed:
      return "parallel_failed";
    case EngineCode::kDefect:
      break;
  }
  return "defect";
}

std::string run_files::step_digits(std::int64_t step) {
  char digits[24];
  std::snprintf(digits, sizeof digits, "%012lld", static_cast<long long>(step));
  return digits;
}

std::string run_files::outcome(const std::string& token) { return "outcome-" + token + ".json"; }

std::string to_json(const Outcome& o) {
  return Json{{"token", o.token},
              {"code", static_cast<int>(o.code)},
              {"word", word_of(o.code)},
              {"reason", o.reason},
              {"by_signal", o.by_signal},
              {"step", o.step},
              {"time", o.time},
              {"end_time", o.end_time},
              {"checkpoint", o.checkpoint},
              {"state_hash", o.state_hash},
              {"max_overlap", o.max_overlap},
              {"mean_overlap", o.mean_overlap},
              {"particles", o.particles},
              {"steps_done", o.steps_done},
              {"wall_seconds", o.wall_seconds},
              {"compute_seconds", o.compute_seconds},
              {"checkpoint_seconds", o.checkpoint_seconds},
              {"slowest_checkpoint_seconds", o.slowest_checkpoint_seconds},
              {"ranks", o.ranks},
              {"threads", o.threads}}
             .dump(2) +
         "\n";
}

Outcome outcome_from_json(const std::string& text, const std::string& source) {
  return parse<Outcome>(text, source, [](const Json& j, Outcome& o) {
    j.at("token").get_to(o.token);
    o.code = code_from(j.at("code").get<int>());
    j.at("reason").get_to(o.reason);
    j.at("by_signal").get_to(o.by_signal);
    j.at("step").get_to(o.step);
    j.at("time").get_to(o.time);
    j.at("end_time").get_to(o.end_time);
    j.at("checkpoint").get_to(o.checkpoint);
    j.at("state_hash").get_to(o.state_hash);
    o.max_overlap = j.value("max_overlap", 0.0);  // younger than the first outcomes
    o.mean_overlap = j.value("mean_overlap", 0.0);
    j.at("particles").get_to(o.particles);
    j.at("steps_done").get_to(o.steps_done);
    j.at("wall_seconds").get_to(o.wall_seconds);
    j.at("compute_seconds").get_to(o.compute_seconds);
    j.at("checkpoint_seconds").get_to(o.checkpoint_seconds);
    o.slowest_checkpoint_seconds = j.value("slowest_checkpoint_seconds", 0.0);
    j.at("ranks").get_to(o.ranks);
    o.threads = j.value("threads", 1);  // records of engines without threads
  });
}

std::string to_json(const Progress& p) {
  return Json{{"token", p.token},
              {"step", p.step},
              {"time", p.time},
              {"end_time", p.end_time},
              {"particle_steps_per_second", p.particle_steps_per_second},
              {"seconds_left", p.seconds_left},
              {"phase", p.phase}}
             .dump() +
         "\n";
}

Progress progress_from_json(const std::string& text, const std::string& source) {
  return parse<Progress>(text, source, [](const Json& j, Progress& p) {
    j.at("token").get_to(p.token);
    j.at("step").get_to(p.step);
    j.at("time").get_to(p.time);
    j.at("end_time").get_to(p.end_time);
    j.at("particle_steps_per_second").get_to(p.particle_steps_per_second);
    j.at("seconds_left").get_to(p.seconds_left);
    j.at("phase").get_to(p.phase);
  });
}

std::string to_json(const Event& e) {
  return Json{{"token", e.token},
              {"sequence", e.sequence},
              {"kind", e.kind},
              {"job", e.job},
              {"step", e.step},
              {"time", e.time},
              {"checkpoint", e.checkpoint},
              {"state_hash", e.state_hash},
              {"host", e.host}}
             .dump(2) +
         "\n";
}

Event event_from_json(const std::string& text, const std::string& source) {
  return parse<Event>(text, source, [](const Json& j, Event& e) {
    j.at("token").get_to(e.token);
    j.at("sequence").get_to(e.sequence);
    j.at("kind").get_to(e.kind);
    j.at("job").get_to(e.job);
    j.at("step").get_to(e.step);
    j.at("time").get_to(e.time);
    j.at("checkpoint").get_to(e.checkpoint);
    j.at("state_hash").get_to(e.state_hash);
    j.at("host").get_to(e.host);
  });
}

void write_event(const std::filesystem::path& run_directory, const Event& event) {
  char sequence[24];
  std::snprintf(sequence, sizeof sequence, "%06lld", static_cast<long long>(event.sequence));
  const std::filesystem::path directory = run_directory / run_files::kEvents;
  write_atomic(directory / (std::string(sequence) + "-" + event.token + "-" + event.kind + ".json"),
               to_json(event));
}

std::string to_json(const CheckpointManifest& m) {
  return Json{{"file", m.file},
              {"case_key", m.case_key},
              {"step", m.step},
              {"time", m.time},
              {"state_hash", m.state_hash},
              {"bytes", m.bytes},
              {"settled_bed", m.settled_bed}}
             .dump(2) +
         "\n";
}

CheckpointManifest manifest_from_json(const std::string& text, const std::string& source) {
  return parse<CheckpointManifest>(text, source, [](const Json& j, CheckpointManifest& m) {
    j.at("file").get_to(m.file);
    j.at("case_key").get_to(m.case_key);
    j.at("step").get_to(m.step);
    j.at("time").get_to(m.time);
    j.at("state_hash").get_to(m.state_hash);
    j.at("bytes").get_to(m.bytes);
    j.at("settled_bed").get_to(m.settled_bed);
  });
}

}  // namespace grouser
