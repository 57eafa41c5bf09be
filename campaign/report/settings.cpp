// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/settings.hpp"

namespace grouser {

SlipDefinition ReportSettings::slip_definition() const {
  return find_slip_definition(horizontal).value_or(SlipDefinition::kPowered);
}

void describe(FieldVisitor& v, ReportSettings& s) {
  v.word({"horizontal", "slip definition of the curves' axis", kOptional}, s.horizontal,
         {"powered", "bounded"});
  v.word({"scatter_axis", "sweep axis that repeats a point, such as seeds", kOptional},
         s.scatter_axis, {});
  v.list(
      {"recordings", "measured values to set beside the campaign", kOptional}, s.recordings.size(),
      [&](std::size_t count) { s.recordings.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) {
        inner.word({"path", "folder of the recording, relative to the campaign file"},
                   s.recordings[i], {});
      });
  v.list(
      {"neglected", "what the campaign leaves out, for readers of the report", kOptional},
      s.neglected.size(), [&](std::size_t count) { s.neglected.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) {
        inner.word({"text", "one simplification and its reason"}, s.neglected[i], {});
      });
}

ReportSettings read_report_settings(const YamlNode& node, std::vector<Problem>& problems) {
  ReportSettings settings;
  if (node.kind == YamlNode::Kind::kNull) return settings;
  read_fields(
      node, [&](FieldVisitor& visitor) { describe(visitor, settings); }, problems);
  return settings;
}

}  // namespace grouser
