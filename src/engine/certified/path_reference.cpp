// SPDX-License-Identifier: GPL-3.0-or-later
// Computes reference energies of bistatic echoes in isovelocity water, for the common visibility of two
// apexes. Cells lie between ellipses of equal path length, and integrals use CertifiedPathIntegrator. See
// docs/notes/certified-energies.md, section "Two apexes".
#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/certified/certified_driver.hpp"
#include "engine/certified/certified_path_energy.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

/// Counts the approximate number of pieces that share a bin.
std::vector<double> pieces_of_bins(const SharedFootprints& shared, const ReceiveBeams& beams,
                                   const CertifiedRequest& request, std::size_t bins) {
  std::vector<double> pieces(bins, 0);
  const std::vector<double>& borders = request.borders;
  for (const SharedFacet& facet : shared.facets)
    each_received(request, beams, shared, facet, [&](const SharedPiece& piece, const auto& received) {
      double least = infinite, most = 0;
      for (const glm::dvec3& corner : ReceivedPiece(shared, piece).corners_m) {
        const double half = (glm::length(corner) + glm::length(corner - shared.receiver_m)) / 2;
        least = std::min(least, half);
        most = std::max(most, half);
      }
      for (std::size_t k = 0; k < request.row(); ++k)
        if (borders[k] < most && borders[k + 1] > least)
          for (std::uint32_t beam = received.first; beam < received.second; ++beam)
            ++pieces[beam * request.row() + k];
    });
  return pieces;
}

}  // namespace

CertifiedEcho certify_echo(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance) {
  require_one_position(history.bistatic);
  const PatternsOfEnds own(model);
  CertifiedRequest request(own.model, samples);
  const SharedFootprints& shared = history.shared;
  const std::size_t row = request.row(), bins = ordinary.energy.size();
  const std::vector<double> pieces = pieces_of_bins(shared, beams, request, bins);
  std::array<Ball, 3> rx_m;
  for (std::size_t k = 0; k < 3; ++k) rx_m[k] = Ball(shared.receiver_m[int(k)]);

  const auto enclose_facet = [&](std::size_t number, BinSums& sums) {
    const FacetId facet = shared.facets[number].facet;
    FacetCone cone;
    FacetCone::make(mesh, facet, history.transmit.apex, cone);
    CertifiedPathIntegrator integrator(request.borders);
    each_received(
        request, beams, shared, shared.facets[number], [&](const SharedPiece& piece, const auto& received) {
          const auto [first, end] = received;
          const ReceivedPiece seen(shared, piece);
          const CertifiedPolygon polygon =
              certified_polygon(cone, seen.corners_m, seen.rests_m, shared.receiver_m, history.grid_unit_m);
          const CertifiedPathEnergy energy(polygon, rx_m, own.model, own.model.seabed(facet),
                                           request.beta_per_m);
          CertifiedPathGains gains;
          if (const BeamPatterns* patterns = own.model.patterns)
            gains = {energy.tx(), energy.rx(), patterns->transmit[patterns->fan_of_tube[piece.receive_tube]],
                     std::span(patterns->receive).subspan(first, end - first)};
          const TexturedPolygon textured =
              request.textured(polygon, model.material[facet], model.path.tx.map_of(facet));
          const Interval whole = interval_of(textured.factor());
          // The relative and the shared error each receive a third of the tolerance. The rest is
          // for gaps and rounding.
          const CertifiedPathIntegrator::Allowance allowance{
              request.tolerance / 3, [&, beam0 = first](std::size_t beam, std::size_t sample) {
                const std::size_t bin = (beam0 + beam) * row + sample;
                const double sharers = std::max(pieces[bin], 1.0) * textured.parts();
                return std::max(request.target[bin] / 3 / sharers / whole.hi, least_allowed);
              }};
          const ApexOverPlane rx = energy.rx().over();
          textured.each_part([&](const CertifiedPolygon& part, const CertifiedCell* cell) {
            CertifiedPathIntegrand integrand(energy, gains, cell);
            integrator.add(part, energy.tx().over(), {&rx, 1}, integrand, allowance,
                           [&](std::size_t sample, std::span<const Interval> values) {
                             for (std::size_t beam = 0; beam < values.size(); ++beam)
                               sums.at(received.first + beam, sample) += whole * values[beam];
                           });
          });
        });
  };
  return refined_until_tolerance(request, ordinary, tolerance, reference_targets, [&] {
    const auto by_run =
        enclose_tasks("facets", shared.facets.size(), facets_in_run, BinSums(bins / row, row), enclose_facet);
    std::vector<Interval> total(bins);
    for (const BinSums& sums : by_run) sums.add_to(total);
    std::vector<Ball> balls;
    for (const Interval& sum : total) balls.push_back(Ball::between(sum.lo, sum.hi));
    return enclosed_echo(ordinary, balls);
  });
}

}  // namespace tubefoot
