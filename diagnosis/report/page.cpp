// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/report/page.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "campaign/report/html.hpp"
#include "campaign/report/plot.hpp"
#include "campaign/report/style.hpp"
#include "diagnosis/hypotheses/table.hpp"
#include "diagnosis/report/json.hpp"

namespace grouser::diagnosis {
namespace {

constexpr const char* kOwnStyle =
    ".before{fill:none;stroke:var(--soft);stroke-width:2;stroke-dasharray:6 4}\n"
    ".recorded{fill:var(--lab)}\n.recorded circle{r:2}\n"
    ".held{outline:2px solid var(--campaign);outline-offset:-1px}\n"
    ".odds{display:block;height:.75rem;min-width:2px;border-radius:.2rem;background:var(--campaign)"
    "}"
    "\n.place{fill:var(--window)}\n";

std::string section(const char* id, const std::string& heading, const std::string& body) {
  return body.empty() ? ""
                      : std::string("<section id=\"") + id + "\">\n<h2>" + escape_html(heading) +
                            "</h2>\n" + body + "</section>\n";
}

std::string card(const std::string& heading, const std::string& body, const char* kind = "") {
  return std::string("<figure class=\"card ") + kind + "\">\n<header><h3>" + escape_html(heading) +
         "</h3></header>\n" + body + "</figure>\n";
}

std::string odds_of(double probability) {
  if (probability > 0.999) return "over 99.9 %";
  return probability < 1e-3 ? "under 0.1 %" : rounded(100.0 * probability) + " %";
}

std::string title_of(const std::string& id) {
  const Hypothesis* const h = find_hypothesis(id.c_str());
  if (h != nullptr) return h->title;
  if (id == "unknown") return "An unknown force";
  return id == "baseline" ? "Nothing is missing" : id;
}

// ---- before and after

std::vector<PlotPoint> points_of(const std::vector<double>& times,
                                 const std::vector<double>& values, double scale) {
  std::vector<PlotPoint> points;
  for (std::size_t i = 0; i < times.size(); ++i) points.emplace_back(times[i], scale * values[i]);
  return points;
}

std::string curve_plot(const Curves& curves, std::size_t c, const SignalEntry& signal) {
  const double scale = signal.shown_scale;
  ValueRange x, y;
  x.add(curves.times);
  for (const double value : curves.recorded[c]) y.add(scale * value);
  Plot plot(std::string(signal.heading) + " of " + curves.condition,
            "Recorded samples, baseline and the model with the cause over time",
            nice_axis(x.low(), x.high()), nice_axis(y.low(), y.high()), "Time [s]",
            std::string(signal.heading) + " [" + signal.shown_unit + "]");
  if (!curves.after.empty()) {
    std::vector<PlotPoint> low = points_of(curves.times, curves.after[c], scale);
    std::vector<PlotPoint> high = low;
    for (PlotPoint& point : low) point.second -= 2.0 * scale * curves.noise[c];
    for (PlotPoint& point : high) point.second += 2.0 * scale * curves.noise[c];
    plot.band(low, high, {"band", "noise"});
  }
  for (const PlotPoint& point : thin_curve(points_of(curves.times, curves.recorded[c], scale), 90))
    plot.marker(point, Marker::kDot, {"recorded", "recorded"}, "");
  plot.line(points_of(curves.times, curves.before[c], scale), {"before", "before"});
  if (!curves.after.empty())
    plot.line(points_of(curves.times, curves.after[c], scale), {"mean", "after"});
  return plot.svg();
}

std::string overlay_section(const Diagnosis& d, const SeriesRecording& recording) {
  std::string cards;
  for (const Curves& curves : d.curves)
    for (std::size_t c = 0; c < curves.recorded.size(); ++c) {
      std::string caption;
      for (const HeldOut& h : d.held_out)
        if (curves.is_held_out && h.condition == curves.condition)
          caption = "<figcaption>Error over the range, all channels: <b>" +
                    rounded(100.0 * h.baseline_error) + " %</b> before, <b>" +
                    rounded(100.0 * h.candidate_error) + " %</b> after; noise alone " +
                    rounded(100.0 * h.noise) + " %.</figcaption>\n";
      cards +=
          card(curves.condition + (curves.is_held_out ? ": held out, never fitted" : ": fitted"),
               curve_plot(curves, c, entry_of(recording.channels[c].signal)) + caption,
               curves.is_held_out ? "held" : "");
    }
  const bool has_after = !d.curves.empty() && !d.curves[0].after.empty();
  const std::string legend =
      "<p class=\"note\">Dots: recorded. Broken line: the baseline, its settings fitted." +
      std::string(has_after
                      ? " Full line: with the cause, in a band of two deviations of the noise."
                      : "") +
      " Curves are runs of the model named below.</p>\n";
  return section("overlay", has_after ? "Before and after" : "Recorded and simulated",
                 legend + "<div class=\"grid pictures\">\n" + cards + "</div>\n");
}

// ---- odds

std::string odds_section(const Diagnosis& d) {
  HtmlTable table("Odds of the causes");
  table.header({"cause", "kind", "odds", ""}, {false, false, true, false});
  std::size_t shown = 0;
  for (const Candidate& c : d.candidates) {
    const bool is_always = c.id == "baseline" || c.id == "unknown";
    if (!is_always && (c.probability < 1e-3 || shown >= 8)) continue;
    ++shown;
    table.row({escape_html(title_of(c.id)), word_of(c.family), odds_of(c.probability),
               "<span class=\"odds\" style=\"width:" + coordinate(12.0 * c.probability) +
                   "rem\"></span>"});
  }
  std::string text = table.html();
  if (d.confusable.size() > 1) {
    text += "<p class=\"note\">Not told apart by these data:";
    for (const std::string& id : d.confusable) text += " " + escape_html(id);
    text += ".</p>\n";
  }
  return section("odds", "Odds", text);
}

// ---- where

std::string place_section(const Diagnosis& d) {
  std::string cards;
  for (const Location& l : d.locations) {
    ValueRange x, y;
    x.add(l.times);
    y.add(0.0);
    std::vector<PlotPoint> low, high, mean;
    for (std::size_t i = 0; i < l.times.size(); ++i) {
      low.emplace_back(l.times[i], 100.0 * (l.latent[i] - l.latent_error[i]));
      high.emplace_back(l.times[i], 100.0 * (l.latent[i] + l.latent_error[i]));
      mean.emplace_back(l.times[i], 100.0 * l.latent[i]);
      y.add(low.back().second);
      y.add(high.back().second);
    }
    Plot plot("Unknown force in " + l.condition,
              "Force that would make the baseline fit, over the buoyant weight",
              nice_axis(x.low(), x.high()), nice_axis(y.low(), y.high()), "Time [s]",
              "Upward force [% of the buoyant weight]");
    for (std::size_t i = 0; i + 1 < l.times.size(); ++i)
      if (l.mask[i]) plot.shade(l.times[i], l.times[i + 1], {"place", ""}, "where the cause acts");
    plot.zero_line();
    plot.band(low, high, {"band", "deviation"});
    plot.line(mean, {"mean", "latent"});
    cards += card(l.condition, plot.svg());
  }
  if (cards.empty()) return "";
  return section("place", "Where",
                 "<p class=\"note\">Line: the force that the baseline would need, with one "
                 "deviation. Shaded: where the cause acts.</p>\n<div class=\"grid\">\n" +
                     cards + "</div>\n");
}

std::string residual_section(const Diagnosis& d, const SeriesRecording& recording) {
  std::vector<std::string> names;
  for (const Condition& c : recording.conditions)
    if (!c.is_held_out()) names.push_back(c.name);
  HtmlTable table("Windows of the baseline's residual that stand out");
  table.header({"run", "channel", "samples", "z"}, {false, false, true, true});
  for (std::size_t i = 0; i < std::min<std::size_t>(8, d.detection.cells.size()); ++i) {
    const ScanCell& cell = d.detection.cells[i];
    table.row({escape_html(names[cell.condition]),
               escape_html(recording.channels[cell.channel].name),
               std::to_string(cell.from) + " to " + std::to_string(cell.to), rounded(cell.z)});
  }
  return section("residual", "What the baseline leaves",
                 table.html() + "<p class=\"note\">By chance |z| passes " +
                     rounded(d.detection.threshold) + " once in a hundred recordings.</p>\n");
}

// ---- checks

std::string bars(const std::string& title, const std::string& x_label,
                 const std::vector<double>& values, double seen) {
  ValueRange x;
  x.add(values);
  if (std::isfinite(seen)) x.add(std::min(seen, 2.0 * x.high()));
  const PlotAxis axis = nice_axis(x.low(), x.high());
  constexpr std::size_t kBins = 30;
  std::vector<double> counts(kBins, 0.0);
  for (const double value : values) {
    const double at = (value - axis.low) / (axis.high - axis.low) * double(kBins);
    counts[std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0, at)))] += 1.0;
  }
  Plot plot(title, title, axis, nice_axis(0.0, *std::max_element(counts.begin(), counts.end())),
            x_label, "Draws");
  const double width = (axis.high - axis.low) / double(kBins);
  std::vector<PlotPoint> line;
  for (std::size_t b = 0; b < kBins; ++b) {
    line.emplace_back(axis.low + double(b) * width, counts[b]);
    line.emplace_back(axis.low + double(b + 1) * width, counts[b]);
  }
  plot.line(line, {"mean", "null"});
  if (std::isfinite(seen))
    plot.marker({std::min(seen, axis.high), 0.0}, Marker::kDiamond, {"lab", "seen"},
                "this recording: " + rounded(seen));
  return plot.svg();
}

