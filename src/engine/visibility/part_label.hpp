// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace tubefoot {

/// A label (TubeAudit::hash) or a seed of a part of what has one: all bits of both count. 0 has its parts'
/// numbers.
constexpr std::uint64_t label_of_part(std::uint64_t label, std::uint64_t part) {
  label = (label ^ label >> 30) * 0xbf58476d1ce4e5b9u;  // SplitMix64 (Steele, Lea & Flood 2014): one to one
  label = (label ^ label >> 27) * 0x94d049bb133111ebu;
  return (label ^ label >> 31) + part;
}

}  // namespace tubefoot
