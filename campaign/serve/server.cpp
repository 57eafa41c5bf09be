// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/serve/server.hpp"

#include <fcntl.h>
#include <httplib.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "campaign/cli/answers.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/drive/driver.hpp"
#include "campaign/drive/lease_guard.hpp"
#include "campaign/serve/curves.hpp"
#include "campaign/serve/dashboard.hpp"
#include "campaign/serve/guard.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;
using httplib::Request;
using httplib::Response;

constexpr std::size_t kBodyMost = 64 << 10;
constexpr std::size_t kThreads = 24;
// Each holds a thread; the rest stay free for short questions.
constexpr int kStreamsMost = 16;
constexpr std::size_t kLogLines = 400;
constexpr std::size_t kSeriesRows = 800;
// Means of a campaign are computed anew no more often. [s]
constexpr double kPointsAge = 10.0;
constexpr const char* kViews[] = {"v_status",   "v_runs",  "v_axes",   "v_chunks",
                                  "v_attempts", "v_seams", "v_ledger", "v_losses"};

// The page may load its own script and style and ask this service; nothing else.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr const char* kReportPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

double now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// A request that is not served, with its HTTP code.
struct Refusal {
  int code;
  std::string why;
};

std::string param_of(const Request& request, const char* name) {
  return request.has_param(name) ? request.get_param_value(name) : "";
}

std::size_t number_of(const Request& request, const char* name, std::size_t otherwise) {
  const std::string text = param_of(request, name);
  if (text.empty()) return otherwise;
  if (text.size() > 9 ||
      !std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
    throw Refusal{400, std::string(name) + " must be a number"};
  return static_cast<std::size_t>(std::stoul(text));
}

RequestOrigin origin_of(const Request& request) {
  return {request.get_header_value("Host"), request.get_header_value("Origin"),
          request.get_header_value("Sec-Fetch-Site"), request.get_header_value("Authorization")};
}

void set_json(Response& response, const Json& json) {
  response.set_content(json_text(json), "application/json");
}

void set_error(Response& response, int code, const std::string& why) {
  response.status = code;
  set_json(response, Json{{"schema", 1}, {"error", why}});
}

RunRow run_of(const Store& store, const Request& request) {
  const std::string label = param_of(request, "run");
  for (const RunRow& run : store.runs())
    if (run.label == label) return run;
  throw Refusal{404, "no run is called so"};
}

// A listening socket is no business of the jobs that are started meanwhile; two services on one
// port would share the questions out between them.
void set_up_socket(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  ::fcntl(socket, F_SETFD, FD_CLOEXEC);
}

}  // namespace

struct Service::Impl {
  struct Campaign {
    std::string key;
    fs::path root;
    std::mutex points_mutex;
    Json points;
    double points_at = 0.0;
  };

  ServiceOptions options;
  Action action;
  std::vector<std::unique_ptr<Campaign>> campaigns;
  std::set<std::string> names;
  std::atomic<bool> is_stopping{false};
  std::atomic<int> streams{0};
  httplib::Server server;

  Campaign& campaign_of(const Request& request) {
    const std::string key = param_of(request, "campaign");
    for (const auto& one : campaigns)
      if (one->key == key || (key.empty() && campaigns.size() == 1)) return *one;
    throw Refusal{404, "no campaign is called so"};
  }

  void add(std::vector<fs::path> roots) {
    for (fs::path& root : roots) {
      auto& one = *campaigns.emplace_back(std::make_unique<Campaign>());
      const std::string name = root.filename().empty() ? root.parent_path().filename().string()
                                                       : root.filename().string();
      one.key = name;
      for (int i = 2; std::count_if(campaigns.begin(), campaigns.end(),
                                    [&](const auto& other) { return other->key == one.key; }) > 1;
           ++i)
        one.key = name + "-" + std::to_string(i);
      one.root = std::move(root);
    }
  }

  // What every request must satisfy before anything is looked at.
  httplib::Server::HandlerResponse admit(const Request& request, Response& response) {
    const RequestOrigin origin = origin_of(request);
    const bool is_read = request.method == "GET" || request.method == "HEAD";
    const bool is_page = request.path == "/" || request.path.rfind("/dashboard.", 0) == 0;
    const std::string why =
        is_read ? refusal_of_reading(origin, names) : refusal_of_writing(origin, names);
    if (!why.empty())
      set_error(response, 403, why);
    else if (!is_read && options.token.empty())
      set_error(response, 403, "the service is read-only: start it with --token-file");
    else if ((!is_read || (options.is_private && !is_page)) &&
             !carries_token(origin, options.token))
      set_error(response, 401, "the token is missing or wrong");
    else
      return httplib::Server::HandlerResponse::Unhandled;
    return httplib::Server::HandlerResponse::Handled;
  }

