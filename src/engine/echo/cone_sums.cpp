// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/cone_sums.hpp"

#include <array>
#include <numeric>
#include <stdexcept>

#include "engine/scattering/volume_scattering.hpp"

namespace tubefoot {

ConeSums::ConeSums(const ReceiveBeams& beams, const RangeSamples& samples, double absorption_db_per_m,
                   const BeamPatterns* patterns, double pattern_tolerance)
    : beams_(beams),
      borders_(sample_borders_m(samples)),
      count_(std::size_t(samples.count)),
      beta_(absorption_per_m(absorption_db_per_m)),
      solid_angle_(std::size_t(beams.count) * (count_ + 1)),
      partial_(std::size_t(beams.count) * count_),
      nearer_solid_angle_(std::size_t(beams.count)) {
  if (!(samples.first_m > 0))
    throw std::invalid_argument(
        "volume reverberation is infinite in a range sample that begins at range 0: begin at a larger range");
  for (std::size_t k = 0; k < count_; ++k)
    spreading_.push_back(volume_spreading(borders_[k], borders_[k + 1], beta_));
  if (patterns == nullptr) {
    radials_ = volume_radial_integrals(samples, absorption_db_per_m);
    cutter_.emplace(radials_->solid_angle, &radials_->partial);
    return;
  }
  extended_ = borders_;
  extended_.push_back(borders_.back() * farthest_over_last);
  solid_angle_patterns_.emplace(extended_, 0, *patterns, pattern_tolerance);
  solid_angle_patterns_->take_density([](double r) { return 1 / (r * r * r); });
  partial_patterns_.emplace(borders_, 0, *patterns, pattern_tolerance);
  partial_patterns_->take_density(
      [this](double r) { return volume_spreading(sample_start_m(borders_, r), r, beta_) / (r * r * r); });
}

void ConeSums::add(const DoubleSpace::Polygon& cone, double s_v_per_m, std::uint32_t tube) {
  const PlaneFrame frame(cone.plane);
  polygon_.assign(cone.corners_m, cone.plane, frame);
  const double factor = s_v_per_m * cone.plane.distance_m;
  if (solid_angle_patterns_) {
    solid_angle_patterns_->add(polygon_, cone.plane, frame, tube, factor, solid_angle_);
    partial_patterns_->add(polygon_, cone.plane, frame, tube, factor, partial_);
    return;
  }
  add_ideal(factor, s_v_per_m, beams_.of_tube[tube]);
}

ConeSums::Outside::Outside(double from_m, double to_m)
    : radial(std::array{from_m, to_m}, [](double r) { return 1 / (r * r * r); }), cutter(radial) {}

void ConeSums::add_ideal(double factor, double s_v_per_m, std::uint32_t beam) {
  const std::span<double> row = std::span(solid_angle_).subspan(beam * (count_ + 1), count_ + 1);
  const double first = borders_.front(), last = borders_.back();
  const double nearest = nearest_point(polygon_).range, farthest = farthest_range(polygon_);
  if (nearest >= last || farthest <= first) {
    (nearest >= last ? row[count_] : nearer_solid_angle_[beam]) += s_v_per_m * solid_angle(polygon_);
    return;
  }
  cutter_->add(polygon_, factor, row.first(count_), std::span(partial_).subspan(beam * count_, count_));
  if (nearest < first) {
    if (!nearer_) nearer_ = std::make_unique<Outside>(first / farthest_over_last, first);
    nearer_->cutter.add(polygon_, factor, std::span(nearer_solid_angle_).subspan(beam, 1));
  }
  if (farthest > last) {
    if (!beyond_) beyond_ = std::make_unique<Outside>(last, last * farthest_over_last);
    beyond_->cutter.add(polygon_, factor, row.last(1));
  }
}

void ConeSums::add_rest(double solid_angle_sr, double s_v_per_m, std::uint32_t beam) {
  constexpr double rounding = 1e-11;
  const std::span<double> row = std::span(solid_angle_).subspan(beam * (count_ + 1), count_ + 1);
  const double whole = s_v_per_m * solid_angle_sr;
  const double rest = whole - std::accumulate(row.begin(), row.end(), nearer_solid_angle_[beam]);
  if (rest > rounding * whole) row[count_] += rest;
}

std::vector<double> ConeSums::energies() {
  if (solid_angle_patterns_) {
    solid_angle_patterns_->settle(solid_angle_);
    partial_patterns_->settle(partial_);
  }
  std::vector<double> energy(partial_.size());
  for (std::size_t beam = 0; beam < std::size_t(beams_.count); ++beam) {
    double beyond = 0;
    for (std::size_t k = count_; k-- > 0;) {
      beyond += solid_angle_[beam * (count_ + 1) + k + 1];
      // Layers have coefficients of both signs, whose sum may be negative due to rounding.
      energy[beam * count_ + k] = std::max(beyond * spreading_[k] + partial_[beam * count_ + k], 0.0);
    }
  }
  std::ranges::fill(solid_angle_, 0.0);
  std::ranges::fill(partial_, 0.0);
  std::ranges::fill(nearer_solid_angle_, 0.0);
  return energy;
}

}  // namespace tubefoot
