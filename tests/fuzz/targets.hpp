// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

namespace grouser {

/// What text from outside goes through. A new one is a function and a line in the table; its
/// corpus is corpus/NAME, and preset `fuzz` makes the program fuzz_NAME.
struct FuzzTarget {
  const char* name;
  /// Reads the text or refuses it with an error of ours; anything else is a defect.
  void (*read)(const std::string& text);
};

void read_yaml(const std::string& text);
void read_case_text(const std::string& text);
void read_event(const std::string& text);
void read_outcome(const std::string& text);
void read_manifest(const std::string& text);
void read_job_record(const std::string& text);
void read_squeue(const std::string& text);
void read_sacct(const std::string& text);
void read_qstat(const std::string& text);

inline constexpr std::array<FuzzTarget, 9> kFuzzTargets{{
    {"yaml", read_yaml},
    {"case", read_case_text},
    {"event", read_event},
    {"outcome", read_outcome},
    {"manifest", read_manifest},
    {"job_record", read_job_record},
    {"squeue", read_squeue},
    {"sacct", read_sacct},
    {"qstat", read_qstat},
}};

}  // namespace grouser
