// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/yaml.hpp"

namespace grouser {

/// Values a quantity may take, in its SI unit.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;  ///< the low end itself is refused
  bool high_open = false;

  static constexpr Range any() { return {}; }
  static constexpr Range positive() { return {0.0, std::numeric_limits<double>::infinity(), true}; }
  static constexpr Range not_negative() { return {0.0}; }
  static constexpr Range closed(double low, double high) { return {low, high}; }
  static constexpr Range above_up_to(double low, double high) { return {low, high, true}; }
  static constexpr Range open(double low, double high) { return {low, high, true, true}; }

  bool contains(double value) const;
  std::string text() const;
};

/// Key of an input value, what it means, and whether it must be given (else the struct's own
/// initial value is the default).
struct Field {
  enum class Need { kRequired, kOptional };
  const char* key;
  const char* meaning;
  Need need = Need::kRequired;
};
inline constexpr Field::Need kOptional = Field::Need::kOptional;

/// Walks the fields of an input struct. A struct is described once, by a function
/// `describe(FieldVisitor&, Struct&)`; reading with located errors, writing in SI units and the
/// reference page are three visitors of that one description.
class FieldVisitor {
 public:
  virtual ~FieldVisitor() = default;
  using Body = std::function<void(FieldVisitor&)>;
  using ItemBody = std::function<void(FieldVisitor&, std::size_t)>;

  /// @param unit UDUNITS-2 unit in which `value` is held; "1" for a pure number
  virtual void quantity(const Field& field, double& value, const char* unit, Range range) = 0;
  virtual void integer(const Field& field, std::int64_t& value, std::int64_t low,
                       std::int64_t high) = 0;
  virtual void flag(const Field& field, bool& value) = 0;
  /// @param choices the words allowed; empty for free text
  virtual void word(const Field& field, std::string& value,
                    const std::vector<std::string>& choices) = 0;
  /// A nested map. An optional group that is absent keeps its defaults.
  virtual void group(const Field& field, const Body& body) = 0;
  /// A nested map whose presence is itself information.
  virtual void optional_group(const Field& field, bool& present, const Body& body) = 0;
  /// A sequence of maps. `resize` is called with the number of items before `item` is.
  virtual void list(const Field& field, std::size_t count,
                    const std::function<void(std::size_t)>& resize, const ItemBody& item) = 0;
  /// A further rule over values already visited, reported at the position of `key`, which may be a
  /// dotted path.
  virtual void rule(const char* key, bool holds, const std::string& problem,
                    const std::string& hint) = 0;
  /// A rule over the value of `key` alone; it is checked although other keys may be wrong.
  virtual void check(const char* key, bool holds, const std::string& problem,
                     const std::string& hint) = 0;
  /// A part of the map that is kept as it is written, for a later reader; `node` is null-kind
  /// when it is absent.
  virtual void raw(const Field& field, YamlNode& node) = 0;
};

/// Fills a struct from `node`, appending every problem found to `problems`: missing, unknown
/// (with the nearest known key), wrong kind, wrong unit, out of range. Nothing is thrown. Local.
/// @param path  of `node` in its document, "" = it is the document
void read_fields(const YamlNode& node, const FieldVisitor::Body& body,
                 std::vector<Problem>& problems, const std::string& path = "");

/// The struct as YAML in SI units; reading it back gives the same bits. Local.
YamlNode write_fields(const FieldVisitor::Body& body);

/// Markdown table rows of all fields: key below `path`, unit, range, default, meaning. Local.
std::string reference_of(const FieldVisitor::Body& body, const std::string& path = "");

}  // namespace grouser
