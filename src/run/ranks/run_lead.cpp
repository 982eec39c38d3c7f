// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "geometry/steps/stop.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/console/progress.hpp"
#include "run/ranks/ping_workers.hpp"
#include "run/ranks/rank_notes.hpp"
#include "run/ranks/run_ranks.hpp"
#include "run/simulation.hpp"

// This file implements rank 0 of a run on several ranks. It distributes pings on request, simulates pings
// itself, and stores all results.

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;

// mpirun kills the processes a second after its signal. The message about the checkpoint must be printed
// before.
constexpr std::chrono::milliseconds lead_patience_when_interrupted{500};
constexpr std::chrono::seconds patience{5};

/// The pings that no rank has yet, in order.
class Deal {
 public:
  Deal(const StoreLayout& layout, const PingStore& store) : order_(ping_order_of(layout)), store_(store) {
    left_ = layout.units() - store.done_units();
  }
  /// Returns at most `wanted` pings, and no more than a fair share of the remaining ones. No rank then has
  /// many left at the end.
  std::vector<PingUnit> next(std::size_t wanted, int ranks) {
    std::vector<PingUnit> units;
    const std::size_t most =
        std::min(wanted, std::max<std::size_t>(1, left_ / (2 * static_cast<std::size_t>(ranks))));
    for (; place_ < order_.size(); ++place_) {
      const auto [group, ping] = order_[place_];
      if (store_.done(group, ping)) continue;
      if (units.size() == most) return units;
      units.push_back({group, ping});
      --left_;
    }
    return units;
  }

 private:
  PingOrder order_;
  const PingStore& store_;
  std::size_t place_ = 0, left_ = 0;
};

}  // namespace

LeadRank::LeadRank(std::unique_ptr<RankLink> link)
    : link_(std::move(link)), over_(static_cast<std::size_t>(link_->ranks()), false) {
  over_[0] = true;
}

LeadRank::~LeadRank() {
  stop_all();
  while (!all_over()) {
    if (Clock::now() - *stopped_ > patience) return;  // does not wait for a rank that died
    // An interrupted mpirun lets no rank leave in order, and kills ranks that wait. The message about the
    // checkpoint therefore comes first.
    if (stop_wanted()) return;
    while (const std::optional<RankMessage> message = link_->receive()) note_end(*message);
    std::this_thread::sleep_for(link_->pause());
  }
  if (!stop_wanted()) link_->leave();
}

void LeadRank::start(const nlohmann::ordered_json& requested, const nlohmann::ordered_json& run) {
  const std::string text =
      note(Note::start, nlohmann::ordered_json{{"asked", requested}, {"run", run}}.dump());
  for (int rank = 1; rank < ranks(); ++rank) link_->send(rank, text);
}

void LeadRank::stop_all() {
  if (stopped_) return;
  stopped_ = Clock::now();
  for (int rank = 1; rank < ranks(); ++rank) link_->send(rank, note(Note::stop));
}

bool LeadRank::all_over() const { return std::find(over_.begin(), over_.end(), false) == over_.end(); }

void LeadRank::note_end(const RankMessage& message) {
  const Note kind = note_of(message.bytes);
  if (kind == Note::failed && !failure_) failure_ = message.bytes;
  if (kind == Note::interrupted) stop_requested = true;
  if (kind == Note::failed || kind == Note::interrupted || kind == Note::done)
    over_[static_cast<std::size_t>(message.from)] = true;
}

void LeadRank::simulate(const Survey& survey, const RunRequest& request, PingStore& store, bool quiet,
                        int threads, double afterwards_s) {
  const StoreLayout layout = layout_of(survey, request);
  const PingSimulation simulation(survey, request);
  Deal deal(layout, store);
  Progress progress("pings", layout.units() - store.done_units(), quiet, afterwards_s);
  PingBufferPool spare;
  PingWorkers workers(threads, [&](const PingUnit& unit) {
    simulation.run_into(store, unit, spare);
    progress.step();
  });
  while (!workers.finished() || !all_over()) {
    // Handles a limited number of messages per turn. Its own threads and requests to stop then have their
    // turn for any number of ranks.
    int received = 0;
    for (; received < ranks(); ++received) {
      const std::optional<RankMessage> message = link_->receive();
      if (!message) break;
      const Note kind = note_of(message->bytes);
      if (kind == Note::wanted && !stopped_)
        link_->send(message->from, pings_note(deal.next(count_in(message->bytes), ranks())));
      else if (kind == Note::result && take_result(message->bytes, layout, store))
        progress.step();
      note_end(*message);
    }
    if (!stopped_ && (stop_wanted() || failure_ || workers.failed())) {
      workers.stop();
      stop_all();
    }
    if (const std::size_t wanted = workers.wanted(); wanted > 0) {
      const std::vector<PingUnit> units = deal.next(wanted, ranks());
      if (units.empty()) workers.close();
      workers.add(units);
    }
    if (stopped_ && Clock::now() - *stopped_ > lead_patience_when_interrupted) break;
    if (received < ranks()) workers.rest(link_->pause());
  }
  workers.join();
  if (failure_) rethrow(*failure_);
}

}  // namespace tubefoot
