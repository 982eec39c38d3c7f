// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes survey lines of Kongsberg sonars, with soundings and a water column in one file. A line is
// rejected, or has modes with ordered beams and a scene that can be read. Recomputed soundings are finite.
#include <algorithm>
#include <cmath>

#include "exchange/readers/kmall_scene.hpp"
#include "files/shown.hpp"
#include "fuzz.hpp"
#include "kmall/kmall_geometry.hpp"

namespace tubefoot::fuzz {
namespace {

void check(const KmallMode& mode) {
  const std::size_t beams = mode.beam_angles_deg.size(), sectors = mode.sectors.size();
  if (beams == 0 || sectors == 0 || mode.pings.empty()) finding("a mode without beams, sectors or pings");
  if (mode.beam_numbers.size() != beams || mode.sector_edges_deg.size() != sectors + 1 ||
      mode.absorptions_db_per_km.size() != sectors)
    finding("lists of different lengths");
  if (!std::ranges::is_sorted(mode.beam_angles_deg)) finding("beams that are not in order");
  for (const double angle_deg : mode.beam_angles_deg)
    if (!std::isfinite(angle_deg)) finding("an angle that is not finite");
  if (!std::ranges::is_sorted(mode.pings, {}, &KmallModePing::time_s)) finding("pings that are not in order");
  if (!(mode.sample_rate_hz > 0) || mode.first_sample >= mode.end_sample) finding("a mode without samples");
}

}  // namespace
}  // namespace tubefoot::fuzz

/// The file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  const auto file = fuzz::scratch_file("line.kmall", fuzz::Bytes(data, size).rest());
  fuzz::may_refuse([&] {
    const KmallSurvey survey = read_kmall_survey(file, false);
    for (const KmallMode& mode : survey.modes) fuzz::check(mode);
    for (const std::string& note : survey.notes) fuzz::check_message(shown(note));
    const KmallResiduals residuals = residuals_of(survey);
    if (!std::isfinite(residuals.median_m) || !std::isfinite(residuals.percentile_95_m))
      fuzz::finding("a sounding at no place");
    const auto folder = fuzz::scratch_folder() / "scene";
    std::filesystem::create_directories(folder);
    write_kmall_scene(survey, {}, folder);
  });
  return 0;
}
