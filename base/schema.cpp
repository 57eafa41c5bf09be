// SPDX-License-Identifier: BSD-3-Clause
#include "base/schema.hpp"

#include <charconv>
#include <set>
#include <stdexcept>

#include "base/units.hpp"

namespace grouser {
namespace {

class Reader : public FieldVisitor {
 public:
  Reader(const YamlNode& node, std::string path, std::vector<Problem>& problems)
      : node_(node), path_(std::move(path)), problems_(problems) {
    if (node.kind != YamlNode::Kind::kMap)
      report(node, path_, "must be a map of keys and values", "write `key: value` lines under it");
  }

  void quantity(const Field& field, double& value, const char* unit, Range range) override {
    const YamlNode* at = scalar(field);
    if (at == nullptr) return;
    try {
      const double read = parse_quantity(at->scalar, unit);
      if (range.contains(read)) {
        value = read;
      } else {
        report(*at, name(field), "'" + at->scalar + "' is out of range",
               "allowed is " + range.text() +
                   (std::string(unit) == "1" ? "" : " " + std::string(unit)));
      }
    } catch (const std::invalid_argument& error) {
      report(*at, name(field), error.what(), "it is " + std::string(field.meaning));
    }
  }

  void integer(const Field& field, std::int64_t& value, std::int64_t low,
               std::int64_t high) override {
    const YamlNode* at = scalar(field);
    if (at == nullptr) return;
    const std::string& text = at->scalar;
    std::int64_t read = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), read);
    if (error != std::errc() || end != text.data() + text.size()) {
      report(*at, name(field), "'" + text + "' is not a whole number", "");
    } else if (read < low || read > high) {
      report(*at, name(field), "'" + text + "' is out of range",
             "allowed is " + std::to_string(low) + " to " + std::to_string(high));
    } else {
      value = read;
    }
  }

  void flag(const Field& field, bool& value) override {
    const YamlNode* at = scalar(field);
    if (at == nullptr) return;
    if (at->scalar == "true" || at->scalar == "yes" || at->scalar == "on") {
      value = true;
    } else if (at->scalar == "false" || at->scalar == "no" || at->scalar == "off") {
      value = false;
    } else {
      report(*at, name(field), "'" + at->scalar + "' is neither true nor false", "");
    }
  }

  void word(const Field& field, std::string& value,
            const std::vector<std::string>& choices) override {
    const YamlNode* at = scalar(field);
    if (at == nullptr) return;
    bool known = choices.empty();
    std::string all;
    for (const std::string& choice : choices) {
      known = known || choice == at->scalar;
      all += (all.empty() ? "" : ", ") + choice;
    }
    if (known) {
      value = at->scalar;
      return;
    }
    const std::string close = nearest(at->scalar, choices);
    report(*at, name(field), "'" + at->scalar + "' is not one of its words",
           (close.empty() ? "" : "did you mean '" + close + "'? ") + ("allowed: " + all));
  }

  void group(const Field& field, const Body& body) override {
    const YamlNode* at = entry(field);
    if (at != nullptr) descend(*at, name(field), body);
  }

  void optional_group(const Field& field, bool& present, const Body& body) override {
    const YamlNode* at = entry(field);
    present = at != nullptr;
    if (present) descend(*at, name(field), body);
  }

  void list(const Field& field, std::size_t, const std::function<void(std::size_t)>& resize,
            const ItemBody& item) override {
    const YamlNode* at = entry(field);
    if (at == nullptr) return;
    if (at->kind != YamlNode::Kind::kSequence) {
      report(*at, name(field), "must be a list", "start each item with '- '");
      return;
    }
    resize(at->items.size());
    for (std::size_t i = 0; i < at->items.size(); ++i)
      descend(at->items[i], name(field) + "[" + std::to_string(i) + "]",
              [&](FieldVisitor& visitor) { item(visitor, i); });
  }

