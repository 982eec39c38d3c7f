// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "advice/trials.hpp"
#include "run/run_request.hpp"
#include "study/tolerance.hpp"

// Selects the engine and the settings for an error tolerance from measurements on a few pings
// (docs/accuracy-and-speed.md).
namespace tubefoot {

struct AdviceOptions {
  std::string pings =
      ":";  ///< pings of each sensor from which trial pings are chosen, as resolved() reads them
  /// Number of probe pings of each sensor, and of other pings for the measurement; at least 2.
  std::size_t trial_pings = 8;
  bool measure = true;      ///< measure the predictions on other pings
  double largest_cost = 3;  ///< rays that take longer than this multiple of an exact tube run are not tried
  std::uint64_t seed = 1;   ///< seed of the rays
  /// Samplings of rays to try.
  std::vector<RaySampling> samplings{RaySampling::stratified, RaySampling::sobol, RaySampling::adaptive,
                                     RaySampling::regular, RaySampling::column};
  bool quiet = false;
};

/// One way to compute the scene, with its errors and work. Seconds are processor seconds of one ping on one
/// thread. Elapsed time would depend on the load of the machine.
struct Candidate {
  EngineSetting setting;
  /// Largest error of the probe pings over all sensors; extrapolated for rays that were not tried.
  double probe_error = 0;
  double predicted_error = 0;  ///< upper confidence limit of the error of all pings (study/ping_spread.hpp)
  double predicted_seconds = 0;
  bool tried = true;            ///< if false, `note` has the reason
  std::optional<Trial> others;  ///< measured on other pings
  std::string note;
};

/// Pings of a sensor on which the advice is based.
struct LookedAt {
  std::string sensor;
  std::size_t pings = 0;  ///< number of pings to choose from
  std::vector<std::size_t> probes;
  std::vector<std::size_t> others;  ///< the probes again if the sensor has no other pings
  bool others_are_probes = false;
};

struct Advice {
  Tolerance tolerance;
  std::vector<LookedAt> sensors;
  /// Sensors without echoes in the probes; for these only exact cuts are reliable.
  std::vector<std::string> silent;
  std::vector<Candidate> candidates;  ///< the first is the reference: tubes with exact cuts
  std::size_t chosen = 0;             ///< the candidate with the least work that satisfies the tolerance

  /// Returns whether the predicted error and, if present, the measured error satisfy the tolerance.
  bool holds(const Candidate& candidate) const;
  /// Returns the seconds measured on other pings, otherwise the predicted ones.
  double seconds(const Candidate& candidate) const;
  const Candidate& best() const { return candidates[chosen]; }
};

/// Returns the index of the candidate that satisfies the tolerance in the fewest seconds; 0 if none does.
std::size_t cheapest(const Advice& advice);

/// Selects `count` probes (or all pings, if fewer) and as many other pings, spread over a run of `pings`
/// pings.
LookedAt looked_at(std::size_t pings, std::size_t count);

/// Measures the candidates on the scene. The reference is the tube engine with exact cuts, whose rounding
/// error counts as zero. Throws as TrialScene does, and std::runtime_error if interrupted.
Advice advise(const SceneDescription& scene, const Tolerance& tolerance, const AdviceOptions& options);

/// Describes the effects in a scene that a setting does not model; "nothing" for exact cuts.
std::string left_out_by(const RunRequest& run);

/// Returns the options of `tubefoot run` for a setting, for example "--engine ray --sampling regular
/// --rays-per-beam 700".
std::string command_options(const RunRequest& run);

/// Sets the request to the settings that satisfy its tolerance with the least work.
Advice pick_settings(const SceneDescription& description, RunRequest& request, bool quiet);

/// Formats pings, counted from 0: "sidescan: pings 90, 270 of 360".
std::string pings_text(const std::string& sensor, const std::vector<std::size_t>& pings, std::size_t all);

}  // namespace tubefoot
