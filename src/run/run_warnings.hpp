// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "run/no_return.hpp"
#include "run/simulation.hpp"

namespace tubefoot {

/// The warnings of a run. Each warning is reported once, as soon as it is known.
class RunWarnings {
 public:
  using Tell = std::function<void(const std::string& warning, bool is_silence)>;
  explicit RunWarnings(Tell tell) : tell_(std::move(tell)) {}

  /// Adds the warnings about the scene before any ping is computed: results of loading, range gates, and
  /// sensors that receive nothing. If each transmission has a surface of its own, or terrain is read by
  /// tiles, look_back() reports the last kind instead. An additional ping would then cost more time than an
  /// early warning is worth.
  void foresee(const Survey& survey, const RunRequest& request);
  /// Adds the warnings about all pings: facets that rays did not reach, and sensors that received nothing.
  void look_back(const Survey& survey, const RunRequest& request, const SimulationStats& stats,
                 const std::vector<Recording>& recordings);
  void add(const std::vector<std::string>& warnings);
  /// Records warnings that were reported before.
  void keep(const std::vector<std::string>& warnings);

  /// Returns all warnings in the order in which they occurred.
  const std::vector<std::string>& all() const { return all_; }

 private:
  void add(const std::vector<NoReturn>& no_returns);

  Tell tell_;
  std::vector<std::string> all_;
  std::vector<std::size_t> silent_;  ///< sensors that a warning already reports as receiving nothing
};

}  // namespace tubefoot
