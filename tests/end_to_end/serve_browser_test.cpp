// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "campaign_run.hpp"
#include "serving.hpp"
#include "tests/support/browser.hpp"

namespace grouser {
namespace {

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++count;
  return count;
}

class DashboardInBrowser : public CampaignRun {
 protected:
  DashboardInBrowser() { variables["FAKE_STEP_MICROSECONDS"] = "0"; }

  static std::string dom_of(const Serving& service, const std::string& rest, std::string& errors) {
    const Browser browser;
    return browser.open("--virtual-time-budget=5000 --dump-dom",
                        "http://127.0.0.1:" + std::to_string(service.port()) + "/" + rest, errors);
  }
};

TEST_F(DashboardInBrowser, ShowsRunsSlipPullJobsLedgerAndLogLive) {
  ASSERT_EQ(submit().code, 0);
  const Serving service(directory_.path(), {});
  std::string errors;
  const std::string dom = dom_of(service, "?run=slip_20", errors);
  EXPECT_EQ(errors.find("CONSOLE"), std::string::npos) << errors;
  EXPECT_NE(dom.find("data-loaded=\"yes\""), std::string::npos) << dom;
  EXPECT_NE(dom.find("data-beats=\""), std::string::npos) << "nothing came over the event stream";
  EXPECT_EQ(count_of(dom, "data-run="), 4u);
  EXPECT_EQ(count_of(dom, "data-point="), 3u) << "each wheel run on the slip axis";
  EXPECT_NE(dom.find("data-rows="), std::string::npos) << "the pull curve";
  EXPECT_GE(count_of(dom, "<rect class=\"done\""), 1u + 3u * 3u) << "each job in the timeline";
  EXPECT_NE(dom.find("id=\"goodput\""), std::string::npos);
  EXPECT_TRUE(std::regex_search(dom, std::regex("<pre id=\"log\">")));
  EXPECT_NE(dom.find("id=\"actions\" hidden"), std::string::npos)
      << "nothing to change without a token";
}

// A label is the one text of a person's that the page shows; titles come from the YAML.
TEST_F(DashboardInBrowser, ShowsTextsAsTheyAreAndRunsNone) {
  write_campaign("title: \"<img src=x onerror=document.title='owned'><script>1</script>\"\n");
  ASSERT_EQ(submit().code, 0);
  const Serving service(directory_.path(), {});
  std::string errors;
  const std::string dom = dom_of(service, "", errors);
  EXPECT_NE(dom.find("&lt;img src=x"), std::string::npos) << dom;
  EXPECT_EQ(dom.find("<img"), std::string::npos);
  EXPECT_EQ(dom.find("owned</title>"), std::string::npos);
  EXPECT_EQ(errors.find("CONSOLE"), std::string::npos) << errors;
}

}  // namespace
}  // namespace grouser
