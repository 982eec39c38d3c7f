// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/refracted_receiver_pair.hpp"

#include <algorithm>
#include <cmath>

#include "engine/certified/flattened_pieces.hpp"
#include "engine/certified/receiver_pair_reference.hpp"
#include "geometry/numbers/scalars.hpp"

// Computes reference energies and products of a receiver pair in stratified water, from the parts of two
// bistatic references and the products over common pieces. See docs/notes/certified-energies.md, section "Of
// two receivers".
namespace tubefoot {
namespace {

constexpr double slack = 1e-9;  // far above the rounding of the doubles that it widens

/// Returns the facets that both receivers share with the transmitter, by their indices in both lists.
std::vector<std::array<std::size_t, 2>> common_facets(const std::array<BistaticParts, 2>& parts) {
  std::vector<std::array<std::size_t, 2>> both;
  const auto &up = parts[0].shared.facets, &down = parts[1].shared.facets;
  for (std::size_t u = 0, d = 0; u < up.size() && d < down.size();) {
    if (up[u].facet == down[d].facet && parts[0].is_proven[u] && parts[1].is_proven[d])
      both.push_back({u, d});
    const bool next_up = up[u].facet <= down[d].facet, next_down = down[d].facet <= up[u].facet;
    u += next_up;
    d += next_down;
  }
  return both;
}

std::vector<FlattenedPieces::Products> products_of(const std::array<BistaticParts, 2>& parts,
                                                   const CertifiedRequest& request, double wavenumber_rad_m) {
  const auto facets = common_facets(parts);
  const SharedFootprints &by_upper = parts[0].shared, &by_lower = parts[1].shared;
  return enclose_tasks("facets", facets.size(), 1, FlattenedPieces::Products(),
                       [&](std::size_t number, FlattenedPieces::Products& found) {
                         const auto [u, d] = facets[number];
                         const SharedFacet &upper = by_upper.facets[u], &lower = by_lower.facets[d];
                         FlattenedPieces pieces(request, upper.facet,
                                                {parts[0].bistatic[u], parts[0].facets[u]},
                                                {parts[1].bistatic[d], parts[1].facets[d]});
                         each_common(by_upper, upper, by_lower, lower,
                                     [&](const ReceivedPiece& one, const ReceivedPiece& two) {
                                       pieces.add_products(wavenumber_rad_m, one, two, found);
                                     });
                       });
}

}  // namespace

RefractedReference certify_refracted_receiver_pair(const std::array<BistaticSurface, 2>& seabeds,
                                                   const std::array<BistaticTubes, 2>& tubes,
                                                   const VisibilityOptions& options,
                                                   const ReceiverBaseline& receiver_pair,
                                                   const RangeSamples& samples, const EchoModel& model,
                                                   const std::array<Echo, 2>& ordinary, double tolerance) {
  std::array<BistaticSurface, 2> both = seabeds;
  for (std::size_t e = 0; e < 2; ++e) {
    both[e].beside = &seabeds[1 - e].rx;
    both[e].ranges_within_m = tolerance / (16 * receiver_pair.wavenumber_rad_m);
  }
  ReceiverPairFlattening receiver_pair_out(seabeds[0].mesh, {seabeds[0].tx.surface_mesh, seabeds[0].tx.water},
                                           {&seabeds[0].rx.water, &seabeds[1].rx.water}, seabeds[0].grid);
  std::array<Flattening, 2> flatten;
  for (const std::size_t e : {0, 1})
    flatten[e] = [&receiver_pair_out, e](const SharedFootprints& shared) {
      return receiver_pair_out.of(shared, e);
    };
  const std::array<BistaticParts, 2> parts =
      bistatic_parts(both, tubes, options, samples, model, ordinary, tolerance, flatten);

  const auto row = std::size_t(samples.count);
  const CertifiedRequest request(model, samples, tolerance,
                                 receiver_pair_targets(ordinary[0].energy, ordinary[1].energy, tolerance));
  std::vector<Interval> total(4 * row);
  std::vector<double> ambiguous(row, 0);
  const auto take_ambiguous = [&](const BinIntervals& bins) {
    for (const auto& [bin, part] : bins) ambiguous[bin] += part.hi;
  };
  for (std::size_t e = 0; e < 2; ++e) {
    const std::span all(parts[e].bins);
    for (const auto& [bin, part] : added_up(all)) total[e * row + bin] = {std::max(part.lo, 0.0), part.hi};
    take_ambiguous(all[parts[e].conservative]);
    // Ambiguities of the transmitter belong to both receivers.
    for (const BinIntervals& bins : all.subspan(parts[e].first_ambiguity[e == 0 ? 0 : 1]))
      take_ambiguous(bins);
  }
  for (const FlattenedPieces::Products& of : products_of(parts, request, receiver_pair.wavenumber_rad_m)) {
    for (const auto& [bin, part] : of.sure) {
      total[2 * row + bin].lo += part.lo;
      total[2 * row + bin].hi += part.hi;
    }
    take_ambiguous(of.ambiguous);
  }

  CertifiedEcho certified{Echo{4, int(row), std::vector<double>(4 * row)}, std::vector<double>(4 * row)};
  for (std::size_t bin = 0; bin < total.size(); ++bin) {
    const double more = bin < 2 * row ? 0 : ambiguous[bin % row] * (1 + slack), lo = total[bin].lo - more,
                 hi = total[bin].hi + more;
    if (!std::isfinite(hi)) {
      certified.echo.energy[bin] = bin < 2 * row ? ordinary[bin / row].energy[bin % row] : 0;
      certified.bound[bin] = infinite;
      continue;
    }
    certified.echo.energy[bin] = lo + (hi - lo) / 2;
    certified.bound[bin] = (hi - lo) / 2 * (1 + slack) + slack * std::max(std::abs(lo), std::abs(hi));
  }
  return reference_of(std::move(certified), tolerance, receiver_pair_row_targets);
}

}  // namespace tubefoot
