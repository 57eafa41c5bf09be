// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/serve/serve.hpp"

#include <iostream>
#include <memory>
#include <mutex>
#include <sstream>
#include <thread>

#include "campaign/cli/exit_codes.hpp"
#include "campaign/cli/find.hpp"
#include "campaign/cli/interrupt.hpp"
#include "campaign/cli/wish.hpp"
#include "campaign/drive/lease_guard.hpp"
#include "campaign/serve/guard.hpp"
#include "campaign/serve/server.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

// How long another manager that is at work is waited for. [s]
constexpr double kLeasePatience = 5.0;
constexpr double kLook = 0.2;

struct Options {
  std::vector<std::string> campaigns;
  std::string address = "127.0.0.1";
  int port = 8642;
  std::string token_file;
  bool tick = false;
  DriveOptions drive;
};

Wish wish_of(const std::string& verb) {
  return verb == "stop" ? Wish::kStop : verb == "cancel" ? Wish::kCancel : Wish::kResume;
}

/// Everything in this process that changes a campaign: one at a time, because the lease tells
/// processes apart and no threads.
class Hand {
 public:
  explicit Hand(const Options& options) : options_(options) {}

  std::string act(const fs::path& root, const std::string& verb, const std::string& run) {
    const std::lock_guard lock(mutex_);
    OpenCampaign campaign(root);
    std::ostringstream done;
    if (verb != "tick") {
      WishOptions wish;
      wish.runs = {run};
      wish.drive = options_.drive;
      write_wishes(campaign, wish, wish_of(verb), "asked to " + verb, done);
    }
    for (const std::string& message : campaign.tick(options_.drive, kLeasePatience).messages)
      done << message << "\n";
    return done.str();
  }

  // @return seconds until the next
  double tick(const fs::path& root) {
    const std::lock_guard lock(mutex_);
    try {
      OpenCampaign campaign(root);
      for (const std::string& message : campaign.tick(options_.drive, 0.0).messages)
        std::cout << root.filename().string() << ": " << message << std::endl;
      return campaign.interval(options_.drive);
    } catch (const std::exception& error) {
      // The next tick may find it mended: a full disk, another manager, a lost mount.
      std::cout << root.filename().string() << ": " << error.what() << std::endl;
      return 60.0;
    }
  }

 private:
  const Options& options_;
  std::mutex mutex_;
};

void tick_until_interrupted(Hand& hand, const std::vector<fs::path>& roots, Clock& clock) {
  std::vector<double> due(roots.size(), 0.0);
  while (!InterruptGuard::is_interrupted()) {
    for (std::size_t i = 0; i < roots.size(); ++i)
      if (clock.now() >= due[i]) {
        const double pause = hand.tick(roots[i]);
        due[i] = clock.now() + pause;
      }
    clock.sleep(kLook);
  }
}

int serve(const Options& options) {
  const auto roots = find_roots(options.campaigns);
  ServiceOptions service_options;
  service_options.address = options.address;
  service_options.port = options.port;
  if (!options.token_file.empty()) service_options.token = token_of(options.token_file);
  service_options.is_private = !is_loopback(options.address);
  if (service_options.is_private && service_options.token.empty())
    throw ConfigError({Problem{options.address, 0, 0, "", "others can reach this address",
                               "say --token-file FILE: it is then needed for reading too"}});
  Hand hand(options);
  Service service(roots, service_options,
                  [&](const fs::path& root, const std::string& verb, const std::string& run) {
                    return hand.act(root, verb, run);
                  });
  const int port = service.bind();
  const std::string host = options.address.find(':') == std::string::npos
                               ? options.address
                               : "[" + options.address + "]";
  std::cout << "http://" << host << ":" << port << "/"
            << (options.token_file.empty()
                    ? "  (read-only)"
                    : "#token=TOKEN  with the token in " + options.token_file)
            << std::endl;
  const InterruptGuard guard;
  std::thread answering([&] { service.run(); });
  SystemClock clock;
  if (options.tick)
    tick_until_interrupted(hand, roots, clock);
  else
    while (!InterruptGuard::is_interrupted()) clock.sleep(kLook);
  service.stop();
  answering.join();
  return exit_codes::kOk;
}

}  // namespace

void add_serve(CLI::App& app, int& code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("serve", "a page and JSON over HTTP about campaigns; may tick them too");
  verb->add_option("campaigns", options->campaigns,
                   "roots, names or YAMLs; without any, all below ./runs");
  verb->add_option("--address", options->address,
                   "where to listen; any but a loopback address needs a token")
      ->capture_default_str();
  verb->add_option("--port", options->port, "0 = any that is free")
      ->capture_default_str()
      ->check(CLI::Range(0, 65535));
  verb->add_option("--token-file", options->token_file,
                   "allows changes to those who have the token in it; made when there is none");
  verb->add_flag("--tick", options->tick, "also carries the campaigns on, as tick does");
  add_drive_options(*verb, options->drive);
  verb->callback([options, &code] { code = serve(*options); });
}

}  // namespace grouser
