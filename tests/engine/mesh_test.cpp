// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "base/errors.hpp"
#include "engine/dem/mesh.hpp"
#include "engine/terrain/shapes.hpp"

namespace grouser {
namespace {

// A square floor of side 1 in n x n squares of two facets each.
Mesh tiled_floor(int n) {
  Mesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      mesh.vertices.push_back({static_cast<double>(i) / n, static_cast<double>(j) / n, 0.0});
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j;
      mesh.facets.push_back({a, a + n + 1, a + n + 2});
      mesh.facets.push_back({a, a + n + 2, a + 1});
    }
  return mesh;
}

TEST(Mesh, NearestPointIsNoFartherThanAnyPointOfTheTriangle) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto point = [&] { return Vec3{unit(random), unit(random), unit(random)}; };
  for (int round = 0; round < 300; ++round) {
    const Vec3 a = point(), b = point(), c = point(), p = 2.0 * point();
    const NearestPoint found = nearest_on_triangle(p, {a, b, c});
    double sampled = 1e300;
    for (int i = 0; i <= 40; ++i)
      for (int j = 0; i + j <= 40; ++j) {
        const Vec3 q = a + (i / 40.0) * (b - a) + (j / 40.0) * (c - a);
        sampled = std::min(sampled, norm(p - q));
      }
    const double distance = norm(p - found.point);
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GE(distance, sampled - 0.1);  // samples are at most a tenth of a side apart
  }
}

TEST(Mesh, AFlatFloorIsTouchedOnceHoweverItIsTiled) {
  const double radius = 0.15;  // spans many tiles
  const MeshSearch search(tiled_floor(20), radius);
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0.2, 0.8);
  for (int round = 0; round < 2000; ++round) {
    Vec3 centre{unit(random), unit(random), 0.14};
    // A hair beside an edge, rounding alone decides which facet is nearer.
    if (round % 7 == 0) centre.x = std::round(centre.x * 20.0) / 20.0 + 1e-9 * (unit(random) - 0.5);
    // Every third sphere stands exactly over an edge, every fifth over a corner.
    if (round % 3 == 0) centre.x = std::round(centre.x * 20.0) / 20.0;
    if (round % 5 == 0) {
      centre.x = std::round(centre.x * 20.0) / 20.0;
      centre.y = std::round(centre.y * 20.0) / 20.0;
    }
    std::vector<MeshTouch> touches;
    search.touches_of(centre, radius, touches);
    ASSERT_EQ(touches.size(), 1u) << centre.x << " " << centre.y;
    EXPECT_NEAR(touches[0].distance, 0.14, 1e-14);
    EXPECT_NEAR(touches[0].point.x, centre.x, 2e-9 * radius);  // where touches are one
  }
}

TEST(Mesh, ABoxCornerIsTouchedOnEachOfItsWalls) {
  const MeshSearch search(box_mesh(1.0, 1.0, 1.0), 0.1);
  std::vector<MeshTouch> touches;
  search.touches_of({0.09, 0.09, 0.09}, 0.1, touches);
  EXPECT_EQ(touches.size(), 3u);
  touches.clear();
  search.touches_of({0.5, 0.09, 0.09}, 0.1, touches);
  EXPECT_EQ(touches.size(), 2u);
}

TEST(Mesh, ADrumIsTouchedOnceFromOutside) {
  WheelCase wheel;
  wheel.diameter = 0.7;
  wheel.width = 0.2;
  wheel.facets = 72;
  const MeshSearch search(wheel_mesh(wheel), 0.02);
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int round = 0; round < 2000; ++round) {
    const double angle = 2.0 * std::numbers::pi * unit(random);
    const double across = 0.24 * (unit(random) - 0.5);
    const double from_axle = 0.3505 + 0.02 * unit(random);
    const Vec3 centre{from_axle * std::sin(angle), across, from_axle * std::cos(angle)};
    std::vector<MeshTouch> touches;
    search.touches_of(centre, 0.02, touches);
    EXPECT_LE(touches.size(), 1u);
    if (from_axle < 0.365 && from_axle > 0.35 && std::abs(across) < 0.1) {
      EXPECT_EQ(touches.size(), 1u);
    }
  }
}

