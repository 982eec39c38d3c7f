// SPDX-License-Identifier: GPL-3.0-or-later
// Integrates a function g of range over planar polygons, by range samples. Let rho and phi be polar
// coordinates about the foot, which is the point of the plane nearest to the apex. With r^2 = D^2 + rho^2 an
// area element is r dr dphi. Let F_k(r) be the integral of g(r) r dr from the lower border of sample k to r,
// but at most to its upper border. By Green's theorem the integral over polygon and sample k is the integral
// of F_k(r(phi)) dphi along the boundary. Chebyshev interpolants on cells (parts of samples) give F_k, and
// Gauss-Legendre rules integrate along the parts of edges that lie in one cell (stretches).

#include "geometry/integrals/range_cut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Cell = RadialIntegral::Cell;

constexpr int nodes = 12;  // of the Chebyshev interpolant of g(r) r; its degree is 11, that of its primitive
                           // 12

struct ChebyshevTables {
  std::array<double, nodes> x{};                            // Chebyshev points
  std::array<std::array<double, nodes>, nodes> cosine{};    // T_k(x_j)
  std::array<std::array<double, nodes>, nodes> monomial{};  // T_k = sum of monomial[k][i] x^i
  ChebyshevTables() {
    for (int j = 0; j < nodes; ++j) {
      const double angle = std::numbers::pi * (j + 0.5) / nodes;
      x[j] = std::cos(angle);
      for (int k = 0; k < nodes; ++k) cosine[k][j] = std::cos(k * angle);
    }
    monomial[0][0] = 1;
    monomial[1][1] = 1;
    for (int k = 2; k < nodes; ++k)
      for (int i = 0; i < nodes; ++i)
        monomial[k][i] = (i > 0 ? 2 * monomial[k - 1][i - 1] : 0.0) - monomial[k - 2][i];
  }
};

/// The integrand of a RadialIntegral.
struct Integrand {
  const std::function<double(double)>& g;
  std::span<const double> kinks;  ///< ranges at which derivatives of g may jump
  double roundings;               ///< error of g in units of 1e-15
};

/// Interpolates g(r) r on [cell.lo, cell.hi]. Returns false if the last two coefficients exceed the rounding
/// error of the values, unless `accept_inaccurate`.
bool fit(Cell& cell, const Integrand& integrand, bool accept_inaccurate) {
  static const ChebyshevTables tables;
  const double half = (cell.hi - cell.lo) / 2;
  cell.middle = cell.lo + half;
  cell.per_half = 1 / half;

  std::array<double, nodes> value{}, chebyshev{};
  for (int j = 0; j < nodes; ++j) {
    const double r = cell.middle + half * tables.x[j];
    value[j] = integrand.g(r) * r;
    if (!std::isfinite(value[j]))
      throw std::invalid_argument(fmt::format("the integrand is not finite at range {} m", r));
  }
  double largest = 0;
  for (int k = 0; k < nodes; ++k) {
    for (int j = 0; j < nodes; ++j) chebyshev[k] += value[j] * tables.cosine[k][j];
    chebyshev[k] *= (k == 0 ? 1.0 : 2.0) / nodes;
    largest = std::max(largest, std::abs(chebyshev[k]));
  }
  // The range itself is rounded. This changes the values by slope * range * rounding, which strong absorption
  // makes larger than the rounding error of g. A finer cell does not reduce this error.
  const double mean_slope = std::abs(value[0] - value[nodes - 1]) / (cell.hi - cell.lo);
  const double noise = 1e-15 * (integrand.roundings * largest + mean_slope * cell.hi) + 1e-300;
  if (std::max(std::abs(chebyshev[nodes - 1]), std::abs(chebyshev[nodes - 2])) > noise && !accept_inaccurate)
    return false;

  int degree = nodes - 1;  // omits terms below the rounding of r and g(r): narrow samples need degree 3 or 4
  while (degree > 0 && std::abs(chebyshev[degree]) <= noise) --degree;
  std::array<double, nodes> coefficient{};
  for (int k = 0; k <= degree; ++k)
    for (int i = 0; i <= k; ++i) coefficient[i] += chebyshev[k] * tables.monomial[k][i];
  cell.degree = degree + 1;
  cell.primitive.fill(0);
  for (int i = 0; i <= degree; ++i) cell.primitive[i + 1] = half * coefficient[i] / (i + 1);
  return true;
}

