// SPDX-License-Identifier: GPL-3.0-or-later
// Integrates over convex polygons that are cut by samples of path length, in polar coordinates about the
// point c of shortest path. Points of equal path lie on ellipses about c; a cell is an interval of angle
// between two curves. A Gauss-Legendre product rule of rising order integrates each cell until two rules
// agree. See path_cut.hpp.

#include "geometry/integrals/path_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "geometry/integrals/compact_path_cut.hpp"
#include "geometry/integrals/gauss_rules.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

constexpr std::array<int, 7> rule_orders{2, 3, 4, 6, 9, 13, 18};
constexpr std::size_t most_first_rule = 3;
constexpr int most_cell_halvings = 120;
constexpr double least_steep_half = 1e-14;  // below this, directions are too inaccurate
/// Accuracy is relaxed for a part of a cell that is smaller than another part by this factor.
constexpr double negligible = 1e-3;

/// Angle from one direction to another.
double angle_between(glm::dvec2 a, glm::dvec2 b) { return std::atan2(cross(a, b), glm::dot(a, b)); }

glm::dvec2 turned(glm::dvec2 direction, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {direction.x * c - direction.y * s, direction.x * s + direction.y * c};
}

double range(double height, glm::dvec2 offset) { return std::hypot(height, offset.x, offset.y); }

}  // namespace

PathCutter::PathCutter(std::span<const double> half_path_borders_m) : borders_(half_path_borders_m) {}
PathCutter::~PathCutter() = default;
PathCutter::PathCutter(PathCutter&&) noexcept = default;

double PathCutter::Apex::range(glm::dvec2 from_c) const {
  return std::hypot(height, from_c.x - foot.x, from_c.y - foot.y);
}

/// Distance from the line's start to the point where a direction from c meets the line.
double PathCutter::Line::along_of(glm::dvec2 direction) const {
  const double s = std::clamp(height / cross(direction, along), least, most);
  return std::clamp(glm::dot(s * direction - from, along), 0.0, length);
}

void PathCutter::add(const PlanarPolygon& polygon, std::span<const Receiver> receivers,
                     const Integrand& integrand, const Work& work, std::span<double> out) {
  if (receivers.size() < 2) return add(polygon, receivers[0], integrand, work, out, nullptr);
  add(polygon, receivers[0], SecondRange{{polygon.distance, glm::dvec2(0)}, receivers[1]}, integrand, work,
      out);
}

void PathCutter::add(const PlanarPolygon& polygon, const Receiver& receiver, const SecondRange& second,
                     const Integrand& integrand, const Work& work, std::span<double> out) {
  add(polygon, receiver, integrand, work, out, &second);
}

void PathCutter::add(const PlanarPolygon& polygon, const Receiver& receiver, const Integrand& integrand,
                     const Work& work, std::span<double> out, const SecondRange* second) {
  if (polygon.offsets.size() < 3 || borders_.size() < 2) return;
  integrand_ = &integrand;
  work_ = work;
  out_ = out;
  if (work.agreements > 1 || second != nullptr) return add_polar(polygon, receiver, second);
  stop_if_wanted();
  if (compact_ == nullptr) compact_ = std::make_unique<CompactPathCutter>();
  not_compact_.clear();
  compact_->add(polygon, {receiver, integrand, work, borders_, out}, not_compact_);
  for (const PlanarPolygon& part : not_compact_) add_polar(part, receiver, nullptr);
}

