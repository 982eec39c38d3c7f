// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/footprint_energy.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "geometry/work/steps.hpp"

namespace tubefoot {
namespace {

/// Footprints that one task takes. No energy depends on it.
constexpr std::size_t footprints_per_task = 128;

/// All range samples as one: its ends are theirs, to the last bit.
RangeSamples as_one(const RangeSamples& samples) {
  return {samples.first_m, samples.step_m * samples.count, 1};
}

/// Footprints [begin, end) of a set, with their pieces and corners.
History part_of(const FootprintSet& set, std::size_t begin, std::size_t end) {
  History part;
  for (std::size_t k = begin; k < end; ++k) {
    Footprint footprint = set.footprints[k];
    const std::uint32_t first_piece = footprint.first_piece;
    footprint.first_piece = std::uint32_t(part.footprints.pieces.size());
    footprint.first_occluder = footprint.occluder_count = 0;
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece& piece = set.pieces[first_piece + p];
      part.footprints.pieces.push_back({std::uint32_t(part.footprints.corners_m.size()), piece.count});
      const auto corner = set.corners_m.begin() + std::ptrdiff_t(piece.first);
      part.footprints.corners_m.insert(part.footprints.corners_m.end(), corner, corner + piece.count);
    }
    part.footprints.footprints.push_back(footprint);
  }
  return part;
}

template <class Task>
void in_tasks(std::size_t count, std::size_t per_task, const Task& task) {
  const std::size_t tasks = (count + per_task - 1) / per_task;
  Steps steps("energies", tasks);
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t k) {
    task(k * per_task, std::min((k + 1) * per_task, count));
    steps.done();
  });
}

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

FootprintEnergies footprint_energies(const History& history, std::span<const std::uint32_t> beam_of_tube,
                                     int beams, const RangeSamples& samples, const EchoLaw& law,
                                     Binning binning) {
  const FootprintSet& set = history.footprints;
  const std::size_t count = set.footprints.size();
  const RangeSamples whole = as_one(samples);
  FootprintEnergies energies{std::vector<double>(count), std::vector<double>(count)};
  if (law.patterns == nullptr) {  // every footprint is given a tube and a beam of its own
    in_tasks(count, footprints_per_task, [&](std::size_t begin, std::size_t end) {
      History part = part_of(set, begin, end);
      std::vector<std::uint32_t> own(end - begin);
      std::iota(own.begin(), own.end(), 0u);
      for (std::size_t k = 0; k < own.size(); ++k) part.footprints.footprints[k].tube = own[k];
      const Echo echo = integrate_echo(part, own, int(own.size()), whole, law, binning);
      std::copy(echo.energy.begin(), echo.energy.end(), energies.all_beams.begin() + std::ptrdiff_t(begin));
    });
    energies.own_beam = energies.all_beams;
    return energies;
  }
  BeamPatterns patterns = *law.patterns;
  patterns.fringes.clear();  // footprints are the transmitter's
  EchoLaw own_law = law;
  own_law.patterns = &patterns;
  in_tasks(count, 1, [&](std::size_t k, std::size_t end) {
    const Echo echo = integrate_echo(part_of(set, k, end), beam_of_tube, beams, whole, own_law, binning);
    energies.all_beams[k] = sum(echo.energy);
    energies.own_beam[k] = echo.at(int(beam_of_tube[set.footprints[k].tube]), 0);
  });
  return energies;
}

FootprintEnergies footprint_energies(const FootprintSet& sent, const BistaticHistory& history,
                                     std::span<const std::uint32_t> beam_of_transmit_tube,
                                     const BistaticBeams& beams, const RangeSamples& samples,
                                     const EchoLaw& law) {
  const std::size_t count = sent.footprints.size();
  const SharedFootprints& shared = history.shared;
  const RangeSamples whole = as_one(samples);
  FootprintEnergies energies{std::vector<double>(count), std::vector<double>(count)};
  in_tasks(count, 1, [&](std::size_t k, std::size_t) {
    const Footprint& footprint = sent.footprints[k];
    const auto facet = std::lower_bound(shared.facets.begin(), shared.facets.end(), footprint.facet,
                                        [](const SharedFacet& f, FacetId id) { return f.facet < id; });
    if (facet == shared.facets.end() || facet->facet != footprint.facet) return;
    BistaticHistory part{history.transmit, history.receive, history.grid_unit_m, {}};
    part.shared.receiver_m = shared.receiver_m;
    part.shared.facets.push_back(*facet);
    for (std::uint32_t p = 0; p < facet->piece_count; ++p) {
      SharedPiece piece = shared.pieces[facet->first_piece + p];
      if (piece.transmit_tube != footprint.tube) continue;
      const auto corner = shared.corners_m.begin() + std::ptrdiff_t(piece.first);
      piece.first = std::uint32_t(part.shared.corners_m.size());
      part.shared.corners_m.insert(part.shared.corners_m.end(), corner, corner + piece.count);
      part.shared.pieces.push_back(piece);
    }
    part.shared.facets[0].first_piece = 0;
    part.shared.facets[0].piece_count = std::uint32_t(part.shared.pieces.size());
    if (part.shared.pieces.empty()) return;
    const Echo echo = integrate_bistatic_echo(part, beams, whole, law);
    energies.all_beams[k] = sum(echo.energy);
    energies.own_beam[k] = echo.at(int(beam_of_transmit_tube[footprint.tube]), 0);
  });
  return energies;
}

}  // namespace tubefoot
