// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/fresnel_zones.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "engine/scattering/knife_edge.hpp"

// Cuts polygons to the zones of edges, and divides them along lines of equal Fresnel parameter. On a small
// polygon h / nu is almost a linear function of position, so such a line is almost straight.

namespace tubefoot {
namespace {

/// Largest slope h / q of a zone: 45 degrees. Fresnel diffraction needs smaller angles.
constexpr double largest_slope = 1;
constexpr int most_divisions = 60;

/// Linear approximation of a zone's h / nu over a polygon: value + rate_q q + rate_t t.
struct LinearScale {
  double value, rate_q, rate_t;
  double at(const ShadowEdge::Place& p) const { return value + rate_q * p.q + rate_t * p.t; }
};

/// Range of a coordinate over the corners of a polygon.
struct CornerRange {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double length() const { return high - low; }
  /// Least absolute value between both ends.
  double nearest() const { return low > 0 ? low : high < 0 ? -high : 0; }
};

/// Tangent of the squared h / nu ~ (q - d) hypot(q, t) at a place.
LinearScale tangent(const FresnelZone& zone, const ShadowEdge::Place& at) {
  const double scale = zone.scale_m(at), rho2 = at.q * at.q + at.t * at.t;
  // d ln(scale) = (dq / (q - d) + (q dq + t dt) / rho^2) / 2.
  LinearScale linear{0, scale / 2 * (1 / (at.q - zone.edge().distance_m) + at.q / rho2),
                     scale / 2 * at.t / rho2};
  linear.value = scale - linear.rate_q * at.q - linear.rate_t * at.t;
  return linear;
}

}  // namespace

glm::dvec3 centre_of(const FresnelPolygon& polygon) {
  glm::dvec3 sum(0);
  for (const glm::dvec3& corner : polygon) sum += corner;
  return sum / double(polygon.size());
}

void split(const FresnelPolygon& polygon, const CutPlane& plane, FresnelPolygon& inside,
           FresnelPolygon& outside) {
  constexpr double rounding = 1e-12;
  inside.clear();
  outside.clear();
  const std::size_t n = polygon.size();
  if (n == 0) return;
  glm::dvec3 from = polygon[n - 1];
  const auto side_of = [&](glm::dvec3 p) {
    const double value = plane.side(p);
    return std::abs(value) <= rounding * (glm::length(p) + std::abs(plane.offset_m)) ? 0.0 : value;
  };
  double side = side_of(from);
  bool in_plane = true;
  for (const glm::dvec3& to : polygon) {
    const double next = side_of(to);
    in_plane = in_plane && next == 0;
    if (side * next < 0) {
      const glm::dvec3 crossing = from + (side / (side - next)) * (to - from);
      inside.push_back(crossing);
      outside.push_back(crossing);
    }
    if (next >= 0) inside.push_back(to);
    if (next <= 0) outside.push_back(to);
    from = to;
    side = next;
  }
  for (FresnelPolygon* part : {&inside, &outside})
    if (part->size() < 3) part->clear();
  if (in_plane) outside.clear();
}

FresnelZone::FresnelZone(const ShadowEdge& edge, double wavelength_m, double reach_m, glm::dvec3 apex_m,
                         int leg)
    : edge_(&edge), wavelength_m_(wavelength_m), apex_m_(apex_m), leg_(leg) {
  const double nearest = edge.distance_m + wavelength_m, farthest = std::max(reach_m, 2 * nearest);
  double most_oblique = 0;
  for (const glm::dvec3& end : {edge.first_m, edge.last_m})
    most_oblique = std::max(most_oblique, std::abs(glm::dot(edge.along, end)) / edge.distance_m);
  // For a given nu, the slope h / q increases with the distance from the edge.
  const double widest = edge.scale_m(wavelength_m, farthest, farthest * most_oblique) / farthest;
  // Near the wall of a tube, the edge beyond the wall acts on places in the tube.
  const double margin = std::min(-knife_edge_lit_limit * widest, largest_slope) * edge.distance_m;
  first_m_ = edge.first_m - std::min(margin, edge.before_m) * edge.along;
  last_m_ = edge.last_m + std::min(margin, edge.beyond_m) * edge.along;
  const auto side_at = [&](glm::dvec3 end, glm::dvec3 other) {
    const glm::dvec3 side = glm::normalize(glm::cross(edge.normal, end));
    return glm::dot(side, other) < 0 ? -side : side;
  };
  const glm::dvec3 first_side = side_at(first_m_, last_m_), last_side = side_at(last_m_, first_m_);
  for (const bool hidden : {false, true}) {
    const double limit = hidden ? knife_edge_shadow_limit : -knife_edge_lit_limit;
    slope_[hidden] = std::min(limit * widest, largest_slope);
    const double sign = hidden ? 1 : -1;
    planes_[hidden][0] = {first_side, 0};
    planes_[hidden][1] = {last_side, 0};
    planes_[hidden][2] = {edge.across, nearest};
    planes_[hidden][3] = {sign * edge.normal, 0};
    planes_[hidden][4] = {glm::normalize(slope_[hidden] * edge.across - sign * edge.normal), 0};
    for (CutPlane& plane : planes_[hidden]) plane.offset_m += glm::dot(plane.normal, apex_m);
  }
}

std::vector<glm::dvec3> FresnelZone::corners(bool hidden) const {
  const glm::dvec3 outwards = (hidden ? 1 : -1) * slope_[hidden] * edge_->distance_m * edge_->normal;
  return {first_m_, last_m_, last_m_ + outwards, first_m_ + outwards};
}

bool FresnelZone::holds(glm::dvec3 p, bool hidden) const {
  return std::ranges::all_of(planes(hidden), [&](const CutPlane& plane) { return plane.side(p) >= 0; });
}

bool FresnelZone::may_act_on(std::span<const glm::dvec3> polygon) const {
  double farthest = 0, most_oblique = 0, nearest = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : polygon) {
    const ShadowEdge::Place at = place(p);
    farthest = std::max(farthest, at.q);
    most_oblique = std::max(most_oblique, std::abs(at.t));
    nearest = std::min(nearest, -at.h);
  }
  // h / nu increases with q and |t|.
  return farthest > edge_->distance_m &&
         nearest < -knife_edge_lit_limit * scale_m({0, farthest, most_oblique});
}

