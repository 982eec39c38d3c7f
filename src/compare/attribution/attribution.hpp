// SPDX-License-Identifier: GPL-3.0-or-later
// Attribution of errors to objects, materials, kinds of bins, ranges and beams, and to the facets behind
// the largest errors.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "compare/attribution/bin_kinds.hpp"
#include "compare/attribution/error_split.hpp"
#include "compare/attribution/scene_at_hand.hpp"
#include "compare/measures/echo_errors.hpp"
#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// One row of a table.
struct ErrorPart {
  std::string name;
  ErrorSums sums;
  std::size_t bins = 0;  ///< number of bins that belong to this part, or in which it has energy
};

struct FacetShare {
  std::uint16_t object = 0, material = 0;
  FacetId facet = 0;  ///< facet of the scene without relief, numbered through all objects
  double share = 0;   ///< share in the energy of the bin
};

struct WorstBin {
  BinPlace place;  ///< position in the compared files
  double slant_range_m = 0, reference_j = 0, candidate_j = 0, share_of_difference = 0;
  BinKind kind = BinKind::interior;
  /// At most eight facets, largest share first. For a dark bin, the facet that casts the shadow.
  std::vector<FacetShare> facets;
};

/// Tables of the error. The rows of each table add up to `whole`.
struct Attribution {
  ErrorSums whole;
  std::vector<ErrorPart> kinds, objects, materials, ranges, beams;
  std::vector<ErrorPart> causes;  ///< pairs of an object and a kind, largest error first
  std::vector<WorstBin> worst;
  std::vector<std::string> object_names, material_names;
  std::vector<std::string> notes;
};

/// Attributes the error of a sensor; `pair` has the reference and the compared energies.
///
/// The owners of a bin are the facets that contribute energy to it (bin_origins()). The owner of a bin
/// without energy is the facet that casts the shadow. This is the facet of the last silhouette before the
/// bin in its beam. Without a silhouette it is the facet with the largest energy in the last non-empty bin
/// before. A bin before the first return has no owner.
///
/// Throws InputError if the echoes do not fit the scene.
Attribution attribute(const SceneAtHand& scene, const SensorEchoes& reference, const EchoPair& pair,
                      std::size_t worst, bool quiet);

std::string attribution_text(const std::string& sensor, const Attribution& attribution);
nlohmann::ordered_json attribution_json(const Attribution& attribution);

}  // namespace tubefoot
