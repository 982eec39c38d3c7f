// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/polygon_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/echo/path_on_facet.hpp"
#include "engine/scattering/density.hpp"
#include "engine/scattering/radial_model.hpp"
#include "geometry/steps/stop.hpp"

// Differentiates without patterns and textures by closed forms in range, and otherwise by quadrature in the
// directions at the apex, in which gains are constant.

namespace tubefoot {
namespace {

using Numbers = PolygonDerivatives;

/// Numbers of the integrals over the area, before the numbers of own parameters.
enum : std::size_t {
  peak,
  area_energy,
  area_absorption,
  area_tilt,
  plain_area = area_tilt + 2,
  area_place = plain_area,
  area_place_x = area_place + 3,
  area_place_y = area_place_x + 3,
  area_scale = area_place_y + 3,
  textured_area
};

/// Tables of patterns have a jump of the second derivative in each row.
constexpr int most_refinements_with_tables = 12;

}  // namespace

void PolygonDerivatives::reset(std::size_t row_count, SampleSpan bins, std::size_t parameters) {
  rows = row_count;
  first_bin = bins.first;
  end_bin = bins.end;
  count = own_parameters + parameters;
  numbers.assign((end_bin - first_bin) * rows * count, 0);
  parts.clear();
}

PolygonGradient::PolygonGradient(const RangeSamples& samples, const EchoModel& model, BeamGains& gains,
                                 bool absorption)
    : borders_(sample_borders_m(samples)),
      beta_(absorption_per_m(model.absorption_db_per_m)),
      tolerance_(model.pattern_tolerance),
      samples_(samples),
      gains_(gains),
      patterns_(model.patterns != nullptr),
      absorption_(absorption || model.absorption_db_per_m > 0),
      plain_(borders_, {}) {
  const double beta = beta_;
  lambert_ = lambert_radial_integral(samples, model.absorption_db_per_m);
  lambert_cutter_.emplace(*lambert_);
  scattering_cutter_.emplace(samples, model.absorption_db_per_m);
  if (!absorption_) return;
  lambert_moment_.emplace(
      borders_, [beta](double r) { return -2 * r * lambert_density(TwoWayRange<double>::of(r), beta); });
  moment_cutter_.emplace(*lambert_moment_);
  scattering_moment_cutter_.emplace(samples, [beta](const ScatteringModel& own, double distance, double r) {
    return -2 * r * density(cross_section(own, distance, r), TwoWayRange<double>::of(r), beta);
  });
}

double PolygonGradient::density_at(const SeenPolygon& seen, double range) const {
  const double distance = seen.polygon.distance;
  const auto two_way = TwoWayRange<double>::of(range);
  return seen.surface.scattering == nullptr
             ? distance * distance * lambert_density(two_way, beta_)
             : density(cross_section(*seen.surface.scattering, distance, range), two_way, beta_);
}

bool PolygonGradient::find_bins(const SeenPolygon& seen, std::size_t rows) {
  const double near = nearest_point(seen.polygon).range, far = farthest_range(seen.polygon);
  if (!(far > borders_.front() && near < borders_.back())) return false;
  const auto first = std::upper_bound(borders_.begin(), borders_.end(), near * (1 - 1e-12));
  const auto end = std::lower_bound(borders_.begin(), borders_.end(), far * (1 + 1e-12));
  const auto bins = std::ptrdiff_t(borders_.size()) - 1;
  const auto k = std::clamp<std::ptrdiff_t>(first - borders_.begin() - 1, 0, bins - 1);
  out_.reset(rows,
             {std::size_t(k), std::size_t(std::clamp<std::ptrdiff_t>(end - borders_.begin(), k + 1, bins))},
             seen.parameters.size());
  return true;
}

const PolygonDerivatives* PolygonGradient::of(const SeenPolygon& seen) {
  const bool quadrature = patterns_ || seen.surface.texture != nullptr;
  if (!find_bins(seen, quadrature ? gains_.rows() : 1)) return nullptr;
  if (gains_.are_zero(out_.first_bin, out_.end_bin)) return nullptr;
  smooth_ = {};
  cells_ = &plain_;
  if (const ScatteringModel* model = seen.surface.scattering) {
    smooth_.angle_rad = resolution_of([&](double y) { return model->growth(y); });
    const auto& pieces = model->pieces();
    for (const ScatteringModel::Piece& piece : pieces)
      for (const ScatteringModel::Term& term : piece.terms)
        smooth_.pointed = smooth_.pointed || term.slope != 0;
    if (pieces.size() > 1) {
      kinked_ = RangeCells(borders_, corner_ranges_m(*model, seen.polygon.distance));
      cells_ = &kinked_;
    }
  }
  out_.weighted = quadrature && gains_.weighted();
  quadrature ? general(seen) : radial(seen);
  return &out_;
}

ScatteringCutter& PolygonGradient::cutter_of(const ScatteringDerivative& parameter) {
  for (const auto& [known, cutter] : parameter_cutters_)
    if (known == &parameter) return *cutter;
  const double beta = beta_;
  parameter_cutters_.emplace_back(
      &parameter, std::make_unique<ScatteringCutter>(samples_, [beta, &parameter](const ScatteringModel&,
                                                                                  double distance, double r) {
        const double sine = std::min(distance / r, 1.0);
        const double cosine = std::sqrt(std::max((r - distance) * (r + distance), 0.0)) / r;
        return density(parameter.cross_section(sine, cosine), TwoWayRange<double>::of(r), beta);
      }));
  return *parameter_cutters_.back().second;
}

void PolygonGradient::radial(const SeenPolygon& seen) {
  const PlanarPolygon& polygon = seen.polygon;
  const double distance = polygon.distance;
  const ScatteringModel* model = seen.surface.scattering;
  row_.resize(borders_.size() - 1);
  const auto take = [&](std::size_t number, const auto& add) {
    // The cutters may add to one bin more on each side.
    const std::size_t first = out_.first_bin - std::min<std::size_t>(out_.first_bin, 2),
                      end = std::min(out_.end_bin + 2, row_.size());
    std::fill(row_.begin() + std::ptrdiff_t(first), row_.begin() + std::ptrdiff_t(end), 0.0);
    add(std::span<double>(row_));
    for (std::size_t bin = out_.first_bin; bin < out_.end_bin; ++bin) out_.at(0, bin)[number] = row_[bin];
  };
  const double factor = distance * distance;
  take(Numbers::energy, [&](std::span<double> row) {
    model == nullptr ? lambert_cutter_->add(polygon, factor, row)
                     : scattering_cutter_->add(polygon, *model, row);
  });
  if (absorption_)
    take(Numbers::by_absorption, [&](std::span<double> row) {
      model == nullptr ? moment_cutter_->add(polygon, factor, row)
                       : scattering_moment_cutter_->add(polygon, *model, row);
    });
  for (std::size_t k = 0; model != nullptr && k < seen.parameters.size(); ++k)
    take(Numbers::own_parameters + k,
         [&](std::span<double> row) { cutter_of(*seen.parameters[k]).add(polygon, *model, row); });

  // Sum of angles of the border by cell, from that of the first bin on, and beyond the last bin.
  turned_.assign(out_.end_bin - out_.first_bin + 1, 0);
  borders_of_.edges(polygon, *cells_, smooth_, [&](const EdgeStretch& stretch) {
    if (stretch.cell == RangeCells::none) {
      turned_.back() += stretch.angle();
      return;
    }
    const std::size_t bin = cells_->bin_of_cell[stretch.cell];
    if (bin < out_.first_bin || bin >= out_.end_bin) return;  // rounding
    turned_[bin - out_.first_bin] += stretch.angle();
    double whole = 0, second = 0;
    stretch.at_nodes([&](double x, double weight, glm::dvec2) {
      const double f = weight * density_at(seen, std::sqrt(stretch.nearest * stretch.nearest + x * x));
      whole += f;
      second += f * (x - stretch.begin);
    });
    second /= stretch.length;
    out_.parts.push_back(
        {0, bin, stretch.edge, (whole - second) * stretch.outward(), second * stretch.outward()});
  });
  // The angle of a range circle inside the polygon is that of the polygon's border beyond the circle.
  double beyond = turned_.back();
  for (std::size_t bin = out_.end_bin; bin-- > out_.first_bin;) {
    const double far = borders_[bin + 1], near = borders_[bin];
    double& by_borders = out_.at(0, bin)[Numbers::by_borders];
    if (beyond != 0 && far > distance) by_borders += far * far * density_at(seen, far) * beyond;
    beyond += turned_[bin - out_.first_bin];
    if (beyond != 0 && near > distance) by_borders -= near * near * density_at(seen, near) * beyond;
  }
  // Energies scale as s^-2 with all lengths.
  for (std::size_t bin = out_.first_bin; bin < out_.end_bin; ++bin) {
    double* numbers = out_.at(0, bin);
    numbers[Numbers::by_distance] = -2 * numbers[Numbers::energy] + beta_ * numbers[Numbers::by_absorption] -
                                    numbers[Numbers::by_borders];
  }
  for (const PolygonDerivatives::Part& part : out_.parts)
    out_.at(0, part.bin)[Numbers::by_distance] -=
        glm::dot(part.by_first, polygon.corner(part.edge)) +
        glm::dot(part.by_second, polygon.corner((part.edge + 1) % polygon.offsets.size()));
  for (std::size_t bin = out_.first_bin; bin < out_.end_bin; ++bin)
    out_.at(0, bin)[Numbers::by_distance] /= distance;
}

void PolygonGradient::general(const SeenPolygon& seen) {
  const ReflectivityGradient* texture = nullptr;
  if (seen.surface.texture != nullptr) {
    auto known = std::ranges::find(textures_, seen.surface.texture,
                                   &std::pair<const ReflectivityField*, ReflectivityGradient>::first);
    if (known == textures_.end())
      known = textures_.insert(known, {seen.surface.texture, ReflectivityGradient(*seen.surface.texture)});
    texture = &known->second;
    smooth_.degree = texture->degree();
    smooth_.breaks = [&seen](glm::dvec2 from, glm::dvec2 to, std::vector<double>& shares) {
      const glm::dvec3 begin = seen.lies.at(from), end = seen.lies.at(to);
      for (const CellPlanes& planes : seen.surface.texture->cells()) {
        const double a = (glm::dot(planes.normal, begin) - planes.offset_m) / planes.spacing_m,
                     b = (glm::dot(planes.normal, end) - planes.offset_m) / planes.spacing_m;
        for (double k = std::ceil(std::min(a, b)); k <= std::max(a, b); ++k)
          if (const double share = (k - a) / (b - a); share > 0 && share < 1) shares.push_back(share);
      }
    };
  }
  smooth_.tolerance = std::max(tolerance_ / 100, 1e-15);
  smooth_.angle_rad = std::min(smooth_.angle_rad, gains_.smooth().angle_rad);
  for (const BeamGains::Cone& cone : gains_.smooth().kinks)
    smooth_.kinks.push_back({{glm::dot(cone.axis, seen.frame.u), glm::dot(cone.axis, seen.frame.v)},
                             -seen.polygon.distance * glm::dot(cone.axis, seen.plane.normal),
                             cone.cosine});
  gain_.resize(out_.rows);
  if (path_cells_ != &plain_ || cells_ != &plain_) path_cutter_.emplace(cells_->borders);
  path_cells_ = cells_;
  texture_cells_.cut(seen.polygon, seen.lies, seen.surface.texture, [&](const PlanarPolygon& part) {
    stop_if_wanted();
    add_area(seen, part, texture);
    add_arcs(seen, part);
  });
  add_edges(seen);
  finish_general(seen);
}

// Let dD and the components (a, b) of dn be a change of the plane. At fixed direction, the relative change of
// range is (dD + a x + b y) / D. That of the sine of the grazing angle is -(a x + b y) / D.
void PolygonGradient::add_area(const SeenPolygon& seen, const PlanarPolygon& part,
                               const ReflectivityGradient* texture) {
  const double distance = part.distance;
  const std::size_t own = texture != nullptr ? textured_area : plain_area,
                    per_row = own - area_energy + seen.parameters.size(), rows = out_.rows,
                    count = 1 + per_row * rows;
  std::vector<double> scalars(per_row);
  const auto integrand = [&](glm::dvec2 p, double r, double, std::span<double> values) {
    const double rest = absorbed(TwoWayRange<double>::of(r), beta_) / squared(r * r);
    const double sine = std::min(distance / r, 1.0);
    double sigma = sine * sine;
    glm::dvec2 tilt;
    if (seen.surface.scattering == nullptr) {
      tilt = (-3 - 2 * beta_ * r) * sigma / distance * p;
    } else {
      const double away = glm::length(p), cosine = away / r;
      const CrossSectionSlopes slopes = slopes_of(*seen.surface.scattering, sine, cosine);
      sigma = slopes.value;
      tilt = ((-1 - 2 * beta_ * r) * sigma - slopes.by_log_sine) / distance * p;
      if (away > 0) tilt += slopes.by_incidence / away * p;
    }
    ReflectivityGradient::Value factor;
    const glm::dvec3 at = p.x * seen.frame.u + p.y * seen.frame.v - distance * seen.plane.normal;
    if (texture != nullptr) factor = texture->at(seen.lies.at(p));
    const double f = sigma * rest * factor.factor;
    double* s = scalars.data();
    *s++ = f;
    *s++ = -2 * r * f;
    tilt *= rest * factor.factor;
    if (texture != nullptr) {
      const glm::dvec3 by_place = sigma * rest * factor.gradient;
      const double by_scale = glm::dot(by_place, seen.displaced ? p.x * seen.lies.u + p.y * seen.lies.v : at);
      tilt += by_scale / distance * p;
      *s++ = tilt.x;
      *s++ = tilt.y;
      for (int k = 0; k < 3; ++k) *s++ = by_place[k];
      for (int k = 0; k < 3; ++k) *s++ = p.x * by_place[k];
      for (int k = 0; k < 3; ++k) *s++ = p.y * by_place[k];
      *s++ = by_scale;
    } else {
      *s++ = tilt.x;
      *s++ = tilt.y;
    }
    for (const ScatteringDerivative* parameter : seen.parameters)
      *s++ = parameter->cross_section(sine, glm::length(p) / r) * rest * factor.factor;
    // Errors are relative to this value. A motion of the range changes a texture by the gradient times it.
    values[peak] = f;
    if (texture != nullptr) values[peak] += sigma * rest * r * glm::length(factor.gradient);
    const std::size_t cell = cells_->cell_at(r);
    gains_.at(at / r, cells_->bin_of_cell[cell == RangeCells::none ? cells_->size() - 1 : cell], gain_);
    double* value = &values[1];
    for (const double gain : gain_)
      for (const double scalar : scalars) *value++ = gain * scalar;
  };
  PathCutter::Work work;
  work.values = count;
  work.resolution_rad = smooth_.angle_rad;
  work.tolerance = std::max(tolerance_, 1e-13);
  work.analytic = !gains_.smooth().tables && texture == nullptr;
  if (gains_.smooth().tables) work.most_refinements = most_refinements_with_tables;
  const PathCutter::Receiver receiver{distance, glm::dvec2(0)};
  const auto [first, end] = path_cutter_->samples_of(part, receiver);
  if (first >= end) return;
  if (area_.size() < cells_->size() * count) area_.resize(cells_->size() * count);
  std::fill(area_.begin() + std::ptrdiff_t(first * count), area_.begin() + std::ptrdiff_t(end * count), 0.0);
  path_cutter_->add(part, receiver, integrand, work, std::span(area_).first(cells_->size() * count));
  for (std::size_t cell = first; cell < end; ++cell) {
    const std::size_t bin = cells_->bin_of_cell[cell];
    if (bin < out_.first_bin || bin >= out_.end_bin) continue;
    const double* value = &area_[cell * count + 1];
    for (std::size_t row = 0; row < rows; ++row, value += per_row) {
      double* numbers = out_.at(row, bin);
      numbers[Numbers::energy] += value[area_energy - 1];
      numbers[Numbers::by_absorption] += value[area_absorption - 1];
      numbers[Numbers::by_tilt] += value[area_tilt - 1];
      numbers[Numbers::by_tilt + 1] += value[area_tilt];
      if (texture != nullptr) {
        for (std::size_t k = 0; k < 9; ++k) numbers[Numbers::by_place + k] += value[area_place - 1 + k];
        numbers[Numbers::by_distance] += value[area_scale - 1];
      }
      for (std::size_t k = 0; k < seen.parameters.size(); ++k)
        numbers[Numbers::own_parameters + k] += value[own - 1 + k];
    }
  }
}

// A border of a bin moves on the plane against directions that are fixed.
void PolygonGradient::add_arcs(const SeenPolygon& seen, const PlanarPolygon& part) {
  const double distance = part.distance;
  borders_of_.arcs(part, *cells_, smooth_, [&](const CircleArc& arc) {
    const double range = cells_->borders[arc.border], density = range * range * density_at(seen, range);
    const double middle = (arc.from + arc.to) / 2, half = (arc.to - arc.from) / 2;
    for (std::size_t k = 0; k < arc.rule->node.size(); ++k) {
      const double angle = middle + half * arc.rule->node[k];
      const glm::dvec2 p = arc.radius * glm::dvec2(std::cos(angle), std::sin(angle));
      const glm::dvec3 at = p.x * seen.frame.u + p.y * seen.frame.v - distance * seen.plane.normal;
      double weight = half * arc.rule->weight[k] * density;
      if (seen.surface.texture != nullptr) weight *= seen.surface.texture->factor(seen.lies.at(p));
      bool known = false;
      const auto add = [&](std::size_t cell, double sign) {
        const std::size_t bin = cells_->bin_of_cell[cell];
        if (bin < out_.first_bin || bin >= out_.end_bin) return;
        if (!known || gains_.weighted()) gains_.at(at / range, bin, gain_);
        known = true;
        for (std::size_t row = 0; row < out_.rows; ++row) {
          double* numbers = out_.at(row, bin);
          const double value = sign * weight * gain_[row];
          numbers[Numbers::by_borders] += value;
          numbers[Numbers::by_tilt] -= value * p.x / distance;
          numbers[Numbers::by_tilt + 1] -= value * p.y / distance;
        }
      };
      if (arc.border > 0) add(arc.border - 1, 1);
      if (arc.border < cells_->size()) add(arc.border, -1);
    }
  });
}

void PolygonGradient::add_edges(const SeenPolygon& seen) {
  const double distance = seen.polygon.distance;
  borders_of_.edges(seen.polygon, *cells_, smooth_, [&](const EdgeStretch& stretch) {
    if (stretch.cell == RangeCells::none) return;
    const std::size_t bin = cells_->bin_of_cell[stretch.cell];
    if (bin < out_.first_bin || bin >= out_.end_bin) return;
    sums_.assign(2 * out_.rows, 0);
    stretch.at_nodes([&](double x, double weight, glm::dvec2 p) {
      const double r = std::sqrt(stretch.nearest * stretch.nearest + x * x);
      double f = weight * density_at(seen, r);
      if (seen.surface.texture != nullptr) f *= seen.surface.texture->factor(seen.lies.at(p));
      const glm::dvec3 at = p.x * seen.frame.u + p.y * seen.frame.v - distance * seen.plane.normal;
      gains_.at(at / r, bin, gain_);
      const double share = (x - stretch.begin) / stretch.length;
      for (std::size_t row = 0; row < out_.rows; ++row) {
        sums_[2 * row] += f * gain_[row];
        sums_[2 * row + 1] += f * gain_[row] * share;
      }
    });
    for (std::size_t row = 0; row < out_.rows; ++row) {
      const double whole = sums_[2 * row], second = sums_[2 * row + 1];
      if (whole != 0 || second != 0)
        out_.parts.push_back(
            {row, bin, stretch.edge, (whole - second) * stretch.outward(), second * stretch.outward()});
    }
  });
}

// Converts from fixed directions to fixed (x, y). The motion of a corner q relative to fixed directions is
//     dq - D (a, b) - q (dD + a x + b y) / D.
void PolygonGradient::finish_general(const SeenPolygon& seen) {
  const PlanarPolygon& polygon = seen.polygon;
  const double distance = polygon.distance;
  for (std::size_t bin = out_.first_bin; bin < out_.end_bin; ++bin)
    for (std::size_t row = 0; row < out_.rows; ++row) {
      double* numbers = out_.at(row, bin);
      numbers[Numbers::by_distance] += -2 * numbers[Numbers::energy] +
                                       beta_ * numbers[Numbers::by_absorption] - numbers[Numbers::by_borders];
      numbers[Numbers::by_distance] /= distance;
    }
  for (const PolygonDerivatives::Part& part : out_.parts) {
    double* numbers = out_.at(part.row, part.bin);
    const auto convert = [&](glm::dvec2 by, glm::dvec2 corner) {
      const double along = glm::dot(by, corner) / distance;
      numbers[Numbers::by_distance] -= along;
      numbers[Numbers::by_tilt] -= distance * by.x + along * corner.x;
      numbers[Numbers::by_tilt + 1] -= distance * by.y + along * corner.y;
    };
    convert(part.by_first, polygon.corner(part.edge));
    convert(part.by_second, polygon.corner((part.edge + 1) % polygon.offsets.size()));
  }
}

}  // namespace tubefoot
