// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/smooth_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "geometry/integrals/measure.hpp"
#include "geometry/numbers/scalars.hpp"

// Cuts polygons into chunks and rectangles by bounds of the rates of phase, of the pulse's band, and of beam
// patterns. Source: docs/notes/signals.md, "Pulses".

namespace tubefoot {
namespace {

/// Radius of a chunk relative to its range.
constexpr double chunk_rad = 0.1;
constexpr int most_halvings = 60;

}  // namespace

/// Plane of a polygon; ends are relative to the polygons' origin.
struct SmoothPieces::OnPlane {
  glm::dvec3 foot, u, v, normal;
  std::vector<glm::dvec3> transmit, receive;
  glm::dvec3 at(glm::dvec2 p) const { return foot + p.x * u + p.y * v; }
};

double amplitude_wavenumber(const Directivity& pattern) {
  switch (pattern.kind) {
    case Directivity::Kind::uniform:
      return 0;
    case Directivity::Kind::line:
      return std::numbers::pi * pattern.size;
    case Directivity::Kind::piston:
      return pattern.size;
    case Directivity::Kind::gaussian:  // its spectrum falls to 1e-9 of the peak there
      return 11 / pattern.size;
    case Directivity::Kind::table:
      return 4 * std::numbers::ln10 / 20 * pattern.table->steepest();
  }
  return 0;
}

double amplitude_wavenumber(const MirrorLoss& loss) {
  // The factor is e^{-(2 k sigma)^2 s / 2}, where s is the sum of n squared sines. It is a Gaussian, no
  // narrower than if all n mirrors were one. Its spectrum is also a Gaussian. Its bandwidth is weighted like
  // that of a pulse, by the mean of order 16.
  constexpr double weighed = 2.48;  // 2027025^(1/16)
  return weighed * std::sqrt(loss.roughness * double(loss.rough_normals.size()));
}

double area_of(std::span<const glm::dvec2> polygon) {
  double twice = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k)
    twice += cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
  return twice / 2;
}

std::vector<glm::dvec2> cut_at(std::span<const glm::dvec2> polygon, int axis, double level, double sign) {
  std::vector<glm::dvec2> left;
  if (polygon.empty()) return left;
  left.reserve(polygon.size() + 2);
  glm::dvec2 from = polygon.back();
  double before = from[axis] - level;
  for (const glm::dvec2 to : polygon) {
    const double after = to[axis] - level;
    if (before * after < 0) {  // independent of the kept side, so both sides get the same corner
      const glm::dvec2 &a = before < 0 ? from : to, &b = before < 0 ? to : from;
      const double below = std::min(before, after), above = std::max(before, after);
      left.push_back(a + below / (below - above) * (b - a));
      left.back()[axis] = level;
    }
    if (sign * after >= 0) left.push_back(to);
    from = to;
    before = after;
  }
  return left;
}

SmoothPieces::SmoothPieces(const SignalExtent& extent, double most_change)
    : extent_(extent), most_change_(most_change) {}

void SmoothPieces::cut(const VisiblePolygons& seen, const VisiblePolygon& patch,
                       std::vector<Chunk>& chunks) const {
  const FacetPlane plane{patch.normal, patch.distance_m};
  const PlaneFrame frame(plane);
  OnPlane on{-plane.distance_m * plane.normal, frame.u, frame.v, patch.normal, {}, {}};
  for (const glm::dvec3& end : extent_.transmit_m) on.transmit.push_back(end - seen.origin_m);
  for (const glm::dvec3& end : extent_.receive_m) on.receive.push_back(end - seen.origin_m);
  PlanarPolygon planar;
  planar.assign(seen.corners(patch), plane, frame);
  std::vector<glm::dvec2> polygon;
  for (std::size_t k = 0; k < planar.offsets.size(); ++k) polygon.push_back(planar.corner(k));
  halve(on, std::move(polygon), chunks, 0);
}

void SmoothPieces::halve(const OnPlane& on, std::vector<glm::dvec2> polygon, std::vector<Chunk>& chunks,
                         int depth) const {
  if (polygon.size() < 3 || !(area_of(polygon) > 0)) return;
  glm::dvec2 low = polygon[0], high = low;
  for (const glm::dvec2 p : polygon) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 middle = on.at((low + high) / 2.0);
  const double radius = glm::length(high - low) / 2;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto* ends : {&on.transmit, &on.receive})
    for (const glm::dvec3& end : *ends) nearest = std::min(nearest, glm::distance(end, middle));
  if (radius > chunk_rad * nearest && depth < most_halvings) {
    const int axis = high.x - low.x > high.y - low.y ? 0 : 1;
    const double level = (low[axis] + high[axis]) / 2;
    halve(on, cut_at(polygon, axis, level, -1), chunks, depth + 1);
    halve(on, cut_at(polygon, axis, level, 1), chunks, depth + 1);
    return;
  }
  chunks.push_back(chunk_of(on, std::move(polygon)));
}

