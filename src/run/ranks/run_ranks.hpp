// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "run/options.hpp"
#include "run/ranks/rank_link.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"

namespace tubefoot {

class PingStore;

/// Rank 0 of a run on several: it deals pings, simulates some itself, and keeps and writes what all found
/// (docs/cluster.md).
class LeadRank {
 public:
  explicit LeadRank(std::unique_ptr<RankLink> link);
  /// Lets the others go, and leaves with them.
  ~LeadRank();
  LeadRank(const LeadRank&) = delete;
  LeadRank& operator=(const LeadRank&) = delete;

  int ranks() const { return link_->ranks(); }
  int local_ranks() const { return link_->local_ranks(); }
  /// Tells the others what is run: as what they were asked must be, and the settings, which a tolerance may
  /// have chosen.
  void start(const nlohmann::ordered_json& requested, const nlohmann::ordered_json& run);
  /// As simulate() in run/simulation.hpp, on all ranks. Throws what any of them throws.
  /// `afterwards_s`: what is done after the last ping takes about so long.
  void simulate(const Survey& survey, const RunRequest& request, PingStore& store, bool quiet, int threads,
                double afterwards_s);

 private:
  void stop_all();
  bool all_over() const;
  /// Notes that the sender does no more, if that is what a message says.
  void note_end(const RankMessage& message);

  std::unique_ptr<RankLink> link_;
  std::vector<bool> over_;  ///< by rank
  std::optional<std::string> failure_;
  std::optional<std::chrono::steady_clock::time_point> stopped_;
};

/// A run's part on another rank: simulates what rank 0 deals, prints nothing, writes nothing. Errors are rank
/// 0's to report. Returns 0.
int help_run(const RunOptions& options, std::unique_ptr<RankLink> link);

}  // namespace tubefoot
