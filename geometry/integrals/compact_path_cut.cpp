// SPDX-License-Identifier: GPL-3.0-or-later
// Integrates over small polygons that are cut by samples of path length, in cells along the path gradient.
// Each cell lies between two curves (edges or ellipses). A Gauss-Legendre product rule integrates the cell;
// its order follows from the cell's size, or from the agreement of two rules. compact_path_cut.hpp states
// the conditions.

#include "geometry/integrals/compact_path_cut.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// A part is compact if its size is below this fraction of the distance over which its integrand is
/// analytic.
constexpr double compact = 0.25;
constexpr int most_polygon_halvings = 8;

/// Error factors: a rule of n nodes on an interval of length x has an error of at most this times x^(2n).
/// The bound holds if the integrand is at most e^3 times its largest value within half of 1 into the complex
/// plane. The factor is 20 * 4^n (n!)^4 / ((2n + 1) ((2n)!)^2), times ten for the contribution of ellipses
/// and ranges.
constexpr std::array<double, 10> left_by_rule{80, 20, 5, 1.2, 0.3, 0.08, 0.02, 5e-3, 1.3e-3, 3e-4};

}  // namespace

double CompactPathCutter::Over::range(glm::dvec2 p) const {
  const glm::dvec2 away = p - foot;
  return std::sqrt(height2 + (away.x * away.x + away.y * away.y));
}

/// Interpolates from the nearer end, so that the result at both ends is exact.
double CompactPathCutter::Edge::at(double across) const {
  const double before = across - from.y, after = to.y - across, length = to.y - from.y;
  if (!(before > 0)) return from.x;
  if (!(after > 0)) return to.x;
  return before < after ? from.x + (to.x - from.x) * (before / length)
                        : to.x - (to.x - from.x) * (after / length);
}

void CompactPathCutter::set_orders(double tolerance) {
  if (tolerance == tolerance_) return;
  tolerance_ = tolerance;
  for (std::size_t n = 1; n <= left_by_rule.size(); ++n)
    largest_[n - 1] = std::pow(tolerance / 4 / left_by_rule[n - 1], 0.5 / double(n));
}

int CompactPathCutter::nodes_for(double extent) const {
  int n = 0;
  while (n < most_nodes && extent > largest_[std::size_t(n)] * smooth_m_) ++n;
  return n + 1;
}

void CompactPathCutter::add(const PlanarPolygon& polygon, const Task& task,
                            std::vector<PlanarPolygon>& left) {
  task_ = &task;
  polygon_ = &polygon;
  set_orders(task.work.tolerance);
  values_.resize(task.work.values);
  inner_.resize(task.work.values);
  cut(polygon.offsets, 0, left);
}

void CompactPathCutter::cut(const std::vector<glm::dvec2>& corners, int halvings,
                            std::vector<PlanarPolygon>& left) {
  if (corners.size() < 3) return;
  if (is_compact(corners)) return cut_compact(corners);
  if (halvings == most_polygon_halvings) {
    left.push_back({polygon_->distance, polygon_->first, corners});
    return;
  }
  glm::dvec2 low = corners[0], high = low;
  for (const glm::dvec2 p : corners) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const int axis = high.x - low.x >= high.y - low.y ? 0 : 1;
  const double border = (low[axis] + high[axis]) / 2;
  std::vector<glm::dvec2> below, above;
  glm::dvec2 from = corners.back();
  for (const glm::dvec2 to : corners) {
    const double before = from[axis] - border, after = to[axis] - border;
    if ((before < 0) != (after < 0)) {
      glm::dvec2 between = from + before / (before - after) * (to - from);
      between[axis] = border;
      below.push_back(between);
      above.push_back(between);
    }
    (after < 0 ? below : above).push_back(to);
    from = to;
  }
  cut(below, halvings + 1, left);
  cut(above, halvings + 1, left);
}