  void rule(const char* key, bool holds, const std::string& problem,
            const std::string& hint) override {
    if (holds || broken_) return;
    const YamlNode* at = node_.find_path(key);
    report(at != nullptr ? *at : node_, path_.empty() ? key : path_ + "." + key, problem, hint);
  }

  void check(const char* key, bool holds, const std::string& problem,
             const std::string& hint) override {
    const YamlNode* at = node_.find(key);
    if (holds || at == nullptr || broken_keys_.count(key) > 0) return;
    report(*at, path_.empty() ? key : path_ + "." + key, problem, hint);
  }

  void raw(const Field& field, YamlNode& node) override {
    const YamlNode* at = entry(field);
    if (at != nullptr) node = *at;
  }

  void refuse_unknown() {
    for (const auto& [key, value] : node_.entries) {
      bool known = false;
      for (const std::string& one : known_) known = known || one == key;
      if (known) continue;
      const std::string close = nearest(key, known_);
      std::string all;
      for (const std::string& one : known_) all += (all.empty() ? "" : ", ") + one;
      report(value, path_.empty() ? key : path_ + "." + key, "unknown key",
             close.empty() ? "known here: " + all : "did you mean '" + close + "'?");
    }
  }

 private:
  std::string name(const Field& field) const {
    return path_.empty() ? field.key : path_ + "." + field.key;
  }

  const YamlNode* entry(const Field& field) {
    known_.emplace_back(field.key);
    const YamlNode* at = node_.find(field.key);
    if (at != nullptr && at->kind != YamlNode::Kind::kNull) return at;
    if (field.need == Field::Need::kRequired && node_.kind == YamlNode::Kind::kMap)
      report(at != nullptr ? *at : node_, name(field), "is missing",
             "give " + std::string(field.meaning));
    return nullptr;
  }

  const YamlNode* scalar(const Field& field) {
    const YamlNode* at = entry(field);
    if (at == nullptr || at->kind == YamlNode::Kind::kScalar) return at;
    report(*at, name(field), "must be a single value", "it is " + std::string(field.meaning));
    return nullptr;
  }

  void descend(const YamlNode& at, const std::string& path, const Body& body) {
    Reader inner(at, path, problems_);
    if (at.kind != YamlNode::Kind::kMap) {
      broken_ = true;
      return;
    }
    body(inner);
    inner.refuse_unknown();
    broken_ = broken_ || inner.broken_;
  }

  void report(const YamlNode& at, const std::string& key, const std::string& problem,
              const std::string& hint) {
    broken_ = true;
    broken_keys_.insert(key.substr(key.rfind('.') + 1));
    problems_.push_back({at.file, at.line, at.column, key, problem, hint});
  }

  const YamlNode& node_;
  std::string path_;
  std::vector<Problem>& problems_;
  std::vector<std::string> known_;
  std::set<std::string> broken_keys_;
  bool broken_ = false;  // rules over values that were not read would only repeat the message
};

class Writer : public FieldVisitor {
 public:
  void quantity(const Field& field, double& value, const char* unit, Range) override {
    put(field, YamlNode::make_scalar(format_quantity(value, unit)));
  }
  void integer(const Field& field, std::int64_t& value, std::int64_t, std::int64_t) override {
    put(field, YamlNode::make_scalar(std::to_string(value)));
  }
  void flag(const Field& field, bool& value) override {
    put(field, YamlNode::make_scalar(value ? "true" : "false"));
  }
  void word(const Field& field, std::string& value, const std::vector<std::string>&) override {
    // An empty optional word means "not given" and must read back as such.
    if (!value.empty()) put(field, YamlNode::make_scalar(value));
  }
  void group(const Field& field, const Body& body) override {
    Writer inner;
    body(inner);
    put(field, inner.node);
  }
  void optional_group(const Field& field, bool& present, const Body& body) override {
    if (present) group(field, body);
  }
  void list(const Field& field, std::size_t count, const std::function<void(std::size_t)>&,
            const ItemBody& item) override {
    if (count == 0) return;
    YamlNode sequence;
    sequence.kind = YamlNode::Kind::kSequence;
    for (std::size_t i = 0; i < count; ++i) {
      Writer inner;
      item(inner, i);
      sequence.items.push_back(inner.node);
    }
    put(field, sequence);
  }
  void rule(const char*, bool, const std::string&, const std::string&) override {}
  void check(const char*, bool, const std::string&, const std::string&) override {}
  void raw(const Field& field, YamlNode& kept) override {
    if (kept.kind != YamlNode::Kind::kNull) put(field, kept);
  }

