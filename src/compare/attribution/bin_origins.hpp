// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "compare/attribution/bin_kinds.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// What one facet adds to a bin.
struct BinPart {
  std::uint32_t bin = 0;  ///< beam * samples + sample
  FacetId facet = 0;      ///< of the scene without relief
  std::uint16_t object = 0, material = 0;
  double energy_j = 0;
};

/// Whose the energies of a ping are, and what is special about its bins.
struct BinOrigins {
  std::vector<BinKind> kind;   ///< by bin
  std::vector<BinPart> parts;  ///< by bin, then by energy, largest first
  /// By bin: whose silhouette is in it, behind which the shadow begins; without energies.
  std::vector<BinPart> casters;
};

/// Of a sensor's ping, by exact cuts of what its tubes see. With beam patterns, of which each beam receives
/// everything, what adds less than a thousandth is left out, and kinds are those of each beam's own tubes.
/// With a separate receiver, kinds are as it sees the scene. Paths over mirrors have no parts. Throws
/// InputError as a run does.
BinOrigins bin_origins(const Transmissions& transmissions, TransmissionsAround& around, std::size_t sensor,
                       std::size_t ping);

}  // namespace tubefoot
