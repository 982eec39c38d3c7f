// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <optional>
#include <vector>

#include "engine/water/eigenray.hpp"
#include "engine/water/unfolding.hpp"

// Maps points of stratified water to apparent positions. An apparent position lies in the launch direction
// of the point's ray, at the distance reference speed times travel time. The factor of a facet is its echo
// along refracted rays, divided by the echo of its apparent facet along straight rays. See
// docs/notes/refraction.md and docs/energies.md.
namespace tubefoot {

/// Apparent position of a point, and the ray that leads to the point.
struct ApparentPoint {
  glm::dvec3 at_m{0};
  Eigenray ray;
  int eigenrays = 1;  ///< number of rays of the permitted branches that lead to the point
};

/// Maps points to their apparent positions for one apex. The apparent position lies in the launch direction
/// of the point's ray. Its distance is the travel time of the ray times the reference speed. Straight rays
/// from the apex see the apparent points as the refracted rays see the true points, at the same times.
///
/// In the local frame z points up, and depth = surface height - z. If several rays lead to a point, the map
/// takes the first to arrive and reports their number.
///
/// Over level mirrors (Unfolding), rays pass the unfolded water. An odd number of mirrors reverses the
/// orientation of facets. The map then flips apparent positions vertically about the apex, as an image of
/// the apex sees them, so that facets keep their orientation.
class ApparentMap {
 public:
  /// Keeps a reference to `water`. Without `reference_speed_m_s`, the sound speed at the apex is the
  /// reference. An `unfolding` requires its unfolded water and its options. Throws std::invalid_argument for
  /// an apex above the surface.
  ApparentMap(const WaterColumn& water, glm::dvec3 apex_m, double surface_height_m,
              const EigenrayOptions& options = {}, std::optional<double> reference_speed_m_s = {},
              const Unfolding& unfolding = {}, const SurfaceApex& surface_apex = {});

  /// Returns nothing if no ray leads to the point (a shadow zone). If several rays lead there, `each`
  /// receives all_apparent().
  std::optional<ApparentPoint> apparent(glm::dvec3 point_m, std::vector<ApparentPoint>* each = nullptr) const;
  /// Returns an apparent point for every ray, ordered from the highest to the lowest launch direction. No
  /// two rays have the same launch direction. Along a curve on the seabed the rays keep their order. Rays
  /// appear and vanish in neighbouring pairs, of which one ray has crossed its neighbours
  /// (Eigenray::crossed). At the limits of the followed rays, they appear and vanish singly.
  std::vector<ApparentPoint> all_apparent(glm::dvec3 point_m) const;

  /// Sound speed that converts travel times into ranges.
  double reference_speed_m_s() const { return reference_speed_m_s_; }
  glm::dvec3 apex_m() const { return apex_m_; }
  /// Depth of the end point of a path in the water. Over mirrors it is the depth in the unfolded water.
  double depth_m(glm::dvec3 point_m) const { return surface_height_m_ - unfolding_.height_m(point_m.z); }
  const Unfolding& unfolding() const { return unfolding_; }
  /// Position of the end point of a path in the unfolded water, local frame.
  glm::dvec3 unfolded(glm::dvec3 point_m) const {
    return {point_m.x, point_m.y, unfolding_.height_m(point_m.z)};
  }
  const WaterColumn& water() const { return finder_.water(); }
  const EigenrayFinder& finder() const { return finder_; }
  double straight_within_m() const { return surface_apex_.straight_within_m; }

  /// Direction in which the ray to a point is launched, in the frame of the image from which the point is
  /// seen.
  glm::dvec3 launch_direction(glm::dvec3 point_m, const Eigenray& ray) const;

  /// Direction of travel on arrival at a point, as a unit vector. `ray` is a result of apparent() for this
  /// point.
  glm::dvec3 arrival_direction(glm::dvec3 point_m, const Eigenray& ray) const;

  /// Area per steradian of the ray tube from the point back to the apex. It is the inverse of the spreading
  /// loss from one square metre that faces the ray at the true point. By reciprocity it equals A c_apex^2 /
  /// c_point^2.
  double return_area_m2_per_sr(glm::dvec3 point_m, const Eigenray& ray) const;

