// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/water/ray_arc.hpp"
#include "engine/water/water_column.hpp"

namespace tubefoot {

/// A ray from a source to a point. Grazing angles are positive downwards, in the direction of travel.
struct Eigenray {
  double launch_sine = 0, launch_cosine = 1;
  double arrival_sine = 0, arrival_cosine = 1;
  double time_s = 0;
  double length_m = 0;
  double absorption_db = 0;  ///< one way, along the path
  /// Area perpendicular to the ray per steradian at launch [m^2/sr]; 0 on a caustic. Reciprocity: this times
  /// the square of the sound speed at the source is the same from the point back to the source.
  double tube_area_m2_per_sr = 0;
  int turns = 0;  ///< turning points between source and point
  /// Neighbouring rays have crossed it an odd number of times: it has touched as many caustics on its way.
  bool crossed = false;
  /// What diffraction leaves of the ray tube on the caustic nearby, which rays would make 0 there: of two
  /// rays that meet on a caustic, with tubes of this area, the sum of intensities is the largest of Airy's
  /// function. Grows as the cube root of the wavelength. 0 where there is no caustic.
  double caustic_area_m2_per_sr = 0;
};

struct EigenrayOptions {
  double surface_m = 0;                                             ///< no ray turns above
  double deepest_turn_m = std::numeric_limits<double>::infinity();  ///< none turns below
  int most_turns = 1;
  double frequency_hz = 1e5;  ///< for Eigenray::caustic_area_m2_per_sr
};

/// All rays without reflection from one source depth to points of a layered water column.
///
/// Within one layer the two-point problem has a closed form. Else, for each order of turning points, the
/// horizontal range is a function of one variable, the sine of the grazing angle at the fastest place that
/// the ray passes: it is monotone without turning point (Newton's method from the left, on a concave
/// function); with turning points it is cut where the ray turns in another layer and where its derivative, in
/// closed form, changes sign. A pair of eigenrays closer together than the steps of that search, 1/16 of a
/// layer's sines, can be missed next to a caustic.
class EigenrayFinder {
 public:
  /// Refers to `water`. Throws std::invalid_argument for a source that is not below the surface.
  EigenrayFinder(const WaterColumn& water, double source_depth_m, const EigenrayOptions& options = {});

  /// The ray that rises or falls all the way, or the arc that stays within one layer; none in its shadow.
  std::optional<Eigenray> direct(double depth_m, double range_m) const;
  /// All of up to `most_turns` turning points, earliest first. Range >= 0.
  std::vector<Eigenray> all(double depth_m, double range_m) const;

  /// Whether a point so much higher or lower is seen more steeply than any ray that turns anywhere in the
  /// water: then it has one ray.
  bool steeper_than_turning(double height_m, double range_m) const {
    return range_m * steepest_turning_ < height_m;
  }

  /// False only if no ray that turns leads to a point, but for an arc within one layer.
  bool may_turn_towards(double depth_m, double range_m) const;

  const WaterColumn& water() const { return water_; }
  double source_depth_m() const { return source_m_; }
  double source_speed_m_s() const { return source_speed_; }

 private:
  struct Piece {  // of a layer, in the direction away from where it is counted from
    double dz_m, c1, c2, gradient_per_s;
    std::size_t layer;
  };
  struct Section;
  struct Order;

  /// Of rays that are launched away from a depth, turn and come back: no range at a depth that lies `way_m`
  /// on from the source is below this.
  struct ComingBack {
    double step_m = 1;
    std::vector<double> least_m;
    double fastest = 0;  ///< where such rays could turn
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
  std::vector<double> fastest_up_, fastest_down_;  // on the way to the end of each of these
  std::vector<double> crossed_up_, crossed_down_;  // integral of speed over depth, likewise
  ComingBack launched_up_, launched_down_;
  double steepest_turning_ = 0;  // tangent of the steepest grazing angle of rays that turn
};

}  // namespace tubefoot
