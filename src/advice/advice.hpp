// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "advice/trials.hpp"
#include "run/run_request.hpp"
#include "study/tolerance.hpp"

// Which engine and settings a tolerance needs: measured on a few pings, docs/advise.md.
namespace tubefoot {

struct AdviceOptions {
  std::string pings = ":";      ///< of each sensor, as resolved() reads them: trial pings are among these
  std::size_t trial_pings = 8;  ///< probe pings of each sensor, and as many others to measure; at least 2
  bool measure = true;          ///< measure on other pings what the probe pings predict
  double largest_cost = 3;      ///< rays that take longer than this many exact tube runs are not tried
  std::uint64_t seed = 1;       ///< of the rays
  /// Of rays, to try.
  std::vector<RaySampling> samplings{RaySampling::stratified, RaySampling::sobol, RaySampling::adaptive,
                                     RaySampling::regular, RaySampling::column};
  bool quiet = false;
};

/// One way to compute the scene, and what is known about it. Seconds are the processor's, of a ping on one
/// thread: what else runs on the machine changes those by the clock.
struct Candidate {
  EngineSetting setting;
  double probe_error = 0;      ///< of the probe pings, worst sensor; of rays not tried, by extrapolation
  double predicted_error = 0;  ///< what that of all pings will hardly exceed (study/ping_spread.hpp)
  double predicted_seconds = 0;
  bool tried = true;            ///< false: `note` says why
  std::optional<Trial> others;  ///< on other pings
  std::string note;
};

/// Pings of a sensor that the advice rests on.
struct LookedAt {
  std::string sensor;
  std::size_t pings = 0;  ///< pings to choose from
  std::vector<std::size_t> probes;
  std::vector<std::size_t> others;  ///< the probes again where the sensor has no more pings
  bool others_are_probes = false;
};

struct Advice {
  Tolerance tolerance;
  std::vector<LookedAt> sensors;
  std::vector<std::string> silent;  ///< sensors that receive nothing on the probes: only exact cuts are safe
  std::vector<Candidate> candidates;  ///< the first is the yardstick: tubes, exact cuts
  std::size_t chosen = 0;             ///< the cheapest that holds

  /// Predicted within the tolerance, and measured so where it was measured.
  bool holds(const Candidate& candidate) const;
  /// As measured on other pings, else as predicted.
  double seconds(const Candidate& candidate) const;
  const Candidate& best() const { return candidates[chosen]; }
};

/// Index of the candidate that holds and takes the fewest seconds; 0 where none does.
std::size_t cheapest(const Advice& advice);

/// Spread over a run of `pings` pings: `count` probes (or all there are), and as many others.
LookedAt looked_at(std::size_t pings, std::size_t count);

/// Tries the candidates on the scene. The yardstick is the tube engine with exact cuts: its own error
/// (rounding) counts as zero. Throws as TrialScene does, and std::runtime_error if interrupted.
Advice advise(const SceneDescription& scene, const Tolerance& tolerance, const AdviceOptions& options);

/// What a setting does not model of a scene, in words; "nothing" for exact cuts.
std::string left_out_by(const RunRequest& run);

/// The options of `tubefoot run` that ask for a setting: "--engine ray --sampling regular --rays-per-beam
/// 700".
std::string command_options(const RunRequest& run);

/// Puts the settings into the request that hold its tolerance most cheaply.
Advice pick_settings(const SceneDescription& description, RunRequest& request, bool quiet);

/// "sidescan: pings 90, 270 of 360" (counted from 0).
std::string pings_text(const std::string& sensor, const std::vector<std::size_t>& pings, std::size_t all);

}  // namespace tubefoot
