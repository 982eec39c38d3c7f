// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/pattern_integral.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tubefoot {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double tolerance = 1e-11;  // of a pattern's peak
constexpr int deepest = 60;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// A computed range, with what it may be wrong by.
RangeEnclosure about(double range) { return {range * (1 - 1e-15), range * (1 + 1e-15)}; }

int sign(double x) { return (x > 0) - (x < 0); }

/// Bernstein's parameter of the ellipse about [-1, 1] through the point that lies (along, across) from the
/// middle of [t0, t1].
double ellipse_through(double along, double across, double half) {
  const double a = std::hypot((along - half) / half, across / half);
  const double b = std::hypot((along + half) / half, across / half);
  const double sum = (a + b) / 2;
  return sum + std::sqrt(std::max(sum * sum - 1, 0.0));
}

}  // namespace

PatternIntegrator::PatternIntegrator(std::span<const double> borders_m, double beta_per_m,
                                     const BeamPatterns& patterns)
    : borders_(borders_m), beta_(beta_per_m), patterns_(patterns) {
  // Beams of one receiver differ in where they look, and their patterns' smoothness only in that.
  for (std::size_t tube = 0; tube < patterns.fan_of_tube.size(); ++tube) {
    const auto [first, end] = patterns.beams_of_tube[tube];
    if (smoothness_.size() < end) smoothness_.resize(end);
    if (first < end && smoothness_[first].transmit == nullptr)
      smoothness_[first] =
          smoothness_of(patterns.transmit[patterns.fan_of_tube[tube]], patterns.receive[first]);
  }
}

PatternIntegrator::Smoothness PatternIntegrator::smoothness_of(const TransmitPattern& transmit,
                                                               const Directivity& receive) const {
  Smoothness smooth;
  smooth.transmit = &transmit;
  smooth.receive = &receive;
  const auto enough = [&](double extent, int n) {
    for (double rho = 1.2; rho < 1e9; rho *= 1.2) {
      const double growth = smooth.growth(extent * (rho - 1 / rho) / 2);
      if (growth > 600) return false;
      if (std::expm1(growth) * (64.0 / 15) * std::pow(rho, -2.0 * n) < tolerance) return true;
    }
    return true;
  };
  for (int n = 1; n <= most_gauss_nodes; ++n) {
    double few = 0, many = pi;
    if (enough(many, n)) few = many;
    for (int k = 0; k < 40 && few < many; ++k) {
      const double middle = (few + many) / 2;
      (enough(middle, n) ? few : many) = middle;
    }
    smooth.extent[n - 1] = few;
  }
  return smooth;
}

void PatternIntegrator::add(const PlanarPolygon& polygon, const FacetPlane& plane, const PlaneFrame& frame,
                            std::uint32_t tube, double factor, std::span<double> energy) {
  const std::size_t n = polygon.offsets.size();
  const auto [first_beam, end_beam] = patterns_.beams_of_tube[tube];
  if (n < 3 || first_beam == end_beam) return;
  frame_ = &frame;
  down_ = -plane.distance_m * plane.normal;
  smooth_ = &smoothness_[first_beam];
  piece_.distance = polygon.distance;
  piece_.distance2 = polygon.distance * polygon.distance;
  piece_.tube = tube;

  edges_.clear();
  ranges_.clear();
  bool inside = true;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = i + 1 == n ? 0 : i + 1;
    const glm::dvec2 from = polygon.corner(i), way = polygon.offsets[next] - polygon.offsets[i];
    const double length = glm::length(way);
    if (!(length > 0)) continue;
    const glm::dvec2 along = way / length;
    Edge edge;
    edge.angle = std::atan2(along.y, along.x);
    edge.height = cross(from, along);
    edge.from = glm::dot(from, along);
    edge.to = glm::dot(polygon.corner(next), along);
    edge.nearest2 = piece_.distance2 + edge.height * edge.height;
    inside = inside && edge.height > 0;
    edges_.push_back(edge);
    const auto range = [&](std::size_t corner) {
      const glm::dvec2 p = polygon.corner(corner);
      return about(std::sqrt(piece_.distance2 + glm::dot(p, p)));
    };
    ranges_.push_back(
        {range(i), range(next), about(std::sqrt(edge.nearest2)), sign(edge.from), sign(edge.to)});
  }
  std::optional<RangeEnclosure> foot;
  if (inside) foot = about(polygon.distance);
  slabs_.cut(ranges_, foot, inside, borders_);

  const std::size_t samples = borders_.size() - 1;
  for (const PolarSlabs::Slab& slab : slabs_.slabs()) {
    const auto crossings = slabs_.crossings(slab);
    piece_.full_circle = crossings.empty();
    piece_.q2 = piece_.distance2;
    for (const Crossing& c : crossings) piece_.q2 = std::max(piece_.q2, edges_[c.edge].nearest2);
    const auto t_of = [&](double r) { return std::sqrt(std::max(r * r - piece_.q2, 0.0)); };
    const double t0 = t_of(double(slab.lo)), t1 = t_of(double(slab.hi));
    if (!(t1 > t0)) continue;
    find_arcs(crossings, (t0 + t1) / 2, inside);
    sum_.assign(end_beam - first_beam, 0);
    integrate(t0, t1, 0);
    for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
      energy[beam * samples + slab.sample] += factor * sum_[beam - first_beam];
  }
}

