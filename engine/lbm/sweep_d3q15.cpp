// SPDX-License-Identifier: BSD-3-Clause
#include "engine/lbm/sweep_rows_impl.hpp"

namespace grouser {

template void sweep_rows<D3Q15, double>(Streaming<D3Q15, double>&, const Collision<double>&,
                                        const Vec3&, const SweepRange&);
template void sweep_rows<D3Q15, float>(Streaming<D3Q15, float>&, const Collision<float>&,
                                       const Vec3&, const SweepRange&);

template void sweep_immersed_rows<D3Q15, double>(Streaming<D3Q15, double>&,
                                                 const Collision<double>&, const Vec3&,
                                                 const SweepRange&, const SolidMap&,
                                                 ImmersedRows<double>&);
template void sweep_immersed_rows<D3Q15, float>(Streaming<D3Q15, float>&, const Collision<float>&,
                                                const Vec3&, const SweepRange&, const SolidMap&,
                                                ImmersedRows<float>&);

}  // namespace grouser
