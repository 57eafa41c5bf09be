// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/flow.hpp"

#include <algorithm>

#include "base/errors.hpp"
#include "engine/lbm/flow_of.hpp"

namespace grouser {
namespace {

template <class Set>
std::unique_ptr<Flow> make(const Communicator& ranks, const FlowSettings& settings) {
  if (settings.precision == Precision::kSingle)
    return std::make_unique<FlowOf<Set, float>>(ranks, settings);
  return std::make_unique<FlowOf<Set, double>>(ranks, settings);
}

struct Maker {
  const char* lattice;
  std::unique_ptr<Flow> (*make)(const Communicator&, const FlowSettings&);
};
constexpr std::array<Maker, 4> kMakers = {{{D2Q9::kName, make<D2Q9>},
                                           {D3Q15::kName, make<D3Q15>},
                                           {D3Q19::kName, make<D3Q19>},
                                           {D3Q27::kName, make<D3Q27>}}};

template <class List>
std::vector<std::string> names_of(const List& list) {
  return {list.begin(), list.end()};
}

Problem problem(std::string key, std::string what, std::string hint) {
  Problem made;
  made.key = std::move(key);
  made.problem = std::move(what);
  made.hint = std::move(hint);
  return made;
}

template <class List>
void check_word(std::vector<Problem>& problems, const std::string& key, const std::string& word,
                const List& list) {
  if (std::find(list.begin(), list.end(), word) != list.end()) return;
  const std::string near = nearest(word, names_of(list));
  std::string all;
  for (const char* one : list) all += (all.empty() ? "" : ", ") + std::string(one);
  problems.push_back(problem(key, "'" + word + "' is not known",
                             near.empty() ? "one of " + all : "did you mean '" + near + "'?"));
}

}  // namespace

std::vector<Problem> problems_of(const FlowSettings& settings) {
  std::vector<Problem> problems;
  check_word(problems, "lattice", settings.lattice, kLattices);
  check_word(problems, "collision", settings.collision, kCollisions);
  const CollisionParameters& p = settings.parameters;
  if (!(p.viscosity_lu > 0.0))
    problems.push_back(problem("viscosity",
                               "the relaxation time is " +
                                   std::to_string(relaxation_time(p.viscosity_lu)) +
                                   ", which must be over 0.5",
                               "the viscosity must be positive"));
  if (!(p.magic > 0.0)) problems.push_back(problem("magic", "must be positive", "3/16 is usual"));
  for (const auto& [key, rate] :
       {std::pair{"bulk_rate", p.bulk_rate}, std::pair{"higher_rate", p.higher_rate}})
    if (!(rate > 0.0 && rate < 2.0))
      problems.push_back(problem(key, "must be between 0 and 2", "1 is usual"));
  if (settings.collision == "les" && !(p.smagorinsky >= 0.0))
    problems.push_back(problem("smagorinsky", "must not be negative", "0.1 to 0.2 is usual"));
  const char* axes[3] = {"x", "y", "z"};
  const bool flat = settings.lattice == "D2Q9";
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = axes[a];
    if (settings.cells[a] < 1)
      problems.push_back(problem("cells", "along " + axis + ": must be 1 or more", ""));
    const bool low = settings.faces[a][0].kind == FaceKind::kPeriodic;
    const bool high = settings.faces[a][1].kind == FaceKind::kPeriodic;
    if (low != high)
      problems.push_back(problem("faces", axis + " is periodic at one end only",
                                 "make both ends periodic or none"));
    for (const Face& face : settings.faces[a])
      if (face.kind == FaceKind::kPressure && !(face.density_lu > 0.0))
        problems.push_back(problem("faces", axis + ": density must be positive", ""));
  }
  if (flat && (settings.cells[2] != 1 || settings.faces[2][0].kind != FaceKind::kPeriodic))
    problems.push_back(problem("cells", "D2Q9 is flat: one cell along z, periodic", ""));
  return problems;
}

std::unique_ptr<Flow> make_flow(const Communicator& ranks, const FlowSettings& settings) {
  if (auto problems = problems_of(settings); !problems.empty())
    throw ConfigError(std::move(problems));
  for (const Maker& maker : kMakers)
    if (settings.lattice == maker.lattice) return maker.make(ranks, settings);
  return nullptr;
}

}  // namespace grouser
