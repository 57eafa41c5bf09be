// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "base/atomic_file.hpp"
#include "campaign/plan/campaign_file.hpp"
#include "campaign/report/settings.hpp"
#include "campaign/store/store.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

std::string page(const char* name) {
  return read_file(std::filesystem::path(GROUSER_SOURCE_DIR) / "docs" / "reference" / name)
      .value_or("");
}

TEST(Reference, CampaignPageHoldsTheTablesOfTheProgram) {
  EXPECT_NE(page("campaign_yaml.md").find(campaign_reference() + "\n" + report_reference()),
            std::string::npos)
      << "put the output of `grouser schema` into docs/reference/campaign_yaml.md";
}

TEST(Reference, EveryColumnOfEveryViewIsExplained) {
  TemporaryDirectory directory;
  const Store store = Store::open(directory.path() / Store::kFileName);
  const std::string text = page("sql_views.md");
  for (const char* view : {"v_status", "v_runs", "v_axes", "v_chunks", "v_attempts", "v_seams",
                           "v_ledger", "v_losses"}) {
    const auto from = text.find("## " + std::string(view));
    ASSERT_NE(from, std::string::npos) << view;
    const std::string section = text.substr(from, text.find("\n## ", from) - from);
    for (const std::string& column : store.query("SELECT * FROM " + std::string(view)).columns)
      EXPECT_NE(section.find("`" + column + "`"), std::string::npos) << view << "." << column;
  }
}

TEST(Reference, EveryReadyQueryCanBeAsked) {
  TemporaryDirectory directory;
  const Store store = Store::open(directory.path() / Store::kFileName);
  const std::string text = page("sql_views.md");
  const std::string mark = "```sql\n";
  int queries = 0;
  for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
    const auto from = at + mark.size();
    const std::string query = text.substr(from, text.find("```", from) - from);
    EXPECT_NO_THROW(store.query(query)) << query;
    ++queries;
  }
  EXPECT_GE(queries, 12);
}

}  // namespace
}  // namespace grouser
