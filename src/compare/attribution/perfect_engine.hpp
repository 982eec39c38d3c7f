// SPDX-License-Identifier: GPL-3.0-or-later
// Error of an engine that makes no mistake except that it takes as few samples as the candidate.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/attribution/scene_at_hand.hpp"
#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// Sampling of each beam by an engine.
struct BeamSampling {
  /// Columns side by side, at the centres of equal parts of the beam; 0: random points.
  std::int64_t columns = 0;
  std::int64_t rays = 0;       ///< rays of each column, at equal angles; for random points, rays of the beam
  std::string words() const;   ///< for example "1 x 512 rays per beam"
  std::string option() const;  ///< for example "1x512"
};

/// Parses "1x512" (columns x rows) or "points:512". Returns nothing for other words, which name a file.
/// Throws UsageError for numbers outside the permitted range.
std::optional<BeamSampling> beam_sampling(const std::string& words);

/// Echoes of a perfect engine, and the solid angles of its rays.
struct PerfectEchoes {
  EchoContents energies;
  /// Solid angle of the hits of each bin, divided by the square of the centre of its range. The file
  /// `solid_angles` of an output model has the same form, with strength 1.
  std::optional<EchoContents> solid_angles;
};

/// Computes the echoes of a perfect engine for all sensors of the reference, or for `only` one. Throws
/// UsageError if the beams of the scene cannot be cut into the columns, and InputError under the same
/// conditions as a run.
PerfectEchoes perfect_echoes(const SceneAtHand& scene, const EchoContents& reference,
                             const BeamSampling& sampling, const std::optional<std::string>& only,
                             bool with_solid_angles, bool quiet);

/// Expected errors of random points.
struct PointsForecast {
  double l1 = 0, l1_deviation = 0;  ///< mean, and standard deviation of one draw
  double rms_db = 0;
  double empty_where_lit = 0;  ///< number of bins
};

/// Computes the expected errors of random points.
///
/// N independent rays of a beam contribute weights w to a bin of energy R. The variance of the bin is
/// (N E[w^2] - R^2) / N. E[w^2] is an integral over the beam. It is estimated with many stratified rays of
/// one weight each. R^2 / variance is the mean number of rays of equal weight that make up the bin. The
/// number of these rays has a Poisson distribution.
///
/// Returns nothing for beams with patterns, for separate receivers, and for paths over mirrors.
std::optional<PointsForecast> points_forecast(const SceneAtHand& scene, const SensorEchoes& reference,
                                              const BeamSampling& sampling);

/// Part of an error that sampling explains.
struct IdealShare {
  std::string sampling;                    ///< description of the sampling
  double l1 = 0, rms_db = 0;               ///< errors of the picture of the perfect engine
  double yours_l1 = 0;                     ///< error of the candidate
  std::optional<PointsForecast> forecast;  ///< replaces the picture, if present
  /// Share of the error of the candidate that sampling explains, at most 1.
  double explained() const;
};
std::string ideal_text(const IdealShare& share);
nlohmann::ordered_json ideal_json(const IdealShare& share);

/// For a Poisson distribution with this mean: the mean of |number - mean| / mean, and the mean of
/// decibel_error(mean, number)^2.
/// @{
double poisson_mean_deviation(double mean);
double poisson_square_db(double mean);
/// @}

}  // namespace tubefoot