void append_cells(std::vector<Cell>& cells, double lo, double hi, std::size_t sample,
                  const Integrand& integrand) {
  Cell cell;
  cell.lo = lo;
  cell.hi = hi;
  cell.sample = sample;
  const bool narrow = hi - lo < 1e-10 * hi;  // too narrow to be split
  const auto kink = std::lower_bound(integrand.kinks.begin(), integrand.kinks.end(), lo);
  if (fit(cell, integrand, narrow && kink != integrand.kinks.end() && *kink <= hi)) {
    cells.push_back(cell);
    return;
  }
  if (narrow) throw std::invalid_argument(fmt::format("the integrand is not smooth at range {} m", lo));
  // Geometric halving away from the singularity of g at range 0 needs few cells. For narrow samples it equals
  // arithmetic halving.
  const double cut = hi > 2 * lo ? std::sqrt(lo * hi) : lo + (hi - lo) / 2;
  append_cells(cells, lo, cut, sample, integrand);
  append_cells(cells, cut, hi, sample, integrand);
}

/// Fewer stretches than this are integrated one by one.
constexpr std::size_t min_batch = 3;

/// Two nodes of a quadrature at once, each computed as a single double would be.
using Double2 = double __attribute__((vector_size(16)));

/// The Gauss-Legendre rule of n nodes on [-1, 1], in pairs. For odd n the last pair has a padding node of
/// weight 0.
template <unsigned n>
struct PairedRule {
  static constexpr std::size_t pairs = (n + 1) / 2;
  std::array<Double2, pairs> x{}, weight{};
  std::array<double, n> each_x{}, each_weight{};  ///< the same nodes and weights, one by one
  PairedRule() {
    using Rule = boost::math::quadrature::gauss<double, n>;
    std::size_t k = 0;
    const auto put = [&](double position, double w) {
      x[k / 2][k % 2] = each_x[k] = position;
      weight[k / 2][k % 2] = each_weight[k] = w;
      ++k;
    };
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
      put(Rule::abscissa()[i], Rule::weights()[i]);
      if (Rule::abscissa()[i] != 0) put(-Rule::abscissa()[i], Rule::weights()[i]);
    }
  }
};
const PairedRule<3> rule_of_3;
const PairedRule<4> rule_of_4;
const PairedRule<5> rule_of_5;
const PairedRule<8> rule_of_8;

RuleOfStretches rule_of(double count) {
  const auto rule = []<unsigned n>(const PairedRule<n>& pairs) {
    return RuleOfStretches{n, pairs.each_x.data(), pairs.each_weight.data()};
  };
  return count == 3   ? rule(rule_of_3)
         : count == 4 ? rule(rule_of_4)
         : count == 5 ? rule(rule_of_5)
                      : rule(rule_of_8);
}

}  // namespace

