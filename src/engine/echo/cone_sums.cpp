// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/cone_sums.hpp"

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
      partial_(std::size_t(beams.count) * count_) {
  if (!(samples.first_m > 0))
    throw std::invalid_argument(
        "volume reverberation is infinite in a range sample that begins at range 0: begin at a larger range");
  for (std::size_t k = 0; k < count_; ++k)
    spreading_.push_back(volume_spreading(borders_[k], borders_[k + 1], beta_));
  if (patterns == nullptr) {
    solid_angle_radial_ = solid_angle_radial_integral(samples);
    partial_radial_ = volume_radial_integral(samples, absorption_db_per_m);
    solid_angle_cutter_.emplace(*solid_angle_radial_);
    partial_cutter_.emplace(*partial_radial_);
    return;
  }
  extended_ = borders_;
  extended_.push_back(borders_.back() * farthest_over_last);
  solid_angle_patterns_.emplace(extended_, 0, *patterns, pattern_tolerance);
  solid_angle_patterns_->take_density([](double r) { return 1 / (r * r * r); });
  partial_patterns_.emplace(borders_, 0, *patterns, pattern_tolerance);
  partial_patterns_->take_density([this](double r) {
    return volume_spreading(sample_start_m(borders_, r), r, beta_) / (r * r * r);
  });
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
  const std::size_t beam = beams_.of_tube[tube];
  solid_angle_cutter_->add(polygon_, factor, std::span(solid_angle_).subspan(beam * (count_ + 1), count_ + 1));
  partial_cutter_->add(polygon_, factor, std::span(partial_).subspan(beam * count_, count_));
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
  return energy;
}

}  // namespace tubefoot
