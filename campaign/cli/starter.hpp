// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace grouser {

/// A small campaign that validates as it is and runs in minutes on two cores.
inline constexpr const char* kStarterCampaign =
    R"yaml(# A slip sweep of a small smooth wheel. Every value carries its unit; `grouser validate` names
# all mistakes at once, with line and column. All keys: docs/reference/campaign_yaml.md.
grouser: 1
campaign: small_wheel
title: Smooth 12.5 cm wheel on loose sand

scheduler: local              # or slurm, pbs; see configs/sites for a cluster's values
resources:
  ranks: 1                    # MPI ranks of one run
  # walltime: 8h              # needed by slurm and pbs: longest duration of one job
chunks: {count: 2}            # jobs per run; walltime adds cuts by itself
retries: {infrastructure: 3}  # failures in a row, without progress, before a run is given up

case:                         # the input of every run
  box: {length: 36 cm, width: 12 cm, depth: 6 cm}
  grains:
    density: 2650 kg/m3
    solid: {young_modulus: 50 MPa, poisson_ratio: 0.25}
    size_curve:               # of the real soil, fine to coarse
      - {diameter: 2.5 mm, finer: 0 %}
      - {diameter: 3 mm, finer: 100 %}
    coarse_graining: 4        # factor on every diameter
    seed: 1
  contact:
    rolling: elastic_plastic
    grain_grain: {restitution: 0.4, friction: 0.5, rolling_friction: 0.2}
    grain_box: {restitution: 0.4, friction: 0.5, rolling_friction: 0.2}
    grain_wheel: {restitution: 0.4, friction: 0.6, rolling_friction: 0.2}
  bed:                        # settled once, shared by all runs with the same soil
    depth: 4 cm
    preparation_friction: 0.1
    settled_energy_ratio: 1e-4
  wheel:
    diameter: 12 cm
    width: 6 cm
    facets: 60
    load: 12 N
    start: 0.3
    settle_time: 50 ms
    ramp_time: 10 ms
    forward_speed: 0.5 m/s
    travel: 8 cm
    average_travel: 4 cm      # the last part, over which means are taken
    drive: slip
    slip: 0 %

sweep:                        # the runs are all combinations of the axes' points
  - axis: slip
    points:
      - {label: towed, set: {wheel.drive: towed}}
      - {label: slip_00, set: {wheel.slip: 0 %}}
      - {label: slip_20, set: {wheel.slip: 20 %}}
      - {label: slip_40, set: {wheel.slip: 40 %}}
)yaml";

}  // namespace grouser
