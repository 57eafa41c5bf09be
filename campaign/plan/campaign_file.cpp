// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/plan/campaign_file.hpp"

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "base/case.hpp"
#include "base/substitution.hpp"
#include "base/units.hpp"
#include "campaign/plan/names.hpp"
#include "schedulers/table.hpp"

namespace grouser {
namespace {

constexpr std::int64_t kVersion = 1;
constexpr std::int64_t kMaxChunks = 10000;
constexpr double kShortestBatchWalltime = 60.0;

const std::vector<std::string> kTitleNames{"campaign"};
const std::vector<std::string> kSetupNames{"campaign", "home"};

std::vector<std::string> launcher_names() {
  std::vector<std::string> names;
  for (const auto& [name, value] : launcher_values(JobSpec{})) names.push_back(name);
  return names;
}

// "{campaign}, {home}"
std::string braced(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "{" : ", {") + name + "}";
  return text;
}

struct BraceCheck {
  bool is_good = true;
  std::string problem;
  std::string hint;
};

// A {name} that stands for nothing would go to the machine as it is written.
BraceCheck look_at_braces(const std::string& text, const std::vector<std::string>& known) {
  std::vector<std::string> unknown;
  std::string close;
  for (const std::string& name : names_in_braces(text)) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    unknown.push_back(name);
    if (close.empty()) close = nearest(name, known);
  }
  return {unknown.empty(), "knows no " + braced(unknown),
          (close.empty() ? "" : "did you mean {" + close + "}? ") + "known here: " + braced(known)};
}

void check_braces(FieldVisitor& v, const char* key, const std::string& text,
                  const std::vector<std::string>& known) {
  const BraceCheck check = look_at_braces(text, known);
  v.check(key, check.is_good, check.problem, check.hint);
}

void describe_batch_words(FieldVisitor& v, Resources& r) {
  const char* const plain = "allowed are letters, digits and . _ + @ : / = -";
  v.word({"memory", "memory per node as the scheduler spells it, for example 64G", kOptional},
         r.memory, {});
  v.check("memory", is_memory(r.memory), "is not an amount of memory", "for example 64G");
  v.word({"partition", "Slurm's partition or PBS's queue", kOptional}, r.partition, {});
  v.check("partition", is_batch_name(r.partition), "has characters a scheduler does not take",
          plain);
  v.word({"account", "account or project that is charged", kOptional}, r.account, {});
  v.check("account", is_batch_name(r.account), "has characters a scheduler does not take", plain);
  v.word({"qos", "quality of service", kOptional}, r.qos, {});
  v.check("qos", is_batch_name(r.qos), "has characters a scheduler does not take", plain);
  v.word(
      {"launcher", "starts the ranks; takes {ranks}, {threads} and others, see above", kOptional},
      r.launcher, {});
  v.check("launcher", is_one_line(r.launcher), "has control characters", "write it on one line");
  check_braces(v, "launcher", r.launcher, launcher_names());
  v.word(
      {"setup_file", "shell file read before the engine starts (modules); takes {campaign}, {home}",
       kOptional},
      r.setup_file, {});
  v.check("setup_file", is_one_line(r.setup_file), "has control characters", "give one path");
}

