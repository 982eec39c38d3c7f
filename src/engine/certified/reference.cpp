// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/reference.hpp"

#include <algorithm>
#include <stdexcept>

#include "engine/certified/interval_integral.hpp"
#include "engine/certified/monostatic_piece.hpp"

// Computes reference energies of monostatic echoes in isovelocity water: intervals of doubles first, then
// balls, with texture cells and beam patterns. See docs/notes/certified-energies.md.
namespace tubefoot {
namespace {

/// Up to this tolerance, all integrals use balls. Doubles also reach smaller tolerances. However, the
/// energies published at this tolerance must be reproduced to the last bit.
constexpr double finest_in_balls = 1e-9;

/// Enclosures of one tube.
struct TubeBins {
  Bins<Ball> in_balls;
  Bins<Interval> in_doubles;
};

/// Approximate number of slabs that share a bin.
std::vector<double> slabs_of_bins(const History& history, std::span<const std::uint32_t> beam_of_tube,
                                  const CertifiedRequest& request, std::size_t bins) {
  const std::vector<double>& borders = request.borders;
  std::vector<double> slabs(bins, 0);
  for (const Footprint& footprint : history.footprints.footprints) {
    const auto first = std::upper_bound(borders.begin(), borders.end(), footprint.slant_range_min_m);
    const auto end = std::lower_bound(borders.begin(), borders.end(), footprint.slant_range_max_m);
    const auto [first_beam, end_beam] = request.beams_of(footprint.tube, beam_of_tube);
    for (auto k = std::max<std::ptrdiff_t>(first - borders.begin() - 1, 0);
         k < std::min<std::ptrdiff_t>(end - borders.begin(), std::ssize(borders) - 1); ++k)
      for (std::uint32_t beam = first_beam; beam < end_beam; ++beam)
        slabs[beam * request.row() + std::size_t(k)] += 4.0 * footprint.piece_count;
  }
  return slabs;
}

}  // namespace

CertifiedEcho certify_echo(const FacetMesh& mesh, const SceneTree& tree, const History& history,
                           const VisibilityOptions& options, std::span<const std::uint32_t> beam_of_tube,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance) {
  require_exact(options);
  if (!model.path.tx.facet_map.empty())
    throw std::invalid_argument("there is no certified bound for textures of facets at apparent positions");
  CertifiedRequest request(model, samples);
  const std::size_t row = request.row();
  const std::vector<double> slabs = slabs_of_bins(history, beam_of_tube, request, ordinary.energy.size());
  const std::span<const double> facet_factor = model.path.facet_factor;
  const bool doubles_first = model.patterns == nullptr && tolerance > finest_in_balls;
  // The relative and the shared error each receive a third of the tolerance. The rest is for gaps and
  // rounding.
  const auto allowed = [&](double size, double parts) {
    return CertifiedIntegrator::Allowance{
        request.tolerance / 3, [&, size, parts](std::uint32_t beam, std::uint32_t sample) {
          const std::size_t bin = beam * row + sample;
          return std::max(request.target[bin] / 3 / (std::max(slabs[bin], 1.0) * parts) / size,
                          least_allowed);
        }};
  };
  const auto enclose_tube = [&](std::uint32_t tube, const NameContext& context, const TubeVisibility& seen,
                                TubeBins& bins) {
    CertifiedIntegrator integrator(request.borders, request.beta_per_m);
    IntervalIntegrator interval_integrator(request.borders,
                                           {request.beta_per_m.lo(), request.beta_per_m.hi()});
    IntervalPolygon in_doubles;
    std::vector<IntervalIntegrator::SamplePart> parts;
    const std::uint32_t beam = beam_of_tube.empty() ? 0 : beam_of_tube[tube];
    // Returns whether doubles alone enclose a piece.
    const auto add_in_doubles = [&](const NamedPiece& piece) {
      if (!enclose_in_intervals(context, seen.corners, piece, history.grid_unit_m, in_doubles)) return false;
      const ScatteringModel* scattering = model.model_of(piece.facet);
      interval_integrator.take_model(scattering);
      Interval factor = scattering != nullptr ? Interval(1)
                                              : model.material_mu[model.material[piece.facet]] *
                                                    squared(in_doubles.distance.in_doubles());
      if (!facet_factor.empty()) factor = factor * facet_factor[piece.facet];
      if (!interval_integrator.enclose(in_doubles, beam, allowed(factor.hi, 1), parts)) return false;
      for (const auto& part : parts) bins.in_doubles[beam * row + part.sample] += factor * part.value;
      return true;
    };
    for (const NamedPiece& named : seen.pieces) {
      stop_if_wanted();
      if (doubles_first && request.textures[model.material[named.facet]] == nullptr && add_in_doubles(named))
        continue;
      const CertifiedPolygon polygon = certified_polygon(context, seen.corners, named, history.grid_unit_m);
      const MonostaticPiece piece(request, polygon, named.facet, model.model_of(named.facet), tube, beam);
      const Ball factor =
          facet_factor.empty() ? piece.factor : piece.factor * Ball(facet_factor[named.facet]);
      const Ball whole = factor * piece.textured.factor();
      piece.integrate_parts(integrator, allowed(factor.hi(), piece.textured.parts()),
                            [&](const Part<Ball>& part) {
                              bins.in_balls[part.beam * row + part.sample] += whole * part.value;
                            });
    }
  };
  return refined_until_tolerance(request, ordinary, tolerance, reference_targets, [&] {
    const auto by_tube = enclose_tubes<TubeBins>(mesh, tree, history.tubes, options, enclose_tube);
    std::vector<Ball> total(ordinary.energy.size());
    for (const TubeBins& bins : by_tube)
      for (const auto& [bin, part] : bins.in_balls) total[bin] += part;
    for (const TubeBins& bins : by_tube)
      for (const auto& [bin, part] : bins.in_doubles) total[bin] += Ball::between(part.lo, part.hi);
    return enclosed_echo(ordinary, total);
  });
}

}  // namespace tubefoot
