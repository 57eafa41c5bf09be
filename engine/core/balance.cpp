// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/balance.hpp"

#include <mpi.h>
#include <zoltan.h>

#include <cmath>
#include <limits>
#include <memory>

#include "base/check.hpp"

namespace grouser {
namespace {

// Shares that differ by less are as good as equal: below what a rank's time varies by.
constexpr const char* kTolerance = "1.01";

const std::vector<Load>& loads_in(void* data) {
  return *static_cast<const std::vector<Load>*>(data);
}

int count_loads(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(loads_in(data).size());
}

void list_loads(void* data, int, int, ZOLTAN_ID_PTR names, ZOLTAN_ID_PTR places, int,
                float* weights, int* error) {
  const std::vector<Load>& loads = loads_in(data);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    names[i] = places[i] = static_cast<ZOLTAN_ID_TYPE>(i);
    weights[i] = static_cast<float>(loads[i].weight);
  }
  *error = ZOLTAN_OK;
}

int count_axes(void*, int* error) {
  *error = ZOLTAN_OK;
  return 3;
}

void list_positions(void* data, int, int, int, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR, int, double* to,
                    int* error) {
  for (const Load& load : loads_in(data)) {
    *to++ = load.position.x;
    *to++ = load.position.y;
    *to++ = load.position.z;
  }
  *error = ZOLTAN_OK;
}

struct Destroy {
  void operator()(Zoltan_Struct* zoltan) const { Zoltan_Destroy(&zoltan); }
};

// Zoltan says "beyond everything" with the largest number.
double edge(double at) {
  constexpr double kBeyond = 0.5 * std::numeric_limits<float>::max();
  return std::abs(at) < kBeyond ? at : std::copysign(std::numeric_limits<double>::infinity(), at);
}

// Where a side of a cut has no loads Zoltan puts the cut at infinity: a box lies beyond everything
// there, or ends before it begins.
bool is_inside_out(const Box& box) {
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  const auto is_so = [](double low, double high) {
    return low > high || low == kBeyond || high == -kBeyond;
  };
  return is_so(box.low.x, box.high.x) || is_so(box.low.y, box.high.y) ||
         is_so(box.low.z, box.high.z);
}

}  // namespace

std::optional<Decomposition> balanced(const Communicator& ranks, const std::vector<Load>& loads) {
  static const int started = [] {
    float version = 0.0F;
    return Zoltan_Initialize(0, nullptr, &version);
  }();
  GROUSER_CHECK(started == ZOLTAN_OK);
  const std::unique_ptr<Zoltan_Struct, Destroy> zoltan(
      Zoltan_Create(MPI_Comm_f2c(ranks.fortran_handle())));
  GROUSER_CHECK(zoltan != nullptr);
  constexpr std::pair<const char*, const char*> kParameters[] = {
      {"DEBUG_LEVEL", "0"},
      {"LB_METHOD", "RCB"},
      {"KEEP_CUTS", "1"},
      {"RETURN_LISTS", "NONE"},
      {"OBJ_WEIGHT_DIM", "1"},
      {"IMBALANCE_TOL", kTolerance},
      {"AVERAGE_CUTS", "1"},
      {"CHECK_GEOM", "0"},
      // Parts keep the order of the cuts, so that ranks that follow one another stay together.
      {"REMAP", "0"}};
  for (const auto& [name, value] : kParameters)
    GROUSER_CHECK(Zoltan_Set_Param(zoltan.get(), name, value) == ZOLTAN_OK);
  auto* const data = const_cast<std::vector<Load>*>(&loads);
  Zoltan_Set_Num_Obj_Fn(zoltan.get(), count_loads, data);
  Zoltan_Set_Obj_List_Fn(zoltan.get(), list_loads, data);
  Zoltan_Set_Num_Geom_Fn(zoltan.get(), count_axes, data);
  Zoltan_Set_Geom_Multi_Fn(zoltan.get(), list_positions, data);
  int changes = 0, width = 0, width_here = 0, coming = 0, going = 0;
  ZOLTAN_ID_PTR coming_names = nullptr, coming_places = nullptr;
  ZOLTAN_ID_PTR going_names = nullptr, going_places = nullptr;
  int* coming_from = nullptr;
  int* going_to = nullptr;
  const int done = Zoltan_LB_Balance(zoltan.get(), &changes, &width, &width_here, &coming,
                                     &coming_names, &coming_places, &coming_from, &going,
                                     &going_names, &going_places, &going_to);
  GROUSER_CHECK(done == ZOLTAN_OK || done == ZOLTAN_WARN);
  std::vector<Box> boxes(static_cast<std::size_t>(ranks.size()));
  for (int rank = 0; rank < ranks.size(); ++rank) {
    Box& box = boxes[static_cast<std::size_t>(rank)];
    int axes = 0;
    GROUSER_CHECK(Zoltan_RCB_Box(zoltan.get(), rank, &axes, &box.low.x, &box.low.y, &box.low.z,
                                 &box.high.x, &box.high.y, &box.high.z) == ZOLTAN_OK);
    box.low = {edge(box.low.x), edge(box.low.y), edge(box.low.z)};
    box.high = {edge(box.high.x), edge(box.high.y), edge(box.high.z)};
    if (is_inside_out(box)) return std::nullopt;
  }
  return Decomposition(std::move(boxes));
}

}  // namespace grouser
