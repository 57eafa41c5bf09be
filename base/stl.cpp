// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>
#include <map>
#include <sstream>
#include <tuple>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/mesh.hpp"

namespace grouser {
namespace {

constexpr std::size_t kHeader = 80;
constexpr std::size_t kRecord = 50;  // normal, three corners, two bytes of attributes

class Welder {
 public:
  explicit Welder(double scale) : scale_(scale) {}

  void add(const std::array<Vec3, 3>& corners) {
    std::array<int, 3> facet{};
    for (std::size_t k = 0; k < 3; ++k) facet[k] = vertex(corners[k]);
    // Exporters write slivers whose corners fall together; they bound nothing.
    if (facet[0] != facet[1] && facet[1] != facet[2] && facet[2] != facet[0])
      mesh.facets.push_back(facet);
  }

  Mesh mesh;

 private:
  int vertex(const Vec3& at) {
    const auto [place, is_new] =
        numbers_.try_emplace({at.x, at.y, at.z}, static_cast<int>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(scale_ * at);
    return place->second;
  }

  double scale_;
  std::map<std::tuple<double, double, double>, int> numbers_;
};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& problem) {
  throw ConfigError(
      {Problem{file.string(), 0, 0, "", problem, "give an STL surface, text or binary"}});
}

std::uint32_t binary_count(const std::string& text) {
  std::uint32_t count = 0;
  if (text.size() >= kHeader + sizeof count)
    std::memcpy(&count, text.data() + kHeader, sizeof count);
  return count;
}

bool is_binary(const std::string& text) {
  // Binary files may begin with "solid" too; only their size tells for sure.
  return text.size() >= kHeader + 4 &&
         text.size() == kHeader + 4 + kRecord * std::size_t{binary_count(text)};
}

void read_binary(const std::string& text, Welder& welder) {
  for (std::size_t f = 0; f < binary_count(text); ++f) {
    float numbers[12];
    std::memcpy(numbers, text.data() + kHeader + 4 + f * kRecord, sizeof numbers);
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = {numbers[3 + 3 * k], numbers[4 + 3 * k], numbers[5 + 3 * k]};
    welder.add(corners);
  }
}

void read_text(const std::filesystem::path& file, const std::string& text, Welder& welder) {
  std::istringstream words(text);
  std::string word;
  std::array<Vec3, 3> corners;
  std::size_t corner = 0;
  while (words >> word) {
    if (word == "vertex") {
      Vec3 at;
      if (corner >= 3 || !(words >> at.x >> at.y >> at.z))
        refuse(file, "has a facet whose three vertices cannot be read");
      corners[corner++] = at;
    } else if (word == "endfacet") {
      if (corner != 3) refuse(file, "has a facet without three vertices");
      welder.add(corners);
      corner = 0;
    }
  }
}

}  // namespace

Mesh read_stl(const std::filesystem::path& file, double scale) {
  const std::optional<std::string> text = read_file(file);
  if (!text) refuse(file, "does not exist");
  Welder welder(scale);
  if (is_binary(*text)) {
    read_binary(*text, welder);
  } else if (text->find('\0') != std::string::npos) {
    refuse(file, "is cut off or damaged: it has " + std::to_string(text->size()) +
                     " bytes instead of the " +
                     std::to_string(kHeader + 4 + kRecord * std::size_t{binary_count(*text)}) +
                     " of the " + std::to_string(binary_count(*text)) + " facets it announces");
  } else {
    read_text(file, *text, welder);
  }
  for (const Vec3& v : welder.mesh.vertices)
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
      refuse(file, "has a coordinate that is no number");
  welder.mesh.check(file.string());
  return welder.mesh;
}

}  // namespace grouser
