// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "footprints/coverage_file.hpp"
#include "run/console/progress.hpp"
#include "run/facet_blocks.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"

namespace tubefoot {

/// Returns the pings that a coverage counts: "2:5" or a similar selection (resolved()) of one sensor or of
/// each. Throws UsageError if there is no such sensor or ping.
std::vector<ReceivedPing> counted_pings(const Survey& survey, const std::optional<std::string>& sensor,
                                        const std::string& pings);
/// Returns the pings with the names of their sensors.
std::vector<CountedPing> names_of(const Survey& survey, std::span<const ReceivedPing> pings);

/// Overlays the visible parts of these pings and calls `add` with the facets in their sector, in the order
/// of facet numbers. Throws InputError under the same conditions as a run, and Interrupted on a stop
/// request.
void cover(const Survey& survey, const RunRequest& request, std::span<const ReceivedPing> pings, bool quiet,
           const std::function<void(const CoveredFacet&)>& add);

/// Areas in m², summed over all facets in the sector of a ping.
struct CoverageTotals {
  std::size_t facets = 0, closed = 0, seen_whole = 0, never_seen = 0;
  double area = 0, seen = 0, shadow = 0;
  std::map<std::uint32_t, double> by_pings;

  void add(const CoveredFacet& facet);
};

/// Returns a title such as "A survey: side, 12 pings".
std::string coverage_title(const Survey& survey, const std::optional<std::string>& sensor, std::size_t pings);

}  // namespace tubefoot
