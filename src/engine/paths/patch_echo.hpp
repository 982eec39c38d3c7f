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

// Computes the echo of a point that scatters to a receiver by one more scattering, the last of a path. Each
// polygon that the point and the receiver both see is cut into small parts, which are evaluated at their
// centroids. Source: docs/notes/multiple-paths.md, "Several scatterings".
namespace tubefoot {

/// Receiver of the last scattering: an image of a receiver, or the images of both receivers of a receiver
/// pair over the same mirrors.
struct ImageReceiver {
  ReceiverViews receives;  ///< for the mean product of a receiver pair: common visibility of both
  /// Row of bins of a receiver pair's energies. The real part of a product goes to this row and the
  /// imaginary part to the next. Without a value, energies go to the rows of the beams that receive them.
  std::optional<std::uint32_t> row{};
  glm::dvec3 middle_m{0}, arm_m{0};  ///< image of the receiver pair: its middle, and the vector from its
                                     ///< lower to its upper end
  double wavenumber_rad_m = 0;

  bool is_product() const { return receives.ends().size() > 1; }
};

/// Array of bins of which most are empty.
class SparseEnergy {
 public:
  void add(std::size_t bin, double energy) {
    if (bin >= values_.size()) values_.resize(bin + 1, 0);
    if (values_[bin] == 0 && energy != 0) touched_.push_back(bin);
    values_[bin] += energy;
  }
  /// Calls `take(bin, energy)` for the non-empty bins in ascending order, and empties them.
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

/// Integrates over the surface that both a point and an image of the receiver see. The visible polygons of
/// each are exact, and their intersections are computed in doubles. Polygons are cut until they are small
/// relative to their distances from both ends. The parts are then cut into samples along straight lines of
/// equal path. Each part is evaluated at its centroid, so the error is proportional to the square of its
/// size. Use one object per thread.
class PatchEcho {
 public:
  /// Parts are at most `longest_m` long. Beams, fans and patterns refer to the tubes of the true receiver.
  /// `least_received`: see PathSettings::least_received.
  PatchEcho(const EchoModel& model, const ReceiveBeams& beams, double longest_m,
            std::span<const double> least_received);

  struct Point {
    glm::dvec3 at_m{0};      ///< the point or its image
    const MirrorLoss& loss;  ///< loss of the mirrors between the point and its image
    glm::dvec3 axis{0};      ///< normal of the point's facet, in the frame of the image
    const ScatteringModel* scattering = nullptr;
    std::uint32_t fan = 0;
  };
  /// Adds the energies for a point that scatters 1 J/sr along its normal. The energy of beam b and sample k
  /// is added to bin b * samples.count + k of the last argument. Sample k contains the half paths from the
  /// point to the receiver from first + k step on, where `first` may be negative. Returns the number of
  /// pairs of intersecting polygons. `seabed`: surface that the point sees. `local_m`: local coordinates of
  /// the origin of the frame. The product of a receiver pair covers the surface from which both receivers
  /// get energy in sample k.
  ///
  /// `borders_m` > 0: the borders of the final samples are unknown, and `borders_m` is their distance. The
  /// product then goes to the sample of the mean of both half paths. Its weight is the average fraction of a
  /// final sample that contains both signals.
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
  /// Gain of a receive pattern in a direction from the true apex.
  double gain_of(std::size_t beam, glm::dvec3 true_back) const;
  void take_product(double sample, glm::dvec2 p, double upper, double lower);

  const EchoModel& model_;
  const ReceiveBeams& beams_;
  double longest_m_, beta_;
  std::span<const double> least_received_;
  // Values for the current facet and polygon.
  const Point* point_ = nullptr;
  const ImageReceiver* received_ = nullptr;
  OverFacet lit_;                // from the point
  std::array<OverFacet, 2> rx_;  // from the upper or only receiver, and for a product from the lower one
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
  /// Corner with its position on the axis of samples.
  struct Placed {
    glm::dvec2 at;
    double sample;
  };
  std::vector<Placed> placed_, left_;
};

}  // namespace tubefoot
