// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
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
/// the distance that sound would cover in the ray's time at a reference speed. What the apex sees of the
/// apparent points along straight rays, and when, is what it sees of the true ones along the curved.
///
/// Local frame: z up, depth = surface height - z. Of several rays the first to arrive is taken, and their
/// number told.
class Straightening {
 public:
  /// Refers to `water`. `reference_speed_m_s`: else the apex's own. Throws std::invalid_argument for an apex
  /// above the surface.
  Straightening(const WaterColumn& water, glm::dvec3 apex_m, double surface_height_m,
                const EigenrayOptions& options = {}, std::optional<double> reference_speed_m_s = {});

  /// None where no ray leads to (a shadow zone).
  std::optional<ApparentPoint> apparent(glm::dvec3 point_m) const;

  /// The sound speed that times become ranges by.
  double reference_speed_m_s() const { return reference_speed_m_s_; }
  glm::dvec3 apex_m() const { return apex_m_; }
  double depth_m(glm::dvec3 point_m) const { return surface_height_m_ - point_m.z; }
  const WaterColumn& water() const { return finder_.water(); }
  const EigenrayFinder& finder() const { return finder_; }

  /// Direction of travel on arrival at a point, unit vector; `ray` as apparent() found it.
  glm::dvec3 arrival_direction(glm::dvec3 point_m, const Eigenray& ray) const;

  /// 1 / (spreading loss) that one square metre facing the ray at the true point returns to the apex, per
  /// steradian at the apex: area per steradian from the point back, by reciprocity A c_apex^2 / c_point^2.
  double return_area_m2_per_sr(glm::dvec3 point_m, const Eigenray& ray) const;

 private:
  EigenrayFinder finder_;
  glm::dvec3 apex_m_;
  double surface_height_m_, reference_speed_m_s_;
};

/// The second-order gap of an edge: how far the image of its middle lies from the middle of its ends' images.
/// `a`, `b`, `middle` are apparent points.
double edge_gap_m(glm::dvec3 a, glm::dvec3 b, glm::dvec3 middle);

/// What the echo of a facet's corner needs of its ray.
struct CornerReturn {
  glm::dvec3 arrival{0};  ///< direction of travel, unit vector
  /// (R^2 / A_back) exp(-2 (path absorption - reference absorption R)), with R the apparent range and A_back
  /// the area per steradian from the point back to the apex; not finite on a caustic.
  double spreading = 1;
};
CornerReturn corner_return(const Straightening& straightening, glm::dvec3 point_m, const ApparentPoint& image,
                           double reference_absorption_db_per_m);

/// Sines of the grazing angles at a facet's corner: of the curved ray on the true facet, and of the straight
/// one on its image.
struct GrazingSines {
  double lies = 0, seen = 0;
};

/// What a facet returns to the apex, over what the straight law (1 / r^4, reference absorption) makes of its
/// apparent image: the mean over its corners of
///     (sigma(lies) / lies) / (sigma(seen) / seen) spreading.
/// Energy flux: the sonar sends energy into a tube of launch directions, the facet intercepts it whatever the
/// tube's shape, scatters about its true normal at the true grazing angle, and the receiver hears through the
/// tube from the point back. With d the solid angle of launch that facet and image share, the energies are
/// sigma(lies) / lies / A_back d and sigma(seen) / seen / R^2 d. `seen_m`: the image's corners, relative to
/// the apex. `scattered_over(sines)`: the first factor; with Lambert's law lies / seen.
template <class ScatteredOver>
double facet_factor(const glm::dvec3 (&corners_m)[3], const glm::dvec3 (&seen_m)[3],
                    const CornerReturn (&returns)[3], const ScatteredOver& scattered_over);

/// With Lambert's law; 0 where the image is edge-on.
inline double lambert_over(const GrazingSines& sines) { return sines.seen > 0 ? sines.lies / sines.seen : 0; }

template <class ScatteredOver>
double facet_factor(const glm::dvec3 (&corners_m)[3], const glm::dvec3 (&seen_m)[3],
                    const CornerReturn (&returns)[3], const ScatteredOver& scattered_over) {
  const auto sine = [](const glm::dvec3(&c)[3], const glm::dvec3& along) {
    const glm::dvec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double length = glm::length(n) * glm::length(along);
    return length > 0 ? std::abs(glm::dot(n, along)) / length : 0;
  };
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    sum += returns[i].spreading *
           scattered_over(GrazingSines{sine(corners_m, returns[i].arrival), sine(seen_m, seen_m[i])});
  return sum / 3;
}

}  // namespace tubefoot
