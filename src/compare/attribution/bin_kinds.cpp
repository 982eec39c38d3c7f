// SPDX-License-Identifier: GPL-3.0-or-later
// Classifies range bins by the edges of the visible polygons in them. Each edge of each footprint is
// sampled at two or more points per range sample. At each point, the facet on the other side of the edge
// determines the kind: object border, silhouette, shadow edge, or end of the beam.
#include "compare/attribution/bin_kinds.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <optional>

#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Central projection of a tube onto a plane in front of its apex. It maps straight lines to straight
/// lines.
class ImagePlane {
 public:
  ImagePlane(const TubeSet& set, const Tube& tube) {
    for (std::size_t k = 0; k < 4; ++k) {
      const GridPoint& ray = set.rays[tube[k]];
      rays_[k] = glm::normalize(glm::dvec3(ray.x, ray.y, ray.z));
    }
    ahead_ = glm::normalize(rays_[0] + rays_[1] + rays_[2] + rays_[3]);
    across_ = glm::normalize(glm::cross(ahead_, rays_[1] - rays_[0]));
    up_ = glm::cross(ahead_, across_);
    glm::dvec2 lo(INFINITY), hi(-INFINITY);
    for (std::size_t k = 0; k < 4; ++k) {
      corners_[k] = at(rays_[k]);
      lo = glm::min(lo, corners_[k]);
      hi = glm::max(hi, corners_[k]);
    }
    lo_ = lo;
    size_ = hi - lo;
    double area = 0;
    for (std::size_t k = 0; k < 4; ++k) area += cross(corners_[k], corners_[(k + 1) % 4]);
    turn_ = area < 0 ? -1 : 1;
  }
  glm::dvec2 at(glm::dvec3 place) const {
    const double far = glm::dot(place, ahead_);
    return {glm::dot(place, across_) / far, glm::dot(place, up_) / far};
  }
  glm::dvec3 direction(glm::dvec2 at) const { return glm::normalize(ahead_ + at.x * across_ + at.y * up_); }
  /// Returns a wall of the tube that a point lies outside of or on, if there is one.
  std::optional<std::size_t> wall_before(glm::dvec2 point) const {
    for (std::size_t k = 0; k < 4; ++k)
      if (turn_ * cross(corners_[(k + 1) % 4] - corners_[k], point - corners_[k]) <= 0) return k;
    return std::nullopt;
  }
  /// Sine of the angle between the normal of the wall, which points into the tube, and the horizontal
  /// plane.
  double height_over(std::size_t wall) const {
    return glm::normalize(glm::cross(rays_[wall], rays_[(wall + 1) % 4])).z * inward();
  }
  glm::dvec2 lo() const { return lo_; }
  glm::dvec2 size() const { return size_; }

 private:
  double inward() const { return glm::dot(glm::cross(rays_[0], rays_[1]), ahead_) > 0 ? 1 : -1; }
  std::array<glm::dvec3, 4> rays_;
  std::array<glm::dvec2, 4> corners_;
  glm::dvec3 ahead_, across_, up_;
  glm::dvec2 lo_, size_;
  double turn_ = 1;
};

/// A convex part of a footprint in the projection.
struct Shape {
  const Footprint* footprint;
  std::size_t first = 0, count = 0;  ///< first corner and number of corners
  glm::dvec2 lo, hi;
};