RadialIntegral::RadialIntegral(std::span<const double> borders_m, const std::function<double(double)>& g,
                               std::span<const double> kinks_m, double roundings)
    : samples_(borders_m.size() - 1) {
  if (borders_m.size() < 2) throw std::invalid_argument("range samples need at least two borders");
  for (std::size_t k = 0; k < borders_m.size(); ++k)
    if (!(borders_m[k] >= 0 && std::isfinite(borders_m[k]) && (k == 0 || borders_m[k] > borders_m[k - 1])))
      throw std::invalid_argument(fmt::format(
          "borders of range samples must be finite, not negative and increasing; border {} is {} m", k,
          borders_m[k]));
  const Integrand integrand{g, kinks_m, roundings};
  for (std::size_t k = 0; k < samples_; ++k) {
    double lo = std::max(borders_m[k], nearest_range_m);
    const double hi = borders_m[k + 1];
    for (auto kink = std::upper_bound(kinks_m.begin(), kinks_m.end(), lo);
         kink != kinks_m.end() && *kink < hi; ++kink) {
      append_cells(cells_, lo, *kink, k, integrand);
      lo = *kink;
    }
    if (hi > lo) append_cells(cells_, lo, hi, k, integrand);
  }
  if (cells_.empty()) throw std::invalid_argument("all range samples are nearer than a nanometre");
  from_front_.reserve(cells_.size());
  for (Cell& cell : cells_) {
    from_front_.emplace_back(cell, cell.lo);
    cell.whole = from_front_.back().over(cell.hi - cell.lo);
  }
  cells_per_m_ = static_cast<double>(cells_.size()) / (back() - front());
  lanes_.resize((5 + From{}.quotient_.size()) * cells_.size());
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const From& from = from_front_[k];
    double* at = lanes_.data() + k;
    const auto put = [&](double value) {
      *at = value;
      at += cells_.size();
    };
    put(cells_[k].lo);
    put(cells_[k].hi);
    put(from.x0_);
    put(from.per_half_);
    put(from.degree_);
    for (int i = 0; i < from.degree_; ++i) put(from.quotient_[std::size_t(i)]);
  }
}

CellsOfStretches RadialIntegral::cells_from(std::size_t cell, std::size_t count) const {
  const double* degrees = lane(4) + cell;
  const double degree = *std::max_element(degrees, degrees + count);
  return {lane(0) + cell, lane(2) + cell, lane(3) + cell, lane(5) + cell, cells_.size(), int(degree)};
}

std::size_t RadialIntegral::cell_at(double range_m) const {
  const double* high = highs();
  if (!(range_m >= high[0])) return 0;
  if (range_m >= high[cells_.size() - 1]) return cells_.size();
  // Samples are usually uniform and have one cell each, so that the guess is nearly always right. Cells are
  // contiguous, and a wrong guess costs a linear search.
  auto k = std::min(static_cast<std::size_t>((range_m - front()) * cells_per_m_), cells_.size() - 1);
  while (range_m >= high[k]) ++k;
  while (k > 0 && range_m < high[k - 1]) --k;
  return k;
}

RadialIntegral::From::From(const Cell& cell, double from_m)
    : x0_((from_m - cell.middle) * cell.per_half), per_half_(cell.per_half), degree_(cell.degree) {
  // Horner's scheme for (P(x) - P(x0)) / (x - x0): the coefficients of the quotient are the partial values
  // of P at x0.
  double partial = cell.primitive[static_cast<std::size_t>(degree_)];
  for (auto i = static_cast<std::size_t>(degree_); i-- > 0;) {
    quotient_[i] = partial;
    partial = partial * x0_ + cell.primitive[i];
  }
}

/// A boundary edge in the coordinates of its line: s is the position along the line from its point nearest
/// to the foot.
struct RangeCutter::Edge {
  glm::dvec2 from, from_foot;  ///< start of the edge: as the polygon's offset, and relative to the foot
  glm::dvec2 along;            ///< unit vector
  double length = 0;
  double start = 0;   ///< s of the edge's start; positions on the edge are y = s - start
  double height = 0;  ///< signed distance of the line from the foot: dphi = height ds / (height^2 + s^2)
  double range2 = 0;  ///< squared slant range of the line's nearest point
  double range = 0;
  double range_at(double y) const { return std::sqrt(range2 + (start + y) * (start + y)); }
};

RangeCutter::RangeCutter(const RadialIntegral& radial, const RadialIntegral* second)
    : radial_(radial), second_(second) {
  if (second != nullptr &&
      !std::ranges::equal(radial.cells(), second->cells(), [](const Cell& a, const Cell& b) {
        return a.lo == b.lo && a.hi == b.hi && a.sample == b.sample;
      }))
    throw std::invalid_argument("two integrands of a cutter need the same cells");
}

