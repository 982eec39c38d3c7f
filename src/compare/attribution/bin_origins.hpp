// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "compare/attribution/bin_kinds.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission.hpp"

namespace tubefoot {

/// Contribution of one facet to a bin.
struct BinPart {
  std::uint32_t bin = 0;  ///< beam * samples + sample
  FacetId facet = 0;      ///< facet of the scene without relief
  std::uint16_t object = 0, material = 0;
  double energy_j = 0;
};

/// Facets behind the energies of a ping, and the kinds of its bins.
struct BinOrigins {
  std::vector<BinKind> kind;   ///< by bin
  std::vector<BinPart> parts;  ///< by bin, then by energy, largest first
  /// Facets whose silhouettes lie in a bin and begin a shadow, by bin; their energies are 0.
  std::vector<BinPart> casters;
};

/// Computes the origins of the energies of a ping from the exact visible polygons of its tubes.
///
/// With beam patterns, each beam receives from all tubes. Contributions below a thousandth are then
/// omitted, and the kinds are those of the tubes of each beam. With a separate receiver, the kinds are
/// those that the receiver sees. Paths over mirrors have no parts. Throws InputError under the same
/// conditions as a run.
BinOrigins bin_origins(const Transmissions& transmissions, TransmissionsAround& around, std::size_t sensor,
                       std::size_t ping);

}  // namespace tubefoot
