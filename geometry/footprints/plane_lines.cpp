// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/plane_lines.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <type_traits>

// Computes lines, their predicates and their intersections with integers of up to 2304 bits (HugeInt).
// Predicates are evaluated in double first, with an error bound. The integers decide only the remaining
// cases.

namespace tubefoot {
namespace {

/// mantissa * 2^exponent, for integers beyond the range of double.
struct Scaled {
  double mantissa = 0;
  int exponent = 0;
};

/// The relative error is at most 2^-53 + 2^-62.
Scaled scaled(const HugeInt& x) {
  if (x == 0) return {};
  const auto& limbs = x.backend();
  static_assert(std::numeric_limits<std::remove_cvref_t<decltype(*limbs.limbs())>>::digits == 64);
  const std::size_t last = limbs.size() - 1;
  std::uint64_t top = limbs.limbs()[last];
  const int empty = std::countl_zero(top);
  if (empty > 0 && last > 0) top = top << empty | limbs.limbs()[last - 1] >> (64 - empty);
  const int shift = last > 0 ? 64 * int(last) - empty : 0;
  const auto size = static_cast<double>(top);
  return {limbs.sign() ? -size : size, shift};
}

double times_power(const Scaled& x, int exponent) { return std::ldexp(x.mantissa, x.exponent + exponent); }

double quotient(const HugeInt& numerator, const HugeInt& denominator) {
  const Scaled n = scaled(numerator), d = scaled(denominator);
  return std::ldexp(n.mantissa / d.mantissa, n.exponent - d.exponent);
}

HugeInt huge(std::int64_t x) { return HugeInt(x); }

HugeInt huge(Int128 x) {
  const UInt128 magnitude = x < 0 ? -static_cast<UInt128>(x) : static_cast<UInt128>(x);
  HugeInt value;
  auto& limbs = value.backend();
  limbs.resize(2, 2);
  limbs.limbs()[0] = static_cast<std::uint64_t>(magnitude);
  limbs.limbs()[1] = static_cast<std::uint64_t>(magnitude >> 64);
  limbs.sign(x < 0);
  limbs.normalize();
  return value;
}

/// Returns the normal in 64 bits if it fits, as normals of planes through two points do. Nearly all walls are
/// such planes.
std::optional<Vec64> narrow(const std::array<HugeInt, 3>& m) {
  std::array<std::int64_t, 3> parts{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& limbs = m[k].backend();
    if (limbs.size() > 1 || limbs.limbs()[0] >> 61 != 0) return std::nullopt;
    const auto size = static_cast<std::int64_t>(limbs.limbs()[0]);
    parts[k] = limbs.sign() ? -size : size;
  }
  return Vec64{parts[0], parts[1], parts[2]};
}

std::array<std::int64_t, 3> parts(const Vec64& v) { return {v.x, v.y, v.z}; }
std::array<std::int64_t, 3> parts(GridPoint p) { return {p.x, p.y, p.z}; }

/// Returns whether the second line continues the first one: their normals are parallel.
bool parallel(const PlaneLine& p, const PlaneLine& q) {
  const double x = p.a_near * q.b_near, y = p.b_near * q.a_near;
  if (std::abs(x - y) > 1e-14 * (std::abs(x) + std::abs(y))) return false;
  return HugeInt(p.a * q.b) == HugeInt(p.b * q.a);
}

}  // namespace

FacetChart::FacetChart(const FacetCone& facet) {
  const auto n = parts(facet.normal);
  for (int k = 0; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[w])) w = k;
  u = (w + 1) % 3;
  v = (w + 2) % 3;
  if (n[w] < 0) std::swap(u, v);
}

std::array<HugeInt, 3> wall_normal(const WideVec& from, const WideVec& to) {
  const auto product = [](const WideInt& x, const WideInt& y) { return HugeInt(HugeInt(x) * HugeInt(y)); };
  std::array<HugeInt, 3> m;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    m[k] = product(from[i], to[j]) - product(from[j], to[i]);
  }
  return m;
}