void describe_resources(FieldVisitor& v, Resources& r, const std::string& scheduler) {
  v.integer({"ranks", "MPI ranks of one run", kOptional}, r.ranks, 1, 10'000'000);
  v.integer({"threads", "threads of each rank; the results do not depend on them", kOptional},
            r.threads, 1, 1024);
  v.integer({"nodes", "nodes of one run; 0 = the scheduler decides", kOptional}, r.nodes, 0,
            1'000'000);
  v.rule("nodes", r.nodes <= r.ranks, "are more than ranks", "every node needs a rank");
  v.quantity({"walltime", "longest duration of one job; 0 = none (local only)", kOptional},
             r.walltime, "s", Range::closed(0.0, 366.0 * 86400.0));
  v.check("walltime", r.walltime == 0.0 || r.walltime >= 1.0, "is shorter than a second",
          "a job needs time to start and to write a checkpoint");
  const bool is_too_short =
      scheduler != "local" && r.walltime >= 1.0 && r.walltime < kShortestBatchWalltime;
  v.check("walltime", !is_too_short, "is under 60 s, which is too short for " + scheduler,
          "batch systems count in minutes, and the engine stops " +
              format_number(stop_margin(kShortestBatchWalltime)) + " s or more before the end");
  describe_batch_words(v, r);
  v.integer({"concurrent", "jobs at once; 0 = cores / (ranks x threads) for local, else no limit",
             kOptional},
            r.concurrent, 0, 1'000'000);
  v.flag({"array", "jobs that may start together become one job array (slurm)", kOptional},
         r.array);
  v.rule("array", !r.array || scheduler == "slurm", "is for slurm alone", "leave it out");
}

void describe_limits(FieldVisitor& v, Limits& l) {
  v.integer({"max_chunks", "jobs of one run, failed ones included; 0 = no limit", kOptional},
            l.max_chunks, 0, kMaxChunks);
  v.quantity({"node_hours", "hours of nodes for the whole campaign; 0 = no limit", kOptional},
             l.node_hours, "1", Range::not_negative());
  v.quantity({"hang",
              "a running job that makes no step for so long is killed and tried again; three times "
              "as long before its first step; 0 = never",
              kOptional},
             l.hang, "s", Range::not_negative());
}

void describe_settings(FieldVisitor& v, Settings& s) {
  v.word({"scheduler", "who runs the jobs", kOptional}, s.scheduler, scheduler_names());
  v.group({"resources", "what one job asks of the machine", kOptional},
          [&](FieldVisitor& inner) { describe_resources(inner, s.resources, s.scheduler); });
  v.group({"retries", "how often a failure is tried again", kOptional}, [&](FieldVisitor& inner) {
    inner.integer({"infrastructure",
                   "attempts in a row that may fail without progress for reasons of node, network "
                   "or scheduler",
                   kOptional},
                  s.retries.infrastructure, 0, 1000);
    inner.quantity({"delay", "before the first retry, doubled with each further one; not for local",
                    kOptional},
                   s.retries.delay, "s", Range::closed(0.0, 3600.0));
  });
  v.word({"chain", "who goes on when a job ends", kOptional}, s.chain,
         {"manager", "prologue", "epilogue"});
  v.rule("chain", s.chain != "prologue" || s.scheduler != "local",
         "cannot be prologue with scheduler local",
         "a job of this machine has no queue to wait in");
  v.group({"planner", "what is taken from measurements once there are any", kOptional},
          [&](FieldVisitor& inner) {
            inner.flag({"checkpoints",
                        "wall time between checkpoints from their cost and the failures so far, in "
                        "place of output.checkpoint_interval",
                        kOptional},
                       s.planner.checkpoints);
            inner.flag({"walltime", "of each job from the speed so far, up to resources.walltime",
                        kOptional},
                       s.planner.walltime);
          });
  v.group({"limits", "where the campaign stops by itself", kOptional},
          [&](FieldVisitor& inner) { describe_limits(inner, s.limits); });
  v.rule("resources", s.scheduler == "local" || s.resources.walltime > 0.0,
         "has no walltime, and scheduler " + s.scheduler + " needs one",
         "for example walltime: 8h");
  const bool is_pbs = s.scheduler == "pbs";
  v.rule("resources", !is_pbs || s.resources.qos.empty(), "has a qos, which PBS does not know",
         "name the queue as partition");
  v.rule("resources", !is_pbs || s.resources.memory.empty() || s.resources.nodes > 0,
         "has memory per node but no nodes", "PBS wants both: give nodes");
}