  // Our errors as answers.
  httplib::Server::Handler guarded(std::function<void(const Request&, Response&)> work) {
    return [work = std::move(work)](const Request& request, Response& response) {
      try {
        work(request, response);
      } catch (const Refusal& refusal) {
        set_error(response, refusal.code, refusal.why);
      } catch (const ConfigError& error) {
        set_error(response, 400, error.what());
      } catch (const CampaignBusy& error) {
        set_error(response, 409, error.what());
      } catch (const LeaseLost& error) {
        set_error(response, 409, error.what());
      } catch (const std::exception& error) {
        set_error(response, 500, error.what());
      }
    };
  }

  void get(const std::string& path, std::function<void(const Request&, Response&)> work) {
    server.Get(path, guarded(std::move(work)));
  }

  // With the campaign's database open for reading.
  void get_json(const std::string& path,
                std::function<Json(const Request&, const Store&, Campaign&)> work) {
    get(path, [this, work = std::move(work)](const Request& request, Response& response) {
      Campaign& campaign = campaign_of(request);
      const Store store = Store::open_read_only(campaign.root / Store::kFileName);
      set_json(response, work(request, store, campaign));
    });
  }

  Json list_campaigns() {
    Json all = Json::array();
    for (const auto& one : campaigns) {
      Json json{{"key", one->key}, {"root", one->root.string()}};
      try {
        const Store store = Store::open_read_only(one->root / Store::kFileName);
        const CampaignRow row = store.campaign();
        json["campaign"] = row.name;
        json["title"] = row.title;
        json["counts"] = counts_of(view_runs(store, one->root));
      } catch (const std::exception& error) {
        json["error"] = error.what();
      }
      all.push_back(json);
    }
    return Json{{"schema", 1}, {"may_write", !options.token.empty()}, {"campaigns", all}};
  }

  Json points_of(Campaign& campaign) {
    const std::lock_guard lock(campaign.points_mutex);
    const double time = now();
    if (campaign.points.is_null() || time - campaign.points_at > kPointsAge) {
      campaign.points = points_answer(campaign.root, time);
      campaign.points_at = time;
    }
    return campaign.points;
  }

  // One line of the stream: where the campaign is, small whatever its size.
  static Json heartbeat(const Store& store, const fs::path& root) {
    const auto views = view_runs(store, root);
    Json active = Json::array();
    for (const RunView& view : views)
      if (view.progress)
        active.push_back(Json{{"label", view.run.label},
                              {"phase", view.progress->phase},
                              {"time_s", view.time},
                              {"end_time_s", view.end_time > 0.0 ? Json(view.end_time) : Json()},
                              {"seconds_left", view.progress->seconds_left}});
    return Json{{"schema", 1},
                {"change", store.change_number()},
                {"counts", counts_of(views)},
                {"active", active}};
  }

  // Looks again and again; sends what is new, and a comment now and then, so that a reader that
  // went away is noticed.
  bool stream(const fs::path& root, std::string& last, double& sent_at, httplib::DataSink& sink) {
    const double begun = now();
    do {
      if (is_stopping || !sink.is_writable()) return false;
      std::string text;
      try {
        text = heartbeat(Store::open_read_only(root / Store::kFileName), root)
                   .dump(-1, ' ', false, Json::error_handler_t::replace);
      } catch (const std::exception&) {
        return false;
      }
      if (text != last || now() - sent_at > 15.0) {
        const std::string message =
            text != last ? "event: status\ndata: " + text + "\n\n" : ": still here\n\n";
        last = text;
        sent_at = now();
        return sink.write(message.data(), message.size());
      }
      const double until = now() + options.look_every;
      while (now() < until && !is_stopping)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    } while (now() - begun < 60.0);
    return true;
  }

