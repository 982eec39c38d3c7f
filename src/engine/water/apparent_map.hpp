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

namespace tubefoot {

/// Where a point seems to be, and the ray that leads to it.
struct ApparentPoint {
  glm::dvec3 at_m{0};
  Eigenray ray;
  int eigenrays = 1;  ///< rays that lead there, of the branches that are looked for
};

/// An apex that lies on the seabed, which is lit there and scatters on.
struct SurfaceApex {
  /// Unit normal of its facet. Of several rays to a place the first that is sent to this side is taken, if
  /// one is; 0: the first.
  glm::dvec3 front{0};
  /// Nearer than this rays are straight (over no mirror): where the seabed is seen from within itself, facets
  /// that are bent a little would lie before the apex, or behind it.
  double straight_within_m = 0;
};

/// Makes curved rays from one apex straight: a point goes to the direction in which its ray is launched, at
/// the distance that sound would cover in the ray's time at a reference speed. What the apex sees of the
/// apparent points along straight rays, and when, is what it sees of the true ones along the curved.
///
/// Local frame: z up, depth = surface height - z. Of several rays the first to arrive is taken, and their
/// number told.
///
/// Over level mirrors (Unfolding): rays are those through unfolded water. What is seen over an odd number of
/// mirrors is seen mirrored; so it is put upside down about the apex, as an image of the apex sees it, and
/// facets turn as they do.
class ApparentMap {
 public:
  /// Refers to `water`. `reference_speed_m_s`: else the apex's own. Throws std::invalid_argument for an apex
  /// above the surface. `unfolding`: with its unfolded water and options.
  ApparentMap(const WaterColumn& water, glm::dvec3 apex_m, double surface_height_m,
              const EigenrayOptions& options = {}, std::optional<double> reference_speed_m_s = {},
              const Unfolding& unfolding = {}, const SurfaceApex& surface_apex = {});

  /// None where no ray leads to (a shadow zone). `each`: becomes all_apparent() where several rays lead
  /// there.
  std::optional<ApparentPoint> apparent(glm::dvec3 point_m, std::vector<ApparentPoint>* each = nullptr) const;
  /// By every ray that leads there, from the one launched highest to the lowest. No two are launched alike:
  /// along a way on the seabed they keep their order, and come or go only in neighbouring pairs, one of which
  /// has crossed its neighbours (Eigenray::crossed), or at the end of what rays are followed.
  std::vector<ApparentPoint> all_apparent(glm::dvec3 point_m) const;

  /// The sound speed that times become ranges by.
  double reference_speed_m_s() const { return reference_speed_m_s_; }
  glm::dvec3 apex_m() const { return apex_m_; }
  /// Of the end of a way, in the water (over mirrors: the unfolded).
  double depth_m(glm::dvec3 point_m) const { return surface_height_m_ - unfolding_.height_m(point_m.z); }
  const Unfolding& unfolding() const { return unfolding_; }
  /// A place at the end of a way as it lies in the unfolded water, local frame.
  glm::dvec3 unfolded(glm::dvec3 point_m) const {
    return {point_m.x, point_m.y, unfolding_.height_m(point_m.z)};
  }
  const WaterColumn& water() const { return finder_.water(); }
  const EigenrayFinder& finder() const { return finder_; }
  double straight_within_m() const { return surface_apex_.straight_within_m; }

  /// Direction in which a ray to a point is launched, as the image has it that the point is seen from.
  glm::dvec3 launch_direction(glm::dvec3 point_m, const Eigenray& ray) const;

  /// Direction of travel on arrival at a point, unit vector; `ray` as apparent() found it.
  glm::dvec3 arrival_direction(glm::dvec3 point_m, const Eigenray& ray) const;

  /// 1 / (spreading loss) that one square metre facing the ray at the true point returns to the apex, per
  /// steradian at the apex: area per steradian from the point back, by reciprocity A c_apex^2 / c_point^2.
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

/// The second-order gap of an edge: how far the image of its middle lies from the middle of its ends' images.
/// `a`, `b`, `middle` are apparent points.
double edge_travel_path_error_m(glm::dvec3 a, glm::dvec3 b, glm::dvec3 middle);

/// What the echo of a facet's corner, or of its centre, needs of its ray.
struct CornerReturn {
  glm::dvec3 arrival{0};  ///< direction of travel, unit vector
  /// exp(-2 path absorption) / (A_out A_back), 1/m4: what comes back by way of a square metre that faces the
  /// ray; not finite on a caustic.
  double density_per_m4 = 0;
  /// (R^2 / A_back) exp(-2 (path absorption - reference absorption R)), with R the apparent range and A_back
  /// the area per steradian from the point back to the apex; not finite on a caustic.
  double spreading = 1;
};
CornerReturn corner_return(const ApparentMap& apparent_map, glm::dvec3 point_m, const ApparentPoint& image,
                           double reference_absorption_db_per_m);

/// Energy flux: the sonar sends energy into a tube of launch directions, the facet intercepts it whatever the
/// tube's shape, scatters about its true normal at the true grazing angle, and the receiver receives through
/// the tube from the point back: sigma(grazing) times the density of CornerReturn a square metre. The
/// straight law makes sigma(seen) exp(-2 reference absorption r) / r^4 of its apparent image.
///
/// The factor between the two, for a whole facet: the ratio of their integrals, each by a rule over corners
/// (a twelfth each) and centre (three quarters), which is exact for polynomials of second degree, so that
/// large facets are not biased. `returns[3]`: at the centre of the true corners; null `centre`: small facets,
/// by their corners alone. `seen_m`: the image's corners, relative to the apex. `sigma(sine)`: cross-section
/// a square metre, but for a factor. 0 where the image is edge-on.
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
