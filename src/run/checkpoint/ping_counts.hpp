// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace tubefoot {

/// Counts of apparent facets of transmissions through refracting water
/// (engine/surface/refracted_surface.hpp), and places of facets that are not reached by exactly one ray. A
/// place consists of azimuth and elevation in degrees and range in metres, from the sonar in the local
/// frame.
struct ApparentMapCounts {
  std::uint64_t facets = 0, in_shadow = 0, of_several = 0, folded = 0;
  double largest_travel_path_error_m = 0;
  /// place of the first facet in shadow, and of the first facet with several rays
  std::array<double, 3> shadow{}, several{};
  std::uint64_t unbounded = 0;  ///< for a reference: number of range bins whose bound is infinite
  /// number of transmissions that would need a finer surface than a reference permits
  std::uint64_t at_limit = 0;
};

/// Counts of the simulation of one ping. Plain data, stored together with the energies of the ping.
struct PingCounts {
  std::uint64_t tubes = 0, candidates = 0, footprints = 0, pieces = 0, hits = 0;
  double visibility_seconds = 0, echo_seconds = 0;
  /// For a reference: number of range bins whose bound exceeds the requested tolerance, and the worst of
  /// these bins.
  std::uint64_t bins_over = 0;
  double worst_ratio = 0;
  std::uint32_t worst_sensor = 0, worst_beam = 0, worst_sample = 0, padding = 0;
  /// With relief: number of facets made for the ping's transmissions, and the change that finer relief would
  /// cause (FinerRelief).
  std::uint64_t refined_facets = 0;
  double finer_relief_largest = 0, finer_relief_rms = 0;
  /// For paths: number of image apexes, number of arrivals without scattering, and the energy of each order.
  std::uint64_t images = 0, arrivals = 0;
  std::array<double, 9> energy_of_order{};
  /// For refraction, summed over transmissions: apparent facets, and the counts that ApparentMapCounts
  /// names.
  ApparentMapCounts refraction;
};

}  // namespace tubefoot
