// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/table.hpp"

#include <array>
#include <stdexcept>

#include "schedulers/local.hpp"
#include "schedulers/pbs.hpp"
#include "schedulers/slurm.hpp"

namespace grouser {
namespace {

std::unique_ptr<Scheduler> make_local(const std::filesystem::path& root) {
  return std::make_unique<LocalScheduler>(root / ".local");
}
std::unique_ptr<Scheduler> make_slurm(const std::filesystem::path&) {
  return std::make_unique<SlurmScheduler>();
}
std::unique_ptr<Scheduler> make_pbs(const std::filesystem::path&) {
  return std::make_unique<PbsScheduler>();
}

constexpr std::array kKinds{
    SchedulerKind{"local", make_local_script, nullptr, make_local, false, 0.0, 10.0},
    SchedulerKind{"slurm", make_slurm_script, make_slurm_array_script, make_slurm, true, 30.0,
                  90.0},
    SchedulerKind{"pbs", make_pbs_script, nullptr, make_pbs, true, 30.0, 90.0},
};

}  // namespace

const SchedulerKind& scheduler_kind(const std::string& name) {
  for (const SchedulerKind& kind : kKinds)
    if (name == kind.name) return kind;
  throw std::invalid_argument("no scheduler is called '" + name + "'");
}

std::vector<std::string> scheduler_names() {
  std::vector<std::string> names;
  for (const SchedulerKind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

}  // namespace grouser
