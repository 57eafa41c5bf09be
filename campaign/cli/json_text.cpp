// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/json_text.hpp"

#include <set>

#include "base/errors.hpp"

namespace grouser {
namespace {

// Numbers stay numbers; NULL is told from an empty text by being no text. SQLite spells infinities
// as words.
Json json_value(const std::string& text, bool is_text) {
  if (is_text) return text;
  const Json number = Json::parse(text, nullptr, false);
  return number.is_number() ? number : Json();
}

class JsonWriter : public FieldVisitor {
 public:
  void quantity(const Field& field, double& value, const char*, Range) override {
    json[field.key] = value;
  }
  void integer(const Field& field, std::int64_t& value, std::int64_t, std::int64_t) override {
    json[field.key] = value;
  }
  void flag(const Field& field, bool& value) override { json[field.key] = value; }
  void word(const Field& field, std::string& value, const std::vector<std::string>&) override {
    json[field.key] = value;
  }
  void group(const Field& field, const Body& body) override {
    JsonWriter inner;
    body(inner);
    json[field.key] = inner.json;
  }
  void optional_group(const Field& field, bool& present, const Body& body) override {
    if (present) group(field, body);
  }
  void list(const Field& field, std::size_t count, const std::function<void(std::size_t)>&,
            const ItemBody& item) override {
    json[field.key] = Json::array();
    for (std::size_t i = 0; i < count; ++i) {
      JsonWriter inner;
      item(inner, i);
      json[field.key].push_back(inner.json);
    }
  }
  void rule(const char*, bool, const std::string&, const std::string&) override {}
  void check(const char*, bool, const std::string&, const std::string&) override {}
  // A case keeps no part of the YAML as it was written.
  void raw(const Field&, YamlNode&) override {}

  Json json = Json::object();
};

}  // namespace

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json rows_json(const Table& table) {
  std::set<std::string> names;
  for (const std::string& name : table.columns)
    if (!names.insert(name).second)
      throw ConfigError({Problem{"query", 0, 0, "", "two columns are called '" + name + "'",
                                 "JSON needs names of their own: say AS NAME"}});
  Json rows = Json::array();
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    Json row = Json::object();
    for (std::size_t k = 0; k < table.columns.size(); ++k)
      row[table.columns[k]] = json_value(table.rows[i][k], table.is_text[i][k]);
    rows.push_back(row);
  }
  return rows;
}

Json case_json(const Case& input) {
  Case copy = input;
  JsonWriter writer;
  describe(writer, copy);
  return writer.json;
}

}  // namespace grouser