double FresnelZone::parameter(glm::dvec3 p) const {
  const ShadowEdge::Place at = place(p);
  return at.h / scale_m(at);
}

void FresnelDivision::lit(const FresnelPolygon& polygon, std::span<const std::uint32_t> candidates,
                          const Take& take) {
  candidates_ = candidates;
  take_ = &take;
  cut(polygon, candidates, {});
}

void FresnelDivision::hidden(const FresnelPolygon& polygon, std::span<const std::uint32_t> own,
                             std::span<const std::uint32_t> candidates, const Take& take) {
  candidates_ = candidates;
  take_ = &take;
  FresnelPolygon rest = polygon, inside, outside;
  for (const std::uint32_t zone : own)
    for (const CutPlane& plane : zones_[zone].planes(true)) {
      split(rest, plane, inside, outside);
      std::swap(rest, inside);
    }
  if (!rest.empty()) cut(rest, candidates, {{}, own});
}

/// Cuts a polygon along the borders of the zones outside of the shadow. Parts outside of a zone continue with
/// the following candidates.
void FresnelDivision::cut(const FresnelPolygon& polygon, std::span<const std::uint32_t> candidates,
                          Active active) {
  FresnelPolygon rest = polygon;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const FresnelZone& zone = zones_[candidates[k]];
    if (std::ranges::any_of(active.own,
                            [&](std::uint32_t own) { return zones_[own].group() == zone.group(); }))
      continue;
    const auto is_outside = [&](const CutPlane& plane) {
      return std::ranges::all_of(rest, [&](const glm::dvec3& p) { return plane.side(p) <= 0; });
    };
    if (!zone.may_act_on(rest) || std::ranges::any_of(zone.planes(false), is_outside)) continue;
    FresnelPolygon inside, outside;
    for (const CutPlane& plane : zone.planes(false)) {
      split(rest, plane, inside, outside);
      if (!outside.empty()) cut(outside, candidates.subspan(k + 1), active);
      std::swap(rest, inside);
      if (rest.empty()) return;
    }
    active.lit.push_back(candidates[k]);
  }
  if (!active.own.empty() || !active.lit.empty()) divide(rest, std::move(active), 0);
}

std::optional<FresnelDivision::Variation> FresnelDivision::vary(const FresnelPolygon& polygon,
                                                                glm::dvec3 middle, std::uint32_t number,
                                                                bool hidden) const {
  const FresnelZone& zone = zones_[number];
  const double limit = hidden ? knife_edge_shadow_limit : -knife_edge_lit_limit;
  const LinearScale linear = tangent(zone, zone.place(middle));
  const double edge_m = zone.edge().distance_m;
  CornerRange nu, q, turn;
  double worst = 0;
  for (const glm::dvec3& p : polygon) {
    const ShadowEdge::Place place = zone.place(p);
    const double scale = zone.scale_m(place), parameter = place.h / scale;
    nu.add(parameter);
    q.add(place.q);
    turn.add(place.t / place.q);
    worst = std::max(worst, std::abs(linear.at(place) / scale - 1));
  }
  if (nu.nearest() > limit) return std::nullopt;
  const double largest = std::min(std::max(std::abs(nu.low), std::abs(nu.high)), limit);
  // Lines of equal parameter are straight only if h / nu is almost linear.
  Variation variation{number, nu.low, nu.high, 2 * worst * largest, 0, {}};
  CutPlane& plane = variation.plane;
  if (variation.curved > step_) {
    variation.width = variation.curved;
    const double beyond = (q.high - edge_m) / (q.low - edge_m), turned = turn.length();
    plane = std::log(beyond) > turned
                ? CutPlane{zone.edge().across, edge_m + (q.low - edge_m) * std::sqrt(beyond)}
                : CutPlane{zone.edge().along - (turn.low + turned / 2) * zone.edge().across, 0};
  } else {
    // h = nu (value + rate_q q + rate_t t) is a plane. In the shadow, the level changes more slowly.
    variation.width = hidden ? nu.length() / (1 + std::max(nu.low, 0.0) / 2) : nu.length();
    // Equal parts are slightly narrower than permitted, so that no part needs another division.
    const double low = std::max(nu.low, -limit), high = std::min(nu.high, limit),
                 parts =
                     std::max(2.0, std::ceil(variation.width * (high - low) / (0.95 * step_ * nu.length()))),
                 between = low + (high - low) * std::floor(parts / 2) / parts;
    plane = {zone.edge().normal -
                 between * (linear.rate_q * zone.edge().across + linear.rate_t * zone.edge().along),
             between * linear.value};
  }
  plane.offset_m += glm::dot(plane.normal, zone.apex_m());
  return variation;
}

