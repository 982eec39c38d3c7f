// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/path_polygon_gradient.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <tuple>
#include <utility>

#include "geometry/integrals/gauss_rules.hpp"

// Differentiates the integral over a polygon. The integrand changes over the area. Reynolds' theorem gives
// the motion of the edges, and of the ellipses at the borders of range bins.

namespace tubefoot {
namespace {

using PathNumbers = PathDerivatives;

constexpr int most_halvings = 40;
constexpr std::array<int, 5> path_rules{4, 6, 9, 13, 18};

double cross_of(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// The logarithm of the factor of one leg in the density. Its derivative by the foot point is `slope` times
/// the offset of the point from the foot point, divided by the squared range.
struct LegSlopes {
  glm::dvec2 offset;
  double range, sine, cosine, slope, by_log_distance;

  LegSlopes(const EndOverPlane& end, glm::dvec2 p, const ScatteringModel* model, double beta)
      : offset(p - end.over.foot), range(end.range(p)) {
    sine = std::min(end.over.distance / range, 1.0);
    cosine = glm::length(offset) / range;
    double of_lobe = 1;
    if (model != nullptr) {
      const CrossSectionSlopes slopes = slopes_of(*model, sine, cosine);
      of_lobe = slopes.by_log_sine;
      if (cosine > 0) of_lobe -= slopes.by_incidence * sine / cosine;
      of_lobe = slopes.value > 0 ? of_lobe / (2 * slopes.value) : 0;
    }
    const double spread = beta * range + 2;
    slope = of_lobe + spread;
    by_log_distance = of_lobe * cosine * cosine - spread * sine * sine;
  }
};

/// Energy per area at a point.
double density_at(const PathOnFacet& path, glm::dvec2 p, double tx_range, double rx_range) {
  const double energy = path.density_at(tx_range, rx_range) * path.texture_at(p);
  return path.over_mirrors() ? energy * path.passed(path.directions(p, tx_range, rx_range)) : energy;
}

std::size_t rough_normals(const MirrorLoss* loss) { return loss != nullptr ? loss->rough_normals.size() : 0; }

/// Derivatives of the logarithm of the loss of one leg by the distance of its apex from the plane, and by the
/// foot point. Normals are at rest. Adds those by the normals, and by the roughness, times `energy`.
struct LossSlopes {
  double by_distance = 0;
  glm::dvec2 by_foot{0};

  LossSlopes() = default;
  LossSlopes(const MirrorLoss* loss, const EndOverPlane& end, glm::dvec2 p, double range, double energy,
             double& by_roughness, double* by_normals) {
    if (rough_normals(loss) == 0) return;
    const glm::dvec3 direction = end.direction(p, range), u = end.seen.u, v = end.seen.v,
                     away = glm::cross(u, v);  // opposite to the normal towards the apexes
    const glm::dvec2 offset = p - end.over.foot;
    for (const glm::dvec3& normal : loss->rough_normals) {
      const double sine = glm::dot(direction, normal), by_sine = -2 * loss->roughness * sine;
      by_distance += by_sine * (glm::dot(away, normal) - sine * end.over.distance / range) / range;
      by_foot +=
          by_sine * (sine * offset / range - glm::dvec2(glm::dot(u, normal), glm::dot(v, normal))) / range;
      by_roughness -= energy * loss->roughness * sine * sine;
      for (int k = 0; k < 3; ++k) *by_normals++ = energy * by_sine * direction[k];
    }
  }
};

}  // namespace

const PathDerivatives* PathPolygonGradient::of(const PlanarPolygon& polygon, std::span<const PathEdge> edges,
                                               const PathOnFacet& path,
                                               std::span<const ScatteringDerivative* const> parameters) {
  std::tie(out_.first_bin, out_.end_bin) = cutter_.samples_of(polygon, path.rx.over);
  if (out_.first_bin >= out_.end_bin) return nullptr;
  const ReflectivityGradient* texture = texture_of(path);
  out_.count = PathNumbers::own_parameters + parameters.size();
  out_.texture = texture != nullptr ? out_.count : 0;
  if (texture != nullptr) out_.count += PathNumbers::by_place + 3;
  const std::size_t normals = rough_normals(path.tx_loss) + rough_normals(path.rx_loss);
  out_.loss = normals > 0 ? out_.count : 0;
  if (normals > 0) out_.count += PathNumbers::by_rough_normal + 3 * normals;
  out_.numbers.assign((out_.end_bin - out_.first_bin) * out_.count, 0);
  out_.parts.clear();
  cells_.cut(polygon, path.lies, path.seabed.texture,
             [&](const PlanarPolygon& part) { add_area(part, path, parameters, texture); });
  add_edges(polygon, edges, path);
  add_arcs(polygon, path);
  return &out_;
}

const ReflectivityGradient* PathPolygonGradient::texture_of(const PathOnFacet& path) {
  const ReflectivityField* field = path.seabed.texture;
  if (field == nullptr) return nullptr;
  auto known =
      std::ranges::find(textures_, field, &std::pair<const ReflectivityField*, ReflectivityGradient>::first);
  if (known == textures_.end()) known = textures_.insert(known, {field, ReflectivityGradient(*field)});
  return &known->second;
}

void PathPolygonGradient::add_area(const PlanarPolygon& polygon, const PathOnFacet& path,
                                   std::span<const ScatteringDerivative* const> parameters,
                                   const ReflectivityGradient* texture) {
  const auto [first, end] = cutter_.samples_of(polygon, path.rx.over);
  if (first >= end) return;
  Smoothness smooth;
  smooth.take(path.seabed);
  smooth.angle_rad = std::min(smooth.angle_rad, mirrors_angle_rad_);
  PathCutter::Work work = smooth.work(tolerance_);
  // The integrand of by_borders is 0, and all others are relative to the energy in size.
  const std::size_t peak = texture != nullptr ? 1 : 0;  // a value to which errors are relative
  work.values = peak + out_.count;
  sums_.resize(std::max(sums_.size(), (borders_.size() - 1) * work.values), 0);
  const ScatteringModel* model = path.seabed.scattering;
  const double length = path.tx.over.distance + path.rx.over.distance;
  cutter_.add(
      polygon, path.rx.over,
      [&](glm::dvec2 p, double tx_range, double rx_range, std::span<double> all) {
        const std::span<double> values = all.subspan(peak);
        const ReflectivityGradient::Value factor =
            texture != nullptr ? texture->at(path.lies.at(p)) : ReflectivityGradient::Value();
        double uniform = path.density_at(tx_range, rx_range);
        if (path.over_mirrors()) uniform *= path.passed(path.directions(p, tx_range, rx_range));
        const double energy = uniform * factor.factor;
        const LegSlopes tx(path.tx, p, model, path.beta_per_m), rx(path.rx, p, model, path.beta_per_m);
        values[PathNumbers::energy] = energy;
        values[PathNumbers::by_absorption] = -energy * (tx_range + rx_range) / length;
        values[PathNumbers::by_borders] = 0;
        LossSlopes tx_loss, rx_loss;
        if (out_.loss > 0) {
          double* own = &values[out_.loss];
          own[PathNumbers::by_roughness] = 0;
          double* by_normals = own + PathNumbers::by_rough_normal;
          const auto slopes = [&](const MirrorLoss* loss, const EndOverPlane& leg, double range) {
            return LossSlopes(loss, leg, p, range, energy, own[PathNumbers::by_roughness], by_normals);
          };
          tx_loss = slopes(path.tx_loss, path.tx, tx_range);
          by_normals += 3 * rough_normals(path.tx_loss);
          rx_loss = slopes(path.rx_loss, path.rx, rx_range);
        }
        values[PathNumbers::by_tx_distance] =
            energy * (tx.by_log_distance + path.tx.over.distance * tx_loss.by_distance);
        values[PathNumbers::by_rx_distance] =
            energy * (rx.by_log_distance + path.rx.over.distance * rx_loss.by_distance);
        const glm::dvec2 by_foot =
            energy * path.rx.over.distance * (rx.slope / (rx.range * rx.range) * rx.offset + rx_loss.by_foot);
        values[PathNumbers::by_foot] = by_foot.x;
        values[PathNumbers::by_foot + 1] = by_foot.y;
        for (std::size_t k = 0; k < parameters.size(); ++k) {
          double relative = 0;
          for (const LegSlopes* leg : {&tx, &rx})
            relative += parameters[k]->cross_section(leg->sine, leg->cosine) /
                        model->cross_section(leg->sine, leg->cosine);
          values[PathNumbers::own_parameters + k] = energy / 2 * relative;
        }
        if (texture == nullptr) return;
        all[0] = energy + uniform * tx_range * glm::length(factor.gradient);
        // The plane is at -D n + x u + y v from the transmit apex, and u x v = -n.
        const glm::dvec3 slope = uniform * factor.gradient;
        const double distance = path.tx.over.distance,
                     across = -glm::dot(slope, glm::cross(path.lies.u, path.lies.v));
        values[PathNumbers::by_tx_distance] -= distance * across;
        double* own = &values[out_.texture];
        own[PathNumbers::by_tilt] = -distance * glm::dot(slope, path.lies.u) - p.x * across;
        own[PathNumbers::by_tilt + 1] = -distance * glm::dot(slope, path.lies.v) - p.y * across;
        for (int k = 0; k < 3; ++k) own[PathNumbers::by_place + std::size_t(k)] = length * slope[k];
      },
      work, std::span(sums_).first((borders_.size() - 1) * work.values));
  const double tx = path.tx.over.distance, rx = path.rx.over.distance;
  scale_.assign(out_.count, 1);
  scale_[PathNumbers::by_absorption] = length;
  scale_[PathNumbers::by_tx_distance] = 1 / tx;
  for (const std::size_t k : {0, 1, 2}) scale_[PathNumbers::by_rx_distance + k] = 1 / rx;
  for (const std::size_t k : {0, 1, 2})
    if (texture != nullptr) scale_[out_.texture + PathNumbers::by_place + k] = 1 / length;
  for (std::size_t bin = first; bin < end; ++bin) {
    double* sums = &sums_[bin * work.values];
    if (bin >= out_.first_bin && bin < out_.end_bin)
      for (std::size_t k = 0; k < out_.count; ++k) out_.at(bin)[k] += scale_[k] * sums[peak + k];
    std::fill(sums, sums + work.values, 0.0);
  }
}

/// Values are relative to values[0] in size. The order of the rule rises until two rules agree; otherwise the
/// interval is halved.
void PathPolygonGradient::integrate(double from, double to, const Function& function, std::span<double> sum,
                                    int halvings) {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  values_.resize(sum.size());
  for (const int nodes : path_rules) {
    std::swap(coarse_, fine_);
    fine_.assign(sum.size(), 0);
    const GaussRule& rule = gauss_rule(nodes);
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      function(middle + half * rule.node[k], values_);
      for (std::size_t v = 0; v < sum.size(); ++v) fine_[v] += half * rule.weight[k] * values_[v];
    }
    if (nodes == path_rules.front()) continue;
    double change = 0;
    for (std::size_t v = 0; v < sum.size(); ++v) change = std::max(change, std::abs(fine_[v] - coarse_[v]));
    if (!(change > tolerance_ * std::abs(fine_[0])) ||
        (nodes == path_rules.back() && halvings == most_halvings)) {
      for (std::size_t v = 0; v < sum.size(); ++v) sum[v] += fine_[v];
      return;
    }
  }
  integrate(from, middle, function, sum, halvings + 1);
  integrate(middle, to, function, sum, halvings + 1);
}

void PathPolygonGradient::add_edges(const PlanarPolygon& polygon, std::span<const PathEdge> edges,
                                    const PathOnFacet& path) {
  const std::size_t corners = polygon.offsets.size();
  for (std::size_t edge = 0; edge < corners; ++edge) {
    const glm::dvec2 first = polygon.corner(edge),
                     along = polygon.offsets[(edge + 1) % corners] - polygon.offsets[edge],
                     line = edges[edge].to - edges[edge].from;
    const double length = glm::length(along), line_length = glm::length(line);
    if (!(length > 0 && line_length > 0)) continue;
    const glm::dvec2 unit = along / length, outward = glm::dvec2(line.y, -line.x) / line_length;
    const double begin = glm::dot(first - edges[edge].from, line) / (line_length * line_length),
                 slope = glm::dot(unit, line) / (line_length * line_length);
    const double rt = path.tx.range(first), rr = path.rx.range(first), bt = glm::dot(unit, first),
                 br = glm::dot(unit, first - path.rx.over.foot);
    breaks_.assign({0, length});
    for (std::size_t k = out_.first_bin; k <= out_.end_bin; ++k) {
      const PathCutter::EllipseOnRay ellipse(2 * borders_[k], rt, rr, bt, br);
      const double discriminant = ellipse.discriminant();
      if (!(discriminant > 0 && ellipse.a > 0)) continue;
      const double q = -(ellipse.b + std::copysign(std::sqrt(discriminant), ellipse.b));
      for (const double x : {q / ellipse.a, ellipse.c / q})
        if (x > 0 && x < length) breaks_.push_back(x);
    }
    if (path.seabed.texture != nullptr) {
      const glm::dvec3 start = path.lies.at(first), stop = path.lies.at(first + along);
      for (const CellPlanes& planes : path.seabed.texture->cells()) {
        const double a = (glm::dot(planes.normal, start) - planes.offset_m) / planes.spacing_m,
                     b = (glm::dot(planes.normal, stop) - planes.offset_m) / planes.spacing_m;
        for (double k = std::ceil(std::min(a, b)); k <= std::max(a, b); ++k)
          if (const double share = (k - a) / (b - a); share > 0 && share < 1)
            breaks_.push_back(share * length);
      }
    }
    std::sort(breaks_.begin(), breaks_.end());
    for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
      const double from = breaks_[k], to = breaks_[k + 1];
      if (!(to > from)) continue;
      const glm::dvec2 middle = first + (from + to) / 2 * unit;
      const double half_path = (path.tx.range(middle) + path.rx.range(middle)) / 2;
      const auto above =
          std::size_t(std::upper_bound(borders_.begin(), borders_.end(), half_path) - borders_.begin());
      if (above == 0 || above == borders_.size()) continue;
      const std::size_t bin = std::clamp(above - 1, out_.first_bin, out_.end_bin - 1);
      std::array<double, 2> sum{};
      integrate(
          from, to,
          [&](double x, std::span<double> values) {
            const glm::dvec2 p = first + x * unit;
            values[0] = density_at(path, p, path.tx.range(p), path.rx.range(p));
            values[1] = values[0] * (begin + x * slope);
          },
          sum);
      out_.parts.push_back({bin, edge, (sum[0] - sum[1]) * outward, sum[1] * outward});
    }
  }
}