  YamlNode node = YamlNode::make_map();

 private:
  void put(const Field& field, YamlNode value) {
    node.entries.emplace_back(field.key, std::move(value));
  }
};

class ReferenceWriter : public FieldVisitor {
 public:
  explicit ReferenceWriter(std::string path) : path_(std::move(path)) {}

  void quantity(const Field& field, double& value, const char* unit, Range range) override {
    row(field, unit, range.text(), format_number(value));
  }
  void integer(const Field& field, std::int64_t& value, std::int64_t low,
               std::int64_t high) override {
    const bool unbounded = high == std::numeric_limits<std::int64_t>::max();
    row(field, "whole number",
        std::to_string(low) + (unbounded ? " and more" : " to " + std::to_string(high)),
        std::to_string(value));
  }
  void flag(const Field& field, bool& value) override {
    row(field, "true/false", "", value ? "true" : "false");
  }
  void word(const Field& field, std::string& value,
            const std::vector<std::string>& choices) override {
    std::string all;
    for (const std::string& choice : choices) all += (all.empty() ? "" : ", ") + choice;
    row(field, "text", all, value);
  }
  void group(const Field& field, const Body& body) override {
    row(field, "group", "", "");
    nest(name(field), body);
  }
  void optional_group(const Field& field, bool&, const Body& body) override { group(field, body); }
  void list(const Field& field, std::size_t, const std::function<void(std::size_t)>& resize,
            const ItemBody& item) override {
    row(field, "list", "", "");
    resize(1);
    nest(name(field) + "[]", [&](FieldVisitor& visitor) { item(visitor, 0); });
  }
  void rule(const char*, bool, const std::string&, const std::string&) override {}
  void check(const char*, bool, const std::string&, const std::string&) override {}
  void raw(const Field& field, YamlNode&) override { row(field, "map", "", ""); }

  std::string text;

 private:
  std::string name(const Field& field) const {
    return path_.empty() ? field.key : path_ + "." + field.key;
  }
  void nest(const std::string& path, const Body& body) {
    ReferenceWriter inner(path);
    body(inner);
    text += inner.text;
  }
  void row(const Field& field, const std::string& unit, const std::string& range,
           const std::string& initial) {
    const bool required = field.need == Field::Need::kRequired;
    text += "| `" + name(field) + "` | " + unit + " | " + range + " | " +
            (required ? "required" : initial) + " | " + field.meaning + " |\n";
  }

  std::string path_;
};

}  // namespace

bool Range::contains(double value) const {
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  const bool from = low > -std::numeric_limits<double>::infinity();
  const bool to = high < std::numeric_limits<double>::infinity();
  if (!from && !to) return "any";
  if (!to) return (low_open ? "> " : ">= ") + format_number(low);
  if (!from) return (high_open ? "< " : "<= ") + format_number(high);
  return (low_open ? "over " : "") + format_number(low) + " to " + (high_open ? "under " : "") +
         format_number(high);
}

void read_fields(const YamlNode& node, const FieldVisitor::Body& body,
                 std::vector<Problem>& problems, const std::string& path) {
  Reader reader(node, path, problems);
  body(reader);
  reader.refuse_unknown();
}

YamlNode write_fields(const FieldVisitor::Body& body) {
  Writer writer;
  body(writer);
  return writer.node;
}

std::string reference_of(const FieldVisitor::Body& body, const std::string& path) {
  ReferenceWriter writer(path);
  body(writer);
  return writer.text;
}

}  // namespace grouser