std::string amplitude_card(const Diagnosis& d) {
  if (d.amplitude == 0.0) return "";
  ValueRange y;
  y.add(0.0);
  y.add(1.0);
  y.add(d.amplitude + d.amplitude_error);
  for (std::size_t i = 0; i < d.amplitudes.size(); ++i)
    for (const double side : {-1.0, 1.0}) y.add(d.amplitudes[i] + side * d.amplitude_errors[i]);
  const double count = static_cast<double>(d.amplitudes.size());
  Plot plot("Amplitude against theory", "All recordings together, then each by itself",
            nice_axis(-0.5, count + 0.5, 2), nice_axis(y.low(), y.high()),
            "0: together, then each recording", "Amplitude [theory = 1]");
  plot.line({{-0.5, 1.0}, {count + 0.5, 1.0}}, {"before", "theory"});
  plot.error_bar({0.0, d.amplitude}, d.amplitude_error, {"bar campaign", ""});
  plot.marker({0.0, d.amplitude}, Marker::kDot, {"seed", "together"},
              rounded(d.amplitude) + " ± " + rounded(d.amplitude_error));
  for (std::size_t i = 0; i < d.amplitudes.size(); ++i) {
    const PlotPoint at{static_cast<double>(i + 1), d.amplitudes[i]};
    plot.error_bar(at, d.amplitude_errors[i], {"bar", ""});
    plot.marker(at, Marker::kRing, {"towed", "each"}, rounded(d.amplitudes[i]));
  }
  return card("Amplitude: " + rounded(d.amplitude) + " ± " + rounded(d.amplitude_error) +
                  " where theory has 1",
              plot.svg());
}