 private:
  ApparentPoint straight_to(glm::dvec3 point_m) const;
  ApparentPoint seen_by(const Eigenray& ray, glm::dvec3 point_m, std::size_t rays) const;
  std::vector<ApparentPoint> seen_by(std::vector<Eigenray> rays, glm::dvec3 point_m) const;

  EigenrayFinder finder_;
  glm::dvec3 apex_m_;
  double surface_height_m_, reference_speed_m_s_;
  Unfolding unfolding_;
  SurfaceApex surface_apex_;
};

/// Travel-path error of an edge, of second order in its length. It is the distance between the image of the
/// edge's middle and the middle between the images of its ends. `a`, `b` and `middle` are apparent points.
double edge_travel_path_error_m(glm::dvec3 a, glm::dvec3 b, glm::dvec3 middle);

/// Quantities of a ray that determine the echo of a facet's corner or centre.
struct CornerReturn {
  glm::dvec3 arrival{0};  ///< direction of travel, unit vector
  /// exp(-2 path absorption) / (A_out A_back), in 1/m^4. It is the returned density for a square metre that
  /// faces the ray. Not finite on a caustic.
  double density_per_m4 = 0;
  /// (R^2 / A_back) exp(-2 (path absorption - reference absorption R)). R is the apparent range, and A_back
  /// the area per steradian from the point back to the apex. Not finite on a caustic.
  double spreading = 1;
};
CornerReturn corner_return(const ApparentMap& apparent_map, glm::dvec3 point_m, const ApparentPoint& image,
                           double reference_absorption_db_per_m);

/// Returns the factor between the echo of a facet along refracted rays and the echo of its apparent image
/// along straight rays.
///
/// The factor follows from the energy flux. The sonar sends energy into a tube of launch directions. The
/// facet intercepts this energy whatever the shape of the tube, and scatters it about its true normal at the
/// true grazing angle. The receiver receives through the tube from the point back. The return per square
/// metre is therefore sigma(grazing) times the density of CornerReturn. Straight propagation returns
/// sigma(seen) exp(-2 reference absorption r) / r^4 from the apparent image.
///
/// For a whole facet, the factor is the ratio of the integrals of both returns. The quadrature rule weighs
/// each corner with a twelfth and the centre with three quarters. It is exact for polynomials of second
/// degree, so that large facets have no bias.
///
/// `returns[3]` belong to the corners and `centre` to the centre of the true corners. For a null `centre`
/// (small facets), the corners alone are used. `seen_m` contains the corners of the image relative to the
/// apex. `sigma(sine)` is the cross-section per square metre up to a constant factor. The result is 0 if the
/// image is seen edge-on.
template <class Sigma>
double facet_factor(const glm::dvec3 (&corners_m)[3], const glm::dvec3 (&seen_m)[3],
                    const CornerReturn (&returns)[3], const CornerReturn* centre,
                    double reference_absorption_db_per_m, const Sigma& sigma) {
  const glm::dvec3 lies = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]),
                   seen = glm::cross(seen_m[1] - seen_m[0], seen_m[2] - seen_m[0]);
  const double lies_area = glm::length(lies), seen_area = glm::length(seen);
  if (!(lies_area > 0 && seen_area > 0)) return 0;
  const auto sine = [](const glm::dvec3& normal, double area, const glm::dvec3& along) {
    const double length = area * glm::length(along);
    return length > 0 ? std::abs(glm::dot(normal, along)) / length : 0;
  };
  double refracted = 0, straight = 0;
  const auto add = [&](double weight, const CornerReturn& returned, const glm::dvec3& seen_at_m) {
    const double r2 = glm::dot(seen_at_m, seen_at_m);
    refracted += weight * sigma(sine(lies, lies_area, returned.arrival)) * returned.density_per_m4;
    straight += weight * sigma(sine(seen, seen_area, seen_at_m)) / (r2 * r2) *
                std::exp(-reference_absorption_db_per_m * std::sqrt(r2) * std::numbers::ln10 / 5);
  };
  for (int i = 0; i < 3; ++i) add(centre != nullptr ? 1.0 / 12 : 1.0 / 3, returns[i], seen_m[i]);
  if (centre != nullptr) add(0.75, *centre, (seen_m[0] + seen_m[1] + seen_m[2]) / 3.0);
  return straight > 0 ? refracted * lies_area / (straight * seen_area) : 0;
}

inline double lambert_sigma(double sine) { return sine * sine; }

}  // namespace tubefoot