  void start_stream(const Request& request, Response& response) {
    const fs::path root = campaign_of(request).root;
    if (++streams > kStreamsMost) {
      --streams;
      throw Refusal{503, "too many pages are watching"};
    }
    auto last = std::make_shared<std::string>();
    auto sent_at = std::make_shared<double>(0.0);
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, root, last, sent_at](std::size_t, httplib::DataSink& sink) {
          return stream(root, *last, *sent_at, sink);
        },
        [this](bool) { --streams; });
  }

  void send_report(const Request& request, Response& response) {
    const fs::path file = file_within(campaign_of(request).root, "report/report.html");
    const auto text = file.empty() ? std::nullopt : read_file(file);
    if (!text) throw Refusal{404, "there is no report yet: grouser report"};
    response.set_header("Content-Security-Policy", kReportPolicy);
    response.set_content(*text, "text/html; charset=utf-8");
  }

  void answer_readers() {
    const auto page = [this](const char* path, const char* text, const char* type) {
      get(path,
          [text, type](const Request&, Response& response) { response.set_content(text, type); });
    };
    page("/", kDashboardHtml, "text/html; charset=utf-8");
    page("/dashboard.js", kDashboardJs, "text/javascript; charset=utf-8");
    page("/dashboard.css", kDashboardCss, "text/css; charset=utf-8");
    get("/report", [this](const Request& q, Response& r) { send_report(q, r); });
    get("/api/campaigns", [this](const Request&, Response& r) { set_json(r, list_campaigns()); });
    get("/api/events", [this](const Request& q, Response& r) { start_stream(q, r); });
    get_json("/api/status", [](const Request&, const Store& store, Campaign& campaign) {
      return status_answer(store, campaign.root, look_at_runs(campaign.root, store, now(), false));
    });
    get_json("/api/show", [](const Request& request, const Store& store, Campaign&) {
      return show_answer(store, {run_of(store, request)});
    });
    get_json("/api/points", [this](const Request&, const Store&, Campaign& campaign) {
      return points_of(campaign);
    });
    get_json("/api/table", [](const Request& request, const Store& store, Campaign&) {
      const std::string name = param_of(request, "view");
      if (std::find(std::begin(kViews), std::end(kViews), name) == std::end(kViews))
        throw Refusal{404, "no view is called so"};
      const std::size_t limit = number_of(request, "limit", 2000);
      return query_answer(store.query("SELECT * FROM " + name + " LIMIT " +
                                      std::to_string(std::min<std::size_t>(limit, 100000))));
    });
    answer_about_files();
  }

  void answer_about_files() {
    get_json("/api/logs", [](const Request& request, const Store& store, Campaign& campaign) {
      const auto number = static_cast<std::int64_t>(number_of(request, "attempt", 0));
      const std::size_t lines = std::min<std::size_t>(number_of(request, "tail", kLogLines), 10000);
      const RunRow run = run_of(store, request);
      LogTail log = read_log(store, campaign.root, run, number, 0);
      const auto relative = fs::path(log.file).lexically_relative(campaign.root);
      if (log.is_there && file_within(campaign.root, relative).empty())
        throw Refusal{403, "the log is not a file of the campaign"};
      return logs_answer({read_log(store, campaign.root, run, number, lines)});
    });
    get_json("/api/series", [](const Request& request, const Store& store, Campaign& campaign) {
      const RunRow run = run_of(store, request);
      return series_answer(file_within(campaign.root, run.directory / run_files::kSeries),
                           kSeriesRows);
    });
  }

  void answer_writers() {
    for (const char* verb : {"tick", "stop", "resume", "cancel"})
      server.Post(std::string("/api/") + verb,
                  guarded([this, verb](const Request& request, Response& response) {
                    const fs::path root = campaign_of(request).root;
                    const std::string run = param_of(request, "run");
                    if (run.empty() && std::string(verb) != "tick")
                      throw Refusal{400, "name a run"};
                    set_json(response, Json{{"schema", 1}, {"done", action(root, verb, run)}});
                  }));
  }

  void set_up() {
    server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server.set_payload_max_length(kBodyMost);
    // A connection is for one question: one whose body was not read cannot be taken for the next.
    server.set_keep_alive_max_count(1);
    server.set_read_timeout(5);
    server.set_write_timeout(10);
    server.set_socket_options(set_up_socket);
    server.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                                {"Referrer-Policy", "no-referrer"},
                                {"Cross-Origin-Resource-Policy", "same-origin"},
                                {"Cache-Control", "no-store"}});
    server.set_pre_routing_handler(
        [this](const Request& request, Response& response) { return admit(request, response); });
    server.set_post_routing_handler([](const Request&, Response& response) {
      if (!response.has_header("Content-Security-Policy"))
        response.set_header("Content-Security-Policy", kPagePolicy);
    });
    server.set_error_handler([](const Request&, Response& response) {
      if (response.body.empty())
        set_error(response, response.status,
                  response.status == 404   ? "there is nothing here"
                  : response.status == 413 ? "the request is too large"
                                           : "the request cannot be read");
    });
    answer_readers();
    answer_writers();
  }
};

Service::Service(std::vector<fs::path> roots, ServiceOptions options, Action action)
    : impl_(std::make_unique<Impl>()) {
  impl_->names = own_names(options.address);
  impl_->options = std::move(options);
  impl_->action = std::move(action);
  impl_->add(std::move(roots));
  impl_->set_up();
}

Service::~Service() = default;

int Service::bind() {
  const ServiceOptions& options = impl_->options;
  const int port = options.port == 0 ? impl_->server.bind_to_any_port(options.address)
                   : impl_->server.bind_to_port(options.address, options.port) ? options.port
                                                                               : -1;
  if (port > 0) return port;
  throw ConfigError(
      {Problem{options.address, 0, 0, "port " + std::to_string(options.port),
               "cannot be listened at", "another program may have it: choose another --port"}});
}

void Service::run() { impl_->server.listen_after_bind(); }

void Service::stop() {
  impl_->is_stopping = true;
  impl_->server.stop();
}

}  // namespace grouser
