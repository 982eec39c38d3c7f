// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/vertex_star.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "geometry/numbers/scalars.hpp"

// Bounds the displacement and the rotation of a surface when a vertex is moved onto a neighbour. The old and
// the new facets are projected along one direction. Their height difference is linear on each intersection,
// so its extremes lie at the corners.

namespace tubefoot {
namespace {

/// The rounding error to float is half of this bound.
constexpr double rounding = 1.2e-7;
/// Smaller sines of angles count as 0. The remaining signs are certain in double.
constexpr double least_sine = 1e-9;

float below(double x) { return static_cast<float>(x - rounding * std::abs(x)); }
float above(double x) { return static_cast<float>(x + rounding * std::abs(x)); }

bool turns_left(const glm::dvec2& a, const glm::dvec2& b) {
  const double c = cross(a, b);
  return c > 0 && c * c > least_sine * least_sine * glm::dot(a, a) * glm::dot(b, b);
}

/// A convex polygon with few corners.
struct Polygon {
  std::array<glm::dvec2, 12> corner;  // six, except for rounding of slivers
  unsigned corners = 0;

  void add(const glm::dvec2& x) { corner[corners++] = x; }

  /// Returns the part on the left of the line from a to b.
  Polygon left_of(const glm::dvec2& a, const glm::dvec2& b) const {
    Polygon left;
    std::array<double, 12> side;
    for (unsigned k = 0; k < corners; ++k) side[k] = cross(b - a, corner[k] - a);
    for (unsigned k = 0; k < corners; ++k) {
      const unsigned next = k + 1 < corners ? k + 1 : 0;
      if (side[k] >= 0) left.add(corner[k]);
      if ((side[k] > 0 && side[next] < 0) || (side[k] < 0 && side[next] > 0))
        left.add(corner[k] + side[k] / (side[k] - side[next]) * (corner[next] - corner[k]));
    }
    return left;
  }