SampleSpan RangeCutter::add(std::span<const glm::dvec3> corners_m, const FacetPlane& plane, double factor,
                            std::span<double> out) {
  polygon_.assign(corners_m, plane, PlaneFrame(plane));
  return add(polygon_, factor, out);
}

SampleSpan RangeCutter::add(const PlanarPolygon& polygon, double factor, std::span<double> out,
                            std::span<double> second_out) {
  const std::size_t n = polygon.offsets.size();
  if (n < 3) return {};
  nearest_ = nearest_point(polygon);
  nearest_from_foot_ = polygon.first + nearest_.offset;
  const double farthest = farthest_range(polygon);
  if (!(farthest > radial_.front() && nearest_.range < radial_.back())) return {};

  // F counts from the polygon's nearest point instead of from the sample's border. The result is the same.
  // If the foot is outside, the angles add up to zero; if it is inside, it is itself the nearest point. A
  // small polygon inside a sample is then no longer a small difference of large numbers.
  const auto& cells = radial_.cells();
  first_ = radial_.cell_at(nearest_.range);
  last_ = radial_.cell_at(farthest);
  const std::size_t end = std::min(last_ + 1, cells.size());
  if (nearest_.range > cells[first_].lo) from_nearest_ = {cells[first_], nearest_.range};
  inside_.assign(end - first_, 0);
  if (second_ != nullptr) {
    if (nearest_.range > cells[first_].lo) second_from_nearest_ = {second_->cells()[first_], nearest_.range};
    second_inside_.assign(end - first_, 0);
  }
  angle_.assign(end - first_ + 1, 0);

  for (std::size_t i = 0; i < n; ++i) {
    Edge edge;
    edge.from = polygon.offsets[i];
    const glm::dvec2 to = polygon.offsets[i + 1 == n ? 0 : i + 1];
    edge.length = glm::length(to - edge.from);
    if (!(edge.length > 0)) continue;
    edge.along = (to - edge.from) / edge.length;
    edge.from_foot = polygon.first + edge.from;
    edge.start = glm::dot(edge.from_foot, edge.along);
    edge.height = cross(edge.from_foot, edge.along);
    edge.range2 = polygon.distance * polygon.distance + edge.height * edge.height;
    edge.range = std::sqrt(edge.range2);
    walk(edge);
  }

  // Boundary in a cell counts its integral of F dphi. Boundary beyond the cell counts the whole cell times
  // its angle about the foot.
  double angle_beyond = angle_.back();
  for (std::size_t k = end; k-- > first_;) {
    const Cell& cell = cells[k];
    // Only the first cell can begin before the nearest point.
    const double whole = nearest_.range > cell.lo ? from_nearest_.over(cell.hi - nearest_.range) : cell.whole;
    out[cell.sample] += factor * (inside_[k - first_] + angle_beyond * whole);
    if (second_ != nullptr) {
      const double second_whole = nearest_.range > cell.lo
                                      ? second_from_nearest_.over(cell.hi - nearest_.range)
                                      : second_->cells()[k].whole;
      second_out[cell.sample] += factor * (second_inside_[k - first_] + angle_beyond * second_whole);
    }
    angle_beyond += angle_[k - first_];
  }
  return {cells[first_].sample, cells[end - 1].sample + 1};
}

void RangeCutter::walk(const Edge& edge) {
  // An edge whose line passes through the foot, except for rounding, contributes nothing. Away from the foot
  // it has no angle. At the foot, where the angle may change by pi, F is still 0.
  if (std::abs(edge.height) <= 1e-14 * (std::abs(edge.start) + edge.length)) return;
  const double nearest = -edge.start;
  if (nearest < edge.length) walk_outwards(edge, std::max(nearest, 0.0), edge.length);
  if (nearest > 0) walk_outwards(edge, std::min(nearest, edge.length), 0);
}