void PathCutter::add_polar(const PlanarPolygon& polygon, const Receiver& receiver,
                           const SecondRange* second) {
  const double heights = polygon.distance + receiver.distance;
  // The straight line from the transmitter to the mirrored receiver meets the plane in c.
  c_ = receiver.foot * (polygon.distance / heights);
  transmit_ = {polygon.distance, -c_};
  receive_ = {receiver.distance, receiver.foot * (receiver.distance / heights)};
  second_.reset();
  if (second != nullptr) {
    second_ = Apex{second->receive.distance, second->receive.foot - c_};
    second_transmit_ = {second->transmit.distance, second->transmit.foot - c_};
    common_transmitter_ =
        second_transmit_.height == transmit_.height && second->transmit.foot == glm::dvec2(0);
    second_shortest_ = range(second->transmit.distance + second->receive.distance,
                             second->receive.foot - second->transmit.foot);
    second_later_ = 2 * second->later_m;
    second_transmit_range_ = range(second_transmit_.height, second_transmit_.foot);
  }
  transmit_range_ = range(transmit_.height, transmit_.foot);
  receive_range_ = range(receive_.height, receive_.foot);
  shortest_ = range(heights, receiver.foot);
  find_sectors(polygon);
  for (const Sector& sector : sectors_) {
    stop_if_wanted();
    integrate(sector);
  }
}

std::pair<double, double> PathCutter::half_paths_of(const PlanarPolygon& polygon, const Receiver& receiver) {
  const auto path = [&](glm::dvec2 p) {
    return range(polygon.distance, p) + range(receiver.distance, p - receiver.foot);
  };
  // The straight line from the transmitter to the mirrored receiver meets the plane in c.
  const glm::dvec2 c = receiver.foot * (polygon.distance / (polygon.distance + receiver.distance));
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  bool holds_c = true;
  const std::size_t n = polygon.offsets.size();
  for (std::size_t k = 0; k < n; ++k) {
    const glm::dvec2 from = polygon.corner(k),
                     edge = polygon.offsets[k + 1 == n ? 0 : k + 1] - polygon.offsets[k];
    longest = std::max(longest, path(from));
    shortest = std::min(shortest, path(from));
    holds_c = holds_c && cross(edge, c - from) >= 0;
    const double length = glm::length(edge);
    if (!(length > 0)) continue;
    // With both apexes rotated about the edge into one plane, the shortest path is a straight line.
    const glm::dvec2 along = edge / length;
    const double to_transmitter = range(polygon.distance, glm::dvec2(cross(along, from), 0)),
                 to_receiver = range(receiver.distance, glm::dvec2(cross(along, from - receiver.foot), 0)),
                 first = -glm::dot(from, along), second = glm::dot(receiver.foot - from, along),
                 at = first + (second - first) * (to_transmitter / (to_transmitter + to_receiver));
    if (at > 0 && at < length) shortest = std::min(shortest, path(from + at * along));
  }
  if (holds_c) shortest = range(polygon.distance + receiver.distance, receiver.foot);
  return {shortest / 2, longest / 2};
}

std::pair<std::size_t, std::size_t> PathCutter::samples_of(const PlanarPolygon& polygon,
                                                           const Receiver& receiver) const {
  double longest = 0;
  glm::dvec2 lo = polygon.corner(0), hi = lo;
  for (std::size_t i = 0; i < polygon.offsets.size(); ++i) {
    const glm::dvec2 p = polygon.corner(i);
    longest = std::max(longest, range(polygon.distance, p) + range(receiver.distance, p - receiver.foot));
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
  }
  // No path is shorter than the sum of both ranges to the polygon's box, or than the shortest path over the
  // plane.
  const auto nearest = [&](glm::dvec2 foot) {
    return foot - glm::dvec2(std::clamp(foot.x, lo.x, hi.x), std::clamp(foot.y, lo.y, hi.y));
  };
  const double least = std::max(
      range(polygon.distance, nearest(glm::dvec2(0))) + range(receiver.distance, nearest(receiver.foot)),
      range(polygon.distance + receiver.distance, receiver.foot));
  const auto first = std::upper_bound(borders_.begin(), borders_.end(), least / 2 * (1 - 1e-12));
  const auto end = std::lower_bound(borders_.begin(), borders_.end(), longest / 2 * (1 + 1e-12));
  const auto samples = std::ptrdiff_t(borders_.size()) - 1;
  const auto k = std::clamp<std::ptrdiff_t>(first - borders_.begin() - 1, 0, samples);
  return {std::size_t(k), std::size_t(std::clamp<std::ptrdiff_t>(end - borders_.begin(), k, samples))};
}

