// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/plan/expand.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

#include "base/atomic_file.hpp"
#include "base/hash.hpp"
#include "base/list_reach.hpp"
#include "base/mesh.hpp"
#include "base/units.hpp"

namespace grouser {
namespace {

constexpr std::size_t kMaxRuns = 100000;
constexpr double kMaxChunks = 10000.0;

// Problems in the order they were found, each once.
class ProblemSet {
 public:
  explicit ProblemSet(std::vector<Problem>& problems) : problems_(problems) {
    for (const Problem& one : problems_) seen_.insert(one.text());
  }
  void add(const Problem& problem) {
    if (seen_.insert(problem.text()).second) problems_.push_back(problem);
  }
  void add(const YamlNode& at, const std::string& key, const std::string& problem,
           const std::string& hint) {
    add(Problem{at.file, at.line, at.column, key, problem, hint});
  }

 private:
  std::vector<Problem>& problems_;
  std::set<std::string> seen_;
};

const YamlNode& node_or(const YamlNode& node, const char* key) {
  const YamlNode* found = node.find(key);
  return found == nullptr ? node : *found;
}

const YamlNode& sweep_node(const CampaignFile& file, std::size_t axis) {
  const YamlNode& sweep = node_or(file.root, "sweep");
  return axis < sweep.items.size() ? sweep.items[axis] : sweep;
}

const YamlNode& point_node(const CampaignFile& file, std::size_t axis, std::size_t point) {
  const YamlNode& points = node_or(sweep_node(file, axis), "points");
  return point < points.items.size() ? points.items[point] : points;
}

void check_names(const CampaignFile& file, ProblemSet& problems) {
  std::set<std::string> axes;
  for (std::size_t i = 0; i < file.sweep.size(); ++i) {
    const Axis& axis = file.sweep[i];
    if (!axes.insert(axis.axis).second)
      problems.add(sweep_node(file, i), "sweep.axis", "'" + axis.axis + "' is given twice",
                   "give every axis its own name");
    std::set<std::string> labels;
    for (std::size_t k = 0; k < axis.points.size(); ++k)
      if (!labels.insert(axis.points[k].label).second)
        problems.add(point_node(file, i, k), "sweep.points.label",
                     "'" + axis.points[k].label + "' is given twice on axis " + axis.axis,
                     "give every point its own label");
  }
}

// The number of combinations, or nothing when there are too many.
std::optional<std::size_t> combinations(const CampaignFile& file) {
  std::size_t count = 1;
  for (const Axis& axis : file.sweep) {
    count *= axis.points.size();
    if (count > kMaxRuns) return std::nullopt;
  }
  return count;
}

// Which point of each axis the n-th run takes; the last axis turns fastest.
std::vector<std::size_t> choice_of(const CampaignFile& file, std::size_t n) {
  std::vector<std::size_t> choice(file.sweep.size());
  for (std::size_t i = file.sweep.size(); i-- > 0;) {
    choice[i] = n % file.sweep[i].points.size();
    n /= file.sweep[i].points.size();
  }
  return choice;
}

YamlNode overlaid_case(const CampaignFile& file, const std::vector<std::size_t>& choice,
                       ProblemSet& problems) {
  YamlNode node = file.case_node;
  for (std::size_t i = 0; i < choice.size(); ++i) {
    for (const auto& [path, value] : file.sweep[i].points[choice[i]].set.entries) {
      try {
        node.overlay(path, value);
      } catch (const std::invalid_argument& error) {
        problems.add(value, "set", error.what(), "write dotted paths into the case");
      }
    }
  }
  return node;
}

// Hash of a surface file's content, or what is wrong with it.
struct SurfaceFile {
  std::string hash;
  std::string problem;
  std::string hint;
  double rim = 0.0;  // largest distance from the axle, in units of the file
};

SurfaceFile refused(const ConfigError& error) {
  const Problem& first = error.problems().front();
  const std::size_t more = error.problems().size() - 1;
  return {"",
          (first.key.empty() ? "" : first.key + " ") + first.problem +
              (more > 0 ? ", and " + std::to_string(more) + " more" : ""),
          first.hint};
}

SurfaceFile read_surface(const std::filesystem::path& file) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable))
    return {"", "is not a file", "paths count from the YAML file"};
  try {
    const auto text = read_file(file);
    if (!text || text->empty()) return {"", "is empty", "export the surface again"};
    const Mesh mesh = read_stl(file, 1.0);
    mesh.check_closed("");
    SurfaceFile surface{hash_text(*text), "", ""};
    for (const Vec3& v : mesh.vertices) surface.rim = std::max(surface.rim, std::hypot(v.x, v.z));
    return surface;
  } catch (const ConfigError& error) {
    return refused(error);
  } catch (const StorageError&) {
    return {"", "cannot be read", "check its permissions"};
  }
}

