// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace grouser {

// How often to write a checkpoint and how long a job to ask for, from what was measured. All pure.

/// Compute time between two checkpoints for which the least is lost, to first order.
/// Young 1974 (Commun. ACM 17, 530), eq. 3.
/// @param cost  of one checkpoint [s], >= 0
/// @param mtbf  mean time between failures of the job [s], > 0
/// @return [s]
double young_interval(double cost, double mtbf);

/// The same to higher order. Daly 2006 (Future Gener. Comput. Syst. 22, 303), eq. 37; `mtbf` itself
/// when a checkpoint costs twice that or more.
double daly_interval(double cost, double mtbf);

/// Expected wall time of `work` seconds of computing, failures being exponentially distributed.
/// Daly 2006, eq. 13.
/// @param interval  compute time between checkpoints [s], > 0
/// @param restart   lost at each failure before computing goes on [s]
double expected_wall_time(double work, double interval, double cost, double restart, double mtbf);

/// Mean time between failures after `failures` in `observed` seconds of jobs, together with one
/// failure in a day that is assumed beforehand, so that little experience decides little.
double mtbf_after(double observed, int failures);

/// The value that 95 of 100 do not exceed (nearest rank); 0 for none.
double percentile95(std::vector<double> values);

/// What is known of the jobs of a campaign so far.
struct Measured {
  std::vector<double> checkpoint_costs;  ///< slowest of each attempt [s]
  double observed = 0.0;                 ///< time jobs were at work [s]
  int failures = 0;                      ///< that the computing was not at fault for
};

/// Wall time between checkpoints; 0 while nothing is measured, then the case decides. [s]
double checkpoint_seconds(const Measured& measured);

/// Walltime to ask for: short jobs wait less in a queue.
/// @param left      computing left in the chunk at the speed measured [s]; 0 = unknown
/// @param longest   that may be asked for [s]
/// @return `longest`, or less in whole quarters of an hour that hold the rest and half as much
/// again
double job_walltime(double left, double longest, const Measured& measured);

}  // namespace grouser
