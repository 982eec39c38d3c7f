// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "sensors/multibeam_soundings.hpp"
#include "sensors/pose_angles.hpp"

namespace tubefoot {

/// A ping and its soundings, placed on Earth.
struct PlacedPing {
  std::size_t ping = 0;
  double unix_time_s = 0;
  PoseAngles lie{};
  glm::dvec3 position_m{0};      ///< of the sensor, in the scene's frame
  glm::dvec3 lon_lat_height{0};  ///< of the sensor: degrees on WGS 84, m
  double course_deg = 0, speed_m_s = 0;
  SoundedPing sounded;
  std::vector<std::optional<Sounding>> ideal;  ///< by beam, of an ideal receiver; empty where it is one
  std::vector<glm::dvec3> soundings_lon_lat;   ///< by beam; not numbers where nothing was found
};

/// A file of a multibeam recording that needs positions on Earth, written ping by ping. Heights are above the
/// scene's height 0, which stands for the water's surface and for the ellipsoid alike.
class MultibeamFormat {
 public:
  virtual ~MultibeamFormat() = default;
  virtual void add(const PlacedPing& ping) = 0;
  /// Completes the file; without it there is none.
  virtual void finish() = 0;
};

/// SONAR-netCDF4 with bathymetry (sensors/sonar_netcdf.hpp).
std::unique_ptr<MultibeamFormat> make_sonar_netcdf(const std::filesystem::path& file,
                                                   const Recording& recording, const RunContext& run,
                                                   const ReceiverChain& receiver);
/// GSF (sensors/gsf_file.hpp).
std::unique_ptr<MultibeamFormat> make_gsf(const std::filesystem::path& file, const Recording& recording,
                                          const RunContext& run);
/// XTF (sensors/xtf_file.hpp): an 8101's own packets for a fan like the 8101's, generic ones for others.
std::unique_ptr<MultibeamFormat> make_xtf(const std::filesystem::path& file, const Recording& recording);

}  // namespace tubefoot