std::string placebo_card(const Diagnosis& d) {
  if (d.held_out.empty() || d.held_out[0].placebos.empty()) return "";
  HtmlTable table("ln of the held-out's predictive density, over the baseline's");
  table.header({"cause", "gain"}, {false, true});
  table.row({"<b>" + escape_html(title_of(d.cause)) + "</b>", rounded(d.held_out[0].gain)});
  auto placebos = d.held_out[0].placebos;
  std::sort(placebos.begin(), placebos.end(),
            [](const auto& a, const auto& b) { return a.second > b.second; });
  for (std::size_t i = 0; i < std::min<std::size_t>(8, placebos.size()); ++i)
    table.row({escape_html(title_of(placebos[i].first)), rounded(placebos[i].second)});
  return card("The cause beside wrong ones on what was held out", table.html());
}

std::string checks_section(const Diagnosis& d) {
  const double seen = d.detection.cells.empty() ? NAN : std::abs(d.detection.cells[0].z);
  std::string cards = amplitude_card(d) + placebo_card(d);
  if (!d.detection.draws.empty())
    cards += card("If nothing were missing", bars("Largest |z| if nothing were missing",
                                                  "largest |z|", d.detection.draws, seen) +
                                                 "<figcaption>Line: draws of a recording without "
                                                 "mismatch, fitted alike. Diamond: this one, "
                                                 "at the edge when beyond.</figcaption>\n");
  return section("checks", "Checks", "<div class=\"grid\">\n" + cards + "</div>\n");
}