/// Cuts the polygon into sectors about c. One far edge and at most one near edge bound each sector.
void PathCutter::find_sectors(const PlanarPolygon& polygon) {
  const std::size_t n = polygon.offsets.size();
  lines_.clear();
  sectors_.clear();
  bool outside = false;
  double lowest = 0;
  glm::dvec2 axis(0);
  const glm::dvec2 first = polygon.first - c_;
  for (std::size_t i = 0; i < n; ++i) {
    Line line;
    const std::size_t next = i + 1 == n ? 0 : i + 1;
    const glm::dvec2 way = polygon.offsets[next] - polygon.offsets[i];
    line.from = first + polygon.offsets[i];
    line.to = first + polygon.offsets[next];
    line.length = glm::length(way);
    if (!(line.length > 0)) continue;
    line.along = way / line.length;
    // The nearer end gives the height: its sign must match the angle at which c sees this end, however near
    // it is to c.
    const bool from_is_nearer = glm::dot(line.from, line.from) <= glm::dot(line.to, line.to);
    line.height = cross(from_is_nearer ? line.from : line.to, line.along);
    const double nearest = std::clamp(-glm::dot(line.from, line.along), 0.0, line.length);
    line.least = glm::length(line.from + nearest * line.along);
    line.most = std::max(glm::length(line.from), glm::length(line.to));
    if (line.height == 0) continue;  // no angle, or no distance
    outside = outside || line.height < 0;
    if (line.height < lowest) {
      lowest = line.height;
      axis = {-line.along.y, line.along.x};
    }
    lines_.push_back(line);
  }
  if (!outside) {
    for (const Line& line : lines_) {
      const double half = angle_between(line.from, line.to) / 2;
      sectors_.push_back({turned(glm::normalize(line.from), half), half, &line, nullptr});
    }
    return;
  }
  // The whole polygon is on the inner side of the edge that c lies farthest outside of. Angles from the
  // normal of that edge do not wrap around.
  struct Interval {
    double from, to;
    const Line* line;
  };
  std::vector<Interval> far, near;
  angles_.clear();
  for (const Line& line : lines_) {
    const double a = angle_between(axis, line.from), b = angle_between(axis, line.to);
    if (line.height > 0)
      far.push_back({a, b, &line});
    else
      near.push_back({b, a, &line});
    angles_.push_back(a);
    angles_.push_back(b);
  }
  std::sort(angles_.begin(), angles_.end());
  const auto at = [](const std::vector<Interval>& intervals, double angle) -> const Line* {
    for (const Interval& i : intervals)
      if (i.from <= angle && angle <= i.to) return i.line;
    return nullptr;
  };
  for (std::size_t k = 0; k + 1 < angles_.size(); ++k) {
    const double middle = (angles_[k] + angles_[k + 1]) / 2, half = (angles_[k + 1] - angles_[k]) / 2;
    if (!(half > 0)) continue;
    const Line *f = at(far, middle), *b = at(near, middle);
    // Only rounding leaves a direction without one of the two edges, and only for some 1e-16 of the
    // directions.
    if (f != nullptr && b != nullptr) sectors_.push_back({turned(axis, middle), half, f, b});
  }
}

double PathCutter::path_of(const Line& line, double along) const {
  const glm::dvec2 p = line.from + along * line.along;
  return transmit_.range(p) + receive_.range(p);
}

/// Shortest path over a part of a line, as for a plane: both apexes are rotated about the line into one
/// plane with it.
double PathCutter::shortest_path(const Line& line, double from, double to) const {
  const glm::dvec2 t = line.from - transmit_.foot, r = line.from - receive_.foot;
  const double t_along = -glm::dot(t, line.along), r_along = -glm::dot(r, line.along);
  const double t_away = std::hypot(transmit_.height, cross(t, line.along)),
               r_away = std::hypot(receive_.height, cross(r, line.along));
  return path_of(line, std::clamp((t_along * r_away + r_along * t_away) / (t_away + r_away), from, to));
}

