// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/sweep_rows_impl.hpp"

namespace grouser {

template void sweep_rows<D2Q9, double>(Streaming<D2Q9, double>&, const Collision<double>&,
                                       const Vec3&, const SweepRange&);
template void sweep_rows<D2Q9, float>(Streaming<D2Q9, float>&, const Collision<float>&, const Vec3&,
                                      const SweepRange&);

}  // namespace grouser
