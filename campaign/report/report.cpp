// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/report/report.hpp"

#include <chrono>
#include <system_error>

#include "base/atomic_file.hpp"
#include "campaign/report/analysis.hpp"
#include "campaign/report/collect.hpp"
#include "campaign/report/page.hpp"
#include "campaign/report/tables.hpp"

namespace grouser {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

std::filesystem::path write_report(const ReportRequest& request) {
  const ReportData data = collect_report(request.campaign_root, seconds_now());
  const Analysis analysis = analyse(data);
  const std::filesystem::path folder = request.campaign_root / "report";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw StorageError(folder.string() + ": cannot be made: " + error.message());
  write_atomic(folder / "results.csv", results_csv(data, analysis));
  write_atomic(folder / "means.csv", means_csv(analysis));
  write_atomic(folder / "compare.csv", compare_csv(data, analysis));
  write_atomic(folder / "report.html", report_html(data, analysis));
  return folder / "report.html";
}

std::string summary_table(const ReportRequest& request) {
  const ReportData data = collect_report(request.campaign_root, seconds_now());
  return summary_text(data, analyse(data));
}

void check_report(const YamlNode& report, const std::filesystem::path& directory,
                  std::vector<Problem>& problems) {
  const ReportSettings settings = read_report_settings(report, problems);
  read_recordings(report, settings, directory, problems);
  read_recorded_series(settings, directory, problems);
}

}  // namespace grouser