/// Follows the edge from its nearest position to an end, cell by cell.
void RangeCutter::walk_outwards(const Edge& edge, double from, double to) {
  const auto& cells = radial_.cells();
  const double direction = to >= from ? 1 : -1;
  const double range_to = edge.range_at(to);
  // Position at which the range equals a border. The clamp keeps rounding from moving it off the rest of the
  // edge.
  const auto crossing = [&](double border, double y) {
    const double s = std::sqrt(std::max((border - edge.range) * (border + edge.range), 0.0));
    return std::clamp(direction * s - edge.start, std::min(y, to), std::max(y, to));
  };

  double y = from, range = edge.range_at(from);
  if (range < radial_.front()) {
    if (range_to <= radial_.front()) return;
    y = crossing(radial_.front(), y);
    range = radial_.front();
  }
  // Rounding may move these ranges slightly outside of the polygon's own.
  const std::size_t first = std::clamp(radial_.cell_at(range), first_, last_);
  const double* highs = radial_.highs();
  std::size_t last = first;
  while (last < cells.size() && !(range_to <= highs[last] || last == last_)) ++last;
  const bool ends = last < cells.size();
  const std::size_t crossed = last - first;
  if (crossed < min_batch) {
    for (std::size_t k = first; k < last; ++k) {
      const double end = crossing(highs[k], y);
      integrate(edge, k, y, end);
      y = end;
    }
    if (ends) return integrate(edge, last, y, to);
  } else {
    ends_.resize(crossed + 2);
    ends_[0] = y;
    distances_to_borders(edge.range, crossed, highs + first, ends_.data() + 1);
    for (std::size_t k = 1; k <= crossed; ++k) {
      const double at = direction * ends_[k] - edge.start;
      y = ends_[k] = std::clamp(at, std::min(y, to), std::max(y, to));
    }
    ends_[crossed + 1] = to;
    integrate_along(edge, direction, first, ends ? crossed + 1 : crossed);
    if (ends) return;
  }
  const glm::dvec2 a = edge.from_foot + y * edge.along, b = edge.from_foot + to * edge.along;
  angle_.back() += direction * std::atan2(cross(a, b), glm::dot(a, b));
}

/// Adds the stretches of ends_, each in its cell. Stretches with the same rule are integrated together.
void RangeCutter::integrate_along(const Edge& edge, double direction, std::size_t first, std::size_t count) {
  const EdgeWalk walk{.start = edge.start,
                      .height = edge.height,
                      .height2 = edge.height * edge.height,
                      .range2 = edge.range2,
                      .direction = direction,
                      .along = edge.along,
                      .from_foot = edge.from_foot,
                      .from_nearest_point = edge.from - nearest_.offset,
                      .nearest_from_foot = nearest_from_foot_,
                      .near_range = nearest_.range};
  step_.resize(count);
  rule_.resize(count);
  nodes_of_stretches(walk, count, ends_.data(), step_.data(), rule_.data());
  std::array<double, most_stretches> angle, inside;
  for (std::size_t k = 0; k < count;) {
    const bool alone = rule_[k] == 0 || nearest_.range > radial_.lows()[first + k];
    std::size_t end = k + 1;
    while (!alone && end < count && end - k < most_stretches && rule_[end] == rule_[k]) ++end;
    if (end - k < min_batch) {
      for (; k < end; ++k) integrate(edge, first + k, ends_[k], ends_[k + 1]);
      continue;
    }
    integrate_stretches(walk, end - k, ends_.data() + k, step_.data() + k,
                        radial_.cells_from(first + k, end - k), rule_of(rule_[k]), angle.data(),
                        inside.data());
    for (std::size_t i = 0; i < end - k; ++i) {
      inside_[first + k + i - first_] += inside[i];
      angle_[first + k + i - first_] += angle[i];
    }
    if (second_ != nullptr) {
      integrate_stretches(walk, end - k, ends_.data() + k, step_.data() + k,
                          second_->cells_from(first + k, end - k), rule_of(rule_[k]), angle.data(),
                          inside.data());
      for (std::size_t i = 0; i < end - k; ++i) second_inside_[first + k + i - first_] += inside[i];
    }
    k = end;
  }
}