void describe_chunks(FieldVisitor& v, ChunkRule& c) {
  v.integer({"count", "equal parts of simulated time of each wheel run; 0 = not given", kOptional},
            c.count, 0, kMaxChunks);
  v.quantity({"simulated_time", "simulated time of each part; 0 = not given", kOptional},
             c.simulated_time, "s", Range::not_negative());
  v.rule("simulated_time", c.count == 0 || c.simulated_time == 0.0, "is given together with count",
         "give one of the two");
}

void describe_point(FieldVisitor& v, AxisPoint& point) {
  v.word({"label", "name of the point, part of the run's directory name"}, point.label, {});
  v.check("label", is_label(point.label), "'" + point.label + "' cannot be a label",
          "1 to 64 letters, digits and . _ + -, not starting with . or -");
  v.raw({"set", "values of the case at this point, as dotted paths: `wheel.slip: 20 %`"},
        point.set);
  v.check("set", point.set.kind == YamlNode::Kind::kMap, "must be a map of dotted paths and values",
          "for example set: {wheel.slip: 20 %}");
}

void describe_axis(FieldVisitor& v, Axis& axis) {
  v.word({"axis", "name of the axis"}, axis.axis, {});
  v.check("axis", is_label(axis.axis), "'" + axis.axis + "' cannot be a name of an axis",
          "1 to 64 letters, digits and . _ + -, not starting with . or -");
  v.list(
      {"points", "values along the axis"}, axis.points.size(),
      [&](std::size_t count) { axis.points.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_point(inner, axis.points[i]); });
  v.check("points", !axis.points.empty(), "has no point", "give one point or leave the axis out");
}

// A file of another version may differ in every key: its version alone is worth a word. What is no
// number at all is left to the reader of the keys.
bool is_other_version(const YamlNode& root, const char* key, std::vector<Problem>& problems) {
  const YamlNode* at = root.find(key);
  if (at == nullptr) return false;
  std::int64_t version = kVersion;
  const char* const end = at->scalar.data() + at->scalar.size();
  const auto read = std::from_chars(at->scalar.data(), end, version);
  if (read.ec != std::errc() || read.ptr != end || version == kVersion) return false;
  problems.push_back(
      {at->file, at->line, at->column, key,
       "the file is of version " + std::to_string(version) + ", and this grouser knows version " +
           std::to_string(kVersion),
       version > kVersion ? "use a newer grouser" : "write " + std::string(key) + ": 1"});
  return true;
}

// Puts the site's own values, with their own positions, over those of the campaign.
void apply_site(YamlNode& root, const YamlNode& site, std::vector<Problem>& problems) {
  if (is_other_version(site, "grouser_site", problems)) return;
  std::int64_t version = kVersion;
  read_fields(
      site,
      [&](FieldVisitor& v) {
        v.integer({"grouser_site", "version of the format"}, version, kVersion, kVersion);
        YamlNode kept;
        v.raw({"scheduler", "", kOptional}, kept);
        v.raw({"resources", "", kOptional}, kept);
      },
      problems);
  if (const YamlNode* scheduler = site.find("scheduler")) root.overlay("scheduler", *scheduler);
  const YamlNode* resources = site.find("resources");
  if (resources == nullptr) return;
  for (const auto& [key, value] : resources->entries) {
    YamlNode* own = root.find("resources");
    if (own != nullptr && own->kind != YamlNode::Kind::kMap && own->kind != YamlNode::Kind::kNull)
      return;  // reported when the campaign is read
    root.overlay("resources." + key, value);
  }
}

// Replaces its {name}s and makes it absolute, counted from the directory of the file it stands in.
void resolve_setup_file(CampaignFile& file, std::vector<Problem>& problems) {
  std::string& path = file.settings.resources.setup_file;
  if (path.empty()) return;
  const YamlNode* resources = file.root.find("resources");
  const YamlNode* at = resources == nullptr ? nullptr : resources->find("setup_file");
  if (at == nullptr) return;
  // Here and not with the other keys: the database keeps the path with its {name}s replaced.
  const BraceCheck check = look_at_braces(path, kSetupNames);
  if (!check.is_good) {
    problems.push_back(
        {at->file, at->line, at->column, "resources.setup_file", check.problem, check.hint});
    return;
  }
  path = substitute(path, {{"campaign", file.name}, {"home", home_directory()}});
  const auto full = std::filesystem::absolute(std::filesystem::path(at->file).parent_path() / path);
  path = full.lexically_normal().string();
  if (!std::filesystem::is_regular_file(full))
    problems.push_back({at->file, at->line, at->column, "resources.setup_file",
                        "'" + path + "' is not a file", "paths count from the YAML file"});
}

}  // namespace

