// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/reference.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/certified_integral.hpp"
#include "engine/certified/interval_integral.hpp"
#include "engine/certified/reference_parts.hpp"
#include "geometry/steps/steps.hpp"

// Computes reference energies of monostatic echoes in isovelocity water: intervals of doubles first, then
// balls, with texture cells and beam patterns. See docs/notes/certified-energies.md.
namespace tubefoot {
namespace {

/// Up to this tolerance, all integrals use balls. Doubles also reach smaller tolerances. However, the
/// energies published at this tolerance must be reproduced to the last bit.
constexpr double finest_in_balls = 1e-9;

/// The same as Bins, in intervals.
using IntervalBins = std::map<std::size_t, Interval>;

std::pair<std::uint32_t, std::uint32_t> beams_of(std::uint32_t tube,
                                                 std::span<const std::uint32_t> beam_of_tube,
                                                 const EchoModel& model) {
  if (model.patterns != nullptr) return model.patterns->beams_of_tube[tube];
  return {beam_of_tube[tube], beam_of_tube[tube] + 1};
}

/// Approximate number of slabs that share a bin.
std::vector<double> slabs_of_bins(const History& history, std::span<const std::uint32_t> beam_of_tube,
                                  std::span<const double> borders, const EchoModel& model, std::size_t bins) {
  const std::size_t samples = borders.size() - 1;
  std::vector<double> slabs(bins, 0);
  for (const Footprint& footprint : history.footprints.footprints) {
    const auto first = std::upper_bound(borders.begin(), borders.end(), footprint.slant_range_min_m);
    const auto end = std::lower_bound(borders.begin(), borders.end(), footprint.slant_range_max_m);
    const auto [first_beam, end_beam] = beams_of(footprint.tube, beam_of_tube, model);
    for (auto k = std::max<std::ptrdiff_t>(first - borders.begin() - 1, 0);
         k < std::min<std::ptrdiff_t>(end - borders.begin(), std::ssize(borders) - 1); ++k)
      for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
        slabs[beam * samples + std::size_t(k)] += 4.0 * footprint.piece_count;
  }
  return slabs;
}

/// One try. Parts are enclosed to `working`, and the bounds are compared with `tolerance`. `coarse` becomes
/// true if some texture has too many cells, so that a narrower try would not help.
CertifiedEcho enclose_echo(const FacetMesh& mesh, const SceneTree& tree, const History& history,
                           const VisibilityOptions& options, std::span<const std::uint32_t> beam_of_tube,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance, double working,
                           std::span<const std::shared_ptr<const CertifiedTexture>> textures, bool& coarse) {
  const std::vector<double> borders = sample_borders_m(samples);
  const std::vector<double> target = reference_targets(ordinary, working);
  const std::vector<double> slabs = slabs_of_bins(history, beam_of_tube, borders, model, target.size());
  const Ball beta = Ball(model.absorption_db_per_m) * log(Ball(10)) / Ball(10);
  const auto row = std::size_t(samples.count);
  const TubeSet& tubes = history.tubes;
  std::vector<Bins> by_tube(tubes.tubes.size());
  std::vector<IntervalBins> by_tube_in_doubles(tubes.tubes.size());
  const bool doubles_first = model.patterns == nullptr && tolerance > finest_in_balls;
  std::atomic<bool> any_coarse = false;
  struct Buffers {
    VisibilityScratch visibility;
    TubeVisibility seen;
    IntervalPolygon polygon;
    std::vector<IntervalIntegrator::SamplePart> parts;
  };
  tbb::enumerable_thread_specific<Buffers> threads;
  Steps steps("tubes", tubes.tubes.size());
  tbb::parallel_for(std::uint32_t{0}, std::uint32_t(tubes.tubes.size()), [&](std::uint32_t tube) {
    steps.done();
    Buffers& buffers = threads.local();
    TubeVisibility& seen = buffers.seen;
    IntervalPolygon& in_doubles = buffers.polygon;
    std::vector<IntervalIntegrator::SamplePart>& parts = buffers.parts;
    see(mesh, tree, tubes, tube, options, buffers.visibility, seen);
    const NameContext context{mesh, tubes.apex, seen.rays};
    CertifiedIntegrator integrator(borders, beta);
    IntervalIntegrator interval_integrator(borders, {beta.lo(), beta.hi()});
    // Returns whether doubles alone enclose a piece.
    const auto add_in_doubles = [&](const NamedPiece& piece) {
      if (!enclose_in_intervals(context, seen.corners, piece, history.grid_unit_m, in_doubles)) return false;
      const ScatteringModel* scattering = model.model_of(piece.facet);
      interval_integrator.take_model(scattering);
      Interval factor = scattering != nullptr ? Interval(1)
                                              : model.material_mu[model.material[piece.facet]] *
                                                    squared(in_doubles.distance.in_doubles());
      if (!model.path.facet_factor.empty()) factor = factor * model.path.facet_factor[piece.facet];
      const IntervalIntegrator::Allowance allowance{
          working / 3, [&](std::uint32_t beam, std::uint32_t sample) {
            const std::size_t bin = beam * row + sample;
            return std::max(target[bin] / 3 / std::max(slabs[bin], 1.0) / factor.hi, least_allowed);
          }};
      const std::uint32_t beam = beam_of_tube[tube];
      if (!interval_integrator.enclose(in_doubles, beam, allowance, parts)) return false;
      for (const auto& part : parts)
        by_tube_in_doubles[tube][beam * row + part.sample] += factor * part.value;
      return true;
    };
    for (const NamedPiece& piece : seen.pieces) {
      stop_if_wanted();
      if (doubles_first && textures[model.material[piece.facet]] == nullptr && add_in_doubles(piece))
        continue;
      const CertifiedPolygon polygon = certified_polygon(context, seen.corners, piece, history.grid_unit_m);
      const ScatteringModel* scattering = model.model_of(piece.facet);
      integrator.take_model(scattering);
      Ball factor = scattering != nullptr
                        ? Ball(1)
                        : Ball(model.material_mu[model.material[piece.facet]]) * squared(polygon.distance);
      if (!model.path.facet_factor.empty()) factor = factor * Ball(model.path.facet_factor[piece.facet]);
      const double size = factor.hi();
      // The relative and the shared error each receive a third of the tolerance. The rest is for gaps and
      // rounding.
      std::size_t cells = 1;
      const CertifiedIntegrator::Allowance allowance{
          working / 3, [&](std::uint32_t beam, std::uint32_t sample) {
            const std::size_t bin = beam * row + sample;
            const double sharers = std::max(slabs[bin], 1.0) * double(cells);
            return std::max(target[bin] / 3 / sharers / size, least_allowed);
          }};
      Ball even(1);  // the range of a texture that is not cut into cells
      const auto sink = [&](const Part<Ball>& part) {
        by_tube[tube][part.beam * row + part.sample] += factor * even * part.value;
      };
      const auto add = [&](const CertifiedPolygon& part, const CertifiedCell* cell) {
        if (model.patterns != nullptr)
          integrator.add(part, *model.patterns, tube, allowance, sink, cell);
        else
          integrator.add(part, beam_of_tube[tube], allowance, sink, cell);
      };
      const CertifiedTexture* texture = textures[model.material[piece.facet]].get();
      if (texture == nullptr || polygon.edges.size() < 3) {
        add(polygon, nullptr);
        continue;
      }
      const Ball range = texture->range();
      const bool worth_it = range.hi() - range.lo() > working / 8 * range.lo();
      const std::size_t count =
          worth_it ? cut_by_cells(polygon, *texture, model.path.tx.map_of(piece.facet), most_cells, {}) : 0;
      if (count > 0) {
        cells = count;
        cut_by_cells(polygon, *texture, model.path.tx.map_of(piece.facet), most_cells,
                     [&](const CertifiedPolygon& part, const CertifiedCell& cell) { add(part, &cell); });
      } else {
        if (worth_it) any_coarse = true;
        even = range;
        add(polygon, nullptr);
      }
    }
  });

  coarse = any_coarse;

  std::vector<Ball> total(ordinary.energy.size());
  for (const Bins& bins : by_tube)  // in order, so that the result does not depend on the threads
    for (const auto& [bin, part] : bins) total[bin] += part;
  for (const IntervalBins& bins : by_tube_in_doubles)
    for (const auto& [bin, part] : bins) total[bin] += Ball::between(part.lo, part.hi);

  return enclosed_echo(ordinary, total, tolerance);
}

}  // namespace

std::vector<double> reference_targets(const Echo& echo, double tolerance) {
  const auto samples = std::size_t(echo.samples);
  const double ping_peak =
      echo.energy.empty() ? 0 : *std::max_element(echo.energy.begin(), echo.energy.end());
  std::vector<double> target(echo.energy.size());
  for (std::size_t row = 0; row < target.size(); row += samples) {
    double floor = reference_floor * reference_floor * ping_peak;
    for (std::size_t k = 0; k < samples; ++k) floor = std::max(floor, reference_floor * echo.energy[row + k]);
    for (std::size_t k = 0; k < samples; ++k)
      target[row + k] = std::max(tolerance * std::max(echo.energy[row + k], floor), least_allowed);
  }
  return target;
}

void compare_with(CertifiedEcho& certified, double tolerance) {
  // The certain part of the energy determines the requested bound.
  const auto row = std::size_t(certified.echo.samples);
  certified.bins_over = 0;
  certified.worst_ratio = 0;
  Echo least = certified.echo;
  for (std::size_t bin = 0; bin < certified.bound.size(); ++bin) {
    const double sure = least.energy[bin] - certified.bound[bin];
    least.energy[bin] = sure > 0 ? sure : 0;
  }
  const std::vector<double> requested = reference_targets(least, tolerance * (1 + 1e-6));
  for (std::size_t bin = 0; bin < certified.bound.size(); ++bin) {
    const double ratio = certified.bound[bin] / requested[bin];
    certified.bins_over += !(ratio <= 1);
    if (ratio > certified.worst_ratio && std::isfinite(ratio)) {
      certified.worst_ratio = ratio;
      certified.worst_beam = int(bin / row);
      certified.worst_sample = int(bin % row);
    }
  }
}

std::optional<std::size_t> material_without_enclosure(
    std::span<const std::shared_ptr<const ReflectivityField>> reflectivity) {
  for (std::size_t material = 0; material < reflectivity.size(); ++material)
    if (reflectivity[material] != nullptr && certified_texture(reflectivity[material]) == nullptr)
      return material;
  return std::nullopt;
}

std::vector<std::shared_ptr<const CertifiedTexture>> certified_textures(const EchoModel& model) {
  if (const auto material = material_without_enclosure(model.reflectivity))
    throw std::invalid_argument(
        fmt::format("there is no certified bound for the reflectivity texture of material {}", *material));
  std::vector<std::shared_ptr<const CertifiedTexture>> textures(model.material_mu.size());
  for (std::size_t material = 0; material < model.reflectivity.size(); ++material)
    if (model.reflectivity[material] != nullptr)
      textures.at(material) = certified_texture(model.reflectivity[material]);
  return textures;
}

CertifiedEcho certify_echo(const FacetMesh& mesh, const SceneTree& tree, const History& history,
                           const VisibilityOptions& options, std::span<const std::uint32_t> beam_of_tube,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument("certified bounds need exact arithmetic: fixed, filtered or rational");
  if (!model.path.tx.facet_map.empty())
    throw std::invalid_argument("there is no certified bound for textures of facets at apparent positions");
  const std::vector<std::shared_ptr<const CertifiedTexture>> textures = certified_textures(model);
  return refined_until_tolerance(tolerance, [&](double working, bool& coarse) {
    return enclose_echo(mesh, tree, history, options, beam_of_tube, samples, model, ordinary, tolerance,
                        working, textures, coarse);
  });
}

}  // namespace tubefoot
