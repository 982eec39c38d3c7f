// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/paths/receiver_views.hpp"

// What a point that scatters sends to a receiver by one more scattering. docs/paths.md
namespace tubefoot {

/// Who receives the last scattering: an image of a receiver, or those of both receivers of a receiver pair in
/// the same mirrors.
struct ImageReceiver {
  ReceiverViews receives;  ///< of a receiver pair for the mean product: what both receive
  /// Of a receiver pair: the row of bins that energies go to; a product's real and imaginary part go to this
  /// and the next. None: those of the beams that receive them.
  std::optional<std::uint32_t> row{};
  glm::dvec3 middle_m{0}, arm_m{0};  ///< of the receiver pair's image: from its lower to its upper end
  double wavenumber_rad_m = 0;

  bool is_product() const { return receives.ends().size() > 1; }
};

/// Bins of which few are not empty.
class SparseEnergy {
 public:
  void add(std::size_t bin, double energy) {
    if (bin >= values_.size()) values_.resize(bin + 1, 0);
    if (values_[bin] == 0 && energy != 0) touched_.push_back(bin);
    values_[bin] += energy;
  }
  /// Bins that are not empty, in order, as `take(bin, energy)`; empties them.
  template <class Take>
  void drain(const Take& take) {
    std::sort(touched_.begin(), touched_.end());
    for (const std::size_t bin : touched_)
      if (const double energy = std::exchange(values_[bin], 0); energy != 0) take(bin, energy);
    touched_.clear();
  }

 private:
  std::vector<double> values_;
  std::vector<std::size_t> touched_;
};

/// Integrates over what both a point and an image of the receiver see. Polygons are intersected in doubles
/// (what either sees is exact), cut until they are small against their distances from both ends, then into
/// samples along straight lines of equal path, and each part is taken at its centroid: the error goes with
/// the square of the size. One per thread.
class PatchEcho {
 public:
  /// No part is longer than `longest_m`. Beams, fans and patterns are those of the true receiver's tubes.
  /// `least_received`: PathSettings::least_received.
  PatchEcho(const EchoModel& model, const ReceiveBeams& beams, double longest_m,
            std::span<const double> least_received);

  struct Point {
    glm::dvec3 at_m{0};      ///< the point, or its image
    const MirrorLoss& loss;  ///< of its mirrors
    glm::dvec3 axis{0};      ///< normal of the facet that it lies on, as the image sees it
    const ScatteringModel* scattering = nullptr;
    std::uint32_t fan = 0;
  };
  /// Adds, for a point that scatters 1 J/sr along its normal, the energy of beam b and sample k to bin
  /// b * samples.count + k of `out`. Sample k holds half paths, from the point to the receiver,
  /// first + k step on; the first may be negative. Returns how many polygons met. `seen`: what the point
  /// sees. `local_m`: the local frame's coordinates of the frame's origin. A product has what both receivers
  /// receive in sample k; with `borders_m` above 0, where samples are that far apart but do not begin where
  /// these do, it is in that of the mean of both half paths, as much of it as both have in one on average.
  std::size_t add(const VisibleSurface& seabed, const Point& point, const ImageReceiver& received,
                  glm::dvec3 local_m, const RangeSamples& samples, double borders_m, SparseEnergy& energy);

 private:
  using Polygon = std::vector<glm::dvec2>;

  void clip(const std::vector<glm::dvec2>& by, Polygon& polygon);
  void halve(std::size_t level);
  void cut_into_samples(const Polygon& polygon, glm::dvec2 centre);
  void cut_for_both(const Polygon& polygon, double sample, double middle, glm::dvec2 gradient,
                    glm::dvec2 centre);
  void take(const Polygon& polygon, double sample);
  double phase_rad_per_m(glm::dvec2 centre) const;
  /// Of a receive pattern, in a direction from the true apex.
  double gain_of(std::size_t beam, glm::dvec3 true_back) const;
  void take_product(double sample, glm::dvec2 p, double upper, double lower);

  const EchoModel& model_;
  const ReceiveBeams& beams_;
  double longest_m_, beta_;
  std::span<const double> least_received_;
  // Of the facet and the piece at hand.
  const Point* point_ = nullptr;
  const ImageReceiver* received_ = nullptr;
  OverFacet lit_;                // the point
  std::array<OverFacet, 2> rx_;  // the upper or only receiver, and of a product the lower one
  glm::dvec3 local_m_{0};
  double borders_m_ = 0;
  RangeSamples samples_;
  SparseEnergy* energy_ = nullptr;
  std::uint32_t own_tube_ = 0;
  const ScatteringModel* scattering_ = nullptr;
  const ReflectivityField* texture_ = nullptr;
  double mu_ = 0;
  std::vector<Polygon> levels_;
  Polygon below_, rest_, before_, both_;
  /// A corner, and where it lies among the samples.
  struct Placed {
    glm::dvec2 at;
    double sample;
  };
  std::vector<Placed> placed_, left_;
};

}  // namespace tubefoot
