// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "sensors/products/swath_soundings.hpp"
#include "sensors/recordings/navigation.hpp"

namespace tubefoot {

/// What files say of a fan across the track, beside what they say of any sensor. One-way widths.
struct SwathSettings {
  DetectionRule rule;
  double grid_cell_m = 0;  ///< of the depth grid; 0: chosen
  double receive_across_deg = 0, along_track_deg = 0;
  double fan_deg = 0;              ///< from border to border of the outermost beams
  double transmit_across_deg = 0;  ///< lit
  double range_max_m = 0;
  bool is_like_8101 = false;  ///< a RESON 8101's own packets hold it
};

/// A ping and its soundings, placed on Earth.
struct PlacedPing {
  std::size_t ping = 0;
  glm::dvec3 position_m{0};  ///< of the sensor, in the scene's frame
  NavigationFix fix{};
  SoundedPing sounded;
  std::vector<std::optional<Sounding>> ideal;  ///< by beam, of an ideal receiver; empty where it is one
  std::vector<glm::dvec3> soundings_lon_lat;   ///< by beam, with heights; not numbers where nothing was found

  /// From the sensor: along its true heading, to starboard and down, in metres on the ellipsoid. They lead
  /// from the sensor's longitude and latitude to the sounding's, which a map's own metres do not.
  glm::dvec3 forward_starboard_down_m(std::size_t beam) const;
};

/// A file of a recording of a fan across the track that needs positions on Earth, written ping by ping, or
/// several: one per line of a survey.
/// Heights are above the scene's height 0, which stands for the water's surface and for the ellipsoid alike;
/// headings are true.
class SwathFormat {
 public:
  virtual ~SwathFormat() = default;
  /// What the file has of a ping, found on any thread; calling what it returns writes it, ping by ping in
  /// order. It does not look at `ping` again.
  virtual std::function<void()> adding(const PlacedPing& ping) = 0;
  /// Completes the file; without it there is none.
  virtual void finish() = 0;
  /// Names of the files in their folder.
  virtual std::vector<std::filesystem::path> files() const = 0;
};

/// SONAR-netCDF4 with bathymetry (sensors/formats/sonar_netcdf.hpp), one file for all lines.
std::unique_ptr<SwathFormat> make_sonar_netcdf(const std::filesystem::path& folder,
                                               const Recording& recording, const RunContext& run,
                                               const SwathSettings& settings, const ReceiverChain& receiver);
/// GSF (sensors/formats/gsf_file.hpp), one file per line. `placer`: by which the soundings were placed.
std::unique_ptr<SwathFormat> make_gsf(const std::filesystem::path& folder, const Recording& recording,
                                      const RunContext& run, const SwathSettings& settings,
                                      const SoundingPlacer& placer);
/// XTF (sensors/formats/xtf_file.hpp), one file per line: an 8101's own packets for a fan like that one's,
/// generic ones for others.
std::unique_ptr<SwathFormat> make_xtf(const std::filesystem::path& folder, const Recording& recording,
                                      const RunContext& run, const SwathSettings& settings);

}  // namespace tubefoot
