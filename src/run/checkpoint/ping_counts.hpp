// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace tubefoot {

/// Apparent facets of transmissions through refracting water (engine/surface/refracted_surface.hpp), and
/// where some have not exactly one ray: azimuth and elevation in degrees and range in metres, from the sonar
/// in the local frame.
struct ApparentMapCounts {
  std::uint64_t facets = 0, in_shadow = 0, of_several = 0, folded = 0;
  double largest_travel_path_error_m = 0;
  std::array<double, 3> shadow{}, several{};  ///< the first of each
  std::uint64_t unbounded = 0;                ///< of a reference: bins whose bound is infinite
  std::uint64_t at_limit = 0;  ///< transmissions that would need a finer ground than is worth it
};

/// What the simulation of one ping counted. Plain data: it is kept beside the ping's energies.
struct PingCounts {
  std::uint64_t tubes = 0, candidates = 0, footprints = 0, pieces = 0, hits = 0;
  double visibility_seconds = 0, echo_seconds = 0;
  /// Of a reference: bins whose bound is above what was asked, and the worst of them.
  std::uint64_t bins_over = 0;
  double worst_ratio = 0;
  std::uint32_t worst_sensor = 0, worst_beam = 0, worst_sample = 0, padding = 0;
  /// With relief: facets made for the ping's transmissions, and what finer relief would change (FinerRelief).
  std::uint64_t refined_facets = 0;
  double finer_relief_largest = 0, finer_relief_rms = 0;
  /// Of paths: image apexes, arrivals without scattering, and the energy of each order.
  std::uint64_t images = 0, arrivals = 0;
  std::array<double, 9> energy_of_order{};
  /// Of refraction, by transmission: apparent facets, and those that ApparentMapCounts names.
  ApparentMapCounts refraction;
};

}  // namespace tubefoot