void FresnelDivision::divide(const FresnelPolygon& polygon, Active active, int depth) {
  if (polygon.empty()) return;
  const glm::dvec3 middle = centre_of(polygon);
  // The edge whose parameter varies most, and the line or place at which the polygon is divided.
  double widest = step_;
  CutPlane plane;
  bool is_divided = false;
  const auto choose = [&](const Variation& variation) {
    if (variation.width <= widest) return;
    widest = variation.width;
    plane = variation.plane;
    is_divided = true;
  };
  for (const std::uint32_t own : active.own) {
    const std::optional<Variation> variation = vary(polygon, middle, own, true);
    if (!variation) return;
    choose(*variation);
  }
  std::vector<Variation>& lit = variations_;
  lit.clear();
  for (const std::uint32_t number : active.lit)
    if (const auto variation = vary(polygon, middle, number, false)) lit.push_back(*variation);
  active.lit.clear();
  for (std::size_t first = 0, end; first < lit.size(); first = end) {
    const auto group = zones_[lit[first].zone].group();
    double nearest = -std::numeric_limits<double>::infinity();
    for (end = first; end < lit.size() && zones_[lit[end].zone].group() == group; ++end)
      if (lit[end].curved <= step_) nearest = std::max(nearest, lit[end].low);
    for (std::size_t k = first; k < end; ++k) {
      // Everywhere on the polygon, another edge of the group has a smaller |nu|.
      if (lit[k].curved <= step_ && lit[k].high < nearest) continue;
      active.lit.push_back(lit[k].zone);
      choose(lit[k]);
    }
  }
  if (active.own.empty() && active.lit.empty()) return;
  if (!is_divided || depth >= most_divisions) return finish(polygon, active);
  FresnelPolygon inside, outside;
  split(polygon, plane, inside, outside);
  if (inside.empty() || outside.empty()) return finish(polygon, active);
  divide(inside, active, depth + 1);
  divide(outside, std::move(active), depth + 1);
}

double FresnelDivision::weight(glm::dvec3 p, const Active& active) const {
  double weight = 1;
  for (const std::uint32_t own : active.own)
    weight *= truncated_knife_edge_intensity(std::max(zones_[own].parameter(p), 0.0));
  for (std::size_t k = 0; k < active.lit.size();) {
    // Zones of one group follow each other.
    const auto group = zones_[active.lit[k]].group();
    double nearest = -std::numeric_limits<double>::infinity();
    for (; k < active.lit.size() && zones_[active.lit[k]].group() == group; ++k)
      nearest = std::max(nearest, std::min(zones_[active.lit[k]].parameter(p), 0.0));
    weight *= truncated_knife_edge_intensity(nearest);
  }
  return legs_ == 1 ? weight : weight * weight;
}

/// Passes on a cell with the mean of its weight, by the midpoints of the edges of its triangles. This rule is
/// exact for polynomials of degree 2. The mean is weighted with r^-6, to which the density of Lambert's law
/// on a plane is proportional without absorption.
void FresnelDivision::finish(const FresnelPolygon& polygon, const Active& active) {
  double area = 0, sum = 0, densities = 0;
  glm::dvec3 centre(0);
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const glm::dvec3 &a = polygon[0], &b = polygon[k - 1], &c = polygon[k];
    const double own = glm::length(glm::cross(b - a, c - a)) / 2;
    area += own;
    centre += own * (a + b + c) / 3.0;
    for (const glm::dvec3& p : {(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0}) {
      const double range2 = glm::dot(p, p), density = own / (range2 * range2 * range2);
      sum += density * weight(p, active);
      densities += density;
    }
  }
  if (!(area > 0)) return;
  const double mean = sum / densities;
  centre /= area;
  if (active.own.empty()) return (*take_)(polygon, mean - 1);
  for (const std::uint32_t own : active.own) {
    const double nearest = zones_[own].parameter(centre);
    for (const std::uint32_t other : candidates_) {
      const FresnelZone& zone = zones_[other];
      if (other == own || zone.group() != zones_[own].group() || !zone.holds(centre, true)) continue;
      const double parameter = zone.parameter(centre);
      if (parameter < nearest || (parameter == nearest && other < own)) return;
    }
  }
  (*take_)(polygon, mean);
}

}  // namespace tubefoot
