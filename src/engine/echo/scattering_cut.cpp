// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/scattering_cut.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/scattering/density.hpp"
#include "engine/scattering/echo_model.hpp"

namespace tubefoot {

std::vector<double> corner_ranges_m(const ScatteringModel& model, double distance_m) {
  std::vector<double> corners;
  for (std::size_t k = 0; k + 1 < model.pieces().size(); ++k)
    corners.push_back(distance_m / std::cos(model.pieces()[k].to));
  return corners;
}

ScatteringCutter::ScatteringCutter(const RangeSamples& samples, double absorption_db_per_m)
    : ScatteringCutter(samples, [beta = absorption_per_m(absorption_db_per_m)](const ScatteringModel& model,
                                                                               double distance_m, double r) {
        return density(cross_section(model, distance_m, r), TwoWayRange<double>::of(r), beta);
      }) {}

ScatteringCutter::ScatteringCutter(const RangeSamples& samples, Density density)
    : borders_(sample_borders_m(samples)), density_(std::move(density)) {}

void ScatteringCutter::prepare(const ScatteringModel& model, double distance_m, std::size_t first,
                               std::size_t end) {
  const bool same = radial_ && model_ == &model && distance_m_ == distance_m;
  if (same && first_ <= first && end <= end_) return;
  model_ = &model;
  distance_m_ = distance_m;
  first_ = same ? 0 : first;
  end_ = same ? borders_.size() - 1 : end;
  std::vector<double> corners = corner_ranges_m(model, distance_m);
  corners.insert(corners.begin(), distance_m);  // nearer ranges do not occur on this plane
  const auto g = [&](double r) { return density_(model, distance_m, r); };
  cutter_.reset();
  radial_ = std::make_unique<RadialIntegral>(std::span(borders_).subspan(first_, end_ - first_ + 1), g,
                                             corners, 1 + model.steepest_exponent());
  cutter_ = std::make_unique<RangeCutter>(*radial_);
}

SampleSpan ScatteringCutter::add(const PlanarPolygon& polygon, const ScatteringModel& model,
                                 std::span<double> row, double factor) {
  if (polygon.offsets.size() < 3 || !(polygon.distance > 0)) return {};
  const double near = nearest_point(polygon).range, far = farthest_range(polygon);
  if (!(far > borders_.front() && near < borders_.back())) return {};
  const auto first = std::upper_bound(borders_.begin(), borders_.end(), near);
  const auto end = std::lower_bound(borders_.begin(), borders_.end(), far);
  const auto samples = std::ptrdiff_t(borders_.size()) - 1;
  // One additional sample on each side, for the rounding of these two ranges.
  const auto k0 = std::clamp<std::ptrdiff_t>(first - borders_.begin() - 2, 0, samples - 1);
  const auto k1 = std::clamp<std::ptrdiff_t>(end - borders_.begin() + 1, k0 + 1, samples);
  prepare(model, polygon.distance, std::size_t(k0), std::size_t(k1));
  const SampleSpan lit = cutter_->add(polygon, factor, row.subspan(first_, end_ - first_));
  return {first_ + lit.first, first_ + lit.end};
}

}  // namespace tubefoot