/// Appends angles, from the sector's middle, of the points of a line whose path to a receiver has that
/// length.
void PathCutter::add_crossings(const Line& line, double path, const Apex& transmit, const Apex& receive,
                               const Sector& sector, std::vector<double>& angles) const {
  const EllipseOnRay on(path, transmit.range(line.from), receive.range(line.from),
                        glm::dot(line.from - transmit.foot, line.along),
                        glm::dot(line.from - receive.foot, line.along));
  const double discriminant = on.discriminant();
  if (!(discriminant > 0) || !(on.a > 0)) return;
  const double q = -(on.b + std::copysign(std::sqrt(discriminant), on.b));
  for (const double y : {q / on.a, on.c / q}) {
    if (!(y > 0 && y < line.length)) continue;
    const double angle = angle_between(sector.middle, line.from + y * line.along);
    if (std::abs(angle) < sector.half) angles.push_back(angle);
  }
}

/// The ellipse of path L about c. Let q be the cosine between a direction and the plane's line through the
/// apexes, and s the distance from c. Then
///   (L^2 - l^2 q^2) s^2 + q d (L^2 - l^2) s = (L^2 - l^2) (L^2 - d^2) / 4,
/// where l and d are sum and difference of the apexes' distances from c. Both apexes have the same grazing
/// angle at c.
double PathCutter::distance(const Curve& curve, glm::dvec2 direction) const {
  if (curve.line != nullptr) {
    const Line& line = *curve.line;
    return std::clamp(line.height / cross(direction, line.along), line.least, line.most);
  }
  if (curve.second) {
    // Near a ray that touches the ellipse, rounding may lose the intersection. The width of the cell is then
    // negligible.
    const std::optional<Stretch> within = in_second(curve.path, direction);
    return !within ? 0 : curve.enters ? within->enter : within->leave;
  }
  const double l = shortest_, path = curve.path;
  if (!(path > l)) return 0;
  const double d = transmit_range_ - receive_range_;
  const double gain = (path - l) * (path + l);
  // The cosine q is B / range at c. The next expression is 1 - q^2 without cancellation.
  const double q = -glm::dot(transmit_.foot, direction) / transmit_range_;
  const double sine2 = (transmit_.height * transmit_.height +
                        cross(transmit_.foot, direction) * cross(transmit_.foot, direction)) /
                       (transmit_range_ * transmit_range_);
  const double a = gain + l * l * sine2, b = q * d * gain / 2;
  const double c = gain * (path - d) * (path + d) / 4;
  const double root = std::sqrt(b * b + a * c);
  return b > 0 ? c / (b + root) : (root - b) / a;
}