// ---- next

std::string next_section(const Diagnosis& d) {
  std::string simulations, laboratory;
  for (const std::string& id : d.confusable) {
    const Hypothesis* const h = find_hypothesis(id.c_str());
    if (h == nullptr) continue;
    (h->family == Family::kNumerics ? simulations : laboratory) +=
        "<li>" + escape_html(h->title) + ": " + escape_html(h->explanation.breaker) + "</li>\n";
  }
  if (d.word == Word::kNoneOfTheKnown)
    laboratory +=
        "<li>Repeat with another sphere: a force that scales with none of weight, drag "
        "and displaced fluid is no term of this catalogue</li>\n";
  const std::string all = simulations + laboratory;
  return section("next", "What would tell more",
                 all.empty() ? "" : "<ul class=\"plain\">\n" + all + "</ul>\n");
}

std::string ledger_section(const Diagnosis& d) {
  std::string text;
  for (const Finding& f : d.findings)
    text += "<p class=\"" + std::string(f.is_fault ? "caution" : "note") + "\">" +
            escape_html(f.condition + " " + f.channel + ": " + f.text) + "</p>\n";
  text += "<p class=\"note\">" + std::to_string(d.fitted) + " fitted recordings, " +
          shown_count(d.runs) + " runs of the model sphere_ode in " + shown_duration(d.seconds) +
          ". Neglected: rotation and sideways motion, how the sphere comes to rest, noise that "
          "remembers more than one sample.</p>\n";
  return section("ledger", "Data and runs", text);
}

}  // namespace

std::string page_html(const Diagnosis& d, const SeriesRecording& recording) {
  std::string head =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta name=\"color-scheme\" content=\"light dark\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'; img-src data:\"/>\n<link rel=\"icon\" href=\"data:,\"/>\n<title>" +
      escape_html("Diagnosis of " + recording.title) + "</title>\n<style>\n" + kPageStyle +
      kOwnStyle + "</style>\n</head>\n<body>\n<header class=\"page\">\n<p class=\"eyebrow\">" +
      escape_html("Diagnosis of " + recording.name + ": " + recording.title) + "</p>\n<h1>" +
      escape_html(sentence(d)) + "</h1>\n";
  if (!d.set.empty() && d.word != Word::kNoMismatch) {
    std::string set;
    for (const std::string& id : d.set) set += (set.empty() ? "" : ", ") + title_of(id);
    head += "<p class=\"lede\">" + escape_html("With 95 %: " + set + ".") + "</p>\n";
  }
  for (const std::string& flag : d.flags)
    head += "<p class=\"caution\">" + escape_html(flag) + "</p>\n";
  return head + "</header>\n<main>\n" + overlay_section(d, recording) + odds_section(d) +
         place_section(d) + checks_section(d) + residual_section(d, recording) + next_section(d) +
         ledger_section(d) + "</main>\n</body>\n</html>\n";
}

}  // namespace grouser::diagnosis
