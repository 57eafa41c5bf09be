// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/report/report_data.hpp"

namespace grouser::synthetic {

/// A slip sweep whose means are known: what a report must find again.
struct Truth {
  double slip;  ///< [1]; the towed wheel's own
  double pull;  ///< coefficient [1]
  double gross;
  double sinkage;  ///< [m]
};

/// Means put into the point of that label ("braked_20", "towed", "slip_00" ... "slip_40").
Truth truth_of(const std::string& point);

/// The points in the order of the sweep.
std::vector<std::string> point_labels();

/// The wheel campaign of the paper with `seeds` runs per point, all finished: time series with
/// correlated noise around `truth_of` plus 0.01 per seed number away from the middle, bed pictures,
/// ledger, recording.
ReportData campaign(int seeds);

/// series.csv text of one run as the engine writes it. @param travel driven so far [m]
std::string series_text(const std::string& point, const Case& input, int seed, double travel);

/// slice.csv text of one run.
std::string slice_text(const Case& input, int seed);

/// The case of a point.
Case case_of(const std::string& point, int seed);

}  // namespace grouser::synthetic