// What the surface says about the wheel's size must be what the case says: slip and sinkage count
// from wheel.diameter. Facets may cut a circle's corners a little.
bool fits(const SurfaceFile& surface, const WheelCase& wheel) {
  constexpr double kTolerance = 0.01;
  const double diameter = 2.0 * surface.rim * wheel.stl_scale;
  return std::abs(diameter - wheel.diameter) <= kTolerance * wheel.diameter;
}

std::string directory_name(const std::string& label, const std::string& key) {
  return label + "-" + key.substr(0, 8);
}

class Planner {
 public:
  Planner(const CampaignFile& file, std::vector<Problem>& problems)
      : file_(file), problems_(problems) {}

  Plan make() {
    check_names(file_, problems_);
    const auto count = combinations(file_);
    if (!count) {
      problems_.add(node_or(file_.root, "sweep"), "sweep",
                    "has more than " + std::to_string(kMaxRuns) + " combinations",
                    "split the campaign");
    } else {
      for (std::size_t n = 0; n < *count; ++n) add_run(choice_of(file_, n));
    }
    Plan plan{file_.name, file_.title, file_.settings, std::move(beds_), std::move(warnings_)};
    plan.runs.insert(plan.runs.end(), runs_.begin(), runs_.end());
    return plan;
  }

 private:
  void add_run(const std::vector<std::size_t>& choice) {
    PlannedRun run;
    for (std::size_t i = 0; i < choice.size(); ++i) {
      const Axis& axis = file_.sweep[i];
      run.label += (i == 0 ? "" : "-") + axis.points[choice[i]].label;
      run.axes.emplace_back(axis.axis, axis.points[choice[i]].label);
    }
    if (run.label.empty()) run.label = "single";
    const YamlNode node = overlaid_case(file_, choice, problems_);
    std::vector<Problem> found;
    run.input = read_case(node, found);
    for (const Problem& one : found) problems_.add(prefixed(one));
    if (!found.empty()) return;
    for (const Problem& one : case_warnings(node, run.input)) warning_set_.add(prefixed(one));
    if (resolve_stl(node, run)) finish(run, choice);
  }

  // Keys of a case are named from the document's root.
  static Problem prefixed(Problem problem) {
    problem.key = problem.key.empty() ? "case" : "case." + problem.key;
    return problem;
  }

  // The file's path counts from the YAML file it is written in. The case gets the copy's name,
  // which is the hash of the content: what is computed follows the content and not the path.
  // @return whether there is nothing wrong with it
  bool resolve_stl(const YamlNode& node, PlannedRun& run) {
    std::string& named = run.input.wheel.stl_file;
    if (!run.input.has_wheel || named.empty()) return true;
    const YamlNode& at = node_or(node_or(node, "wheel"), "stl_file");
    run.surface = std::filesystem::absolute(std::filesystem::path(at.file).parent_path() / named)
                      .lexically_normal();
    auto [known, is_new] = surfaces_.try_emplace(run.surface);
    if (is_new) known->second = read_surface(run.surface);
    const SurfaceFile& surface = known->second;
    if (!surface.problem.empty()) {
      problems_.add(at, "case.wheel.stl_file", "'" + run.surface.string() + "' " + surface.problem,
                    surface.hint);
      return false;
    }
    const WheelCase& wheel = run.input.wheel;
    if (wheel.profile == "stl" && !fits(surface, wheel)) {
      problems_.add(at, "case.wheel.stl_file",
                    "'" + run.surface.string() + "' is " +
                        rounded(2.0 * surface.rim * wheel.stl_scale) +
                        " m across its axle, wheel.diameter is " + rounded(wheel.diameter) + " m",
                    "look at stl_scale, the length of one unit of the file, and at the diameter; "
                    "the axle is the file's y axis through the origin");
      return false;
    }
    named = "../../surfaces/" + surface.hash + ".stl";
    return true;
  }

  // The engine would refuse them only when the job has waited and begun.
  void check_ranks(const Case& input) {
    const std::int64_t ranks = file_.settings.resources.ranks;
    const double reach = list_reach(input.grains);
    const BoxCase& box = input.box;
    const std::int64_t most = most_ranks(box.length, box.width, input.bed.depth, reach);
    if (ranks <= most) return;
    problems_.add(node_or(node_or(file_.root, "resources"), "ranks"), "resources.ranks",
                  std::to_string(ranks) +
                      " ranks leave a rank less of the bed than a cube of the " +
                      rounded(1e3 * reach) + " mm that a contact reaches",
                  "use at most " + std::to_string(most));
  }