bool CompactPathCutter::is_compact(const std::vector<glm::dvec2>& corners) {
  glm::dvec2 low = corners[0], high = low;
  for (const glm::dvec2 p : corners) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  middle_ = (low + high) * 0.5;
  double reach2 = 0;
  for (const glm::dvec2 p : corners) reach2 = std::max(reach2, glm::dot(p - middle_, p - middle_));
  const double reach = std::sqrt(reach2);
  const PathCutter::Receiver& receiver = task_->receiver;
  const glm::dvec2 from_transmitter = polygon_->first + middle_,
                   from_receiver = from_transmitter - receiver.foot;
  transmit_.height2 = polygon_->distance * polygon_->distance;
  receive_.height2 = receiver.distance * receiver.distance;
  const double tx = std::sqrt(transmit_.height2 + glm::dot(from_transmitter, from_transmitter)),
               rx = std::sqrt(receive_.height2 + glm::dot(from_receiver, from_receiver));
  const double least_tx = tx - reach, least_rx = rx - reach;
  if (!(least_tx > 0 && least_rx > 0)) return false;
  const glm::dvec2 gradient = from_transmitter / tx + from_receiver / rx;
  const double steep = glm::length(gradient), bend = 1 / least_tx + 1 / least_rx;
  const double least_range = std::min(least_tx, least_rx);
  // Points at which the path stops growing are singular too. They are nearer where ranges are smaller.
  const double growth = steep / bend - reach;
  if (!(growth > 0)) return false;
  const double analytic_m = 1 / (1 / least_range + 1 / growth);
  if (!(2 * reach <= compact * analytic_m)) return false;
  along_ = gradient / steep;
  across_ = {-along_.y, along_.x};
  transmit_.foot = {-glm::dot(from_transmitter, along_), -glm::dot(from_transmitter, across_)};
  receive_.foot = {-glm::dot(from_receiver, along_), -glm::dot(from_receiver, across_)};
  flattest_ = steep - bend * reach;
  rounding_m_ = 1e-15 * (tx + rx) / flattest_;
  steepest_ = bend * reach / flattest_;
  smooth_m_ = std::min(analytic_m, std::min(task_->work.resolution_rad, 1.0) * least_range);
  return true;
}

void CompactPathCutter::cut_compact(const std::vector<glm::dvec2>& corners) {
  edges_.clear();
  places_.clear();
  const auto placed = [&](glm::dvec2 p) {
    return glm::dvec2(glm::dot(p - middle_, along_), glm::dot(p - middle_, across_));
  };
  glm::dvec2 from = placed(corners.back());
  for (const glm::dvec2 corner : corners) {
    const glm::dvec2 to = placed(corner);
    if (to.y > from.y) edges_.push_back({from, to, true});
    if (to.y < from.y) edges_.push_back({to, from, false});
    places_.push_back(to.y);
    from = to;
  }
  std::sort(places_.begin(), places_.end());
  for (std::size_t k = 0; k + 1 < places_.size(); ++k) {
    Strip strip{nullptr, nullptr, places_[k], places_[k + 1]};
    if (!(strip.to > strip.from)) continue;
    const double middle = (strip.from + strip.to) / 2;
    for (const Edge& edge : edges_)
      if (edge.from.y <= middle && middle <= edge.to.y) (edge.far ? strip.far : strip.near) = &edge;
    // Only rounding removes one of the two edges, and only for some 1e-16 of the points.
    if (strip.near != nullptr && strip.far != nullptr) integrate(strip);
  }
}

/// Appends the positions strictly between `from` and `to` at which the path via a point of the edge has this
/// length.
void CompactPathCutter::cross(const Edge& edge, double from, double to, double path,
                              std::vector<double>& across) const {
  const glm::dvec2 way = edge.to - edge.from;
  const double length = glm::length(way);
  const glm::dvec2 direction = way / length;
  const double place = (from + to) / 2;
  const glm::dvec2 p(edge.at(place), place);
  const PathCutter::EllipseOnRay on(path, transmit_.range(p), receive_.range(p),
                                    glm::dot(p - transmit_.foot, direction),
                                    glm::dot(p - receive_.foot, direction));
  const double discriminant = on.discriminant();
  if (!(discriminant > 0) || !(on.a > 0)) return;
  const double q = -(on.b + std::copysign(std::sqrt(discriminant), on.b));
  for (const double y : {q / on.a, on.c / q})
    if (const double at = place + y * direction.y; at > from && at < to) across.push_back(at);
}

