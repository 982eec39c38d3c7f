// SPDX-License-Identifier: GPL-3.0-or-later
// Classifies range bins by the edges of what the sonar sees in them: silhouettes, shadow edges, ends of the
// beam and edges between facets.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "engine/visibility/history.hpp"

namespace tubefoot {

/// Kind of a range bin. A bin with several kinds of edges has the last of these kinds; a bin without edges
/// is interior. A bin without returned sound is `shadow` or `open_water`.
enum class BinKind : std::uint8_t {
  interior,     ///< no edge
  facet_edge,   ///< border between two objects, or a sharp edge of one surface
  far_edge,     ///< the upper end of a beam or the last sample cuts off a visible surface
  near_edge,    ///< the lower end of a beam or the first sample cuts off a visible surface
  shadow_edge,  ///< a nearer surface begins to hide a visible surface
  silhouette,   ///< edge of a visible surface beyond which the ray continues to a farther surface or none
  shadow,       ///< nothing is visible in the bin, but a nearer surface is visible in the beam
  open_water,   ///< nothing is visible in the bin, and no nearer surface in the beam
};
inline constexpr std::size_t bin_kinds = 8;
/// Name of the kind in JSON, for example "shadow-edge".
std::string_view name_of(BinKind kind);

/// Visible polygons from one apex, and the beams that receive their echoes.
struct SeenEdges {
  const History& history;
  std::span<const std::uint16_t> object;        ///< by facet of the history's mesh
  std::span<const std::uint32_t> beam_of_tube;  ///< by tube
  std::size_t beams = 0;
  RangeSamples samples;
  glm::dvec3 other_end_m{0};  ///< other end of the paths, relative to the apex; not 0 for a separate receiver
  /// Beams have a lower and an upper end, unlike those of a fan that looks down.
  bool ends_are_levels = true;
};

/// Two facets are parts of one curved surface if their normals differ by a smaller angle.
inline constexpr double least_bend_deg = 20;
/// Two surfaces at an edge have the same range if their ranges differ by a smaller fraction of a sample.
inline constexpr double least_step_of_sample = 0.1;

/// Arrays by beam and sample.
struct BinEdges {
  std::vector<BinKind> kind;    ///< `interior`, or the kind of the edges in the bin
  std::vector<FacetId> caster;  ///< facet whose silhouette lies in the bin and begins a shadow; or no_caster
  static constexpr FacetId no_caster = ~FacetId{0};
};

/// Finds the kinds of all bins. Samples each edge of each footprint along its length. Looks up the facet on
/// the other side at an offset of a millionth of the width of the tube.
BinEdges edges_of_bins(const SeenEdges& seen);

}  // namespace tubefoot