  double twice_area() const {
    double sum = 0;
    for (unsigned k = 2; k < corners; ++k) sum += cross(corner[k - 1] - corner[0], corner[k] - corner[0]);
    return sum;
  }
};

}  // namespace

VectorBox VectorBox::of(const glm::dvec3& v) {
  return {{below(v.x), below(v.y), below(v.z)}, {above(v.x), above(v.y), above(v.z)}};
}

void VectorBox::add(const VectorBox& other) {
  if (is_empty()) {
    *this = other;
    return;
  }
  for (unsigned k = 0; k < 3; ++k) lo[k] = std::min(lo[k], other.lo[k]), hi[k] = std::max(hi[k], other.hi[k]);
}

VectorBox VectorBox::shifted(const glm::dvec3& along, double least, double most) const {
  VectorBox box;
  for (unsigned k = 0; k < 3; ++k) {
    const double a = least * along[static_cast<int>(k)], b = most * along[static_cast<int>(k)];
    box.lo[k] = below(lo[k] + std::min(a, b)), box.hi[k] = above(hi[k] + std::max(a, b));
  }
  return box;
}

double VectorBox::farthest_from(const glm::dvec3& point) const {
  glm::dvec3 far;
  for (unsigned k = 0; k < 3; ++k) {
    const double at = point[static_cast<int>(k)];
    far[static_cast<int>(k)] = std::max(std::abs(lo[k] - at), std::abs(hi[k] - at));
  }
  return glm::length(far);
}

void VertexStar::measure() {
  for (unsigned i = 0; i < facets; ++i) {
    normal_[i] = glm::normalize(glm::cross(ring[i], ring[(i + 1) % facets]));
    moved_[i] = past[i]->moved();
  }
}

double VertexStar::cost_of(unsigned target) const {
  // Prefers short moves among equal ones, because the resulting facets have a better shape.
  constexpr double worth_of_length = 1e-4;
  double cost = 0, least_limit = std::numeric_limits<double>::infinity();
  for (unsigned i = 0; i < facets; ++i) {
    const double limit = past[i]->limit;
    cost = std::max(cost, (std::abs(glm::dot(normal_[i], ring[target])) + moved_[i]) / limit);
    least_limit = std::min(least_limit, limit);
  }
  return cost + worth_of_length * glm::length(ring[target]) / least_limit;
}

glm::dvec2 VertexStar::seen(const glm::dvec3& at) const {
  return {glm::dot(at, east_), glm::dot(at, north_)};
}

bool VertexStar::look(std::optional<glm::dvec3> along) {
  pieces_.clear();
  if (!along) {
    glm::dvec3 area(0);
    for (unsigned i = 0; i < facets; ++i) area += glm::cross(ring[i], ring[(i + 1) % facets]);
    const double length = glm::length(area);
    if (!(length > 0)) return false;
    along = area / length;
  }
  up_ = *along;
  // Two arbitrary directions orthogonal to it and to each other.
  const glm::dvec3 size = glm::abs(up_);
  const glm::dvec3 axis = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                          : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                               : glm::dvec3(0, 0, 1);
  east_ = glm::normalize(glm::cross(axis, up_));
  north_ = glm::cross(up_, east_);
  for (unsigned i = 0; i < facets; ++i) {
    flat_[i] = seen(ring[i]);
    height_[i] = glm::dot(ring[i], up_);
  }
  // Facets that turn left about the centre, exactly once around, cover a star-shaped polygon once.
  unsigned rounds = 0;
  for (unsigned i = 0; i < facets; ++i) {
    const glm::dvec2 &a = flat_[i], &b = flat_[(i + 1) % facets];
    if (!turns_left(a, b)) return false;
    rounds += a.y < 0 && b.y >= 0 ? 1 : 0;
  }
  return rounds == 1;
}

void VertexStar::add_piece(const std::array<glm::dvec3, 3>& corners, const FacetPast& of) {
  Piece piece;
  for (std::size_t k = 0; k < 3; ++k) piece.corner[k] = seen(corners[k]);
  const glm::dvec2 u = piece.corner[1] - piece.corner[0], v = piece.corner[2] - piece.corner[0];
  piece.lo = glm::min(piece.corner[0], glm::min(piece.corner[1], piece.corner[2]));
  piece.hi = glm::max(piece.corner[0], glm::max(piece.corner[1], piece.corner[2]));
  piece.twice_area = cross(u, v);
  const double base = glm::dot(corners[0], up_), h = glm::dot(corners[1], up_) - base,
               l = glm::dot(corners[2], up_) - base;
  piece.plane.slope = glm::dvec2(h * v.y - l * u.y, l * u.x - h * v.x) / piece.twice_area;
  piece.plane.height = base - glm::dot(piece.plane.slope, piece.corner[0]);
  piece.past = of;
  pieces_.push_back(piece);
}

void VertexStar::add_own_pieces() {
  for (unsigned i = 0; i < facets; ++i) add_piece({glm::dvec3(0), ring[i], ring[(i + 1) % facets]}, *past[i]);
}

bool VertexStar::becomes(unsigned target, double most_turn, std::vector<Part>& parts) const {
  // A smaller share of a facet results only from rounding where two facets touch.
  constexpr double least_share = 1e-10;
  parts.resize(facets - 2);
  const glm::dvec2 x = flat_[target];
  for (unsigned k = 0; k + 2 < facets; ++k) {
    const unsigned b = (target + k + 1) % facets, c = (target + k + 2) % facets;
    const glm::dvec2 u = flat_[b] - x, v = flat_[c] - x;
    // If all triangles turn left and their border is a polygon, each point lies in exactly one of them.
    if (!turns_left(u, v)) return false;
    const double area = cross(u, v), h = height_[b] - height_[target], l = height_[c] - height_[target];
    Plane plane{glm::dvec2(h * v.y - l * u.y, l * u.x - h * v.x) / area, 0};
    plane.height = height_[target] - glm::dot(plane.slope, x);
    const glm::dvec2 lo = glm::min(x, glm::min(flat_[b], flat_[c])),
                     hi = glm::max(x, glm::max(flat_[b], flat_[c]));
    FacetPast& past_of_part = parts[k].past;
    past_of_part = {{}, {}, std::numeric_limits<float>::infinity()};
    parts[k].pieces.clear();
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      const Piece& piece = pieces_[i];
      if (piece.lo.x >= hi.x || piece.hi.x <= lo.x || piece.lo.y >= hi.y || piece.hi.y <= lo.y) continue;
      Polygon shared;
      for (const glm::dvec2& corner : piece.corner) shared.add(corner);
      shared = shared.left_of(x, flat_[b]);
      if (shared.corners > 2) shared = shared.left_of(flat_[b], flat_[c]);
      if (shared.corners > 2) shared = shared.left_of(flat_[c], x);
      if (shared.corners < 3 || shared.twice_area() <= least_share * std::min(area, piece.twice_area))
        continue;
      // The displacement is a difference of planes, with its extremes at the corners.
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (unsigned n = 0; n < shared.corners; ++n) {
        const double move = plane.at(shared.corner[n]) - piece.plane.at(shared.corner[n]);
        least = std::min(least, move), most = std::max(most, move);
      }
      past_of_part.moves.add(piece.past.moves.shifted(up_, least, most));
      past_of_part.normals.add(piece.past.normals);
      past_of_part.limit = std::min(past_of_part.limit, piece.past.limit);
      parts[k].pieces.push_back(i);
      if (past_of_part.moved() > past_of_part.limit) return false;
    }
    const glm::dvec3 normal = glm::normalize(glm::cross(ring[b] - ring[target], ring[c] - ring[target]));
    if (past_of_part.moves.is_empty() || !(past_of_part.normals.farthest_from(normal) <= most_turn))
      return false;
  }
  return true;
}

}  // namespace tubefoot
