// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/schema.hpp"

namespace grouser {

/// What one attempt of a run asks of the machine.
struct Resources {
  std::int64_t ranks = 1;
  std::int64_t threads = 1;  ///< of each rank
  std::int64_t nodes = 0;    ///< 0 = the scheduler decides
  double walltime = 0.0;     ///< of one job [s]; 0 = no limit, for `local` only
  std::string memory;        ///< per node, as the scheduler spells it: "64G"
  std::string partition;     ///< Slurm's partition, PBS's queue
  std::string account;
  std::string qos;
  std::string launcher;         ///< starts the ranks, for example "srun --mpi=pmix"
  std::string setup_file;       ///< shell file read before the engine starts: modules, paths
  std::int64_t concurrent = 0;  ///< jobs at once; 0 = as cores allow for `local`, else no limit
  bool array = false;           ///< jobs that may start together are submitted as one (slurm)
};

/// How the simulated time of a run is cut into jobs; walltime adds cuts by itself.
struct ChunkRule {
  std::int64_t count = 0;       ///< equal parts of a wheel run; 0 = not given
  double simulated_time = 0.0;  ///< length of each part [s]; 0 = not given
};

struct RetryRule {
  std::int64_t infrastructure = 3;  ///< attempts in a row that may fail without progress
  double delay = 60.0;              ///< before the first retry, then doubled; not for `local` [s]
};

/// What is left to the planner (planner.hpp) once something is measured.
struct PlannerRule {
  bool checkpoints = false;  ///< wall time between checkpoints, in place of the case's interval
  bool walltime = false;     ///< of each job, up to resources.walltime
};

/// Where a campaign stops by itself rather than burn hours; 0 = no limit.
struct Limits {
  std::int64_t max_chunks = 0;  ///< jobs of one run
  double node_hours = 0.0;      ///< of the whole campaign
  double hang = 1800.0;         ///< a running job that does not advance for so long is killed [s]
};

/// Scheduler, resources, retries and limits: what may change during a campaign without new runs.
struct Settings {
  std::string scheduler = "local";
  Resources resources;
  RetryRule retries;
  Limits limits;
  PlannerRule planner;
  std::string chain = "manager";  ///< who goes on when a job ends: see docs/reference/chains.md
};

/// One point of an axis: a label and the values it sets, as dotted paths into the case.
struct AxisPoint {
  std::string label;
  YamlNode set;
};

struct Axis {
  std::string axis;
  std::vector<AxisPoint> points;
};

/// A campaign as written by a person.
struct CampaignFile {
  std::int64_t version = 0;
  std::string name;
  std::string title;
  Settings settings;
  ChunkRule chunks;
  YamlNode case_node;  ///< of the base case; each run overlays it
  std::vector<Axis> sweep;
  YamlNode report;  ///< for the report alone; null-kind when absent
  YamlNode root;    ///< the whole document, for positions
};

/// The one description of the file; see FieldVisitor.
void describe(FieldVisitor& visitor, CampaignFile& file);

/// Reads the YAML of a campaign; with `site` not empty, the values of that site file replace
/// `scheduler` and entries of `resources`. Every problem found is appended; the cases are not read
/// here (see make_plan). @throws ConfigError when a file is no YAML at all. Local.
CampaignFile read_campaign(const std::filesystem::path& file, const std::filesystem::path& site,
                           std::vector<Problem>& problems);

/// Home directory of the user this process belongs to: HOME, else what the system has. Local.
std::string home_directory();

/// The settings as YAML text and back; what the database keeps. @throws ConfigError. Local.
std::string write_settings(const Settings& settings);
Settings read_settings(const std::string& text);

/// The reference page's tables of all keys of a campaign and of its case, in Markdown. Local.
std::string campaign_reference();

}  // namespace grouser