void PathCutter::integrate(const Sector& sector) {
  const glm::dvec2 begin = turned(sector.middle, -sector.half), end = turned(sector.middle, sector.half);
  const double longest = std::max(path_of(*sector.far, sector.far->along_of(begin)),
                                  path_of(*sector.far, sector.far->along_of(end)));
  double least = shortest_;
  if (sector.near != nullptr) {
    const double a = sector.near->along_of(begin), b = sector.near->along_of(end);
    least = shortest_path(*sector.near, std::min(a, b), std::max(a, b));
  }
  const auto first = std::upper_bound(borders_.begin(), borders_.end(), least / 2);
  for (auto k = std::size_t(std::max<std::ptrdiff_t>(first - borders_.begin() - 1, 0));
       k + 1 < borders_.size() && 2 * borders_[k] < longest; ++k) {
    const double from = 2 * borders_[k], to = 2 * borders_[k + 1];
    angles_.assign({-sector.half, sector.half});
    for (const double path : {from, to}) {
      add_crossings(*sector.far, path, transmit_, receive_, sector, angles_);
      if (sector.near != nullptr) add_crossings(*sector.near, path, transmit_, receive_, sector, angles_);
      if (!second_) continue;
      const double later = path + second_later_;
      add_crossings(*sector.far, later, second_transmit_, *second_, sector, angles_);
      if (sector.near != nullptr)
        add_crossings(*sector.near, later, second_transmit_, *second_, sector, angles_);
      for (const double other : {from, to}) {
        if (common_transmitter_)
          add_meetings(path, other + second_later_, sector, angles_);
        else
          add_meetings_found(path, other + second_later_, sector, angles_);
      }
      add_tangents(later, sector, angles_);
    }
    std::sort(angles_.begin(), angles_.end());
    for (std::size_t i = 0; i + 1 < angles_.size(); ++i) {
      Cell cell;
      cell.half = (angles_[i + 1] - angles_[i]) / 2;
      if (!(cell.half > 0)) continue;
      cell.middle = turned(sector.middle, (angles_[i] + angles_[i + 1]) / 2);
      // The same two curves bound the whole cell.
      Curve near{nullptr, from}, far{nullptr, to};
      if (sector.near != nullptr && distance({sector.near, 0}, cell.middle) > distance(near, cell.middle))
        near = {sector.near, 0};
      if (distance({sector.far, 0}, cell.middle) < distance(far, cell.middle)) far = {sector.far, 0};
      const std::span<double> out = out_.subspan(k * work_.values, work_.values);
      second_ ? integrate_both(near, far, from + second_later_, to + second_later_, cell, out)
              : integrate_whole(near, far, cell, out);
    }
  }
}

void PathCutter::integrate_whole(const Curve& near, const Curve& far, const Cell& cell,
                                 std::span<double> out) {
  if (!(distance(far, cell.middle) > distance(near, cell.middle))) return;
  refinements_left_ = most_refined_cells;
  largest_part_ = 0;
  integrate(near, far, cell, out);
}

PathCutter::Extent PathCutter::extent_of(const Curve& near, const Curve& far, const Cell& cell) const {
  double arc = 0, ray = 0;
  bool steep = false;
  const double lo = distance(near, cell.middle), hi = distance(far, cell.middle);
  for (const double turn : {-cell.half, 0.0, cell.half}) {
    const glm::dvec2 direction = turned(cell.middle, turn);
    const double from = distance(near, direction), to = distance(far, direction);
    ray = std::max(ray, (to - from) * (cell.to - cell.from));
    arc = std::max(arc, 2 * cell.half * (from + (to - from) * cell.to));
    const auto differ = [](double x, double y) { return x > 2 * y || y > 2 * x; };
    steep = steep || (near.line != nullptr && differ(lo, from)) || (far.line != nullptr && differ(hi, to));
  }
  const glm::dvec2 centre = (lo + (hi - lo) * (cell.from + cell.to) / 2) * cell.middle;
  const auto nearest = [&](double height, glm::dvec2 foot) {
    return std::max(height, range(height, centre - foot) - arc - ray);
  };
  double away = std::min(nearest(transmit_.height, transmit_.foot), nearest(receive_.height, receive_.foot));
  if (work_.from_second)
    away = std::min({away, nearest(second_->height, second_->foot),
                     nearest(second_transmit_.height, second_transmit_.foot)});
  return {arc / away, ray / away, steep && cell.half > least_steep_half};
}

