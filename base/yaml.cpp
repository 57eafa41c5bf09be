// SPDX-License-Identifier: BSD-3-Clause
#include "base/yaml.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "base/errors.hpp"

namespace grouser {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{4} << 20;
constexpr std::size_t kMaxNodes = 200000;
constexpr int kMaxDepth = 64;

class Importer {
 public:
  explicit Importer(std::string file) : file_(std::move(file)) {}

  YamlNode import(const YAML::Node& from, int depth) {
    YamlNode node;
    node.file = file_;
    node.line = from.Mark().line + 1;
    node.column = from.Mark().column + 1;
    if (++count_ > kMaxNodes) refuse(node, "more than 200000 values", "split the document");
    if (depth > kMaxDepth) refuse(node, "nested deeper than 64 levels", "flatten it");
    if (from.IsScalar()) {
      node.kind = YamlNode::Kind::kScalar;
      node.scalar = from.Scalar();
    } else if (from.IsSequence()) {
      node.kind = YamlNode::Kind::kSequence;
      for (const YAML::Node& item : from) node.items.push_back(import(item, depth + 1));
    } else if (from.IsMap()) {
      node.kind = YamlNode::Kind::kMap;
      for (const auto& entry : from) add_entry(node, entry.first, import(entry.second, depth + 1));
    }
    return node;
  }

  std::vector<Problem> problems;

 private:
  void add_entry(YamlNode& map, const YAML::Node& key, YamlNode value) {
    const int line = key.Mark().line + 1;
    const int column = key.Mark().column + 1;
    if (!key.IsScalar()) {
      problems.push_back({file_, line, column, "", "a key must be a plain word", ""});
      return;
    }
    if (const YamlNode* first = map.find(key.Scalar())) {
      problems.push_back({file_, line, column, key.Scalar(), "given twice",
                          "first given in line " + std::to_string(first->line)});
      return;
    }
    // Values without text (null, empty maps) carry no mark of their own.
    if (value.line == 0) {
      value.line = line;
      value.column = column;
    }
    map.entries.emplace_back(key.Scalar(), std::move(value));
  }

  [[noreturn]] void refuse(const YamlNode& at, const std::string& what, const std::string& hint) {
    throw ConfigError({Problem{file_, at.line, at.column, "", what, hint}});
  }

  std::string file_;
  std::size_t count_ = 0;
};

YAML::Node to_yaml_cpp(const YamlNode& node) {
  YAML::Node out;
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      break;
    case YamlNode::Kind::kScalar:
      out = node.scalar;
      break;
    case YamlNode::Kind::kSequence:
      out = YAML::Node(YAML::NodeType::Sequence);
      for (const YamlNode& item : node.items) out.push_back(to_yaml_cpp(item));
      break;
    case YamlNode::Kind::kMap:
      out = YAML::Node(YAML::NodeType::Map);
      for (const auto& [key, value] : node.entries) out[key] = to_yaml_cpp(value);
      break;
  }
  return out;
}

// Notes where documents begin and nothing else.
class DocumentStarts : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { line = mark.line + 1; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

  int line = 0;
};

// 0 = there is none. YAML::LoadAll would not come back from a text that begins with a comma: the
// library then finds one empty document after the other at the same place.
int line_of_second_document(const std::string& text) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  DocumentStarts starts;
  return parser.HandleNextDocument(starts) && parser.HandleNextDocument(starts) ? starts.line : 0;
}

}  // namespace

const YamlNode* YamlNode::find(const std::string& key) const {
  for (const auto& entry : entries)
    if (entry.first == key) return &entry.second;
  return nullptr;
}

YamlNode* YamlNode::find(const std::string& key) {
  for (auto& entry : entries)
    if (entry.first == key) return &entry.second;
  return nullptr;
}

const YamlNode* YamlNode::find_path(const std::string& path) const {
  const YamlNode* at = this;
  std::istringstream steps(path);
  for (std::string step; at != nullptr && std::getline(steps, step, '.');) at = at->find(step);
  return at;
}

void YamlNode::overlay(const std::string& path, const YamlNode& value) {
  YamlNode* at = this;
  std::istringstream steps(path);
  std::string step;
  while (std::getline(steps, step, '.')) {
    if (at->kind == Kind::kNull) at->kind = Kind::kMap;
    if (at->kind != Kind::kMap || step.empty())
      throw std::invalid_argument("'" + path + "' does not lead to a value");
    YamlNode* next = at->find(step);
    if (next == nullptr) {
      at->entries.emplace_back(step, YamlNode{});
      next = &at->entries.back().second;
      next->file = value.file;
      next->line = value.line;
      next->column = value.column;
    }
    at = next;
  }
  *at = value;
}

YamlNode YamlNode::make_scalar(std::string text) {
  YamlNode node;
  node.kind = Kind::kScalar;
  node.scalar = std::move(text);
  return node;
}

YamlNode YamlNode::make_map() {
  YamlNode node;
  node.kind = Kind::kMap;
  return node;
}

YamlNode parse_yaml(const std::string& text, const std::string& name) {
  if (text.size() > kMaxBytes)
    throw ConfigError(
        {Problem{name, 0, 0, "", "larger than 4 MiB", "a case or campaign is small"}});
  try {
    Importer importer(name);
    if (const int line = line_of_second_document(text); line > 0)
      throw ConfigError({Problem{name, line, 1, "", "a second document begins at this line",
                                 "one file holds one document; remove '---' and what follows"}});
    YamlNode node = importer.import(YAML::Load(text), 0);
    if (!importer.problems.empty()) throw ConfigError(importer.problems);
    return node;
  } catch (const YAML::Exception& error) {
    throw ConfigError({Problem{name, error.mark.line + 1, error.mark.column + 1, "",
                               "not YAML: " + error.msg, "check indentation, colons and quotes"}});
  }
}

YamlNode load_yaml(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error || !std::filesystem::is_regular_file(file))
    throw ConfigError(
        {Problem{file.string(), 0, 0, "", "cannot be read", "check the path and its permissions"}});
  if (size > kMaxBytes)
    throw ConfigError(
        {Problem{file.string(), 0, 0, "", "larger than 4 MiB", "a case or campaign is small"}});
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in)
    throw ConfigError(
        {Problem{file.string(), 0, 0, "", "cannot be read", "check the path and its permissions"}});
  return parse_yaml(text.str(), file.string());
}

std::string emit_yaml(const YamlNode& node) {
  YAML::Emitter out;
  out << to_yaml_cpp(node);
  return std::string(out.c_str()) + "\n";
}

}  // namespace grouser
