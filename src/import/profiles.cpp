// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles: the picture formats of other engines according to their source code. Importing assumes a
// profile and then tests it against the reference.
#include <fmt/format.h>

#include <algorithm>

#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "import/import_options.hpp"

namespace tubefoot {
namespace {

struct Profile {
  const char* name;
  const char* order;
  bool flip_beams, flip_range;
  const char *scale, *azimuths, *range_origin;
  const char* why;
};

// HoloOcean: client, sensors.py: float32 (RangeBins, AzimuthBins), mean per bin; it does not state the sign
// of azimuths.
// Stonefish b21eb8e1: the shader writes bin i to row N-1-i. Beams are columns of perspective views of at most
// 20 degrees (OpenGLFLS.cpp: FLS_MAX_SINGLE_FOV). The last view has the remaining beams.
// DAVE nps_uw_multibeam_sonar 47dae1f: index = sample x beams + k, reversed beams, min(255, gain |P|).
// OceanSim 2809388: azimuths start at 90 - hfov / 2 (starboard); bins by their left edges. Each row is
// divided by its maximum, or all rows by the common maximum.
constexpr Profile profiles[] = {
    {"holoocean", "range-first", false, false, "energy", "", "",
     "rows are ranges, the nearest first; columns go from port to starboard; values are means per bin from 0 "
     "to 1"},
    {"stonefish", "range-first", false, true, "energy", "tangent:20deg", "",
     "rows are ranges, the farthest first; columns are equidistant in views of at most 20 degrees; values "
     "are means per bin times a gain, "
     "blurred and clamped to 1"},
    {"dave", "range-first", true, false, "amplitude", "", "",
     "rows are ranges, the nearest first; columns go from starboard to port; values are amplitudes times a "
     "gain, clamped"},
    {"oceansim", "range-first", true, false, "energy", "", "edges",
     "rows are ranges (near edges of the bins), the nearest first; columns go from starboard to port; values "
     "are normalised per row or over all rows"},
};

}  // namespace

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  for (const Profile& profile : profiles) names.emplace_back(profile.name);
  return names;
}

std::vector<std::string> apply_profile(ImportOptions& options, const ForeignFrame& first) {
  if (options.profile.empty()) return {};
  const auto found =
      std::ranges::find_if(profiles, [&](const Profile& p) { return options.profile == p.name; });
  if (found == std::end(profiles))
    throw UsageError(
        fmt::format("there is no profile '{}': choose {}", options.profile, one_of(profile_names(), '\'')));
  const auto unless_said = [](std::string& word, const char* otherwise) {
    if (word.empty()) word = otherwise;
  };
  if (options.cartesian.empty()) {
    unless_said(options.order, found->order);
    unless_said(options.azimuths, found->azimuths);
    unless_said(options.range_origin, found->range_origin);
    // OceanSim's points contain their positions. DAVE reverses the beams of its pictures but not of its
    // tables.
    const bool table = !first.range_m.empty() && first.azimuth_rad.empty(),
               points = options.profile == "oceansim" && !first.azimuth_rad.empty();
    if (!options.flip_beams) options.flip_beams = found->flip_beams && !table && !points;
    // Ranges in the file determine their direction themselves.
    if (!options.flip_range) options.flip_range = found->flip_range && first.range_m.empty();
  }
  unless_said(options.scale, found->scale);
  return {fmt::format("profile {}: {}", found->name, found->why)};
}

std::string words_of(const ImportOptions& o) {
  std::string words;
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words += fmt::format(" {} {}", option, value);
  };
  add("--profile", o.profile);
  add("--variable", o.variable);
  add("--range-variable", o.range_variable);
  add("--azimuth-variable", o.azimuth_variable);
  add("--topic", o.topic);
  add("--order", o.order);
  if (o.flip_beams) words += *o.flip_beams ? " --flip-beams" : " --no-flip-beams";
  if (o.flip_range) words += *o.flip_range ? " --flip-range" : " --no-flip-range";
  add("--scale", o.scale);
  add("--azimuths", o.azimuths);
  add("--ranges", o.ranges);
  add("--range-origin", o.range_origin);
  add("--cartesian", o.cartesian);
  add("--forward", o.forward);
  if (o.resample) words += " --resample";
  return words.empty() ? words : words.substr(1);
}

}  // namespace tubefoot