TEST(Mesh, ADrumsSurfaceIsClosed) {
  WheelCase wheel;
  wheel.diameter = 0.125;
  wheel.width = 0.06;
  for (const char* profile : {"drum", "grousers"}) {
    wheel.profile = profile;
    wheel.grousers = 24;
    wheel.grouser_height = 0.0045;
    wheel.grouser_width = 0.002;
    const Mesh mesh = wheel_mesh(wheel);
    mesh.check_closed(profile);
    // In a closed, consistently turned surface every edge is run through once in each direction.
    std::map<std::pair<int, int>, int> edges;
    for (const auto& f : mesh.facets)
      for (std::size_t k = 0; k < 3; ++k) ++edges[{f[k], f[(k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
    double farthest = 0.0;
    for (const Vec3& v : mesh.vertices) farthest = std::max(farthest, std::hypot(v.x, v.z));
    EXPECT_NEAR(farthest, 0.0625, 1e-12);
  }
}

TEST(Mesh, AGapAndATurnedFacetAreNamed) {
  WheelCase wheel;
  wheel.diameter = 0.1;
  wheel.width = 0.05;
  wheel.facets = 12;
  Mesh torn = wheel_mesh(wheel);
  torn.facets.pop_back();
  EXPECT_NO_THROW(torn.check("wheel"));
  Mesh turned = wheel_mesh(wheel);
  std::swap(turned.facets[0][0], turned.facets[0][1]);
  for (const Mesh& mesh : {torn, turned}) {
    try {
      mesh.check_closed("wheel");
      ADD_FAILURE() << "taken for closed";
    } catch (const ConfigError& error) {
      // The three edges of the one facet.
      EXPECT_NE(std::string(error.what()).find("is not closed at 3 edges"), std::string::npos)
          << error.what();
    }
  }
}

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / name;
}

TEST(Stl, TextAndBinaryGiveTheSameMesh) {
  const Vec3 corners[4] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  const int facets[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  std::ofstream text(temporary("a.stl"));
  text << "solid t\n";
  std::string binary(80, ' ');
  const std::uint32_t count = 4;
  binary.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& f : facets) {
    text << "facet normal 0 0 0\nouter loop\n";
    binary.append(12, '\0');
    for (const int v : f) {
      text << "vertex " << corners[v].x << " " << corners[v].y << " " << corners[v].z << "\n";
      const float at[3] = {static_cast<float>(corners[v].x), static_cast<float>(corners[v].y),
                           static_cast<float>(corners[v].z)};
      binary.append(reinterpret_cast<const char*>(at), sizeof at);
    }
    text << "endloop\nendfacet\n";
    binary.append(2, '\0');
  }
  text << "endsolid\n";
  text.close();
  std::ofstream(temporary("b.stl"), std::ios::binary) << binary;
  const Mesh a = read_stl(temporary("a.stl"), 0.001);
  const Mesh b = read_stl(temporary("b.stl"), 0.001);
  EXPECT_EQ(a.facets, b.facets);
  EXPECT_EQ(a.vertices.size(), 4u);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.vertices[static_cast<std::size_t>(a.facets[0][2])].x, 0.002);
}

TEST(Stl, DamagedSurfacesAreRefusedWithTheirName) {
  std::ofstream(temporary("empty.stl")) << "solid\nendsolid\n";
  std::ofstream(temporary("torn.stl")) << "solid\nfacet\nvertex 0 0 0\nvertex 1 0\n";
  std::ofstream(temporary("flat.stl"))
      << "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 2 0 0\nendfacet\n";
  for (const char* name : {"empty.stl", "torn.stl", "flat.stl", "absent.stl"}) {
    try {
      read_stl(temporary(name), 1.0);
      ADD_FAILURE() << name;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace grouser