/// Fills `breaks_` with the angles, about the point of shortest path, at which an ellipse of equal path
/// crosses the border of the polygon. The first angle is repeated after a full turn.
void PathPolygonGradient::find_arcs(const PlanarPolygon& polygon, const PathOnFacet& path, double border) {
  const glm::dvec2 foot = path.rx.over.foot,
                   centre = foot * (path.tx.over.distance / (path.tx.over.distance + path.rx.over.distance));
  const std::size_t corners = polygon.offsets.size();
  breaks_.clear();
  for (std::size_t edge = 0; edge < corners; ++edge) {
    const glm::dvec2 first = polygon.corner(edge),
                     along = polygon.offsets[(edge + 1) % corners] - polygon.offsets[edge];
    const double length = glm::length(along);
    if (!(length > 0)) continue;
    const glm::dvec2 unit = along / length;
    const PathCutter::EllipseOnRay ellipse(2 * border, path.tx.range(first), path.rx.range(first),
                                           glm::dot(unit, first), glm::dot(unit, first - foot));
    const double discriminant = ellipse.discriminant();
    if (!(discriminant > 0 && ellipse.a > 0)) continue;
    const double q = -(ellipse.b + std::copysign(std::sqrt(discriminant), ellipse.b));
    for (const double x : {q / ellipse.a, ellipse.c / q})
      if (x >= 0 && x <= length) {
        const glm::dvec2 from_centre = first + x * unit - centre;
        breaks_.push_back(std::atan2(from_centre.y, from_centre.x));
      }
  }
  if (breaks_.empty()) breaks_.push_back(-std::numbers::pi);
  std::sort(breaks_.begin(), breaks_.end());
  breaks_.push_back(breaks_.front() + 2 * std::numbers::pi);
}

