// SPDX-License-Identifier: GPL-3.0-or-later
// What is special about the bins of a picture: where what is seen ends, and because of what.
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

/// A bin is of the last kind of which it holds an edge; without any it is interior. A bin that nothing
/// returns sound into is of one of the last two.
enum class BinKind : std::uint8_t {
  interior,     ///< no edge
  facet_edge,   ///< where two objects meet, or one surface bends
  far_edge,     ///< the upper end of a beam, or the last sample, cuts off what is seen
  near_edge,    ///< the lower end of a beam, or the first sample
  shadow_edge,  ///< where something nearer begins to hide what is seen
  silhouette,   ///< beyond which the way goes on, past what is seen
  shadow,       ///< nothing is seen, but something nearer is
  open_water,   ///< nothing is seen, and nothing nearer
};
inline constexpr std::size_t bin_kinds = 8;
/// As in JSON: "shadow-edge".
std::string_view name_of(BinKind kind);

/// What is seen from one place, and which beams receive it.
struct SeenEdges {
  const History& history;
  std::span<const std::uint16_t> object;        ///< by facet of the history's mesh
  std::span<const std::uint32_t> beam_of_tube;  ///< by tube
  std::size_t beams = 0;
  RangeSamples samples;
  glm::dvec3 other_end_m{0};    ///< of the paths, relative to the apex; 0 but where the receiver is apart
  bool ends_are_levels = true;  ///< beams have a lower and an upper end: not those of a fan that looks down
};

/// Surfaces that differ by less in direction are one, bent.
inline constexpr double least_bend_deg = 20;
/// What lies nearer or farther by less than this part of a sample lies at the same range.
inline constexpr double least_step_of_sample = 0.1;

/// By beam and sample.
struct BinEdges {
  std::vector<BinKind> kind;  ///< interior, or what the edges in it make it
  std::vector<FacetId>
      caster;  ///< whose silhouette is in it, behind which shadow begins; no_caster: nobody's
  static constexpr FacetId no_caster = ~FacetId{0};
};

/// What lies on both sides of each edge of
/// each footprint is looked at, all along it, an angle of a millionth of the tube away.
BinEdges edges_of_bins(const SeenEdges& seen);

}  // namespace tubefoot
