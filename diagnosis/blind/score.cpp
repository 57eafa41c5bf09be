// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/blind/score.hpp"

#include <boost/math/distributions/beta.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <sstream>

#include "base/atomic_file.hpp"
#include "base/units.hpp"
#include "diagnosis/blind/cases.hpp"
#include "diagnosis/blind/seal.hpp"

namespace grouser::diagnosis {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kConfident = 0.95;

/// One case: what was concealed beside what was said.
struct Marked {
  std::string name;
  std::string kind;
  std::vector<std::string> secrets;
  int conditions = 0;
  bool is_answered = false;
  Json truth;
  Json answer = Json::object();
  Json rivals = Json::object();

  std::string verdict() const { return answer.value("verdict", ""); }
  std::string cause() const { return answer.value("cause", ""); }
  bool is_named() const { return verdict() == "named" || verdict() == "provisional"; }
  double probability() const { return answer.value("probability", 0.0); }
  std::set<std::string> causes() const {
    std::set<std::string> all;
    std::stringstream text(cause());
    for (std::string id; std::getline(text, id, '+');) all.insert(id);
    return all;
  }
  bool is_exact() const {
    return is_named() && causes() == std::set<std::string>(secrets.begin(), secrets.end());
  }
  /// Whether a cause was named that is not there.
  bool is_wrong() const {
    if (!is_named()) return false;
    for (const std::string& id : causes())
      if (std::find(secrets.begin(), secrets.end(), id) == secrets.end()) return true;
    return false;
  }
  bool is_right() const {
    if (kind == "null") return verdict() == "no_mismatch";
    return kind == "unlisted" ? verdict() == "none_of_the_known" : is_exact();
  }
};

using Cases = std::vector<Marked>;

template <typename Keep>
Cases only(const Cases& cases, Keep keep) {
  Cases kept;
  std::copy_if(cases.begin(), cases.end(), std::back_inserter(kept), keep);
  return kept;
}

template <typename Is>
Rate share(const Cases& cases, Is is) {
  return share_of(static_cast<int>(std::count_if(cases.begin(), cases.end(), is)),
                  static_cast<int>(cases.size()));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// A statistic of values with its bounds by resampling (Efron 1979), 2.5 and 97.5 %.
template <typename Statistic>
Rate resampled(const std::vector<double>& values, Statistic statistic) {
  if (values.empty()) return {NAN, NAN, NAN, 0};
  std::mt19937_64 random(5);
  std::uniform_int_distribution<std::size_t> pick(0, values.size() - 1);
  std::vector<double> many;
  for (int i = 0; i < 1000; ++i) {
    std::vector<double> again;
    for (std::size_t k = 0; k < values.size(); ++k) again.push_back(values[pick(random)]);
    many.push_back(statistic(again));
  }
  std::sort(many.begin(), many.end());
  return {statistic(values), many[25], many[975], static_cast<int>(values.size())};
}

/// Common part over the union of the two masks, mean of the conditions; NaN where lengths differ.
double overlap(const Marked& c) {
  double sum = 0.0;
  int count = 0;
  for (const Json& place : c.answer.value("locations", Json::array())) {
    const std::string said = place.value("mask", "");
    const std::string real = c.truth["masks"].value(place.value("condition", ""), "");
    if (said.size() != real.size()) continue;
    int both = 0, either = 0;
    for (std::size_t i = 0; i < said.size(); ++i) {
      both += said[i] == '1' && real[i] == '1' ? 1 : 0;
      either += said[i] == '1' || real[i] == '1' ? 1 : 0;
    }
    sum += either > 0 ? static_cast<double>(both) / either : 1.0;
    ++count;
  }
  return count > 0 ? sum / count : NAN;
}

/// Mean distance of stated probability and share of right ones over ten equal bins of the cases.
double calibration_error(const std::vector<std::pair<double, bool>>& said) {
  std::vector<std::pair<double, bool>> sorted = said;
  std::sort(sorted.begin(), sorted.end());
  double error = 0.0;
  const std::size_t bins = std::min<std::size_t>(10, sorted.size());
  for (std::size_t b = 0; b < bins; ++b) {
    double stated = 0.0, right = 0.0;
    const std::size_t from = b * sorted.size() / bins;
    const std::size_t to = (b + 1) * sorted.size() / bins;
    for (std::size_t i = from; i < to; ++i) {
      stated += sorted[i].first;
      right += sorted[i].second ? 1.0 : 0.0;
    }
    error += std::abs(stated - right);
  }
  return sorted.empty() ? NAN : error / static_cast<double>(sorted.size());
}

Rate calibration_of(const Cases& cases) {
  std::vector<std::pair<double, bool>> said;
  for (const Marked& c : cases)
    if (c.is_named()) said.emplace_back(c.probability(), !c.is_wrong());
  if (said.empty()) return {NAN, NAN, NAN, 0};
  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::size_t> pick(0, said.size() - 1);
  std::vector<double> many;
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::pair<double, bool>> again;
    for (std::size_t k = 0; k < said.size(); ++k) again.push_back(said[pick(random)]);
    many.push_back(calibration_error(again));
  }
  std::sort(many.begin(), many.end());
  return {calibration_error(said), many[25], many[975], static_cast<int>(said.size())};
}

/// Error with the cause over that without, on what was held out; `is_beyond`: both without noise.
std::vector<double> held_out_ratios(const Cases& cases, bool is_beyond) {
  std::vector<double> ratios;
  for (const Marked& c : cases)
    for (const Json& held : c.answer.value("held_out", Json::array())) {
      double before = held.value("baseline_error", 0.0);
      double after = held.value("candidate_error", 0.0);
      if (is_beyond) {
        const double noise = held.value("noise_error", 0.0);
        before = std::sqrt(std::max(0.0, before * before - noise * noise));
        after = std::sqrt(std::max(0.0, after * after - noise * noise));
        if (before < 0.5 * noise) continue;  // nothing to gain beyond noise
      }
      if (before > 0.0) ratios.push_back(after / before);
    }
  return ratios;
}

Cases load(const fs::path& folder, const std::string& half, std::string& tier) {
  check_answers(folder);
  const Json truths = Json::parse(open_truth(folder));
  tier = truths.value("tier", "t0");
  Cases cases;
  for (const Json& truth : truths["cases"]) {
    if (!half.empty() && truth.value("half", "") != half) continue;
    Marked c;
    c.name = truth.value("case", "");
    c.kind = truth.value("kind", "");
    c.secrets = truth["secrets"].get<std::vector<std::string>>();
    c.conditions = truth.value("fitted_runs", 1);
    c.truth = truth;
    if (const auto text = read_file(folder / c.name / kAnswerFile)) {
      c.answer = Json::parse(*text);
      c.is_answered = true;
    }
    if (const auto text = read_file(folder / c.name / kRivalsFile)) c.rivals = Json::parse(*text);
    cases.push_back(c);
  }
  return cases;
}

bool is_in_set(const Marked& c) {
  const Json set = c.answer.value("set", Json::array());
  return std::any_of(set.begin(), set.end(), [&](const Json& id) { return id == c.secrets[0]; });
}

void mark_shares(const Cases& all, const Cases& nulls, const Cases& singles, Score& s) {
  const Cases several = only(singles, [](const Marked& c) { return c.conditions > 1; });
  const Cases doubles = only(all, [](const Marked& c) { return c.kind == "double"; });
  const Cases unlisted = only(all, [](const Marked& c) { return c.kind == "unlisted"; });
  const Cases rich = only(unlisted, [](const Marked& c) { return c.conditions > 1; });
  const Cases poor = only(unlisted, [](const Marked& c) { return c.conditions == 1; });
  const auto is_exact = [](const Marked& c) { return c.is_exact(); };
  s.marks.push_back({"false_alarm", "false alarm on nulls",
                     share(nulls, [](const Marked& c) { return c.verdict() != "no_mismatch"; })});
  s.marks.push_back(
      {"top1", "one cause, several recordings: exactly that named", share(several, is_exact)});
  s.marks.push_back({"top1_all", "the same with one recording as well", share(singles, is_exact)});
  s.marks.push_back({"set_coverage", "truth in the 95 % set", share(singles, is_in_set)});
  s.marks.push_back({"confident_wrong", "named, over 95 % and wrong, of all cases",
                     share(all, [](const Marked& c) {
                       return c.verdict() == "named" && c.probability() > kConfident &&
                              c.is_wrong();
                     })});
  s.marks.push_back(
      {"confident_wrong_any_word", "the same, provisional verdicts as well",
       share(all, [](const Marked& c) { return c.probability() > kConfident && c.is_wrong(); })});
  s.marks.push_back({"out_of_catalogue_flagged",
                     "outside the catalogue, several recordings: none of the known",
                     share(rich, [](const Marked& c) { return c.is_right(); })});
  s.marks.push_back({"out_of_catalogue_single_not_named",
                     "outside the catalogue, one recording: provisional or none of the known",
                     share(poor, [](const Marked& c) { return c.verdict() != "named"; })});
  s.marks.push_back({"doubles_both", "two causes: both named", share(doubles, is_exact)});
  s.marks.push_back(
      {"doubles_none_wrong", "two causes: nothing named that is not there",
       share(doubles, [](const Marked& c) { return c.is_answered && !c.is_wrong(); })});
}

void mark_sizes(const Cases& all, const Cases& singles, Score& s) {
  std::vector<double> sizes, overlaps;
  Cases amplitudes;
  for (const Marked& c : singles) {
    if (c.is_answered) sizes.push_back(double(c.answer.value("set", Json::array()).size()));
    if (!c.is_exact()) continue;
    const double common = overlap(c);
    if (std::isfinite(common)) overlaps.push_back(common);
    if (c.truth.value("amplitude", 0.0) > 0.0) amplitudes.push_back(c);
  }
  const Cases right = only(singles, [](const Marked& c) { return c.is_exact(); });
  s.marks.push_back({"set_size", "mean size of the 95 % set", resampled(sizes, mean), false});
  s.marks.push_back({"localisation_overlap", "overlap with the true place, median of named singles",
                     resampled(overlaps, median), false});
  s.marks.push_back({"amplitude_coverage", "amplitude within its 90 % interval",
                     share(amplitudes, [](const Marked& c) {
                       const Json& a = c.answer["amplitude"];
                       return std::abs(a.value("value", 0.0) - c.truth.value("amplitude", 0.0)) <=
                              1.645 * a.value("deviation", 0.0);
                     })});
  s.marks.push_back({"held_out_ratio",
                     "held-out error over the baseline's, median of named singles",
                     resampled(held_out_ratios(right, false), median), false});
  s.marks.push_back({"held_out_ratio_beyond_noise", "the same, noise taken off both",
                     resampled(held_out_ratios(right, true), median), false});
  s.marks.push_back({"ece", "error of stated probabilities", calibration_of(all), false});
}

void mark_rivals(const Cases& nulls, const Cases& several, Score& s) {
  for (const char* const name : {"rmse", "correlation", "sindy", "smc", "gp"}) {
    const auto says = [&](const Marked& c) { return c.rivals.value(name, std::string()); };
    s.rivals.push_back({name, share(nulls, [&](const Marked& c) { return !says(c).empty(); }),
                        share(several, [&](const Marked& c) { return says(c) == c.secrets[0]; })});
  }
}

std::string line_of(const Marked& c) {
  std::string secrets;
  for (const std::string& id : c.secrets) secrets += (secrets.empty() ? "" : "+") + id;
  return c.name + " (" + c.kind + ", " + std::to_string(c.conditions) + " fitted, visible " +
         rounded(c.truth.value("visibility", 0.0)) +
         " sd): " + (secrets.empty() ? "nothing" : secrets) + " -> " +
         (c.is_answered ? c.verdict() + " " + c.cause() + " " + rounded(c.probability())
                        : std::string("no answer"));
}

Json to_json(const Mark& mark, Json out) {
  out[mark.key] = mark.rate.value;
  out[mark.key + "_lo"] = mark.rate.lo;
  out[mark.key + "_hi"] = mark.rate.hi;
  out[mark.key + "_count"] = mark.rate.count;
  return out;
}

}  // namespace

