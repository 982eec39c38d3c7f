// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_refraction.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <stdexcept>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/certified_integral.hpp"
#include "engine/certified/refracted_bins.hpp"
#include "engine/certified/uncertain_edges.hpp"
#include "geometry/numbers/enclosure_slack.hpp"
#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/steps.hpp"

// Computes reference energies of monostatic echoes in stratified water. It integrates visible pieces of
// proven apparent facets and adds intervals for conservative, ambiguous and unproven facets. See
// docs/notes/certified-energies.md, section "Through refracting water".
namespace tubefoot {
namespace {

constexpr double slack = enclosure_slack;
using State = FacetEnclosure::State;

/// Common data of all pieces.
struct Requested {
  const EchoModel& model;
  std::vector<std::shared_ptr<const CertifiedTexture>> textures;  // by material
  std::vector<double> borders, target;
  double step_m, tolerance;
  Ball beta;
};

/// A visible piece of a proven facet, and the tube that sees it.
struct ProvenPiece {
  const CertifiedPolygon& polygon;
  const FacetEnclosure& facet;
  FacetId id;
  std::uint32_t tube, beam;
};

void add_piece(const ProvenPiece& piece, const Requested& requested, BinIntervals& bins) {
  const EchoModel& model = requested.model;
  const CertifiedPolygon& polygon = piece.polygon;
  const FacetEnclosure& facet = piece.facet;
  const std::uint16_t material = model.material[piece.id];
  const std::size_t row = requested.borders.size() - 1;
  const ShiftedSamples samples(requested.borders, requested.step_m, facet.shift_m * (1 + slack));
  CertifiedIntegrator integrator(samples.borders(), requested.beta);
  if (facet.model) integrator.take_model(&*facet.model);
  const Ball factor = facet.model ? Ball(1) : Ball(model.material_mu[material]) * squared(polygon.distance);
  const double size = factor.hi() * facet.factor.hi;
  std::size_t cells = 1;
  const CertifiedIntegrator::Allowance allowance{
      requested.tolerance / 50, [&](std::uint32_t beam, std::uint32_t sample) {
        const std::size_t bin = beam * row + std::min<std::size_t>(sample / 2, row - 1);
        return std::max(requested.target[bin] / 2000 / double(cells) / size, 1e-300);
      }};
  // Adds a part. `times` encloses the factors that are not in its integral.
  const auto add = [&](const CertifiedPolygon& part, const CertifiedCell* cell, const BinInterval& times) {
    const auto sink = [&](const Part<Ball>& own) {
      const Ball whole = factor * own.value;
      const double hi = whole.hi() * facet.factor.hi * (1 + slack),
                   lo = std::max(whole.lo() * facet.factor.lo * (1 - slack), 0.0);
      samples.add(own.beam, own.sample, (times.lo < 0 ? hi : lo) * times.lo, hi * times.hi, bins);
    };
    if (model.patterns != nullptr)
      integrator.add(part, *model.patterns, piece.tube, allowance, sink, cell);
    else
      integrator.add(part, piece.beam, allowance, sink, cell);
  };
  const CertifiedTexture* texture = requested.textures[material].get();
  if (texture == nullptr) return add(polygon, nullptr, {1, 1});
  const BinInterval range{std::max(texture->range().lo(), 0.0), texture->range().hi()};
  const FacetMap& lies = model.path.tx.facet_map[piece.id];
  const bool worth_it = range.hi - range.lo > requested.tolerance / 8 * range.lo;
  cells = worth_it ? cut_by_cells(polygon, *texture, lies, most_cells, {}) : 0;
  if (cells == 0) {
    cells = 1;
    return add(polygon, nullptr, range);
  }
  cut_by_cells(polygon, *texture, lies, most_cells,
               [&](const CertifiedPolygon& part, const CertifiedCell& cell) {
                 add(part, &cell, {1, 1});
               });
  // Points are slightly displaced from the positions that the map gives.
  double per_m = 0;
  for (const CertifiedTexture::Axis& axis : texture->axes())
    per_m =
        std::max(per_m, root(squared(axis.per_m[0]) + squared(axis.per_m[1]) + squared(axis.per_m[2])).hi());
  const double change = std::min(texture->change(per_m * facet.place_off_m * (1 + slack)), range.hi);
  cells = 1;
  add(polygon, nullptr, {-change, change});
}

}  // namespace

RefractedReference certify_refracted_echo(const MappedSeabed& seabed, const RayEnclosure& rays,
                                          const History& history, const VisibilityOptions& options,
                                          std::span<const std::uint32_t> beam_of_tube,
                                          const RangeSamples& samples, const EchoModel& model,
                                          const Echo& ordinary, double tolerance) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument("certified bounds need exact arithmetic: fixed, filtered or rational");
  const Requested requested{model,
                            certified_textures(model),
                            sample_borders_m(samples),
                            reference_targets(ordinary, tolerance),
                            samples.step_m,
                            tolerance,
                            Ball(model.absorption_db_per_m) * log(Ball(10)) / Ball(10)};
  if (model.path.tx.facet_map.empty() &&
      std::ranges::any_of(requested.textures, [](const auto& texture) { return texture != nullptr; }))
    throw std::invalid_argument(
        "certified reflectivity textures of apparent facets need the maps to the true positions");
  const FacetMesh& apparent = seabed.mesh();
  const std::vector<double>& borders = requested.borders;
  const auto row = std::size_t(samples.count);
  const ApparentEnclosures enclosures = enclose(seabed, rays, model);
  const UncertainEdges edges(apparent, seabed.parent, enclosures);
  const Unknown unknown(enclosures.unproven, rays);
  TubeSet tubes = history.tubes;
  // Facets beyond the reach may have images within it.
  const Looked looked(enclosures.facets);
  tubes.reach += 2 * looked.most_gap_m() / history.grid_unit_m;

