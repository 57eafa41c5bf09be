// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/populations.hpp"

#include <sys/mman.h>

#include <new>

namespace grouser {
namespace {

constexpr std::size_t kLine = 64;
constexpr std::size_t kHugePage = std::size_t{1} << 21;

std::ptrdiff_t round_up(std::ptrdiff_t value, std::ptrdiff_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

// Zeroed pages, huge ones where the system has them: a sweep walks through as many arrays as there
// are velocities, more than the translation buffers of small pages can follow.
void* map_pages(std::size_t bytes) {
  void* at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) throw std::bad_alloc();
  madvise(at, bytes, MADV_HUGEPAGE);  // advice: nothing is lost where it is not taken
  return at;
}

}  // namespace

template <class Real>
void Populations<Real>::Release::operator()(void* at) const {
  munmap(at, bytes);
}

template <class Real>
Populations<Real>::Populations(const CellBox& box, std::size_t velocities)
    : box_(box), memory_(nullptr, Release{0}) {
  constexpr auto kPerLine = static_cast<std::ptrdiff_t>(kLine / sizeof(Real));
  pitch_ = round_up(box.nx, kPerLine) + kPerLine;
  const std::ptrdiff_t cells = step_z() * (box.nz + 2 * box.ghosts_z);
  // Five lines more than a multiple of 4096 bytes: neither pages nor sets of caches coincide.
  step_velocity_ = round_up(cells, 64 * kPerLine) + 5 * kPerLine;
  const std::ptrdiff_t values = step_velocity_ * static_cast<std::ptrdiff_t>(velocities) + kPerLine;
  bytes_ = static_cast<std::size_t>(values) * sizeof(Real);
  const std::size_t mapped = (bytes_ + 2 * kHugePage - 1) / kHugePage * kHugePage;
  memory_ = std::unique_ptr<void, Release>(map_pages(mapped), Release{mapped});
  first_ = static_cast<Real*>(memory_.get()) + kPerLine + step_y() + box.ghosts_z * step_z();
}

template class Populations<double>;
template class Populations<float>;

}  // namespace grouser