/// Adds one stretch of an edge that lies in one cell. The nearest singularities of the integrand are those
/// of 1 / (height^2 + s^2), as far from the stretch as the foot is. On intervals of at most half that
/// distance Gauss-Legendre converges like 8^-2n (Trefethen, Approximation Theory and Approximation Practice,
/// theorem 19.3). Most intervals are shorter and need fewer nodes. Angles and weights have the sense of the
/// edge, whatever the direction of the walk.
void RangeCutter::integrate(const Edge& edge, std::size_t k, double from, double to) {
  const Cell& cell = radial_.cells()[k];
  const bool from_nearest = nearest_.range > cell.lo;
  const RadialIntegral::From& radial = from_nearest ? from_nearest_ : radial_.from_front(k);
  const double skipped = (from_nearest ? nearest_.range : cell.lo) - nearest_.range;
  const double direction = to >= from ? 1 : -1;
  const double height2 = edge.height * edge.height, near_range = nearest_.range;
  const glm::dvec2 from_nearest_point = edge.from - nearest_.offset, along_edge = edge.along,
                   from_foot = edge.from_foot, nearest_from_foot = nearest_from_foot_;
  const RadialIntegral::From* const second = second_ == nullptr ? nullptr
                                             : from_nearest     ? &second_from_nearest_
                                                                : &second_->from_front(k);
  double inside = 0, angle = 0, second_inside = 0;

  double y = from, rest = std::abs(to - from);
  while (rest > 0) {
    const double s = edge.start + y, distance = std::sqrt(s * s + height2);
    double step = std::min(rest, distance / 2);
    if (rest - step < step / 4) step = rest;  // no short step at the end
    const double half = direction * step / 2, centre = y + half;

    const auto quadrature = [&]<unsigned n>(const PairedRule<n>& rule) {
      constexpr std::size_t pairs = PairedRule<n>::pairs;
      std::array<Double2, pairs> dphi, range_increment;
#pragma GCC unroll 4
      for (std::size_t p = 0; p < pairs; ++p) {
        const Double2 along = centre + half * rule.x[p], at = edge.start + along, at2 = at * at;
        dphi[p] = step / 2 * (rule.weight[p] * edge.height / (height2 + at2));
        const Double2 range2 = edge.range2 + at2, range{std::sqrt(range2[0]), std::sqrt(range2[1])};
        const Double2 reach_x = along * along_edge.x, reach_y = along * along_edge.y;
        // range - nearest range, without cancellation
        range_increment[p] =
            ((from_nearest_point.x + reach_x) * (from_foot.x + reach_x + nearest_from_foot.x) +
             (from_nearest_point.y + reach_y) * (from_foot.y + reach_y + nearest_from_foot.y)) /
                (range + near_range) -
            skipped;
      }
      const std::array<Double2, pairs> primitive_increment = radial.over(range_increment);
#pragma GCC unroll 8
      for (std::size_t i = 0; i < n; ++i) {
        angle += dphi[i / 2][i % 2];
        inside += dphi[i / 2][i % 2] * primitive_increment[i / 2][i % 2];
      }
      if (second != nullptr) {
        const std::array<Double2, pairs> second_increment = second->over(range_increment);
        for (std::size_t i = 0; i < n; ++i)
          second_inside += dphi[i / 2][i % 2] * second_increment[i / 2][i % 2];
      }
    };
    // The relative error of n nodes is about (step / (4 distance))^2n. It is 1e-17 at the limits of 3, 4 and
    // 5 nodes, and 4e-15 for the longest steps of 8 nodes.
    if (step <= 0.006 * distance)
      quadrature(rule_of_3);
    else if (step <= 0.03 * distance)
      quadrature(rule_of_4);
    else if (step <= 0.08 * distance)
      quadrature(rule_of_5);
    else
      quadrature(rule_of_8);
    y += direction * step;
    rest -= step;
  }
  inside_[k - first_] += inside;
  if (second != nullptr) second_inside_[k - first_] += second_inside;
  angle_[k - first_] += angle;
}

}  // namespace tubefoot
