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

/// The pings that a coverage counts: "2:5" or the like (resolved()) of a sensor, or of each. Throws
/// UsageError where there is no such sensor or ping.
std::vector<ReceivedPing> counted_pings(const Survey& survey, const std::optional<std::string>& sensor,
                                        const std::string& pings);
/// Their sensors by name.
std::vector<CountedPing> names_of(const Survey& survey, std::span<const ReceivedPing> pings);

/// Lays what these pings see over each other and calls `add` with the facets that they met, in the order of
/// their numbers. Throws InputError as a run does, Interrupted when somebody wants to stop.
void cover(const Survey& survey, const RunRequest& request, std::span<const ReceivedPing> pings, bool quiet,
           const std::function<void(const CoveredFacet&)>& add);

/// Areas of all facets that were met, m^2.
struct CoverageTotals {
  std::size_t facets = 0, closed = 0, seen_whole = 0, never_seen = 0;
  double area = 0, seen = 0, shadow = 0;
  std::map<std::uint32_t, double> by_pings;

  void add(const CoveredFacet& facet);
};

/// "A survey: side, 12 pings".
std::string coverage_title(const Survey& survey, const std::optional<std::string>& sensor, std::size_t pings);

}  // namespace tubefoot
