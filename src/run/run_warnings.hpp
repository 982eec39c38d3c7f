// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "run/no_return.hpp"
#include "run/simulation.hpp"

namespace tubefoot {

/// What a run warns of, each thing once, and told as soon as it is known.
class RunWarnings {
 public:
  using Tell = std::function<void(const std::string& warning, bool is_silence)>;
  explicit RunWarnings(Tell tell) : tell_(std::move(tell)) {}

  /// Of the scene, before a ping is computed: what loading it found, range windows, sensors that will receive
  /// nothing. Where a transmission's ground is made for it that is left for look_back(): one more ping takes
  /// longer than knowing it is worth.
  void foresee(const Survey& survey, const RunRequest& request);
  /// Of all pings: what rays did not reach, and sensors that received nothing.
  void look_back(const Survey& survey, const RunRequest& request, const SimulationStats& stats,
                 const std::vector<Recording>& recordings);
  void add(const std::vector<std::string>& warnings);
  /// Of what was told before.
  void keep(const std::vector<std::string>& warnings);

  /// In the order in which they came.
  const std::vector<std::string>& all() const { return all_; }

 private:
  void add(const std::vector<NoReturn>& no_returns);

  Tell tell_;
  std::vector<std::string> all_;
  std::vector<std::size_t> silent_;  ///< sensors that were told to receive nothing
};

}  // namespace tubefoot
