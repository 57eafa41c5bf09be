// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "campaign/report/analysis.hpp"
#include "campaign/report/report_data.hpp"

namespace grouser {

/// The report's pictures as inline SVG. Local.

/// One observable over slip: every seed, their mean with a band of one standard deviation, and
/// the recorded values. A towed value stands at the campaign's own towed slip.
std::string slip_figure(const ReportData& data, const Analysis& analysis, Observable observable);

/// What the markers of slip_figure mean, as HTML.
std::string slip_legend(const ReportData& data, const Analysis& analysis);

/// Pull and gross coefficient of a run over simulated time, the averaging window shaded.
std::string coefficient_figure(const RunData& run, const RunResult& result);

/// Sinkage of a run over simulated time, the averaging window shaded.
std::string sinkage_figure(const RunData& run, const RunResult& result);

/// What of a tracked grain is drawn.
enum class TrackSignal { kGap, kVelocity };

/// The recorded curves of a signal whose condition is named as one of the run's sweep points.
std::vector<const RecordedCurve*> curves_of(const ReportData& data, const RunData& run,
                                            TrackSignal signal);

/// Root mean square of engine minus recording at the recorded times within the run; gap [mm], speed
/// [mm s-1]; NaN when no time is.
double rms_difference(const TrackSeries& track, TrackSignal signal, const RecordedCurve& curve);

/// Gap or downward speed of the tracked grain over time, with the recorded points.
std::string track_figure(const ReportData& data, const RunData& run, TrackSignal signal);

/// Displacement at the upper end of the colours, a round number for all pictures together: few
/// grains are beyond it. 0 when no run has a picture. [m]
double displacement_scale(const ReportData& data);

/// Grains near the mid-plane coloured by displacement, the wheel's outline and the box.
/// @param scale see displacement_scale, positive [m]
std::string bed_figure(const RunData& run, double scale);

/// The colours of bed_figure with their values.
std::string displacement_legend(double scale);

}  // namespace grouser