double SmoothPieces::moving_rate(double range_m) const {
  if (extent_.moved_m == 0 && extent_.speed_share == 0) return 0;
  // Directions to moving ends turn by at most moved / (range - moved). A moving transmitter increases the
  // gradient of the path length, a sum of two unit vectors, by at most the fraction speed_share
  // (docs/notes/signals.md).
  const double turned =
      range_m > extent_.moved_m ? std::min(2.0, extent_.moved_m / (range_m - extent_.moved_m)) : 2.0;
  return extent_.wavenumber_rad_m * (2 * turned + 2 * extent_.speed_share) * (extent_.products ? 2 : 1);
}

SmoothPieces::Chunk SmoothPieces::chunk_of(const OnPlane& on, std::vector<glm::dvec2> polygon) const {
  glm::dvec2 centre(0);
  for (const glm::dvec2 p : polygon) centre += p / double(polygon.size());
  double radius = 0;
  for (const glm::dvec2 p : polygon) radius = std::max(radius, glm::distance(p, centre));
  const glm::dvec3 middle = on.at(centre);
  const auto towards = [&](glm::dvec3 end) { return glm::normalize(middle - end); };

  Chunk chunk;
  const glm::dvec3 gradient = towards(on.transmit[0]) + towards(on.receive[0]),
                   along = gradient - glm::dot(gradient, on.normal) * on.normal;
  chunk.u = glm::length(along) > 1e-6 ? glm::normalize(along) : on.u;
  chunk.v = glm::cross(-on.normal, chunk.u);

  double nearest = std::numeric_limits<double>::infinity();
  glm::dvec2 phase(0), motion(0);
  double apart = 0;
  for (const auto* ends : {&on.transmit, &on.receive}) {
    glm::dvec2 least(2), most(-2), largest(0), off(0);
    const glm::dvec3 first = towards((*ends)[0]);
    for (const glm::dvec3& end : *ends) {
      nearest = std::min(nearest, glm::distance(end, middle));
      const glm::dvec3 d = towards(end);
      const glm::dvec2 slope(glm::dot(d, chunk.u), glm::dot(d, chunk.v)),
          further(glm::dot(d - first, chunk.u), glm::dot(d - first, chunk.v));
      least = glm::min(least, slope);
      most = glm::max(most, slope);
      largest = glm::max(largest, glm::abs(slope));
      off = glm::max(off, glm::abs(further));
      apart = std::max(apart, glm::distance(end, (*ends)[0]) * (extent_.products ? 2 : 1));
    }
    phase += extent_.products ? most - least : off;
    motion += largest;
  }
  // A direction turns by at most distance / range. The third derivative of a range is at most 3 / range^2.
  // The difference of two directions therefore changes by at most 3 distance * separation / range^2.
  const double range = std::max(nearest - radius, nearest / 2);
  const double even = extent_.wavenumber_rad_m * 2 * 3 * apart / (range * range) * radius +
                      extent_.band_rad_m * 2 * radius / range + (extent_.pattern_rad + amplitude_rad) / range;
  const glm::dvec2 rate = extent_.wavenumber_rad_m * phase +
                          extent_.band_rad_m * (1 + extent_.speed_share) * motion +
                          (even + moving_rate(range));

  const glm::dvec2 turn(glm::dot(chunk.u, on.u), glm::dot(chunk.u, on.v));
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
  for (glm::dvec2& p : polygon) {
    const glm::dvec2 q = p - centre;
    p = {glm::dot(q, turn), cross(turn, q)};
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec2 extent = high - low;
  constexpr double most_rectangles = 1e9;
  chunk.count_u = int(std::ceil(std::clamp(rate.x * extent.x / 2 / most_change_, 1.0, most_rectangles)));
  chunk.count_v = int(std::ceil(std::clamp(rate.y * extent.y / 2 / most_change_, 1.0, most_rectangles)));
  chunk.size_m = {extent.x / chunk.count_u, extent.y / chunk.count_v};
  chunk.change_u = rate.x * chunk.size_m.x / 2;
  chunk.change_v = rate.y * chunk.size_m.y / 2;
  chunk.first = low;
  chunk.corner_m = middle + low.x * chunk.u + low.y * chunk.v;
  chunk.polygon = std::move(polygon);
  return chunk;
}

}  // namespace tubefoot
