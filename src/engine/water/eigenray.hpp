// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/water/ray_arc.hpp"
#include "engine/water/water_column.hpp"

// Finds all eigenrays between a source depth and a point of a stratified water column without reflections.
// Within layers of constant sound-speed gradient, rays are arcs of circles (ray_arc.hpp). The search uses
// closed forms, Newton's method and bracketed root finding over the Snell parameter.
namespace tubefoot {

/// Ray from a source to a point. Grazing angles are in the direction of travel and positive downwards.
struct Eigenray {
  double launch_sine = 0, launch_cosine = 1;
  double arrival_sine = 0, arrival_cosine = 1;
  double time_s = 0;
  double length_m = 0;
  double absorption_db = 0;  ///< one way, along the path
  /// Area perpendicular to the ray per steradian at launch, in m^2/sr; 0 on a caustic. By reciprocity, this
  /// area times the squared sound speed at the start of the ray is the same for the ray back from the point.
  double tube_area_m2_per_sr = 0;
  int turns = 0;  ///< turning points between source and point
  /// Whether the ray has crossed its neighbours an odd number of times. The number of crossings is the
  /// number of caustics that it has touched.
  bool crossed = false;
  /// Area per steradian that diffraction leaves on a nearby caustic, where ray theory gives 0. If two rays
  /// that meet on a caustic have tubes of this area, their intensities add up to the largest intensity of
  /// the Airy function. It grows as the cube root of the wavelength, and is 0 where there is no caustic.
  double caustic_area_m2_per_sr = 0;
};

struct EigenrayOptions {
  double surface_m = 0;                                             ///< no ray turns above this depth
  double deepest_turn_m = std::numeric_limits<double>::infinity();  ///< no ray turns below this depth
  int most_turns = 1;
  double frequency_hz = 1e5;  ///< for Eigenray::caustic_area_m2_per_sr
};

/// Finds all rays without reflection from one source depth to points of a stratified water column.
///
/// Within one layer the two-point problem has a closed form. For paths through several layers, the finder
/// treats each order of turning points separately. For each order, the horizontal range is a function of one
/// search variable, and the finder looks for the values at which this function equals the requested range:
/// - Without turning points, the variable is the cotangent of the grazing angle at the depth of the largest
///   sound speed on the path. The function is monotone and concave, and Newton's method finds its root.
/// - With turning points, the finder searches one interval [a, b] of turning sound speeds after another.
///   All rays of an interval turn in the same layers. The variable is the sine of the grazing angle at the
///   depth of speed a. The finder splits the interval where the derivative (in closed form) changes sign.
/// Next to a caustic the finder can miss a pair of eigenrays that are closer together than its steps, 1/16 of
/// an interval.
class EigenrayFinder {
 public:
  /// Keeps a reference to `water`. Throws std::invalid_argument for a source above the surface.
  EigenrayFinder(const WaterColumn& water, double source_depth_m, const EigenrayOptions& options = {});

  /// Returns the ray that rises or falls monotonically, or the arc that stays within one layer. Returns
  /// nothing if the point is in the shadow of such rays.
  std::optional<Eigenray> direct(double depth_m, double range_m) const;
  /// Returns all rays with at most `most_turns` turning points, earliest first. The range must not be
  /// negative.
  std::vector<Eigenray> all(double depth_m, double range_m) const;

  /// Returns whether the direction to a point is steeper than any ray that turns anywhere in the water.
  /// `height_m` is the depth difference of the point, in either direction. Such a point has exactly one ray.
  bool steeper_than_turning(double height_m, double range_m) const {
    return range_m * steepest_turning_ < height_m;
  }

  /// Returns false only if no turning ray leads to the point, except an arc within one layer.
  bool may_turn_towards(double depth_m, double range_m) const;

  const WaterColumn& water() const { return water_; }
  double source_depth_m() const { return source_m_; }
  double source_speed_m_s() const { return source_speed_; }

 private:
  struct Piece {  // part of a layer, in the direction away from the starting depth
    double dz_m, c1, c2, gradient_per_s;
    std::size_t layer;
  };
  struct Section;
  struct Order;

  /// Lower bounds of the range of rays that leave a depth, turn and come back. At a depth `way_m` beyond the
  /// source, no such ray has a smaller range than least_at(way_m).
  struct ComingBack {
    double step_m = 1;
    std::vector<double> least_m;
    double fastest = 0;  ///< largest sound speed at which such rays can turn
    double least_at(double way_m) const {
      return least_m[std::min(least_m.size() - 1, static_cast<std::size_t>(way_m / step_m))];
    }
  };
  ComingBack coming_back(const std::vector<Piece>& away, const std::vector<Piece>& on) const;

  struct RayPath;
  RayPath path_to(double depth_m) const;

  std::vector<Piece> pieces(double top_m, double bottom_m) const;
  std::vector<Piece> pieces_up(double from_m, double to_m) const;
  std::size_t common_layer(double top_m, double bottom_m) const;
  std::optional<Eigenray> within_layer(std::size_t layer, double depth_m, double range_m) const;
  std::optional<Eigenray> through_layers(double depth_m, double range_m) const;
  template <class Pieces>
  RaySums along(const SnellRay& ray, const Pieces& path, bool times_too) const;
  void add_turn(const SnellRay& ray, const std::vector<Piece>& path, double times, bool times_too,
                RaySums& sums) const;
  static std::pair<double, double> range_bounds(const Section& section, const Order& order, double a,
                                                double b);
  void search(const Section& section, const Order& order, double a, double b, double depth_m, double range_m,
              std::vector<Eigenray>& found) const;
  double caustic_width_m_per_rad(double change_m_per_rad2, const Eigenray& ray, double depth_m) const;
  Eigenray eigenray(const SnellRay& ray, const RaySums& sums, double depth_m, bool launched_up,
                    int turns) const;

  const WaterColumn& water_;
  EigenrayOptions options_;
  double source_m_, source_speed_;
  std::vector<Piece> up_, down_;                   // from the source to the ends of the profile
  std::vector<double> fastest_up_, fastest_down_;  // largest sound speed up to the end of each piece
  // Integral of sound speed over depth up to the end of each piece.
  std::vector<double> crossed_up_, crossed_down_;
  ComingBack launched_up_, launched_down_;
  double steepest_turning_ = 0;  // tangent of the steepest grazing angle of a turning ray
};

/// Properties of an apex that lies on the insonified seabed and scatters sound onwards.
struct SurfaceApex {
  /// Unit normal of the apex's facet, or 0. If several rays lead to a point, ApparentMap takes the first
  /// ray that leaves the apex on this side. Without such a ray, or with 0, it takes the first of all rays.
  glm::dvec3 front{0};
  /// Rays are straight within this distance (without mirrors). For an apex on the seabed, slightly refracted
  /// facets nearby would otherwise lie in front of the apex or behind it.
  double straight_within_m = 0;
};

}  // namespace tubefoot