/// Visible polygons of a tube in projection, with a search for the polygon at a point.
class TubeImage {
 public:
  TubeImage(const History& history, std::size_t first, std::size_t end, const ImagePlane& plane)
      : plane_(plane) {
    for (std::size_t f = first; f < end; ++f) {
      const Footprint& footprint = history.footprints.footprints[f];
      for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
        const Piece& piece = history.footprints.pieces[footprint.first_piece + p];
        if (piece.count < 3) continue;
        Shape shape{&footprint, corners_.size(), piece.count, glm::dvec2(INFINITY), glm::dvec2(-INFINITY)};
        for (std::uint32_t c = 0; c < piece.count; ++c) {
          places_m_.push_back(history.footprints.corners_m[piece.first + c]);
          corners_.push_back(plane.at(places_m_.back()));
          shape.lo = glm::min(shape.lo, corners_.back());
          shape.hi = glm::max(shape.hi, corners_.back());
        }
        shapes_.push_back(shape);
      }
    }
    const double cells = std::clamp(std::sqrt(double(shapes_.size())), 1.0, 128.0);
    side_ = static_cast<std::size_t>(cells);
    cells_.resize(side_ * side_);
    for (std::uint32_t s = 0; s < shapes_.size(); ++s) {
      const auto [x0, y0] = cell_of(shapes_[s].lo);
      const auto [x1, y1] = cell_of(shapes_[s].hi);
      for (std::size_t y = y0; y <= y1; ++y)
        for (std::size_t x = x0; x <= x1; ++x) cells_[y * side_ + x].push_back(s);
    }
  }

  const std::vector<Shape>& shapes() const { return shapes_; }
  glm::dvec2 corner(const Shape& shape, std::size_t k) const {
    return corners_[shape.first + k % shape.count];
  }
  glm::dvec3 place_m(const Shape& shape, std::size_t k) const {
    return places_m_[shape.first + k % shape.count];
  }
  /// Returns 1 for counter-clockwise corners and -1 for clockwise ones.
  double turn(const Shape& shape) const {
    double area = 0;
    for (std::size_t k = 0; k < shape.count; ++k)
      area += cross(corner(shape, k) - corner(shape, 0), corner(shape, k + 1) - corner(shape, 0));
    return area < 0 ? -1 : 1;
  }
  /// Returns the footprint at a point, or null in the unobstructed region.
  const Footprint* seen_at(glm::dvec2 point) const {
    const auto [x, y] = cell_of(point);
    for (const std::uint32_t s : cells_[y * side_ + x])
      if (holds(shapes_[s], point)) return shapes_[s].footprint;
    return nullptr;
  }

 private:
  bool holds(const Shape& shape, glm::dvec2 point) const {
    if (point.x < shape.lo.x || point.y < shape.lo.y || point.x > shape.hi.x || point.y > shape.hi.y)
      return false;
    bool left = false, right = false;
    for (std::size_t k = 0; k < shape.count; ++k) {
      const double side = cross(corner(shape, k + 1) - corner(shape, k), point - corner(shape, k));
      left = left || side > 0;
      right = right || side < 0;
    }
    return !(left && right);
  }
  std::pair<std::size_t, std::size_t> cell_of(glm::dvec2 point) const {
    const auto index = [&](double from, double lo, double size) {
      return static_cast<std::size_t>(std::clamp((from - lo) / size * double(side_), 0.0, double(side_) - 1));
    };
    return {index(point.x, plane_.lo().x, plane_.size().x), index(point.y, plane_.lo().y, plane_.size().y)};
  }

  const ImagePlane& plane_;
  std::vector<Shape> shapes_;
  std::vector<glm::dvec2> corners_;
  std::vector<glm::dvec3> places_m_;
  std::size_t side_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
};

/// Slant range from the apex to the plane of a facet in a given direction.
double range_m(const Footprint& footprint, glm::dvec3 direction) {
  return footprint.plane_distance_m / std::abs(glm::dot(footprint.plane_normal, direction));
}

class Edges {
 public:
  explicit Edges(const SeenEdges& seen)
      : seen_(seen),
        samples_(static_cast<std::size_t>(seen.samples.count)),
        least_cosine_(std::cos(least_bend_deg * std::numbers::pi / 180)),
        least_step_m_(least_step_of_sample * seen.samples.step_m),
        found_{std::vector<BinKind>(seen.beams * samples_, BinKind::interior),
               std::vector<FacetId>(seen.beams * samples_, BinEdges::no_caster)} {
    find_end_walls();
  }

  BinEdges found() {
    const std::vector<Footprint>& all = seen_.history.footprints.footprints;
    for (std::size_t first = 0, end = 0; first < all.size(); first = end) {
      for (end = first; end < all.size() && all[end].tube == all[first].tube;) ++end;
      stop_if_wanted();
      look_at(all[first].tube, first, end);
    }
    return std::move(found_);
  }

 private:
  enum class Wall : std::uint8_t { side, lower_end, upper_end };

