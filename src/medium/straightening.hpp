// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "medium/eigenray.hpp"

namespace tubefoot {

/// Where a point seems to be, and the ray that leads to it.
struct ApparentPoint {
  glm::dvec3 at_m{0};
  Eigenray ray;
  int eigenrays = 1;  ///< rays that lead there, of the branches that are looked for
};

/// Makes curved rays from one apex straight: a point goes to the direction in which its ray is launched, at
/// the distance that sound would cover in the ray's time at the apex's own speed. What the apex sees of the
/// apparent points along straight rays, and when, is what it sees of the true ones along the curved.
///
/// Local frame: z up, depth = surface height - z. Of several rays the first to arrive is taken, and their
/// number told.
class Straightening {
 public:
  /// Refers to `water`. Throws std::invalid_argument for an apex above the surface.
  Straightening(const WaterColumn& water, glm::dvec3 apex_m, double surface_height_m,
                const EigenrayOptions& options = {});

  /// None where no ray leads to (a shadow zone).
  std::optional<ApparentPoint> apparent(glm::dvec3 point_m) const;

  /// The sound speed that times become ranges by: the apex's own.
  double reference_speed_m_s() const { return finder_.source_speed_m_s(); }
  glm::dvec3 apex_m() const { return apex_m_; }
  double depth_m(glm::dvec3 point_m) const { return surface_height_m_ - point_m.z; }
  const WaterColumn& water() const { return finder_.water(); }

  /// Direction of travel on arrival at a point, unit vector; `ray` as apparent() found it.
  glm::dvec3 arrival_direction(glm::dvec3 point_m, const Eigenray& ray) const;

  /// 1 / (spreading loss) that one square metre facing the ray at the true point returns to the apex, per
  /// steradian at the apex: area per steradian from the point back, by reciprocity A c_apex^2 / c_point^2.
  double return_area_m2_per_sr(glm::dvec3 point_m, const Eigenray& ray) const;

 private:
  EigenrayFinder finder_;
  glm::dvec3 apex_m_;
  double surface_height_m_;
};

/// The second-order gap of an edge: how far the image of its middle lies from the middle of its ends' images.
/// `a`, `b`, `middle` are apparent points.
double edge_gap_m(glm::dvec3 a, glm::dvec3 b, glm::dvec3 middle);

/// What a facet of true corners `corners_m` returns to the apex, over what the straight law (Lambert,
/// 1 / r^4, absorption `reference_absorption_db_per_m`) makes of its apparent image, at the facet's centre.
/// Energy flux: the sonar sends energy into a tube of launch directions, the facet intercepts it whatever the
/// tube's shape, scatters by Lambert about its true normal at the true grazing angle, and the receiver hears
/// through the tube from the point back. With d the solid angle of launch that facet and image share, the
/// energies are mu sin(true) / A_back d and mu sin(apparent) / R^2 d, so the factor is
/// (sin true / sin apparent) (R^2 / A_back) exp(-2 (path absorption - reference absorption R)). None without
/// an eigenray to the centre; 0 where the image is edge-on.
std::optional<double> facet_factor(const Straightening& straightening, const glm::dvec3 (&corners_m)[3],
                                   const glm::dvec3 (&apparent_m)[3], double reference_absorption_db_per_m);

}  // namespace tubefoot