PlaneLine PlaneLine::on_plane(const FacetCone& facet, const FacetChart& chart,
                              const std::array<HugeInt, 3>& m) {
  const auto [u, v, w] = chart;
  // The wall's inward normal is m. On the plane n . (x - V) = 0 of the facet, times n_w,
  //   m . x = m . V + (m_u - m_w n_u / n_w) (x - V)_u + (m_v - m_w n_v / n_w) (x - V)_v.
  const auto n = parts(facet.normal), vertex = parts(facet.point[0]);
  const std::int64_t turn = n[w] < 0 ? -1 : 1;
  if (const auto small = narrow(m)) {
    const auto wall = parts(*small);
    return of(huge(turn * (Int128(wall[u]) * n[w] - Int128(wall[w]) * n[u])),
              huge(turn * (Int128(wall[v]) * n[w] - Int128(wall[w]) * n[v])),
              huge(turn * n[w]) * huge(dot(*small, facet.point[0])));
  }
  const HugeInt nu = huge(turn * n[u]), nv = huge(turn * n[v]), nw = huge(turn * n[w]);
  return of(m[u] * nw - m[w] * nu, m[v] * nw - m[w] * nv,
            nw * HugeInt(m[0] * huge(vertex[0]) + m[1] * huge(vertex[1]) + m[2] * huge(vertex[2])));
}

