// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/parameters.hpp"

#include "base/schema.hpp"
#include "campaign/report/html.hpp"

namespace grouser {
namespace {

class ParameterLister : public FieldVisitor {
 public:
  ParameterLister(std::string path, std::vector<Parameter>& parameters)
      : path_(std::move(path)), parameters_(parameters) {}

  void quantity(const Field& field, double& value, const char* unit, Range) override {
    const std::string shown = std::string(unit) == "1" ? "" : unit;
    put(field, shown_significant(value, 6), shown);
  }
  void integer(const Field& field, std::int64_t& value, std::int64_t, std::int64_t) override {
    put(field, std::to_string(value), "");
  }
  void flag(const Field& field, bool& value) override { put(field, value ? "yes" : "no", ""); }
  void word(const Field& field, std::string& value, const std::vector<std::string>&) override {
    if (!value.empty()) put(field, value, "");
  }
  void group(const Field& field, const Body& body) override {
    ParameterLister inner(name(field), parameters_);
    body(inner);
  }
  void optional_group(const Field& field, bool& present, const Body& body) override {
    if (present) group(field, body);
  }
  void list(const Field& field, std::size_t count, const std::function<void(std::size_t)>&,
            const ItemBody& item) override {
    for (std::size_t i = 0; i < count; ++i) {
      ParameterLister inner(name(field) + "[" + std::to_string(i + 1) + "]", parameters_);
      item(inner, i);
    }
  }
  void rule(const char*, bool, const std::string&, const std::string&) override {}
  void check(const char*, bool, const std::string&, const std::string&) override {}
  void raw(const Field&, YamlNode&) override {}

 private:
  std::string name(const Field& field) const {
    return path_.empty() ? field.key : path_ + "." + field.key;
  }
  void put(const Field& field, std::string value, std::string unit) {
    parameters_.push_back({name(field), std::move(value), std::move(unit), field.meaning});
  }

  std::string path_;
  std::vector<Parameter>& parameters_;
};

}  // namespace

std::vector<Parameter> parameters_of(const Case& input) {
  std::vector<Parameter> parameters;
  Case copy = input;
  ParameterLister lister("", parameters);
  describe(lister, copy);
  return parameters;
}

}  // namespace grouser
