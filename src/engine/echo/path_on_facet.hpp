// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/vec2.hpp>
#include <span>

#include "engine/scattering/density.hpp"
#include "engine/scattering/echo_model.hpp"
#include "engine/visibility/common_visibility.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/integrals/path_cut.hpp"

namespace tubefoot {

/// Where an apex is over a facet's plane.
struct EndOverPlane {
  PathCutter::Receiver over;  ///< distance from the plane, and foot point
  LyingPlane seen;            ///< the plane as the apex sees it, relative to itself
  bool flattened = false;     ///< ranges are not the lengths of what is seen (BistaticFacet)

  double range(glm::dvec2 p) const { return std::hypot(over.distance, p.x - over.foot.x, p.y - over.foot.y); }
  /// Unit; `range_m`: to p.
  glm::dvec3 direction(glm::dvec2 p, double range_m) const {
    return flattened ? seen.towards(p) : seen.at(p) / range_m;
  }
};

/// A path on the plane of one facet, in the coordinates of a PlaneFrame whose origin is the foot point of the
/// way out's apex: what an element there returns (density.hpp), weighed by all but patterns.
struct PathOnFacet {
  EndOverPlane tx, rx;
  SurfaceProperties seabed;
  LyingPlane lies;     ///< for the texture
  double lambert = 0;  ///< mu and both distances
  double beta_per_m = 0;
  const MirrorLoss *tx_loss = nullptr, *rx_loss = nullptr;  ///< null: none

  PathOnFacet() = default;
  /// A facet that lies where it is seen. `rx_m`: the apex of the receive leg relative to that of the transmit
  /// leg.
  PathOnFacet(const FacetPlane& plane, const PlaneFrame& frame, glm::dvec3 rx_m, double rx_distance_m,
              FacetId facet, const EchoModel& model);
  /// One that both ends see elsewhere.
  PathOnFacet(const BistaticFacet& bistatic, FacetId facet, const EchoModel& model);
  /// A part of it, in the coordinates of that facet's plane.
  static void flatten(std::span<const glm::dvec3> corners_m, const BistaticFacet& bistatic,
                      PlanarPolygon& polygon);

  /// Of an even seabed, without mirrors.
  double density_at(double tx_range_m, double rx_range_m) const {
    const auto two_way = TwoWayRange<double>::of(tx_range_m, rx_range_m);
    if (seabed.scattering == nullptr) return lambert * lambert_density(two_way, beta_per_m);
    const double sigma = std::sqrt(cross_section(*seabed.scattering, tx.over.distance, tx_range_m) *
                                   cross_section(*seabed.scattering, rx.over.distance, rx_range_m));
    return seabed.factor * density(sigma, two_way, beta_per_m);
  }
  double texture_at(glm::dvec2 p) const {
    return seabed.texture == nullptr ? 1 : seabed.texture->factor(lies.at(p));
  }
  /// What mirrors leave of what goes and comes in these directions.
  double passed(glm::dvec3 tx_direction, glm::dvec3 rx_direction) const {
    double part = 1;
    if (tx_loss != nullptr) part *= tx_loss->at(tx_direction);
    if (rx_loss != nullptr) part *= rx_loss->at(rx_direction);
    return part;
  }
  bool over_mirrors() const { return tx_loss != nullptr || rx_loss != nullptr; }

 private:
  void finish(const EchoModel& model);
};

/// The path on facet `number` of a sight of two apexes; `frame`: of its plane.
PathOnFacet path_on(const CommonVisibility& visibility, std::size_t number, const PlaneFrame& frame,
                    const EchoModel& model);
/// What the transmit leg sees of a facet, where it is flattened.
void flatten(std::span<const glm::dvec3> corners_m, const BistaticFacet& bistatic, PlanarPolygon& polygon);

/// The largest angle, at most 1, over which something that grows so into the complex plane changes little:
/// there, rules of few nodes resolve it.
template <class Growth>
double resolution_of(const Growth& growth) {
  double angle = 1;
  while (growth(angle / 2) > 3 && angle > 1e-6) angle /= 2;
  return angle;
}

/// An angle over which rough mirrors' losses change little: by e where the sum of the sines' squares changes
/// by 1 / roughness. Below the least, cells are halved where the loss asks for it. 1 without them.
double smooth_angle_rad(const Path& path);

/// How smooth an integrand is over a facet.
struct Smoothness {
  double angle_rad = 1;   ///< as seen from either apex, over which it is smooth
  bool cornered = false;  ///< a law with corners
  bool tables = false;    ///< tabulated patterns
  bool textured = false;  ///< a texture, analytic over its cells, but not known how far beyond
  bool limited = false;   ///< gains below a limit count as 0 (BeamPatterns::least)

  void take(const SurfaceProperties& seabed);
  /// Patterns that are multiplied.
  void take(const Directivity& sent, const Directivity& received);
  PathCutter::Work work(double tolerance) const;
};

}  // namespace tubefoot