void describe(FieldVisitor& v, CampaignFile& f) {
  v.integer({"grouser", "version of the format"}, f.version, kVersion, kVersion);
  v.word({"campaign", "name of the campaign"}, f.name, {});
  v.check("campaign", is_campaign_name(f.name), "'" + f.name + "' cannot be a name of a campaign",
          "1 to 64 letters, digits, _ and -");
  v.word({"title", "one line for the report's head; takes {campaign}", kOptional}, f.title, {});
  check_braces(v, "title", f.title, kTitleNames);
  describe_settings(v, f.settings);
  v.group({"chunks", "how a run is cut into jobs", kOptional},
          [&](FieldVisitor& inner) { describe_chunks(inner, f.chunks); });
  v.raw({"case", "the input of every run, before the sweep's values are set"}, f.case_node);
  v.check("case",
          f.case_node.kind == YamlNode::Kind::kMap || f.case_node.kind == YamlNode::Kind::kNull,
          "must be a map", "see the keys of a case");
  v.list(
      {"sweep", "axes; the runs are all combinations of their points", kOptional}, f.sweep.size(),
      [&](std::size_t count) { f.sweep.resize(count); },
      [&](FieldVisitor& inner, std::size_t i) { describe_axis(inner, f.sweep[i]); });
  v.raw({"report", "what the report shows and compares with; keys below", kOptional}, f.report);
  v.check("report", f.report.kind == YamlNode::Kind::kMap || f.report.kind == YamlNode::Kind::kNull,
          "must be a map", "");
}

CampaignFile read_campaign(const std::filesystem::path& path, const std::filesystem::path& site,
                           std::vector<Problem>& problems) {
  CampaignFile file;
  file.root = load_yaml(path);
  if (is_other_version(file.root, "grouser", problems)) return file;
  if (!site.empty() && file.root.kind == YamlNode::Kind::kMap)
    apply_site(file.root, load_yaml(site), problems);
  read_fields(
      file.root, [&](FieldVisitor& visitor) { describe(visitor, file); }, problems);
  file.title = substitute(file.title, {{"campaign", file.name}});
  resolve_setup_file(file, problems);
  return file;
}

std::string home_directory() {
  const char* const variable = std::getenv("HOME");
  if (variable != nullptr && *variable != '\0') return variable;
  const passwd* const entry = ::getpwuid(::getuid());
  return entry == nullptr || entry->pw_dir == nullptr ? "/" : entry->pw_dir;
}

std::string write_settings(const Settings& settings) {
  Settings copy = settings;
  return emit_yaml(write_fields([&](FieldVisitor& v) { describe_settings(v, copy); }));
}

Settings read_settings(const std::string& text) {
  Settings settings;
  std::vector<Problem> problems;
  read_fields(
      parse_yaml(text, "settings in the database"),
      [&](FieldVisitor& v) { describe_settings(v, settings); }, problems);
  if (!problems.empty()) throw ConfigError(problems);
  return settings;
}

std::string campaign_reference() {
  CampaignFile file;
  Case input;
  return "## Campaign\n\n| key | unit | range | default | meaning |\n|---|---|---|---|---|\n" +
         reference_of([&](FieldVisitor& v) { describe(v, file); }) +
         "\n## Case\n\n| key | unit | range | default | meaning |\n|---|---|---|---|---|\n" +
         reference_of([&](FieldVisitor& v) { describe(v, input); });
}

}  // namespace grouser