void CompactPathCutter::integrate(const Strip& strip) {
  const auto path_on = [&](const Edge& edge, double across) { return path_of({edge.at(across), across}); };
  const double near_from = path_on(*strip.near, strip.from), near_to = path_on(*strip.near, strip.to);
  // The path is convex: on an edge it is longest at an end, and it is nowhere below a tangent.
  const double middle = (strip.from + strip.to) / 2;
  const glm::dvec2 p(strip.near->at(middle), middle), q(strip.near->at(strip.to), strip.to);
  const double tx = transmit_.range(p), rx = receive_.range(p);
  const double rise = std::abs(glm::dot((p - transmit_.foot) / tx + (p - receive_.foot) / rx, q - p));
  const double near_least = std::min({tx + rx - rise, near_from, near_to}),
               near_most = std::max(near_from, near_to),
               far_most = std::max(path_on(*strip.far, strip.from), path_on(*strip.far, strip.to));
  const std::span<const double> borders = task_->borders_m;
  const auto first = std::upper_bound(borders.begin(), borders.end(), near_least / 2);
  auto k = std::size_t(std::max<std::ptrdiff_t>(first - borders.begin() - 1, 0));
  const auto cross_both = [&](double path, std::vector<double>& across) {
    across.clear();
    if (path > near_least && path < near_most) cross(*strip.near, strip.from, strip.to, path, across);
    if (path > near_least && path < far_most) cross(*strip.far, strip.from, strip.to, path, across);
  };
  if (k + 1 < borders.size()) cross_both(2 * borders[k], before_);
  for (; k + 1 < borders.size() && 2 * borders[k] < far_most; ++k) {
    const double from = 2 * borders[k], to = 2 * borders[k + 1];
    cross_both(to, after_);
    cuts_.assign({strip.from, strip.to});
    cuts_.insert(cuts_.end(), before_.begin(), before_.end());
    cuts_.insert(cuts_.end(), after_.begin(), after_.end());
    std::sort(cuts_.begin(), cuts_.end());
    sample_ = task_->out.subspan(k * values_.size(), values_.size());
    for (std::size_t i = 0; i + 1 < cuts_.size(); ++i) {
      if (!(cuts_[i + 1] > cuts_[i])) continue;
      // The same two curves bound the whole cell.
      const double place = (cuts_[i] + cuts_[i + 1]) / 2;
      const double near = path_on(*strip.near, place), far = path_on(*strip.far, place);
      if (!(near < to && far > from)) continue;
      refinements_left_ = PathCutter::most_refined_cells;
      integrate(
          Cell{strip.near, strip.far, near < from ? from : 0, far > to ? to : 0, cuts_[i], cuts_[i + 1]});
    }
    before_.swap(after_);
  }
}