Rate share_of(int hits, int count) {
  if (count == 0) return {NAN, NAN, NAN, 0};
  using boost::math::beta_distribution;
  const double n = count, k = hits;
  return {k / n, hits == 0 ? 0.0 : quantile(beta_distribution<>(k, n - k + 1.0), 0.025),
          hits == count ? 1.0 : quantile(beta_distribution<>(k + 1.0, n - k), 0.975), count};
}

Score score_cases(const fs::path& folder, const std::string& half, bool is_answered_only) {
  Score s;
  Cases all = load(folder, half, s.tier);
  s.unanswered = static_cast<int>(
      std::count_if(all.begin(), all.end(), [](const Marked& c) { return !c.is_answered; }));
  if (is_answered_only) all = only(all, [](const Marked& c) { return c.is_answered; });
  s.cases = static_cast<int>(all.size());
  const Cases nulls = only(all, [](const Marked& c) { return c.kind == "null"; });
  const Cases singles = only(all, [](const Marked& c) { return c.kind == "single"; });
  mark_shares(all, nulls, singles, s);
  mark_sizes(all, singles, s);
  mark_rivals(nulls, only(singles, [](const Marked& c) { return c.conditions > 1; }), s);
  for (const Marked& c : all)
    if (!c.is_right()) s.failures.push_back(line_of(c));
  return s;
}