double PatternIntegrator::s_at(const Crossing& crossing, double t2) const {
  return std::sqrt(std::max(t2 + (piece_.q2 - edges_[crossing.edge].nearest2), 0.0));
}

/// Angle about the foot point at which the circle t crosses an edge.
double PatternIntegrator::angle_at(const Crossing& crossing, double t2) const {
  const Edge& edge = edges_[crossing.edge];
  const double turn = std::atan2(edge.height, s_at(crossing, t2));
  return crossing.rising ? edge.angle - turn : edge.angle + pi + turn;
}

/// Pairs the crossings of a slab: each arc runs from where the polygon begins to the next place where it
/// ends.
void PatternIntegrator::find_arcs(std::span<const Crossing> crossings, double t, bool foot_inside) {
  arcs_.clear();
  sorted_.clear();
  for (const Crossing& c : crossings) sorted_.emplace_back(angle_at(c, t * t), c);
  std::size_t rising = 0;
  for (const auto& [angle, c] : sorted_) rising += c.rising;
  if (2 * rising != sorted_.size()) return;  // a slab that rounding made, as narrow as that
  if (sorted_.size() > 2) {
    for (auto& [angle, c] : sorted_) angle -= 2 * pi * std::floor(angle / (2 * pi));
    std::sort(sorted_.begin(), sorted_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    if (!sorted_[i].second.rising) continue;
    std::size_t k = (i + 1) % sorted_.size();
    while (sorted_[k].second.rising) k = (k + 1) % sorted_.size();
    Arc arc{sorted_[i].second, sorted_[k].second, 0};
    const double angle = angle_at(arc.end, t * t) - angle_at(arc.begin, t * t);
    // An arc about a foot point outside is at most half a circle; rounding may make a thin one negative.
    const double least = foot_inside ? -1e-9 : -pi / 2;
    arc.turns = -std::floor((angle - least) / (2 * pi));
    arcs_.push_back(arc);
  }
}

/// Distance of the nearest singularities from the origin of t: they lie on the imaginary axis, where the
/// circle shrinks to the foot point, or where another edge is only touched.
double PatternIntegrator::nearest_singularity() const {
  double nearest2 = piece_.full_circle ? piece_.distance2 : piece_.q2 - piece_.distance2;
  for (const Arc& arc : arcs_)
    for (const std::uint32_t e : {arc.begin.edge, arc.end.edge}) {
      const double gap2 = piece_.q2 - edges_[e].nearest2;
      if (gap2 > 1e-13 * piece_.q2) nearest2 = std::min(nearest2, gap2);
    }
  return std::sqrt(nearest2);
}

void PatternIntegrator::integrate(double t0, double t1, int depth) {
  const double half = (t1 - t0) / 2, middle = t0 + half;
  if (!(half > 0)) return;
  // Not through the singularity but three quarters of the way, where the integrand is still of its own size.
  const double rho_geometry =
      std::min(1 + 0.75 * (ellipse_through(middle, nearest_singularity(), half) - 1), 1e6);
  // How far the arcs' ends, or a full circle, move as directions.
  const double r0 = std::sqrt(piece_.q2 + t0 * t0);
  double moved = piece_.full_circle ? t1 - t0 : 0;
  for (const Arc& arc : arcs_)
    for (const Crossing& c : {arc.begin, arc.end})
      moved = std::max(moved, s_at(c, t1 * t1) - s_at(c, t0 * t0));
  const double extent = 1.3 * moved / r0 / 2;  // the way is not straight
  int n = 1;
  while (n < most_gauss_nodes && smooth_->extent[n - 1] < extent) ++n;
  double rho = rho_geometry, growth = 0;
  while ((growth = smooth_->growth(extent * (rho - 1 / rho) / 2)) > 4 && rho > 1.5) rho /= 1.5;
  const double wanted = std::ceil((growth - std::log(tolerance)) / (2 * std::log(rho)));
  const bool too_many = wanted > most_gauss_nodes || smooth_->extent[most_gauss_nodes - 1] < extent;
  if (too_many && depth < deepest) {
    integrate(t0, middle, depth + 1);
    integrate(middle, t1, depth + 1);
    return;
  }
  n = std::clamp(int(std::min(wanted, double(most_gauss_nodes))), n, most_gauss_nodes);
  double half_arc = piece_.full_circle ? pi : 0;
  for (const Arc& arc : arcs_)
    for (const double t : {t0, middle, t1})
      half_arc =
          std::max(half_arc, (angle_at(arc.end, t * t) - angle_at(arc.begin, t * t)) / 2 + pi * arc.turns);
  choose_nodes_of_arcs(half_arc, std::sqrt(std::max(1 - piece_.distance2 / (piece_.q2 + t1 * t1), 0.0)));
  const GaussRule& rule = gauss_rule(n);
  for (std::size_t i = 0; i < rule.node.size(); ++i)
    add_circle(middle + half * rule.node[i], half * rule.weight[i]);
}

/// `half`: half of an arc as an angle about the foot point; `radius`: of the circle, as directions. A cosine
/// is w = w0 + radius cos(angle): for an imaginary part h <= 1 of the angle, w has at most radius sinh(h) <=
/// 1.18 radius h.
void PatternIntegrator::choose_nodes_of_arcs(double half, double radius) {
  panels_ = 1;
  for (;; panels_ *= 2) {
    const double h = half / panels_, extent = 1.18 * radius * h;
    int n = 1;
    while (n < most_gauss_nodes && smooth_->extent[n - 1] < extent) ++n;
    const double reach = std::expm1(std::min(smooth_->growth(1.18 * radius), 600.0));
    const double log_rho = std::asinh(1 / std::max(h, 1e-9));  // where the angle's imaginary part is 1
    if (reach > 0) n = std::max(n, int(std::ceil((std::log(64.0 / 15 * reach / tolerance)) / (2 * log_rho))));
    if ((n <= most_gauss_nodes && smooth_->extent[n - 1] >= extent) || panels_ >= 1 << 20) {
      arc_rule_ = &gauss_rule(std::min(n, most_gauss_nodes));
      return;
    }
  }
}

void PatternIntegrator::add_circle(double t, double weight) {
  const double t2 = t * t, r2 = piece_.q2 + t2, r = std::sqrt(r2);
  const double rho = std::sqrt(std::max(r2 - piece_.distance2, 0.0));
  const double radial = weight * t * std::exp(-beta_ * r) / (r2 * r2 * r2);
  if (piece_.full_circle) add_arc(r, rho, 0, pi, radial);
  for (const Arc& arc : arcs_) {
    const double begin = angle_at(arc.begin, t2), end = angle_at(arc.end, t2) + 2 * pi * arc.turns;
    add_arc(r, rho, (begin + end) / 2, (end - begin) / 2, radial);
  }
}

void PatternIntegrator::add_arc(double r, double rho, double middle, double half, double weight) {
  const GaussRule& rule = *arc_rule_;
  const TransmitPattern& transmit = patterns_.transmit[patterns_.fan_of_tube[piece_.tube]];
  const auto [first, end] = patterns_.beams_of_tube[piece_.tube];
  for (int p = 0; p < panels_; ++p) {
    const double panel_half = half / panels_, panel_middle = middle - half + (2 * p + 1) * panel_half;
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double angle = panel_middle + panel_half * rule.node[i];
      const glm::dvec3 direction =
          (down_ + rho * (std::cos(angle) * frame_->u + std::sin(angle) * frame_->v)) / r;
      const double share = weight * panel_half * rule.weight[i] * transmit.gain(direction);
      for (std::uint32_t beam = first; beam < end; ++beam)
        sum_[beam - first] += share * patterns_.receive[beam].gain(direction);
    }
  }
}

}  // namespace tubefoot
