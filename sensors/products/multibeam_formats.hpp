// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "sensors/products/multibeam_soundings.hpp"
#include "sensors/recordings/navigation.hpp"

namespace tubefoot {

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

/// A file of a multibeam recording that needs positions on Earth, written ping by ping. Heights are above the
/// scene's height 0, which stands for the water's surface and for the ellipsoid alike; headings are true.
class MultibeamFormat {
 public:
  virtual ~MultibeamFormat() = default;
  virtual void add(const PlacedPing& ping) = 0;
  /// Completes the file; without it there is none.
  virtual void finish() = 0;
};

/// SONAR-netCDF4 with bathymetry (sensors/formats/sonar_netcdf.hpp).
std::unique_ptr<MultibeamFormat> make_sonar_netcdf(const std::filesystem::path& file,
                                                   const Recording& recording, const RunContext& run,
                                                   const ReceiverChain& receiver);
/// GSF (sensors/formats/gsf_file.hpp).
std::unique_ptr<MultibeamFormat> make_gsf(const std::filesystem::path& file, const Recording& recording,
                                          const RunContext& run);
/// XTF (sensors/formats/xtf_file.hpp): an 8101's own packets for a fan like the 8101's, generic ones for
/// others.
std::unique_ptr<MultibeamFormat> make_xtf(const std::filesystem::path& file, const Recording& recording,
                                          const RunContext& run);

}  // namespace tubefoot