  std::vector<BinIntervals> by_tube(tubes.tubes.size());
  struct Buffers {
    VisibilityScratch visibility;
    TubeVisibility seen;
  };
  tbb::enumerable_thread_specific<Buffers> threads;
  Steps steps("tubes", tubes.tubes.size());
  tbb::parallel_for(std::uint32_t{0}, std::uint32_t(tubes.tubes.size()), [&](std::uint32_t tube) {
    steps.done();
    auto& [visibility, seen] = threads.local();
    see(apparent, seabed.tree, tubes, tube, options, visibility, seen);
    const NameContext context{apparent, tubes.apex, seen.rays};
    BinIntervals& bins = by_tube[tube];
    const auto beams = model.patterns != nullptr ? model.patterns->beams_of_tube[tube]
                                                 : std::pair(beam_of_tube[tube], beam_of_tube[tube] + 1);
    const auto each_bin = [&](double nearest_m, double farthest_m, const auto& change) {
      const auto first = std::upper_bound(borders.begin(), borders.end(), nearest_m);
      const auto end = std::upper_bound(borders.begin(), borders.end(), farthest_m);
      const std::size_t from = std::size_t(std::max<std::ptrdiff_t>(first - borders.begin() - 1, 0)),
                        to = std::min(std::size_t(end - borders.begin()), row);
      for (std::size_t k = from; k < to; ++k)
        for (std::uint32_t beam = beams.first; beam < beams.second; ++beam) change(bins[beam * row + k]);
    };
    const AmbiguitySink ambiguity = [&](const Ambiguity& d) {
      each_bin(d.nearest_m, d.farthest_m, [&](BinInterval& bin) {
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
        each_bin(facet.nearest_m, facet.farthest_m, [&](BinInterval& bin) { bin.hi += facet.most; });
    }

    std::vector<AmbiguousPiece> pieces;
    for (const NamedPiece& piece : seen.pieces) {
      stop_if_wanted();
      const CertifiedPolygon polygon = certified_polygon(context, seen.corners, piece, history.grid_unit_m);
      pieces.push_back(seen_piece(piece, polygon));
      const FacetEnclosure& facet = enclosures.facets[piece.facet];
      if (facet.state != State::proven || polygon.edges.size() < 3) continue;
      add_piece({polygon, facet, piece.facet, tube, beam_of_tube[tube]}, requested, bins);
    }
    edges.add_ambiguities(context, seen, pieces, nearby, ambiguity);

    if (const double begins = unknown.begins_m(sector); begins < infinite)
      each_bin(begins, infinite, [&](BinInterval& bin) { bin.hi = infinite; });
  });

  return reference_between(by_tube, ordinary, tolerance);
}

}  // namespace tubefoot