/// Sums one product rule over a cell. Returns the possible effect of the curves' rounding. Directions and
/// distances have errors of some 1e-16. A curve that runs nearly towards c converts an error of direction
/// into one of distance.
double PathCutter::tensor(const Curve& near, const Curve& far, const Cell& cell, int angles, int distances,
                          std::vector<double>& sum) {
  const GaussRule &by_angle = gauss_rule(angles), &by_distance = gauss_rule(distances);
  sum.assign(work_.values, 0);
  values_.resize(work_.values);
  double least = std::numeric_limits<double>::infinity(), farthest = 0, nearest = least, most = 0,
         largest = 0;
  for (std::size_t i = 0; i < by_angle.node.size(); ++i) {
    const glm::dvec2 direction = turned(cell.middle, cell.half * by_angle.node[i]);
    const double lo = distance(near, direction), hi = distance(far, direction), span = hi - lo;
    nearest = std::min(nearest, lo);
    most = std::max(most, lo);
    least = std::min(least, hi);
    farthest = std::max(farthest, hi);
    const double part = span * (cell.to - cell.from) / 2, begin = lo + span * cell.from;
    for (std::size_t k = 0; k < by_distance.node.size(); ++k) {
      const double s = begin + part * (1 + by_distance.node[k]);
      const glm::dvec2 p = s * direction;
      (*integrand_)(c_ + p, transmit_.range(p), receive_.range(p), values_);
      const double weight = cell.half * by_angle.weight[i] * part * by_distance.weight[k] * s;
      for (std::size_t v = 0; v < values_.size(); ++v) sum[v] += weight * values_[v];
      largest = std::max(largest, s * std::abs(values_[0]));
    }
  }
  return 1e-15 * largest * (farthest * 2 * cell.half + (farthest - least) + (most - nearest));
}

void PathCutter::integrate(const Curve& near, const Curve& far, const Cell& cell, std::span<double> out) {
  const auto halves = [&](bool split_angle, int halvings, int refinements) {
    Cell a = cell;
    a.halvings += halvings;
    a.refinements += refinements;
    Cell b = a;
    if (split_angle) {
      a.half = b.half = cell.half / 2;
      a.middle = turned(cell.middle, -a.half);
      b.middle = turned(cell.middle, a.half);
    } else {
      a.to = b.from = (cell.from + cell.to) / 2;
    }
    integrate(near, far, a, out);
    integrate(near, far, b, out);
  };
  const double smooth = std::min(work_.resolution_rad, 1.0);
  const Extent extent = extent_of(near, far, cell);
  if (cell.halvings < most_cell_halvings && (extent.steep || extent.arc + extent.ray > smooth))
    return halves(extent.steep || extent.arc > extent.ray, 1, 0);

  // The error of n nodes on an interval of length x is about (x / 4)^2n if the next singularity is at
  // distance 1.
  const auto first_rule = [&](double size) {
    std::size_t k = 0;
    while (k < most_first_rule && std::pow(size / smooth / 4, 2 * rule_orders[k]) > work_.tolerance) ++k;
    return k;
  };
  const std::size_t arc = first_rule(extent.arc), ray = first_rule(extent.ray);
  std::vector<double> coarse, fine;
  const auto error = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0;
    for (std::size_t v = 0; v < a.size(); ++v) worst = std::max(worst, std::abs(a[v] - b[v]));
    return worst;
  };
  tensor(near, far, cell, rule_orders[arc], rule_orders[ray], coarse);
  bool agree = false;
  int agreements = 0;
  const std::size_t last = rule_orders.size() - 1;
  for (std::size_t k = 1; std::max(arc, ray) + k <= last && !agree; ++k) {
    const int by_arc = rule_orders[arc + k], by_ray = rule_orders[ray + k];
    const double rounding = tensor(near, far, cell, by_arc, by_ray, fine);
    const double size = std::max(std::abs(fine[0]), negligible * largest_part_);
    agreements = error(coarse, fine) <= work_.tolerance * size + rounding ? agreements + 1 : 0;
    agree = agreements >= work_.agreements;
    coarse.swap(fine);
  }
  if (!agree && cell.refinements < work_.most_refinements && refinements_left_-- > 0) {
    const int few = rule_orders[last - 1], many = rule_orders[last];
    std::vector<double> other;
    tensor(near, far, cell, few, many, fine);
    tensor(near, far, cell, many, few, other);
    return halves(error(coarse, fine) > error(coarse, other), 0, 1);
  }
  largest_part_ = std::max(largest_part_, std::abs(coarse[0]));
  for (std::size_t v = 0; v < out.size(); ++v) out[v] += coarse[v];
}

}  // namespace tubefoot
