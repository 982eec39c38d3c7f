// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "sensors/products/swath_soundings.hpp"
#include "sensors/recordings/navigation.hpp"

namespace tubefoot {

/// Properties of a fan across the track for the headers of files. Widths are one-way.
struct SwathSettings {
  DetectionRule rule;
  double grid_cell_m = 0;  ///< of the depth grid; 0: automatic
  double receive_across_deg = 0, along_track_deg = 0;
  double receive_along_deg = 0;    ///< of the receive beams; `along_track_deg` is that of transmission
  double fan_deg = 0;              ///< between the borders of the outermost beams
  double transmit_across_deg = 0;  ///< insonified width
  double range_max_m = 0;
  bool is_like_8101 = false;  ///< true if the packets of a RESON 8101 can represent it
};

/// A ping and its soundings, placed on Earth.
struct PlacedPing {
  std::size_t ping = 0;
  glm::dvec3 position_m{0};  ///< of the sensor, in the scene's frame
  NavigationFix fix{};
  SoundedPing sounded;
  std::vector<std::optional<Sounding>> ideal;  ///< by beam, with an ideal receiver; empty if the receiver is
                                               ///< ideal
  std::vector<glm::dvec3> soundings_lon_lat;   ///< by beam, with heights; NaN without a sounding

  /// Vector from the sensor to a sounding: along its true heading, to starboard and down, in metres on the
  /// ellipsoid. It leads from the sensor's longitude and latitude to those of the sounding. A vector in the
  /// map's own metres does not.
  glm::dvec3 forward_starboard_down_m(std::size_t beam) const;
};

/// A file of a fan across the track that needs positions on Earth, written ping by ping. A format with one
/// file per survey line has several. Heights are above the scene's height 0, which represents both the water
/// surface and the ellipsoid; headings are true.
class SwathFormat {
 public:
  virtual ~SwathFormat() = default;
  /// Prepares a ping for the file, on any thread. The returned function writes it; call these functions in
  /// the order of the pings. The function does not access `ping` again.
  virtual std::function<void()> adding(const PlacedPing& ping) = 0;
  /// Completes the file. An unfinished file is removed.
  virtual void finish() = 0;
  /// Names of the files in their folder.
  virtual std::vector<std::filesystem::path> files() const = 0;
};

/// SONAR-netCDF4 with bathymetry (sensors/formats/sonar_netcdf.hpp), one file for all lines. `finder`: the
/// one that found the soundings, which must outlive the file.
std::unique_ptr<SwathFormat> make_sonar_netcdf(const std::filesystem::path& folder,
                                               const Recording& recording, const RunContext& run,
                                               const SwathSettings& settings, const BottomFinder& finder);
/// GSF (sensors/formats/gsf_file.hpp), one file per line. `placer`: the one that placed the soundings.
std::unique_ptr<SwathFormat> make_gsf(const std::filesystem::path& folder, const Recording& recording,
                                      const RunContext& run, const SwathSettings& settings,
                                      const SoundingPlacer& placer);
/// XTF (sensors/formats/xtf_file.hpp), one file per line: packets of an 8101 for a fan like that of an 8101,
/// generic ones for others.
std::unique_ptr<SwathFormat> make_xtf(const std::filesystem::path& folder, const Recording& recording,
                                      const RunContext& run, const SwathSettings& settings);

}  // namespace tubefoot
