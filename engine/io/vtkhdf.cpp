// SPDX-License-Identifier: BSD-3-Clause
#include "engine/io/vtkhdf.hpp"

#include <numeric>

#include "base/atomic_file.hpp"
#include "engine/core/agree.hpp"
#include "engine/io/h5_rows.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

// VTK's numbers of cell types.
constexpr std::uint8_t kVertex = 1;
constexpr std::uint8_t kTriangle = 5;

// Headers and attributes, beside the data.
constexpr std::uintmax_t kFileOverhead = 64 << 10;

struct Cells {
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> offsets;  // end of each cell; the first rank also has the leading 0
  std::vector<std::uint8_t> types;
};

// The parts of all ranks one after another are the cells of the whole grid.
Cells cells_of(const Communicator& ranks, const VtkGrid& grid) {
  const auto points = static_cast<std::int64_t>(grid.points.size() / 3);
  Cells cells;
  cells.connectivity = grid.triangles;
  if (!grid.has_triangles) {
    cells.connectivity.resize(static_cast<std::size_t>(points));
    std::iota(cells.connectivity.begin(), cells.connectivity.end(), ranks.sum_before(points));
  }
  const std::int64_t corners = grid.has_triangles ? 3 : 1;
  const std::int64_t count = static_cast<std::int64_t>(cells.connectivity.size()) / corners;
  cells.types.assign(static_cast<std::size_t>(count), grid.has_triangles ? kTriangle : kVertex);
  const std::int64_t before = ranks.sum_before(count);
  if (ranks.rank() == 0) cells.offsets.push_back(0);
  for (std::int64_t cell = 1; cell <= count; ++cell)
    cells.offsets.push_back((before + cell) * corners);
  return cells;
}

// A dataset with one number, as the format wants it for each piece of a grid.
void write_single(const Communicator& ranks, hid_t group, const char* name, std::int64_t value) {
  write_rows(ranks, group, name,
             ranks.rank() == 0 ? std::vector<std::int64_t>{value} : std::vector<std::int64_t>{}, 0);
}

void write_time(const Communicator& ranks, hid_t root, double time) {
  H5Handle whole(H5Gcreate2(root, "FieldData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                 "make group FieldData");
  write_rows(ranks, whole, "time [s]",
             ranks.rank() == 0 ? std::vector<double>{time} : std::vector<double>{}, 0);
}

void write_datasets(const Communicator& ranks, hid_t h5, const VtkGrid& grid) {
  const Cells cells = cells_of(ranks, grid);
  H5Handle root(H5Gcreate2(h5, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                "make group VTKHDF");
  write_numbers(root, "Version", {1, 0});
  write_text(root, "Type", "UnstructuredGrid");
  const auto total = [&](std::size_t count) { return ranks.sum(static_cast<std::int64_t>(count)); };
  write_single(ranks, root, "NumberOfPoints", total(grid.points.size() / 3));
  write_single(ranks, root, "NumberOfCells", total(cells.types.size()));
  write_single(ranks, root, "NumberOfConnectivityIds", total(cells.connectivity.size()));
  write_rows(ranks, root, "Points", grid.points, 3);
  write_rows(ranks, root, "Connectivity", cells.connectivity, 0);
  write_rows(ranks, root, "Offsets", cells.offsets, 0);
  write_rows(ranks, root, "Types", cells.types, 0);
  H5Handle values(H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                  "make group PointData");
  if (total(grid.ids.size()) > 0) write_rows(ranks, values, "id", grid.ids, 0);
  for (const VtkField& field : grid.fields)
    write_rows(ranks, values, field.name, field.values, field.width);
  write_time(ranks, root, grid.time);
}

void write_datasets(const Communicator& ranks, hid_t h5, const VtkImage& image) {
  H5Handle root(H5Gcreate2(h5, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                "make group VTKHDF");
  write_numbers(root, "Version", {1, 0});
  write_text(root, "Type", "ImageData");
  write_numbers(root, "WholeExtent",
                {0, image.cells[0] - 1, 0, image.cells[1] - 1, 0, image.cells[2] - 1});
  // Points, because VTK 9.1 reads cell data of images as if they were.
  const double centre = 0.5 * image.spacing;
  write_reals(root, "Origin", {centre, centre, centre});
  write_reals(root, "Spacing", {image.spacing, image.spacing, image.spacing});
  write_reals(root, "Direction", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  H5Handle values(H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                  "make group PointData");
  for (const VtkField& field : image.fields)
    write_layers(ranks, values, field.name, field.values, image.cells, field.width);
  write_time(ranks, root, image.time);
}

template <class Grid>
void write_grid(const Communicator& ranks, const fs::path& file, const Grid& grid) {
  H5Handle h5 = create_file(ranks, file, true);
  write_datasets(ranks, h5, grid);
  h5.close("finish " + file.string());
}

std::uintmax_t bytes_of(const VtkGrid& grid) {
  std::size_t floats = grid.points.size();
  for (const VtkField& field : grid.fields) floats += field.values.size();
  const std::size_t cells = grid.has_triangles ? grid.triangles.size() / 3 : grid.points.size() / 3;
  return floats * sizeof(float) +
         (grid.ids.size() + cells * (grid.has_triangles ? 4 : 2)) * sizeof(std::int64_t) + cells;
}

std::uintmax_t bytes_of(const VtkImage& image) {
  std::size_t floats = 0;
  for (const VtkField& field : image.fields) floats += field.values.size();
  return floats * sizeof(float);
}

template <class Grid>
void write_file(const Communicator& ranks, const fs::path& file, const Grid& grid) {
  const auto bytes =
      static_cast<std::uintmax_t>(ranks.sum(static_cast<std::int64_t>(bytes_of(grid))));
  fs::path part = file;
  part += ".part";
  // Asking first keeps a full disk away from the file library, which does not survive one.
  on_first_rank(ranks, [&] {
    fs::create_directories(file.parent_path());
    check_room(file.parent_path(), bytes + kFileOverhead);
  });
  const std::string failure = agreed_failure(ranks, [&] { write_grid(ranks, part, grid); });
  on_first_rank(ranks, [&] {
    if (failure.empty()) {
      fs::rename(part, file);
      return;
    }
    std::error_code ignored;
    fs::remove(part, ignored);
    throw StorageError("snapshot " + file.string() + " could not be written: " + failure);
  });
}

}  // namespace

void write_vtkhdf(const Communicator& ranks, const fs::path& file, const VtkGrid& grid) {
  write_file(ranks, file, grid);
}

void write_vtkhdf(const Communicator& ranks, const fs::path& file, const VtkImage& image) {
  write_file(ranks, file, image);
}

}  // namespace grouser