void CompactPathCutter::integrate(const Cell& cell) {
  // The width is at most the distance of the edges, or of the ellipses. A point at a fixed fraction between
  // the two curves moves as the curves do.
  const double near_from = cell.near->at(cell.from), near_to = cell.near->at(cell.to),
               far_from = cell.far->at(cell.from), far_to = cell.far->at(cell.to);
  const double high = cell.to - cell.from;
  double wide = std::max(far_from - near_from, far_to - near_to);
  if (cell.near_path > 0 && cell.far_path > 0)
    wide = std::min(wide, (cell.far_path - cell.near_path) / flattest_);
  wide *= cell.end - cell.begin;
  const double near_moves = cell.near_path > 0 ? steepest_ * high : std::abs(near_to - near_from),
               far_moves = cell.far_path > 0 ? steepest_ * high : std::abs(far_to - far_from);
  const double moves = std::max(near_moves, far_moves), way = std::sqrt(high * high + moves * moves);
  const int by_along = nodes_for(wide), by_across = nodes_for(way);
  if (by_along > most_nodes || by_across > most_nodes)
    return halve(cell, by_along >= by_across && wide > way);
  if (task_->work.analytic) {
    tensor(cell, by_along, by_across, sample_);
    return;
  }
  const auto sum_by = [&](int n, std::vector<double>& sum) {
    sum.assign(values_.size(), 0);
    return tensor(cell, std::min(by_along + n, most_nodes + 1), std::min(by_across + n, most_nodes + 1), sum);
  };
  sum_by(0, coarse_);
  for (int n = 1; std::max(by_along, by_across) + n <= most_nodes + 1; ++n) {
    const double rounding = sum_by(n, fine_) * rounding_m_ * (wide + high);
    double error = 0;
    for (std::size_t v = 0; v < fine_.size(); ++v) error = std::max(error, std::abs(fine_[v] - coarse_[v]));
    coarse_.swap(fine_);
    if (error <= task_->work.tolerance * std::abs(coarse_[0]) + rounding) break;
    if (std::max(by_along, by_across) + n <= most_nodes) continue;
    if (cell.refinements < task_->work.most_refinements && refinements_left_-- > 0)
      return halve(cell, wide > way);
  }
  for (std::size_t v = 0; v < coarse_.size(); ++v) sample_[v] += coarse_[v];
}

void CompactPathCutter::halve(const Cell& cell, bool along) {
  stop_if_wanted();
  Cell a = cell;
  ++a.refinements;
  Cell b = a;
  if (along)
    a.end = b.begin = (cell.begin + cell.end) / 2;
  else
    a.to = b.from = (cell.from + cell.to) / 2;
  integrate(a);
  integrate(b);
}

double CompactPathCutter::tensor(const Cell& cell, int by_along, int by_across, std::span<double> sum) {
  double largest = 0;
  const GaussRule &along = gauss_rule(by_along), &across = gauss_rule(by_across);
  const glm::dvec2 origin = polygon_->first + middle_;
  const double half = (cell.to - cell.from) / 2;
  for (std::size_t i = 0; i < across.node.size(); ++i) {
    const double v = cell.from + half * (1 + across.node[i]);
    const double near_edge = cell.near->at(v), far_edge = cell.far->at(v);
    double near = near_edge, far = far_edge;
    if (cell.near_path > 0 || cell.far_path > 0) {
      const glm::dvec2 base(0, v);
      const double tx = transmit_.range(base), rx = receive_.range(base);
      // The path grows along the ray, so the ray leaves the ellipse.
      const auto leaves = [&](double path) {
        const PathCutter::EllipseOnRay on(path, tx, rx, -transmit_.foot.x, -receive_.foot.x);
        const double root = std::sqrt(std::max(on.discriminant(), 0.0));
        return on.b > 0 ? -on.c / (on.b + root) : (root - on.b) / on.a;
      };
      if (cell.near_path > 0)
        near = std::clamp(leaves(cell.near_path), near_edge, std::max(near_edge, far_edge));
      if (cell.far_path > 0) far = std::clamp(leaves(cell.far_path), near, std::max(near, far_edge));
    }
    const double part = (far - near) * (cell.end - cell.begin) / 2, begin = near + (far - near) * cell.begin;
    const double weight = half * across.weight[i] * part;
    if (!(weight > 0)) continue;
    std::fill(inner_.begin(), inner_.end(), 0);
    for (std::size_t k = 0; k < along.node.size(); ++k) {
      const glm::dvec2 p(begin + part * (1 + along.node[k]), v);
      task_->integrand(origin + p.x * along_ + p.y * across_, transmit_.range(p), receive_.range(p), values_);
      largest = std::max(largest, std::abs(values_[0]));
      for (std::size_t value = 0; value < values_.size(); ++value)
        inner_[value] += along.weight[k] * values_[value];
    }
    for (std::size_t value = 0; value < values_.size(); ++value) sum[value] += weight * inner_[value];
  }
  return largest;
}

}  // namespace tubefoot