  void finish(PlannedRun& run, const std::vector<std::size_t>& choice) {
    check_ranks(run.input);
    run.key = content_key(run.input);
    const YamlNode& at = choice.empty() ? node_or(file_.root, "case")
                                        : point_node(file_, choice.size() - 1, choice.back());
    const auto [same, is_new] = labels_by_key_.emplace(run.key, run.label);
    if (!is_new)
      problems_.add(at, "sweep", "run " + run.label + " is the same case as run " + same->second,
                    "points must differ in what is computed");
    if (!labels_.insert(run.label).second)
      problems_.add(at, "sweep", "two runs are labelled " + run.label,
                    "labels joined by '-' must differ");
    run.directory = std::filesystem::path("runs") / directory_name(run.label, run.key);
    run.is_bed = !run.input.has_wheel;
    run.chunk_ends = ends_of(run.input);
    if (run.input.has_wheel) run.bed_key = add_bed(run.input);
    runs_.push_back(run);
  }

  std::string add_bed(const Case& input) {
    PlannedRun bed;
    bed.input = bed_case(input);
    bed.key = content_key(bed.input);
    if (!bed_keys_.insert(bed.key).second) return bed.key;
    bed.is_bed = true;
    bed.label = directory_name("bed", bed.key);
    bed.directory = std::filesystem::path("beds") / bed.label;
    bed.chunk_ends = ends_of(bed.input);
    labels_.insert(bed.label);
    beds_.push_back(bed);
    return bed.key;
  }

  std::vector<std::optional<double>> ends_of(const Case& input) {
    const double duration = run_duration(input);
    const double length = file_.chunks.simulated_time;
    const double longest = duration > 0.0 ? duration : input.bed.settle_limit;
    if (length > 0.0 && longest / length > kMaxChunks) {
      problems_.add(node_or(node_or(file_.root, "chunks"), "simulated_time"),
                    "chunks.simulated_time", "cuts a run into more than 10000 chunks",
                    "the longest run takes " + std::to_string(longest) + " s");
      return {};
    }
    return chunk_ends(file_.chunks, duration, input.bed.settle_limit);
  }

  const CampaignFile& file_;
  ProblemSet problems_;
  std::vector<Problem> warnings_;
  ProblemSet warning_set_{warnings_};
  std::map<std::string, std::string> labels_by_key_;
  std::set<std::string> labels_;
  std::set<std::string> bed_keys_;
  std::map<std::filesystem::path, SurfaceFile> surfaces_;
  std::vector<PlannedRun> beds_;
  std::vector<PlannedRun> runs_;
};

}  // namespace

std::vector<std::optional<double>> chunk_ends(const ChunkRule& rule, double duration,
                                              double limit) {
  std::vector<std::optional<double>> ends;
  if (duration > 0.0 && rule.count > 0) {
    for (std::int64_t i = 1; i < rule.count; ++i)
      ends.emplace_back(duration * static_cast<double>(i) / static_cast<double>(rule.count));
  } else if (rule.simulated_time > 0.0) {
    const double end = duration > 0.0 ? duration : limit;
    for (std::int64_t i = 1;; ++i) {
      const double until = static_cast<double>(i) * rule.simulated_time;
      if (until >= end) break;
      ends.emplace_back(until);
    }
  }
  // The last has no end of its own: rounding must not leave a sliver of the run undone.
  ends.emplace_back(std::nullopt);
  return ends;
}

Plan make_plan(const CampaignFile& file, std::vector<Problem>& problems) {
  return Planner(file, problems).make();
}

Plan plan_campaign(const std::filesystem::path& path, const std::filesystem::path& site,
                   const FileCheck& check) {
  std::vector<Problem> problems;
  const CampaignFile file = read_campaign(path, site, problems);
  Plan plan;
  // A broken frame still has a case worth checking, as long as it can be put together.
  const bool has_sweep = std::all_of(file.sweep.begin(), file.sweep.end(),
                                     [](const Axis& axis) { return !axis.points.empty(); });
  if (file.case_node.kind == YamlNode::Kind::kMap && has_sweep) plan = make_plan(file, problems);
  if (check) check(file, problems);
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.file, a.line, a.column) < std::tie(b.file, b.line, b.column);
  });
  if (!problems.empty()) throw ConfigError(problems);
  return plan;
}

}  // namespace grouser