PlaneLine PlaneLine::through_image(const FacetCone& image, const FacetCone& charted, const FacetChart& chart,
                                   const std::array<HugeInt, 3>& normal) {
  ChartCorners corners;
  const auto origin = parts(charted.point[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto q = parts(charted.point[k]);
    corners[k] = {q[std::size_t(chart.u)] - origin[std::size_t(chart.u)],
                  q[std::size_t(chart.v)] - origin[std::size_t(chart.v)]};
  }
  return on_image(image.point, corners, normal);
}

PlaneLine PlaneLine::on_image(const std::array<GridPoint, 3>& corners, const ChartCorners& on_chart,
                              const std::array<HugeInt, 3>& m) {
  // The signed distance is an affine function on the facet, which its values at the three vertices define.
  std::array<HugeInt, 3> at;
  std::array<HugeInt, 3> u, v;  // relative to the first
  for (std::size_t k = 0; k < 3; ++k) {
    const auto p = parts(corners[k]);
    at[k] = m[0] * huge(p[0]) + m[1] * huge(p[1]) + m[2] * huge(p[2]);
    u[k] = huge(on_chart[k][0] - on_chart[0][0]);
    v[k] = huge(on_chart[k][1] - on_chart[0][1]);
  }
  const HugeInt first = at[1] - at[0], second = at[2] - at[0];
  const HugeInt a = first * v[2] - second * v[1], b = second * u[1] - first * u[2];
  return of(a, b, at[0] * (u[1] * v[2] - u[2] * v[1]) - a * huge(on_chart[0][0]) - b * huge(on_chart[0][1]));
}

PlaneLine PlaneLine::of(HugeInt a_exact, HugeInt b_exact, HugeInt c_exact) {
  PlaneLine line{std::move(a_exact), std::move(b_exact), std::move(c_exact)};
  if (line.is_none()) return line;
  const Scaled a = scaled(line.a), b = scaled(line.b), c = scaled(line.c);
  const auto size = [](const Scaled& x) {
    return x.mantissa == 0 ? std::numeric_limits<int>::min() : std::ilogb(x.mantissa) + x.exponent;
  };
  const int power = -std::max(size(a), size(b));
  line.a_near = times_power(a, power);
  line.b_near = times_power(b, power);
  line.c_near = times_power(c, power);
  return line;
}

int side(const PlaneLine& p, const PlaneLine& q, const PlaneLine& r) {
  // Doubles are tried first. The relative error of the coefficients is 2^-52 and eight roundings follow. The
  // error is therefore below 2e-15 of the sum of the six products' magnitudes.
  const double first = p.a_near * q.b_near, second = p.b_near * q.a_near, third = p.b_near * q.c_near,
               fourth = p.c_near * q.b_near, fifth = p.c_near * q.a_near, sixth = p.a_near * q.c_near;
  const double value = (first - second) * r.c_near + (third - fourth) * r.a_near + (fifth - sixth) * r.b_near;
  const double size = (std::abs(first) + std::abs(second)) * std::abs(r.c_near) +
                      (std::abs(third) + std::abs(fourth)) * std::abs(r.a_near) +
                      (std::abs(fifth) + std::abs(sixth)) * std::abs(r.b_near);
  if (size > 1e-200 && std::abs(value) > 1e-14 * size) return value > 0 ? 1 : -1;
  HugeInt exact = HugeInt(p.a * q.b - p.b * q.a) * r.c;
  exact += HugeInt(p.b * q.c - p.c * q.b) * r.a;
  exact += HugeInt(p.c * q.a - p.a * q.c) * r.b;
  return exact.sign();
}

LinePolygon line_polygon(const std::vector<PlaneLine>& lines) {
  LinePolygon polygon;
  for (const PlaneLine& line : lines)
    if (!line.is_none() && (polygon.empty() || !parallel(*polygon.back(), line))) polygon.push_back(&line);
  while (polygon.size() > 1 && parallel(*polygon.back(), *polygon.front())) polygon.pop_back();
  if (polygon.size() < 3) polygon.clear();
  return polygon;
}

void clip(LinePolygon& polygon, const PlaneLine& line, std::vector<int>& sides) {
  const std::size_t n = polygon.size();
  sides.resize(n);  // of the corner at which edge k begins
  bool some_in = false, some_out = false;
  for (std::size_t k = 0; k < n; ++k) {
    sides[k] = side(*polygon[k == 0 ? n - 1 : k - 1], *polygon[k], line);
    some_in = some_in || sides[k] > 0;
    some_out = some_out || sides[k] < 0;
  }
  if (!some_out) return;
  if (!some_in) {
    polygon.clear();
    return;
  }
  LinePolygon rest;
  for (std::size_t k = 0; k < n; ++k) {
    const int begin = sides[k], end = sides[k + 1 == n ? 0 : k + 1];
    if (begin <= 0 && end <= 0) continue;
    rest.push_back(polygon[k]);
    // The new line follows where the polygon leaves the half-plane: inside this edge, or at its end if the
    // next edge is outside.
    if (end < 0 || (end == 0 && sides[(k + 2) % n] < 0)) rest.push_back(&line);
  }
  polygon.swap(rest);
}

glm::dvec2 meeting_point(const PlaneLine& p, const PlaneLine& q) {
  const HugeInt x = p.b * q.c - p.c * q.b, y = p.c * q.a - p.a * q.c, z = p.a * q.b - p.b * q.a;
  return {quotient(x, z), quotient(y, z)};
}

glm::dvec3 meeting_point(const FacetCone& facet, const FacetChart& chart, const PlaneLine& p,
                         const PlaneLine& q) {
  const auto [u, v, w] = chart;
  const HugeInt x = p.b * q.c - p.c * q.b, y = p.c * q.a - p.a * q.c, z = p.a * q.b - p.b * q.a;
  const auto n = parts(facet.normal), vertex = parts(facet.point[0]);
  glm::dvec3 point;
  point[u] = quotient(x + huge(vertex[u]) * z, z);
  point[v] = quotient(y + huge(vertex[v]) * z, z);
  const HugeInt nz = huge(n[w]) * z;
  point[w] = quotient(huge(vertex[w]) * nz - huge(n[u]) * x - huge(n[v]) * y, nz);
  return point;
}

}  // namespace tubefoot
