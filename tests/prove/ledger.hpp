// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include "geometry/visibility/closure.hpp"
#include "prove/small_scenes.hpp"

namespace tubefoot::prove {

enum class Law {
  closure,
  filtered,
  rational,
  predicate,
  facet_order,
  translation,
  tube_splitting,
  facet_splitting,
  inner_splitting,
};

constexpr std::array<std::string_view, 9> law_names{"closure",        "filtered = fixed", "rational = fixed",
                                                    "predicate",      "facet order",      "translation",
                                                    "tube splitting", "facet splitting",  "inner splitting"};

/// Number of tubes on which a law was checked, by law and kind of scene. Sums do not depend on the order of
/// additions.
struct Ledger {
  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();

  struct Entry {
    std::uint64_t tubes = 0, failures = 0;
    std::uint64_t first_failure = none;  ///< number of a scene
    void add(const Entry& o) {
      tubes += o.tubes;
      failures += o.failures;
      first_failure = std::min(first_failure, o.first_failure);
    }
  };

  std::array<std::array<Entry, generator_names.size()>, law_names.size()> entries{};
  TopologyHash hash;  ///< of the result of `fixed`, over all scenes
  /// By kind of scene, summed over tubes: a ledger of open water would prove nothing.
  std::array<std::uint64_t, generator_names.size()> facets_seen{}, tubes_with_facets{};

  void count(Law law, std::uint64_t scene, bool holds) {
    entries[static_cast<std::size_t>(law)][scene % generator_names.size()].add(
        {1, holds ? 0u : 1u, holds ? none : scene});
  }
  void add(const Ledger& o) {
    for (std::size_t g = 0; g < generator_names.size(); ++g) {
      for (std::size_t l = 0; l < entries.size(); ++l) entries[l][g].add(o.entries[l][g]);
      facets_seen[g] += o.facets_seen[g];
      tubes_with_facets[g] += o.tubes_with_facets[g];
    }
    hash += o.hash;
  }
  Entry total(Law law) const {
    Entry sum;
    for (const Entry& e : entries[static_cast<std::size_t>(law)]) sum.add(e);
    return sum;
  }
  std::uint64_t failures() const {
    std::uint64_t sum = 0;
    for (const auto& law : entries)
      for (const Entry& e : law) sum += e.failures;
    return sum;
  }
};

}  // namespace tubefoot::prove
