// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine without a mistake would have of an error, if it only took as few samples.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/attribution/scene_at_hand.hpp"
#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// How an engine takes samples of each beam.
struct BeamSampling {
  std::int64_t columns = 0;   ///< side by side, at the middles of equal parts of the beam; 0: at random
  std::int64_t rays = 0;      ///< of each column, at equal angles; at random: of the beam
  std::string words() const;  ///< "1 x 512 rays a beam"
};

/// Of "1x512" (columns x rows) or "points:512"; nothing where it is not of such a form, and names a file.
/// Throws UsageError for numbers that no engine has.
std::optional<BeamSampling> beam_sampling(const std::string& words);

/// The reference's sensors, or `only` one, as a perfect engine of that sampling has them. Throws UsageError
/// for columns that the scene's beams cannot be cut into, InputError as a run does.
EchoContents perfect_echoes(const SceneAtHand& scene, const EchoContents& reference,
                            const BeamSampling& sampling, const std::optional<std::string>& only, bool quiet);

/// What is to be expected of points at random, before they are drawn.
struct PointsForecast {
  double l1 = 0, l1_deviation = 0;  ///< of one draw
  double rms_db = 0;
  double empty_where_lit = 0;  ///< bins
};

/// Of a bin of energy R into which N independent rays of a beam send weights w, the variance is
/// (N E[w^2] - R^2) / N; E[w^2] is an integral over the beam, here over many rays of one weight each
/// (stratified). R^2 / variance is how many rays of equal weight the bin is made of, on average; how many
/// there are is Poisson's. Nothing where beams have patterns, receivers are apart, or paths have mirrors.
std::optional<PointsForecast> points_forecast(const SceneAtHand& scene, const SensorEchoes& reference,
                                              const BeamSampling& sampling);

/// What of an error is sampling.
struct IdealShare {
  std::string sampling;                    ///< in words
  double l1 = 0, rms_db = 0;               ///< of the perfect engine's picture
  double yours_l1 = 0;                     ///< the candidate's
  std::optional<PointsForecast> forecast;  ///< counts in the picture's stead
  /// Of the candidate's error, 1 at most.
  double explained() const;
};
std::string ideal_text(const IdealShare& share);
nlohmann::ordered_json ideal_json(const IdealShare& share);

/// Of a number of Poisson's law with this mean: the mean of |number - mean| / mean, and of
/// decibel_error(mean, number)^2.
/// @{
double poisson_mean_deviation(double mean);
double poisson_square_db(double mean);
/// @}

}  // namespace tubefoot