  /// Finds the lower and upper end walls of the beams. An end wall belongs to no other tube of the beam,
  /// and it lies below or above the tube rather than at its side.
  void find_end_walls() {
    const TubeSet& set = seen_.history.tubes;
    using Side = std::array<std::uint32_t, 3>;  // beam and two rays
    const auto side_of = [&](std::size_t tube, std::size_t wall) {
      const std::uint32_t a = set.tubes[tube][wall], b = set.tubes[tube][(wall + 1) % 4];
      return Side{seen_.beam_of_tube[tube], std::min(a, b), std::max(a, b)};
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < set.tubes.size(); ++t)
      for (std::size_t k = 0; k < 4; ++k) sides.push_back(side_of(t, k));
    std::ranges::sort(sides);
    walls_.assign(set.tubes.size(), {Wall::side, Wall::side, Wall::side, Wall::side});
    if (!seen_.ends_are_levels) return;
    for (std::size_t t = 0; t < set.tubes.size(); ++t) {
      const ImagePlane plane(set, set.tubes[t]);
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [first, last] = std::equal_range(sides.begin(), sides.end(), side_of(t, k));
        const double height = plane.height_over(k), beside = plane.height_over((k + 1) % 4);
        if (last - first > 1 || std::abs(height) <= std::abs(beside)) continue;
        walls_[t][k] = height > 0 ? Wall::lower_end : Wall::upper_end;
      }
    }
  }

  void look_at(std::uint32_t tube, std::size_t first, std::size_t end) {
    const ImagePlane plane(seen_.history.tubes, seen_.history.tubes.tubes[tube]);
    const TubeImage image(seen_.history, first, end, plane);
    const double away = 1e-6 * std::min(plane.size().x, plane.size().y);
    for (const Shape& shape : image.shapes()) {
      const double turn = image.turn(shape);
      mark_window(*shape.footprint);
      for (std::size_t k = 0; k < shape.count; ++k) {
        const glm::dvec2 way = image.corner(shape, k + 1) - image.corner(shape, k);
        const double length = std::hypot(way.x, way.y);
        if (!(length > away)) continue;
        const glm::dvec2 outward = turn * glm::dvec2(way.y, -way.x) / length;
        const glm::dvec3 from_m = image.place_m(shape, k), to_m = image.place_m(shape, k + 1);
        // At least two points per sample.
        const double steps = std::ceil(2 * glm::length(to_m - from_m) / seen_.samples.step_m);
        const auto places = static_cast<std::size_t>(std::clamp(steps, 1.0, 4.0 * double(samples_)));
        for (std::size_t n = 0; n < places; ++n) {
          const double part = (double(n) + 0.5) / double(places);
          const glm::dvec3 place_m = from_m + part * (to_m - from_m);
          const std::optional<std::size_t> sample = sample_of(place_m);
          if (!sample) continue;
          const std::size_t bin = seen_.beam_of_tube[tube] * samples_ + *sample;
          const BinKind edge = across(image, plane, tube, shape, plane.at(place_m) + away * outward);
          found_.kind[bin] = std::max(found_.kind[bin], edge);
          if (edge == BinKind::silhouette) found_.caster[bin] = shape.footprint->facet;
        }
      }
    }
  }

  BinKind across(const TubeImage& image, const ImagePlane& plane, std::uint32_t tube, const Shape& shape,
                 glm::dvec2 point) const {
    if (const auto wall = plane.wall_before(point)) {
      const Wall which = walls_[tube][*wall];
      if (which == Wall::side) return BinKind::interior;
      return which == Wall::lower_end ? BinKind::near_edge : BinKind::far_edge;
    }
    const Footprint& own = *shape.footprint;
    const Footprint* other = image.seen_at(point);
    if (other == nullptr) return BinKind::silhouette;
    if (other->facet == own.facet) return BinKind::interior;
    const glm::dvec3 direction = plane.direction(point);
    const double step_m = range_m(*other, direction) - range_m(own, direction);
    if (step_m > least_step_m_) return BinKind::silhouette;
    if (step_m < -least_step_m_) return BinKind::shadow_edge;
    const bool bends = glm::dot(own.plane_normal, other->plane_normal) < least_cosine_;
    return bends || seen_.object[own.facet] != seen_.object[other->facet] ? BinKind::facet_edge
                                                                          : BinKind::interior;
  }

  /// Marks footprints that extend beyond the first or the last sample: the range gate cuts them off.
  void mark_window(const Footprint& footprint) {
    const double first_m = seen_.samples.first_m,
                 last_m = first_m + seen_.samples.step_m * seen_.samples.count;
    const std::size_t row = seen_.beam_of_tube[footprint.tube] * samples_;
    const auto mark = [&](BinKind& kind, BinKind edge) { kind = std::max(kind, edge); };
    if (seen_.other_end_m != glm::dvec3(0)) return;
    if (footprint.slant_range_min_m < first_m && footprint.slant_range_max_m > first_m)
      mark(found_.kind[row], BinKind::near_edge);
    if (footprint.slant_range_min_m < last_m && footprint.slant_range_max_m > last_m)
      mark(found_.kind[row + samples_ - 1], BinKind::far_edge);
  }

  std::optional<std::size_t> sample_of(glm::dvec3 place_m) const {
    const double half_path_m = (glm::length(place_m) + glm::length(place_m - seen_.other_end_m)) / 2;
    const double sample = std::floor((half_path_m - seen_.samples.first_m) / seen_.samples.step_m);
    if (!(sample >= 0 && sample < double(samples_))) return std::nullopt;
    return static_cast<std::size_t>(sample);
  }

  const SeenEdges& seen_;
  std::size_t samples_;
  double least_cosine_, least_step_m_;
  std::vector<std::array<Wall, 4>> walls_;
  BinEdges found_;
};

}  // namespace

std::string_view name_of(BinKind kind) {
  static constexpr std::array<std::string_view, bin_kinds> names{
      "interior", "facet-edge", "far-edge", "near-edge", "shadow-edge", "silhouette", "shadow", "open-water"};
  return names.at(static_cast<std::size_t>(kind));
}

BinEdges edges_of_bins(const SeenEdges& seen) { return Edges(seen).found(); }

}  // namespace tubefoot
