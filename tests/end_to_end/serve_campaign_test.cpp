// SPDX-License-Identifier: BSD-3-Clause
#include <httplib.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/atomic_file.hpp"
#include "base/run_contract.hpp"
#include "campaign_run.hpp"
#include "schedulers/scripts.hpp"
#include "serving.hpp"

namespace grouser {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class ServedCampaign : public CampaignRun {
 protected:
  ServedCampaign() { variables["FAKE_STEP_MICROSECONDS"] = "0"; }

  static int code_of(int port, const std::string& path, const httplib::Headers& headers = {}) {
    const auto answer = httplib::Client("127.0.0.1", port).Get(path, headers);
    return answer ? answer->status : 0;
  }
  static Json json_of(int port, const std::string& path) {
    const auto answer = httplib::Client("127.0.0.1", port).Get(path);
    EXPECT_TRUE(answer && answer->status == 200) << path;
    return answer ? Json::parse(answer->body) : Json();
  }
  static int post(int port, const std::string& path, const httplib::Headers& headers) {
    const auto answer = httplib::Client("127.0.0.1", port).Post(path, headers, "", "text/plain");
    return answer ? answer->status : 0;
  }
  Json printed(const std::vector<std::string>& words) const {
    return Json::parse(grouser(words).out);
  }
};

TEST_F(ServedCampaign, AnswersWithTheSchemasOfTheCommandLine) {
  ASSERT_EQ(submit().code, 0);
  const Serving service(directory_.path(), {});
  const int port = service.port();
  EXPECT_EQ(json_of(port, "/api/status"), printed({"status", "--json"}));
  EXPECT_EQ(json_of(port, "/api/show?run=towed"), printed({"show", "--json", "towed"}));
  EXPECT_EQ(json_of(port, "/api/logs?run=towed&tail=5"),
            printed({"logs", "--json", "--tail", "5", "towed"}));
  EXPECT_EQ(json_of(port, "/api/table?view=v_ledger"),
            printed({"query", "--json", "SELECT * FROM v_ledger"}));
  const Json series = json_of(port, "/api/series?run=towed");
  EXPECT_EQ(series["columns"]["time_s"].size(), series["columns"]["pull"].size());
  EXPECT_GT(series["rows"], 10);
  EXPECT_EQ(json_of(port, "/api/points")["points"].size(), 3u);
}

TEST_F(ServedCampaign, ChangesNothingWithoutATokenNorForAnotherPage) {
  ASSERT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const httplib::Headers none;
  {
    const Serving service(directory_.path(), {});
    EXPECT_EQ(post(service.port(), "/api/tick", {{"Authorization", "Bearer "}}), 403);
  }
  const Serving service(directory_.path(), {"--token-file", "token"});
  const int port = service.port();
  const fs::path file = directory_.path() / "token";
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  std::string token = read_file(file).value();
  token.pop_back();
  const std::pair<std::string, std::string> right{"Authorization", "Bearer " + token};
  EXPECT_EQ(post(port, "/api/tick", none), 401);
  EXPECT_EQ(post(port, "/api/tick", {{"Authorization", "Bearer " + token + "x"}}), 401);
  EXPECT_EQ(post(port, "/api/tick", {right, {"Origin", "http://elsewhere.example"}}), 403);
  EXPECT_EQ(post(port, "/api/tick", {right, {"Sec-Fetch-Site", "cross-site"}}), 403);
  EXPECT_EQ(post(port, "/api/tick", {right, {"Host", "elsewhere.example"}}), 403);
  EXPECT_EQ(code_of(port, "/api/status", {{"Host", "elsewhere.example"}}), 403)
      << "a name that was made to point here";
  EXPECT_EQ(post(port, "/api/stop", {right}), 400) << "no run is named";
  EXPECT_EQ(post(port, "/api/tick", {right}), 200);
  EXPECT_EQ(
      post(port, "/api/tick", {right, {"Origin", "http://127.0.0.1:" + std::to_string(port)}}),
      200);
}

TEST_F(ServedCampaign, BoundsWhatItIsSent) {
  ASSERT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const Serving service(directory_.path(), {"--token-file", "token"});
  std::string token = read_file(directory_.path() / "token").value();
  token.pop_back();
  httplib::Client client("127.0.0.1", service.port());
  const auto large = client.Post("/api/tick", {{"Authorization", "Bearer " + token}},
                                 std::string(1 << 20, 'x'), "text/plain");
  EXPECT_TRUE(!large || large->status == 413);
  const int long_address = code_of(service.port(), "/api/show?run=" + std::string(20000, 'x'));
  EXPECT_TRUE(long_address == 414 || long_address == 0) << long_address;
  EXPECT_EQ(code_of(service.port(), "/api/logs?run=towed&tail=99999999999"), 400);
  EXPECT_EQ(code_of(service.port(), "/api/status"), 200) << "and goes on serving";
}

TEST_F(ServedCampaign, ServesNoFileThatIsNotTheCampaigns) {
  ASSERT_EQ(submit().code, 0);
  const Serving service(directory_.path(), {});
  const int port = service.port();
  for (const char* path : {"/../campaign.yaml", "/%2e%2e/campaign.yaml", "/grouser.db",
                           "/api/../../campaign.yaml", "/report/../grouser.db", "//etc/passwd"})
    EXPECT_EQ(code_of(port, path), 404) << path;
  EXPECT_EQ(code_of(port, "/api/show?run=..%2F..%2Fcampaign"), 404);
  EXPECT_EQ(code_of(port, "/api/table?view=run"), 404) << "views only";
  EXPECT_EQ(code_of(port, "/api/table?view=v_runs%3B%20DROP%20TABLE%20run"), 404);
  EXPECT_EQ(code_of(port, "/api/status?campaign=..%2F.."), 404);
  // A link that leads out, planted where a file of the run is looked for.
  write_atomic(directory_.path() / "secret", "secret\n");
  const RunRow towed = run("towed");
  const Store store = Store::open_read_only(root() / Store::kFileName);
  for (const std::string& name : {attempt_files::log(store.attempts(towed.id).back().token),
                                  std::string(run_files::kSeries)}) {
    fs::remove(root() / towed.directory / name);
    fs::create_symlink(directory_.path() / "secret", root() / towed.directory / name);
  }
  EXPECT_EQ(code_of(port, "/api/logs?run=towed"), 403);
  EXPECT_EQ(json_of(port, "/api/series?run=towed")["rows"], 0);
}

TEST_F(ServedCampaign, IsTheServiceThatCarriesItOnAndTellsOfItAtOnce) {
  ASSERT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const Serving service(directory_.path(), {"--tick", "--every", "0.2"});
  std::string heard;
  httplib::Client client("127.0.0.1", service.port());
  client.set_read_timeout(60);
  const auto begun = std::chrono::steady_clock::now();
  client.Get("/api/events", [&](const char* data, std::size_t size) {
    heard.append(data, size);
    return std::chrono::steady_clock::now() - begun < std::chrono::minutes(4) &&
           heard.find(R"("counts":{"COMPLETED":4})") == std::string::npos;
  });
  EXPECT_NE(heard.find(R"("counts":{"COMPLETED":4})"), std::string::npos) << heard;
  EXPECT_EQ(heard.rfind("event: status\ndata: {\"schema\":1,", 0), 0u) << heard;
  expect_undisturbed_result();
}

TEST_F(ServedCampaign, EndsInOrderWhileAPageIsWatching) {
  ASSERT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  Serving service(directory_.path(), {});
  httplib::Client client("127.0.0.1", service.port());
  client.set_read_timeout(30);
  int code = -1;
  client.Get("/api/events", [&](const char*, std::size_t) {
    code = service.stop();
    return false;
  });
  EXPECT_EQ(code, 0);
}

TEST_F(ServedCampaign, ListensBeyondThisMachineOnlyWithAToken) {
  ASSERT_EQ(grouser({"submit", "campaign.yaml", "--detach"}).code, 0);
  const auto refused = grouser({"serve", "--address", "0.0.0.0", "--port", "0"});
  EXPECT_EQ(refused.code, 20);
  EXPECT_NE(refused.err.find("say --token-file FILE"), std::string::npos) << refused.err;
  write_atomic(directory_.path() / "open", "0123456789abcdef0123456789abcdef\n");
  fs::permissions(directory_.path() / "open", fs::perms(0644));
  EXPECT_EQ(grouser({"serve", "--token-file", "open", "--port", "0"}).code, 20);
}

}  // namespace
}  // namespace grouser
