// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace tubefoot {

/// Returns a label (TubeAudit::hash) or a seed for a part of an object with the given label. All bits of both
/// arguments have an effect. For label 0 the result is the number of the part.
constexpr std::uint64_t label_of_part(std::uint64_t label, std::uint64_t part) {
  label = (label ^ label >> 30) * 0xbf58476d1ce4e5b9u;  // SplitMix64 (Steele, Lea & Flood 2014): one to one
  label = (label ^ label >> 27) * 0x94d049bb133111ebu;
  return (label ^ label >> 31) + part;
}

}  // namespace tubefoot
