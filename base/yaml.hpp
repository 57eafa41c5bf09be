// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace grouser {

/// A YAML value that remembers where it was written. A plain value: copy it, overlay it, hand it
/// on.
struct YamlNode {
  enum class Kind { kNull, kScalar, kSequence, kMap };

  Kind kind = Kind::kNull;
  std::string scalar;
  std::vector<YamlNode> items;                            ///< of a sequence
  std::vector<std::pair<std::string, YamlNode>> entries;  ///< of a map, in the file's order
  std::string file;
  int line = 0;    ///< 1-based
  int column = 0;  ///< 1-based

  /// The entry of a map, or nullptr.
  const YamlNode* find(const std::string& key) const;
  YamlNode* find(const std::string& key);

  /// The value at the dotted `path` (`wheel.slip`), or nullptr.
  const YamlNode* find_path(const std::string& path) const;

  /// Puts `value` at the dotted `path` (`wheel.slip`), making maps on the way. Later paths win.
  /// @throws std::invalid_argument when a step of the path meets something that is not a map
  void overlay(const std::string& path, const YamlNode& value);

  static YamlNode make_scalar(std::string text);
  static YamlNode make_map();
};

/// Reads one YAML document.
/// Refused with a ConfigError: syntax errors, a key given twice, files over 4 MiB, documents that
/// unfold (aliases) to more than 200 000 values or nest deeper than 64. @throws ConfigError. Local.
YamlNode load_yaml(const std::filesystem::path& file);

/// The same for text; `name` stands for the file in messages.
YamlNode parse_yaml(const std::string& text, const std::string& name);

/// Block-style YAML text of `node`; scalars are quoted where YAML would read them otherwise.
std::string emit_yaml(const YamlNode& node);

}  // namespace grouser
