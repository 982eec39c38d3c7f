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

/// Rank 0 of a run on several ranks. It distributes the pings, simulates some of them, and stores and writes
/// the results of all ranks (docs/large-jobs.md).
class LeadRank {
 public:
  explicit LeadRank(std::unique_ptr<RankLink> link);
  /// Sends stop to the other ranks, and leaves together with them.
  ~LeadRank();
  LeadRank(const LeadRank&) = delete;
  LeadRank& operator=(const LeadRank&) = delete;

  int ranks() const { return link_->ranks(); }
  int local_ranks() const { return link_->local_ranks(); }
  /// Sends the run to the other ranks. `requested` must equal their own request. `run` contains the
  /// settings, which a tolerance may have chosen.
  void start(const nlohmann::ordered_json& requested, const nlohmann::ordered_json& run);
  /// Simulates all pings, as simulate() in run/simulation.hpp does, on all ranks. Throws the exception of
  /// any rank.
  /// `afterwards_s`: approximate duration of the work after the last ping.
  void simulate(const Survey& survey, const RunRequest& request, PingStore& store, bool quiet, int threads,
                double afterwards_s);

 private:
  void stop_all();
  bool all_over() const;
  /// Records the end of the sender's work if the message reports it.
  void note_end(const RankMessage& message);

  std::unique_ptr<RankLink> link_;
  std::vector<bool> over_;  ///< by rank
  std::optional<std::string> failure_;
  std::optional<std::chrono::steady_clock::time_point> stopped_;
};

/// Simulates the pings that rank 0 assigns to this rank. Prints nothing and writes nothing; rank 0 reports
/// all errors. Returns 0.
int help_run(const RunOptions& options, std::unique_ptr<RankLink> link);

}  // namespace tubefoot
