// SPDX-License-Identifier: BSD-3-Clause
#include "engine/app/snapshot.hpp"

#include "base/run_contract.hpp"
#include "engine/io/vtkhdf.hpp"

namespace grouser {
namespace {

std::filesystem::path file_of(const std::filesystem::path& directory, const std::string& name,
                              std::int64_t step) {
  return directory / (name + "_" + run_files::step_digits(step) + ".vtkhdf");
}

void push(std::vector<double>& to, const Vec3& v) { to.insert(to.end(), {v.x, v.y, v.z}); }

StateTable sorted_grains(const World& world) {
  StateTable table;
  table.name = "grains";
  table.key_count = world.particle_count();
  table.real_fields = {{"position", "m", 3},
                       {"radius", "m", 1},
                       {"velocity", "m s-1", 3},
                       {"spin", "rad s-1", 3},
                       {"displacement", "m", 3}};
  for (std::size_t i = 0; i < world.owned(); ++i) {
    const Particle& p = world.particles()[i];
    table.integers.insert(table.integers.end(), {p.id, 0});
    push(table.reals, p.position);
    table.reals.push_back(p.radius);
    push(table.reals, p.velocity);
    push(table.reals, p.spin);
    push(table.reals, p.position - world.origins()[i]);
  }
  sort_rows(world.ranks(), table);
  return table;
}

// One field of the rows in single precision.
std::vector<float> column_of(const StateTable& table, std::size_t from, std::size_t width) {
  std::vector<float> values;
  values.reserve(table.rows() * width);
  for (std::size_t row = 0; row < table.rows(); ++row)
    for (std::size_t k = 0; k < width; ++k)
      values.push_back(static_cast<float>(table.reals[row * table.real_width() + from + k]));
  return values;
}

VtkGrid grid_of_grains(const World& world) {
  const StateTable table = sorted_grains(world);
  VtkGrid grid;
  for (std::size_t row = 0; row < table.rows(); ++row)
    grid.ids.push_back(table.integers[row * table.integer_width()]);
  std::size_t from = 0;
  for (const StateField& field : table.real_fields) {
    const auto width = static_cast<std::size_t>(field.width);
    if (field.name == "position")
      grid.points = column_of(table, from, width);
    else
      grid.fields.push_back({field.name + " [" + field.unit + "]", width == 1 ? 0 : width,
                             column_of(table, from, width)});
    from += width;
  }
  return grid;
}

VtkGrid grid_of_body(const Body& body, bool is_mine) {
  VtkGrid grid;
  grid.has_triangles = true;
  if (!is_mine) return grid;
  const BodyFrame frame(body.motion);
  for (const Vec3& vertex : body.search->mesh().vertices) {
    const Vec3 at = frame.to_world(vertex);
    for (const double x : {at.x, at.y, at.z}) grid.points.push_back(static_cast<float>(x));
  }
  for (const auto& facet : body.search->mesh().facets)
    grid.triangles.insert(grid.triangles.end(), facet.begin(), facet.end());
  return grid;
}

}  // namespace

void write_fluid_snapshot(const Communicator& ranks, const ResolvedFlow& fluid,
                          const std::filesystem::path& directory, std::int64_t step, double time) {
  const CellBlocks& blocks = fluid.flow().blocks();
  const LatticeUnits& units = fluid.scale().units;
  // Sorted by layers, so that each rank comes to hold whole ones.
  StateTable table;
  table.name = "fluid";
  table.key_count = blocks.cells()[2];
  table.real_fields = {{"velocity", "m s-1", 3}, {"pressure", "Pa", 1}};
  for (std::int64_t z = blocks.low(2); z < blocks.high(2); ++z)
    for (std::int64_t y = blocks.low(1); y < blocks.high(1); ++y)
      for (std::int64_t x = blocks.low(0); x < blocks.high(0); ++x) {
        const FlowNode node = fluid.flow().node(x, y, z);
        table.integers.insert(table.integers.end(), {z, y * blocks.cells()[0] + x});
        push(table.reals, units.velocity(1.0) * node.velocity_lu);
        table.reals.push_back(units.pressure(node.density_lu));
      }
  sort_rows(ranks, table);
  VtkImage image;
  image.cells = blocks.cells();
  image.spacing = units.cell;
  image.time = time;
  image.fields = {{"velocity [m s-1]", 3, column_of(table, 0, 3)},
                  {"pressure [Pa]", 0, column_of(table, 3, 1)}};
  write_vtkhdf(ranks, file_of(directory, "fluid", step), image);
}

void write_snapshot(const World& world, const std::filesystem::path& directory, std::int64_t step,
                    double time) {
  VtkGrid grains = grid_of_grains(world);
  grains.time = time;
  write_vtkhdf(world.ranks(), file_of(directory, "grains", step), grains);
  for (std::size_t b = 0; b < world.bodies(); ++b) {
    const Body& body = world.body(b);
    if (!body.turns) continue;
    VtkGrid surface = grid_of_body(body, world.ranks().rank() == 0);
    surface.time = time;
    write_vtkhdf(world.ranks(), file_of(directory, body.name, step), surface);
  }
}

}  // namespace grouser
