// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/find.hpp"

#include <fnmatch.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "campaign/cli/machine.hpp"
#include "campaign/report/report.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEngineName = "grouser-engine";

[[noreturn]] void refuse(const std::string& what, const std::string& problem,
                         const std::string& hint) {
  throw ConfigError({Problem{what, 0, 0, "", problem, hint}});
}

bool is_root(const fs::path& directory) {
  std::error_code unreadable;
  // Without its database it can be rebuilt.
  const bool is_there = fs::exists(directory / Store::kFileName, unreadable) ||
                        fs::exists(directory / kJournalName, unreadable);
  if (unreadable)
    throw StorageError("cannot look into " + directory.string() + ": " + unreadable.message());
  return is_there;
}

std::vector<fs::path> roots_here() {
  std::vector<fs::path> roots;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("runs", error))
    if (is_root(entry.path())) roots.push_back(entry.path());
  std::sort(roots.begin(), roots.end());
  return roots;
}

bool is_executable(const fs::path& file) {
  return fs::is_regular_file(file) && ::access(file.c_str(), X_OK) == 0;
}

std::vector<fs::path> engine_places() {
  std::vector<fs::path> places;
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  // Installed side by side, or each in its folder of a build tree.
  places.push_back(here / kEngineName);
  places.push_back(here.parent_path() / "engine" / kEngineName);
  const char* const path = std::getenv("PATH");
  std::istringstream directories(path == nullptr ? "" : path);
  for (std::string one; std::getline(directories, one, ':');)
    places.push_back(fs::path(one) / kEngineName);
  return places;
}

bool matches(const RunRow& run, const std::string& pattern) {
  return ::fnmatch(pattern.c_str(), run.label.c_str(), 0) == 0 ||
         ::fnmatch(pattern.c_str(), run.directory.filename().c_str(), 0) == 0;
}

}  // namespace

fs::path find_root(const std::string& where) {
  if (where.empty()) {
    if (is_root(".")) return fs::absolute(".").lexically_normal();
    const auto roots = roots_here();
    if (roots.size() == 1) return fs::absolute(roots.front()).lexically_normal();
    std::string names;
    for (const fs::path& root : roots) names += (names.empty() ? "" : ", ") + root.string();
    refuse("runs", roots.empty() ? "there is no campaign here" : "there are several campaigns",
           roots.empty() ? "name its root directory" : "name one of " + names);
  }
  if (is_root(where)) return fs::absolute(where).lexically_normal();
  if (is_root(fs::path("runs") / where))
    return fs::absolute(fs::path("runs") / where).lexically_normal();
  if (fs::is_regular_file(where)) {
    const YamlNode yaml = load_yaml(where);
    const YamlNode* name = yaml.find("campaign");
    if (name != nullptr && is_root(root_of(name->scalar, ""))) return root_of(name->scalar, "");
  }
  refuse(where, "is not a campaign",
         "give a campaign's root, its name below runs/ or its YAML, here or after -C");
}

std::vector<fs::path> find_roots(const std::vector<std::string>& where) {
  std::vector<fs::path> roots;
  for (const std::string& one : where) roots.push_back(find_root(one));
  if (where.empty() && !is_root("."))
    for (const fs::path& root : roots_here())
      roots.push_back(fs::absolute(root).lexically_normal());
  return roots.empty() ? std::vector<fs::path>{find_root("")} : roots;
}

fs::path root_of(const std::string& name, const std::string& given) {
  return fs::absolute(given.empty() ? fs::path("runs") / name : fs::path(given)).lexically_normal();
}

Plan checked_plan(const std::string& file, const std::string& site) {
  Plan plan =
      plan_campaign(file, site, [&](const CampaignFile& read, std::vector<Problem>& problems) {
        check_machine(read, problems);
        if (read.report.kind == YamlNode::Kind::kMap)
          check_report(read.report, fs::absolute(file).parent_path(), problems);
      });
  for (const Problem& one : plan.warnings) std::cerr << "warning: " << one.text() << "\n";
  return plan;
}

std::vector<RunRow> select_runs(const Store& store, const std::vector<std::string>& patterns,
                                bool all) {
  const auto runs = store.runs();
  if (all) return runs;
  if (patterns.empty()) refuse("", "no run is named", "name runs, or say --all");
  for (const std::string& pattern : patterns)
    if (std::none_of(runs.begin(), runs.end(),
                     [&](const RunRow& run) { return matches(run, pattern); })) {
      std::vector<std::string> labels;
      for (const RunRow& run : runs) labels.push_back(run.label);
      const std::string close = nearest(pattern, labels);
      refuse(pattern, "no run is called so",
             close.empty() ? "see grouser status" : "did you mean " + close + "?");
    }
  std::vector<RunRow> chosen;
  for (const RunRow& run : runs)
    if (std::any_of(patterns.begin(), patterns.end(),
                    [&](const std::string& pattern) { return matches(run, pattern); }))
      chosen.push_back(run);
  return chosen;
}

fs::path find_engine(const std::string& given) {
  const char* const variable = std::getenv("GROUSER_ENGINE");
  const std::string named = !given.empty() ? given : variable != nullptr ? variable : "";
  if (!named.empty()) {
    if (!is_executable(named)) refuse(named, "is not a program", "name the engine's program file");
    return fs::absolute(named).lexically_normal();
  }
  for (const fs::path& place : engine_places())
    if (is_executable(place)) return fs::absolute(place).lexically_normal();
  refuse(kEngineName, "is not found beside grouser nor on PATH",
         "say --engine FILE or set GROUSER_ENGINE");
}

}  // namespace grouser
