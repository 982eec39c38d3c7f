// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/checkpoint/build_identity.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/ranks/ping_workers.hpp"
#include "run/ranks/rank_notes.hpp"
#include "run/ranks/run_ranks.hpp"
#include "run/ranks/send_queue.hpp"
#include "run/run_steps.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"

// This file implements all ranks except rank 0. Such a rank requests pings from rank 0, simulates them, and
// sends the packed results back.

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

// After this time, rank 0 no longer exists.
constexpr std::chrono::seconds helper_patience_when_interrupted{2};

// Limit of bytes of results that wait for rank 0.
constexpr std::size_t most_unsent = std::size_t{8} << 20;

/// Removes the limit of the queue on every exit, because the destructor of the workers waits for their
/// threads.
struct OpenedAtExit {
  SendQueue& send_queue;
  ~OpenedAtExit() { send_queue.open(); }
};

class HelpingRank {
 public:
  explicit HelpingRank(RankLink& link) : link_(link) {}

  void work(const RunOptions& options) {
    SceneDescription description = described(options);
    RunRequest request = requested(options, description);
    const Json scene_request = request_json(description, request);
    std::optional<std::string> start;
    while (!start && !over())
      if (const auto message = next())
        start = message->substr(1);
      else
        std::this_thread::sleep_for(link_.pause());
    if (!start) return;
    const Json told = Json::parse(*start);
    const Json lead_build = told.at("asked").value("build", Json());
    if (lead_build != scene_request.at("build"))
      throw UsageError(fmt::format(
          "rank {} on '{}' uses a different build of tubefoot than rank 0 (rank 0: {}): install the same "
          "build on all machines; 'tubefoot --version' identifies a build",
          link_.rank(), link_.host(), difference_of_builds(lead_build, scene_request.at("build"))));
    if (told.at("asked") != scene_request)
      throw UsageError(
          fmt::format("rank {} on '{}' has a different command or scene than rank 0: all ranks need the same "
                      "command and the same files",
                      link_.rank(), link_.host()));
    request = request_of(told.at("run"), std::move(request));
    const ThreadLimit limit(description.run.threads > 0 ? description.run.threads
                                                        : threads_of_rank(link_.local_ranks()));
    const auto survey = open_survey(description, facets_for(request), request.coarseness);
    simulate(*survey, request, limit.threads());
  }

  /// Sends the last message, and leaves together with rank 0.
  void leave(const std::string& last) {
    link_.send(0, last);
    std::optional<Clock::time_point> stop_seen;
    while (!stopped_) {
      next();
      if (!stop_seen && stop_wanted()) stop_seen = Clock::now();
      if (stop_seen && Clock::now() - *stop_seen > helper_patience_when_interrupted) return;
      std::this_thread::sleep_for(link_.pause());
    }
    link_.leave();
  }

  bool was_told_to_stop() const { return stopped_; }

 private:
  bool over() const { return stopped_ || stop_wanted(); }

  /// Returns a message, except the one that requests a stop.
  std::optional<std::string> next() {
    std::optional<RankMessage> message = link_.receive();
    if (!message) return std::nullopt;
    if (note_of(message->bytes) != Note::stop) return std::move(message->bytes);
    stopped_ = true;
    return std::nullopt;
  }

  void simulate(const Survey& survey, const RunRequest& request, int threads) {
    const StoreLayout layout = layout_of(survey, request);
    const PingSimulation simulation(survey, request);
    PingBufferPool spare;
    SendQueue send_queue(most_unsent);
    PingWorkers workers(threads, [&](const PingUnit& unit) {
      send_queue.put(spare.with([&](PingValues& values) {
        const PingCounts counts = simulation.run(unit, values);
        return result_note(layout, unit, counts, values);
      }));
    });
    const OpenedAtExit opened{send_queue};
    bool has_requested = false;
    for (bool last = false; !last;) {
      last = workers.finished();  // must precede the handling of the results
      while (const auto message = next()) {
        const std::vector<PingUnit> units = units_in(*message);
        if (units.empty()) workers.close();
        workers.add(units);
        has_requested = false;
      }
      if (stopped_) stop_requested = true;  // also stops the pings in progress, whose results no rank needs
      if (over()) {
        workers.stop();
        send_queue.open();
      }
      for (std::string& result : send_queue.take(link_.unsent())) link_.send(0, std::move(result));
      if (const std::size_t wanted = workers.wanted(); wanted > 0 && !has_requested) {
        link_.send(0, wanted_note(wanted));
        has_requested = true;
      }
      if (!last) workers.rest(link_.pause());
    }
    workers.join();
  }

  RankLink& link_;
  bool stopped_ = false;
};

}  // namespace

int help_run(const RunOptions& options, std::unique_ptr<RankLink> link) {
  HelpingRank rank(*link);
  std::string last;
  try {
    rank.work(options);
    last = note(stop_wanted() && !rank.was_told_to_stop() ? Note::interrupted : Note::done);
  } catch (const Interrupted&) {
    last = note(Note::interrupted);
  } catch (const std::exception& error) {
    last = failed_note(error);
  }
  rank.leave(last);
  return 0;
}

}  // namespace tubefoot
