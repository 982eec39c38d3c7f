// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_refraction.hpp"

#include <algorithm>
#include <stdexcept>

#include "engine/certified/monostatic_piece.hpp"
#include "engine/certified/uncertain_edges.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"

// Computes reference energies of monostatic echoes in stratified water. It integrates visible pieces of
// proven apparent facets and adds intervals for conservative, ambiguous and unproven facets. See
// docs/notes/certified-energies.md, section "Through refracting water".
namespace tubefoot {
namespace {

using State = FacetEnclosure::State;

/// Adds a visible piece of a proven facet.
void add_piece(const MonostaticPiece& piece, const CertifiedPolygon& polygon, const FacetEnclosure& facet,
               const CertifiedRequest& request, BinIntervals& bins) {
  const std::size_t row = request.row();
  const ShiftedSamples samples(request.borders, request.step_m, facet.shift_m * (1 + enclosure_slack));
  CertifiedIntegrator integrator(samples.borders(), request.beta_per_m);
  const double size = piece.factor.hi() * facet.factor.hi;
  const auto allowed = [&](double parts) {
    return CertifiedIntegrator::Allowance{
        request.tolerance / 50, [&, parts](std::uint32_t beam, std::uint32_t sample) {
          const std::size_t bin = beam * row + std::min<std::size_t>(sample / 2, row - 1);
          return std::max(request.target[bin] / 2000 / parts / size, least_allowed);
        }};
  };
  // `times` encloses the factors that are not in the integral.
  const auto sink = [&](const Interval& times) {
    return [&, times](const Part<Ball>& own) {
      const Ball whole = piece.factor * own.value;
      const double hi = whole.hi() * facet.factor.hi * (1 + enclosure_slack),
                   lo = std::max(whole.lo() * facet.factor.lo * (1 - enclosure_slack), 0.0);
      samples.add(own.beam, own.sample, (times.lo < 0 ? hi : lo) * times.lo, hi * times.hi, bins);
    };
  };
  const TexturedPolygon& textured = piece.textured;
  piece.integrate_parts(integrator, allowed(textured.parts()), sink(textured.factor_bounds()));
  // Points are slightly displaced from the positions that the map gives.
  if (const double change = textured.change_over(facet.place_off_m); change > 0)
    piece.integrate(integrator, polygon, nullptr, allowed(1), sink({-change, change}));
}

}  // namespace

RefractedReference certify_refracted_echo(const MappedSeabed& seabed, const RayEnclosure& rays,
                                          const History& history, const VisibilityOptions& options,
                                          std::span<const std::uint32_t> beam_of_tube,
                                          const RangeSamples& samples, const EchoModel& model,
                                          const Echo& ordinary, double tolerance) {
  require_exact(options);
  const CertifiedRequest request(model, samples, tolerance, reference_targets(ordinary, tolerance));
  if (model.path.tx.facet_map.empty() &&
      std::ranges::any_of(request.textures, [](const auto& texture) { return texture != nullptr; }))
    throw std::invalid_argument(
        "certified reflectivity textures of apparent facets need the maps to the true positions");
  const FacetMesh& apparent = seabed.mesh();
  const ApparentEnclosures enclosures = enclose(seabed, rays, model);
  const UncertainEdges edges(apparent, seabed.parent, enclosures);
  const Unknown unknown(enclosures.unproven, rays);
  TubeSet tubes = history.tubes;
  // Facets beyond the reach may have images within it.
  const Looked looked(enclosures.facets);
  tubes.reach += 2 * looked.most_gap_m() / history.grid_unit_m;

  const auto enclose_tube = [&](std::uint32_t tube, const NameContext& context, const TubeVisibility& seen,
                                BinIntervals& bins) {
    const auto beams = request.beams_of(tube, beam_of_tube);
    const auto each_bin = [&](double nearest_m, double farthest_m, const auto& change) {
      const auto [from, to] = samples_between(request.borders, nearest_m, farthest_m);
      for (std::size_t k = from; k < to; ++k)
        for (std::uint32_t beam = beams.first; beam < beams.second; ++beam)
          change(bins[beam * request.row() + k]);
    };
    const AmbiguitySink ambiguity = [&](const Ambiguity& d) {
      each_bin(d.nearest_m, d.farthest_m, [&](Interval& bin) {
        bin.lo -= d.energy_j;
        bin.hi += d.energy_j;
      });
    };

    TubeSet own = tubes;
    own.tubes = {tubes.tubes[tube]};
    const Sector sector(own, history.grid_unit_m);
    const std::vector<FacetId> nearby = looked.in(sector, seabed.tree);
    for (const FacetId f : nearby) {
      const FacetEnclosure& facet = enclosures.facets[f];
      if (facet.state == State::conservative)
        each_bin(facet.nearest_m, facet.farthest_m, [&](Interval& bin) { bin.hi += facet.most; });
    }

    std::vector<AmbiguousPiece> pieces;
    for (const NamedPiece& piece : seen.pieces) {
      stop_if_wanted();
      const CertifiedPolygon polygon = certified_polygon(context, seen.corners, piece, history.grid_unit_m);
      pieces.push_back(seen_piece(piece, polygon));
      const FacetEnclosure& facet = enclosures.facets[piece.facet];
      if (facet.state != State::proven || polygon.edges.size() < 3) continue;
      const MonostaticPiece proven(request, polygon, piece.facet, facet.model ? &*facet.model : nullptr, tube,
                                   beam_of_tube[tube]);
      add_piece(proven, polygon, facet, request, bins);
    }
    edges.add_ambiguities(context, seen, pieces, nearby, ambiguity);

    if (const double begins = unknown.begins_m(sector); begins < infinite)
      each_bin(begins, infinite, [&](Interval& bin) { bin.hi = infinite; });
  };
  const auto by_tube = enclose_tubes<BinIntervals>(apparent, seabed.tree, tubes, options, enclose_tube);
  return reference_between(by_tube, ordinary, tolerance);
}

}  // namespace tubefoot
