// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/visibility/closure.hpp"

namespace tubefoot {

/// What holds of what two apexes see, in rationals: the closure law of all tubes of both, and, by facet that
/// both look at, that of the parts that they share.
struct BistaticAudit {
  std::vector<TubeAudit> transmit, receive;
  std::vector<SharedAudit> shared;
};

/// Labels (TubeAudit::hash) of the parts of what has one: all bits of both count. 0 has its parts' numbers.
constexpr std::uint64_t label_of_part(std::uint64_t label, std::uint64_t part) {
  label = (label ^ label >> 30) * 0xbf58476d1ce4e5b9u;  // SplitMix64 (Steele, Lea & Flood 2014): one to one
  label = (label ^ label >> 27) * 0x94d049bb133111ebu;
  return (label ^ label >> 31) + part;
}

/// Of all tubes of a set, parts of what `label` is of. `seen`: with open water.
std::vector<TubeAudit> audit_tubes(const FacetMesh& mesh, const TubeSet& tubes,
                                   std::span<const TubeVisibility> seen, std::uint64_t label);
std::vector<SharedAudit> audit_shared(const FootprintSharer& sharer, std::uint64_t label);

}  // namespace tubefoot
