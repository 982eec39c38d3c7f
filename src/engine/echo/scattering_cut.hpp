// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "geometry/integrals/range_cut.hpp"

namespace tubefoot {

/// Increasing ranges at which a model changes from one of its pieces to the next, on a plane at the given
/// distance.
std::vector<double> corner_ranges_m(const ScatteringModel& model, double distance_m);

/// Integrates g(r) = sigma(D / r) r^-4 e^(-2 beta r) over polygons cut by range samples: an echo without
/// patterns, for any scattering model. On a plane at distance D the sine of the grazing angle is D / r. The
/// model is thus a function of range that depends on D. A RadialIntegral is made for the samples that a
/// polygon reaches. If a second polygon of the same plane follows, it is made for all samples.
class ScatteringCutter {
 public:
  ScatteringCutter(const RangeSamples& samples, double absorption_db_per_m);
  /// Another g for a model, with the same kinks.
  using Density = std::function<double(const ScatteringModel& model, double distance_m, double range_m)>;
  ScatteringCutter(const RangeSamples& samples, Density density);

  /// Adds `factor` times the integral over polygon and sample k to row[k]. Returns the samples to which
  /// values were added. All other samples are unchanged.
  SampleSpan add(const PlanarPolygon& polygon, const ScatteringModel& model, std::span<double> row,
                 double factor = 1);

 private:
  void prepare(const ScatteringModel& model, double distance_m, std::size_t first, std::size_t end);

  std::vector<double> borders_;
  Density density_;
  const ScatteringModel* model_ = nullptr;
  double distance_m_ = 0;
  std::size_t first_ = 0, end_ = 0;  // samples that radial_ contains
  std::unique_ptr<RadialIntegral> radial_;
  std::unique_ptr<RangeCutter> cutter_;
};

}  // namespace tubefoot
