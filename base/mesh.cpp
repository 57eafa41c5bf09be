// SPDX-License-Identifier: BSD-3-Clause
#include "base/mesh.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "base/errors.hpp"
#include "base/units.hpp"

namespace grouser {

void Mesh::check(const std::string& name) const {
  std::vector<Problem> problems;
  if (facets.empty()) problems.push_back({name, 0, 0, "", "has no facets", "give a surface"});
  for (std::size_t f = 0; f < facets.size() && problems.size() < 10; ++f) {
    bool known = true;
    for (const int v : facets[f])
      known = known && v >= 0 && static_cast<std::size_t>(v) < vertices.size();
    const auto corner = [&](std::size_t k) {
      return vertices[static_cast<std::size_t>(facets[f][k])];
    };
    const std::string which = "facet " + std::to_string(f);
    if (!known) {
      problems.push_back({name, 0, 0, which, "names a vertex that is not there", ""});
      continue;
    }
    const Vec3 u = corner(1) - corner(0);
    const Vec3 v = corner(2) - corner(0);
    const double longest = std::max({norm(u), norm(v), norm(u - v)});
    // A height under 1e-9 of the longest side leaves no digits for its normal.
    if (!(norm(cross(u, v)) > 1e-9 * longest * longest))
      problems.push_back({name, 0, 0, which, "has no area", "remove or mend it"});
  }
  if (!problems.empty()) throw ConfigError(problems);
}

void Mesh::check_closed(const std::string& name) const {
  check(name);
  // Passes of each edge, from its lower to its higher vertex less those the other way.
  std::map<std::pair<int, int>, std::pair<int, int>> passes;
  for (const auto& facet : facets)
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = facet[k];
      const int to = facet[(k + 1) % 3];
      auto& [up, down] = passes[{std::min(from, to), std::max(from, to)}];
      ++(from < to ? up : down);
    }
  std::size_t open = 0;
  std::string first;
  for (const auto& [edge, count] : passes) {
    if (count.first == 1 && count.second == 1) continue;
    if (open++ > 0) continue;
    for (const int vertex : {edge.first, edge.second}) {
      const Vec3& v = vertices[static_cast<std::size_t>(vertex)];
      if (!first.empty()) first.append(" to");
      for (const double x : {v.x, v.y, v.z}) first.append(" ").append(format_number(x));
    }
  }
  if (open == 0) return;
  throw ConfigError({Problem{
      name, 0, 0, "", "is not closed at " + std::to_string(open) + " edges, the first from" + first,
      "every edge must belong to two facets turned alike; mend the surface "
      "in a mesh program (join vertices, fix normals)"}});
}

}  // namespace grouser
