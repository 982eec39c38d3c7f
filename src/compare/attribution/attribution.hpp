// SPDX-License-Identifier: GPL-3.0-or-later
// Whose an error is: by object, material, kind of bin, range and beam; and which facets are behind the worst.
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
  std::size_t bins = 0;  ///< that belong to it, or in which it has something
};

struct FacetShare {
  std::uint16_t object = 0, material = 0;
  FacetId facet = 0;  ///< of the scene without relief, counted through all its objects
  double share = 0;   ///< of the bin's energy
};

struct WorstBin {
  BinPlace place;  ///< in the files
  double slant_range_m = 0, reference_j = 0, candidate_j = 0, share_of_difference = 0;
  BinKind kind = BinKind::interior;
  /// Largest first, eight at most; of a dark bin, the one that casts the shadow.
  std::vector<FacetShare> facets;
};

/// Each table adds up to the whole.
struct Attribution {
  ErrorSums whole;
  std::vector<ErrorPart> kinds, objects, materials, ranges, beams;
  std::vector<ErrorPart> causes;  ///< pairs of an object and a kind, largest error first
  std::vector<WorstBin> worst;
  std::vector<std::string> object_names, material_names;
  std::vector<std::string> notes;
};

/// Of a sensor, `pair` being its reference and what is compared with it. Owners of a bin are those of its
/// energy in the scene, bin_origins(); of a bin that nothing returns sound into, whoever casts the shadow:
/// whose silhouette is the last before it in its beam, without any the largest of the last bin before it, and
/// before the first return nobody. Throws InputError where the scene does not fit.
Attribution attribute(const SceneAtHand& scene, const SensorEchoes& reference, const EchoPair& pair,
                      std::size_t worst, bool quiet);

std::string attribution_text(const std::string& sensor, const Attribution& attribution);
nlohmann::ordered_json attribution_json(const Attribution& attribution);

}  // namespace tubefoot