void PathPolygonGradient::add_arcs(const PlanarPolygon& polygon, const PathOnFacet& path) {
  const double tx_distance = path.tx.over.distance, rx_distance = path.rx.over.distance;
  const glm::dvec2 foot = path.rx.over.foot, centre = foot * (tx_distance / (tx_distance + rx_distance));
  const double tx_range = path.tx.range(centre), rx_range = path.rx.range(centre);
  const std::size_t corners = polygon.offsets.size();
  for (std::size_t k = out_.first_bin; k <= out_.end_bin; ++k) {
    const double border = borders_[k];
    if (!(2 * border > tx_range + rx_range)) continue;
    find_arcs(polygon, path, border);
    const auto distance_in = [&](glm::dvec2 direction) {
      const PathCutter::EllipseOnRay ellipse(2 * border, tx_range, rx_range, glm::dot(direction, centre),
                                             glm::dot(direction, centre - foot));
      const double root = std::sqrt(std::max(ellipse.discriminant(), 0.0));
      return ellipse.b > 0 ? -ellipse.c / (ellipse.b + root) : (root - ellipse.b) / ellipse.a;
    };
    for (std::size_t arc = 0; arc + 1 < breaks_.size(); ++arc) {
      const double from = breaks_[arc], to = breaks_[arc + 1], middle = (from + to) / 2;
      if (!(to > from)) continue;
      const glm::dvec2 towards(std::cos(middle), std::sin(middle));
      const glm::dvec2 at = centre + distance_in(towards) * towards - polygon.first;
      bool inside = true;
      for (std::size_t edge = 0; edge < corners && inside; ++edge)
        inside = cross_of(polygon.offsets[(edge + 1) % corners] - polygon.offsets[edge],
                          at - polygon.offsets[edge]) >= 0;
      if (!inside) continue;
      std::array<double, 5> sum{};
      integrate(
          from, to,
          [&](double angle, std::span<double> values) {
            const glm::dvec2 direction(std::cos(angle), std::sin(angle));
            const double distance = distance_in(direction);
            const glm::dvec2 p = centre + distance * direction, offset = p - foot;
            const double tx = path.tx.range(p), rx = path.rx.range(p);
            const double growth = glm::dot(direction, p) / tx + glm::dot(direction, offset) / rx;
            values[0] = density_at(path, p, tx, rx) * distance / growth;
            values[1] = values[0] * tx_distance / tx;
            values[2] = values[0] * rx_distance / rx;
            values[3] = values[0] * offset.x / rx;
            values[4] = values[0] * offset.y / rx;
          },
          sum);
      const auto add = [&](std::size_t bin, double sign) {
        double* numbers = out_.at(bin);
        numbers[PathNumbers::by_borders] += sign * 2 * border * sum[0];
        numbers[PathNumbers::by_tx_distance] -= sign * sum[1];
        numbers[PathNumbers::by_rx_distance] -= sign * sum[2];
        numbers[PathNumbers::by_foot] += sign * sum[3];
        numbers[PathNumbers::by_foot + 1] += sign * sum[4];
      };
      if (k > out_.first_bin) add(k - 1, 1);
      if (k < out_.end_bin) add(k, -1);
    }
  }
}

}  // namespace tubefoot