std::string to_json(const Score& s) {
  Json tier{{"cases", s.cases}, {"unanswered", s.unanswered}};
  for (const Mark& mark : s.marks) tier = to_json(mark, tier);
  Json rivals = Json::object();
  for (const RivalMark& rival : s.rivals) {
    Json one = to_json({"false_alarm", "", rival.false_alarm}, Json::object());
    rivals[rival.name] = to_json({"top1", "", rival.top1}, one);
  }
  tier["baselines"] = rivals;
  tier["failures"] = s.failures;
  return Json{{"schema", 1}, {s.tier, tier}}.dump(1) + "\n";
}

std::string to_text(const Score& s) {
  std::ostringstream out;
  out << s.tier << ": " << s.cases << " cases, " << s.unanswered << " without an answer\n";
  const auto print = [&](const std::string& words, const Rate& rate, bool is_share) {
    const double scale = is_share ? 100.0 : 1.0;
    out << "  " << words << std::string(words.size() < 68 ? 68 - words.size() : 1, ' ')
        << rounded(scale * rate.value) << (is_share ? " %" : "") << "  ("
        << rounded(scale * rate.lo) << " to " << rounded(scale * rate.hi) << ", " << rate.count
        << ")\n";
  };
  for (const Mark& mark : s.marks) print(mark.words, mark.rate, mark.is_share);
  for (const RivalMark& rival : s.rivals) {
    print(rival.name + ": false alarm", rival.false_alarm, true);
    print(rival.name + ": one cause named", rival.top1, true);
  }
  for (const std::string& failure : s.failures) out << "  wrong " << failure << "\n";
  return out.str();
}

}  // namespace grouser::diagnosis
