// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/page.hpp"

#include "campaign/report/html.hpp"
#include "campaign/report/sections.hpp"
#include "campaign/report/style.hpp"
#include "campaign/report/words.hpp"

namespace grouser {
namespace {

std::string head(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
         "<meta name=\"color-scheme\" content=\"light dark\"/>\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
         "'unsafe-inline'; img-src data:\"/>\n"
         "<link rel=\"icon\" href=\"data:,\"/>\n<title>" +
         escape_html(title) + "</title>\n<style>\n" + kPageStyle + "</style>\n</head>\n";
}

std::string heading(const ReportData& data, const Analysis& analysis, const std::string& title) {
  std::string text =
      "<header class=\"page\">\n<p class=\"eyebrow\">Campaign " + escape_html(data.name) + " · " +
      escape_html(data.made_at) + "</p>\n<h1>" + escape_html(title) + "</h1>\n<p class=\"lede\">" +
      escape_html(progress_in_words(data) + " " + result_in_words(data, analysis, "lab")) +
      "</p>\n";
  const std::string published = result_in_words(data, analysis, "paper_dem");
  if (!published.empty()) text += "<p class=\"lede\">" + escape_html(published) + "</p>\n";
  const std::string drift = drift_in_words(analysis);
  if (!drift.empty()) text += "<p class=\"caution\">" + escape_html(drift) + "</p>\n";
  for (const std::string& warning : data.warnings)
    text += "<p class=\"warning\">" + escape_html(warning) + "</p>\n";
  return text + "</header>\n";
}

/// Links to the sections that exist.
std::string navigation(const std::string& body) {
  static constexpr const char* kLinks[][2] = {{"curves", "Curves"},
                                              {"comparison", "Comparison"},
                                              {"points", "Means"},
                                              {"pictures", "Pictures"},
                                              {"runs", "Runs"},
                                              {"tracks", "Tracked grains"},
                                              {"neglected", "Neglected"},
                                              {"recordings", "Recordings"},
                                              {"parameters", "Parameters"},
                                              {"ledger", "Ledger"},
                                              {"provenance", "Provenance"}};
  std::string links;
  for (const auto& [id, name] : kLinks)
    if (body.find(std::string("<section id=\"") + id + "\"") != std::string::npos)
      links += std::string("<a href=\"#") + id + "\">" + name + "</a>\n";
  return "<nav aria-label=\"Sections\">\n" + links + "</nav>\n";
}

}  // namespace

std::string report_html(const ReportData& data, const Analysis& analysis) {
  const std::string title = data.title.empty() ? data.name : data.title;
  const std::string body = curves_section(data, analysis) + comparison_section(data, analysis) +
                           points_section(data, analysis) + pictures_section(data, analysis) +
                           runs_section(data, analysis) + tracks_section(data) +
                           neglected_section(data) + recordings_section(data) +
                           parameters_section(data) + ledger_section(data) +
                           provenance_section(data);
  return head(title) + "<body>\n" + heading(data, analysis, title) + navigation(body) + "<main>\n" +
         body + "</main>\n</body>\n</html>\n";
}

}  // namespace grouser
