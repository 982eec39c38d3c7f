// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Writes GSF files (Generic Sensor Format of Leidos, version 3) record by record. docs/exchange-formats.md
// lists the fields that are filled, and the uncertain ones.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "files/streamed_file.hpp"
#include "sensors/formats/packet_bytes.hpp"
#include "sensors/formats/reson_8101.hpp"

namespace tubefoot {

/// Storage of a ping's array: the integer nearest to (value + offset) * multiplier, in 1, 2 or 4 bytes. The
/// permitted sizes of an array are those of the Leidos library.
struct GsfScale {
  std::int32_t multiplier = 1;  ///< 1 or more
  std::int32_t offset = 0;      ///< pygsf uses the opposite sign; use 0 for it
  int bytes = 4;
};

struct GsfOptions {
  std::string version = "GSF-v03.09";  ///< of the format, at most 11 bytes
  /// Writes a checksum of each record's bytes before it. pygsf cannot read such files.
  bool checksums = false;
  GsfScale depth{1000, 0, 4};             ///< 1 mm; not signed; 2 or 4 bytes
  GsfScale across{1000, 0, 4};            ///< 1 mm; 2 or 4 bytes
  GsfScale along{1000, 0, 4};             ///< 1 mm; 2 or 4 bytes
  GsfScale two_way_time{10000000, 0, 4};  ///< 0.1 us; not signed; 2 or 4 bytes
  GsfScale beam_angle{100, 0, 2};         ///< 0.01 degree, also of azimuths; 2 bytes
  GsfScale mean_amplitude{100, 0, 2};     ///< 0.01 dB; 1 or 2 bytes
};

/// One ping. Each array has a value for every beam, port-most beam first. Every array except `depth_m` may
/// be empty and is then omitted. All pings must have the same arrays, because the format's readers keep
/// scales from ping to ping.
struct GsfPing {
  double unix_time_s = 0;                      ///< UTC, seconds since 1970 without leap seconds, until 2038
  double longitude_deg = 0, latitude_deg = 0;  ///< WGS 84, east and north positive
  double heading_deg = 0;                      ///< clockwise from north, 0 to 360
  double pitch_deg = 0;                        ///< bow up, -90 to 90
  double roll_deg = 0;                         ///< starboard down, -180 to 180
  double heave_m = 0;                          ///< positive down, as all z of the format
  double course_deg = 0;                       ///< course made good, clockwise from north, 0 to 360
  double speed_m_s = 0;                        ///< over the surface
  double tide_m = 0;                           ///< tide corrector, which the depths include
  double depth_corrector_m = 0;                ///< depth of the sonar, which the depths include
  double height_m = 0;                         ///< above the ellipsoid
  double separation_m = 0;                     ///< ellipsoid to the vertical datum
  double gps_tide_m = 0;

  std::vector<double> depth_m;         ///< down from the surface
  std::vector<double> across_m;        ///< horizontal, starboard positive
  std::vector<double> along_m;         ///< horizontal, forward positive
  std::vector<double> two_way_time_s;  ///< 0: no bottom found
  std::vector<double> beam_angle_deg;  ///< from straight down, starboard positive; with azimuths the full
                                       ///< angle of the beam, otherwise that across the heading
  std::vector<double> mean_amplitude_db;
  std::vector<std::uint8_t> flags;         ///< 0 accepted; bit 0 rejects the beam
  std::vector<double> beam_azimuth_deg{};  ///< counterclockwise from starboard, 0 to 360 (90: forward)
  std::vector<std::uint8_t> sector{};      ///< transmit sector, counted from 0

  std::optional<Reson8101Settings> reson_8101{};  ///< settings of an 8101; unset for other sonars
  std::uint32_t ping_number = 0;                  ///< belongs to reson_8101
};

/// Sound speed against depth, with the times of its measurement and first use, and its position.
struct GsfSoundSpeedProfile {
  double observed_unix_time_s = 0, applied_unix_time_s = 0;  ///< as the time of a ping
  double longitude_deg = 0, latitude_deg = 0;
  struct Point {
    double depth_m = 0, sound_speed_m_s = 0;  ///< down from the surface, 0 or more; depths do not decrease
  };
  std::vector<Point> points;  ///< at least one
};

struct GsfAttitude {
  double unix_time_s = 0;
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0, heave_m = 0;  ///< as GsfPing
};

/// Writes a GSF file (Generic Sensor Format of Leidos, version 3) record by record; at most one record is in
/// memory. The page docs/exchange-formats.md lists the fields that are filled, and the uncertain ones.
///
/// Throws std::invalid_argument for NaN and for values out of range of their fields, before any byte of the
/// record is written; further records can follow. Throws std::runtime_error for disk errors, with the file's
/// name and the reason; the file is then removed. The destructor removes an unfinished file.
class GsfFile {
 public:
  explicit GsfFile(const std::filesystem::path& path, const GsfOptions& options = {});

  void add_ping(const GsfPing& ping);
  /// Processing of the following data, "KEYWORD=VALUE" each.
  void add_processing_parameters(double unix_time_s, std::span<const std::string> parameters);
  /// The profile by which the following soundings were placed. Depths and speeds are stored to 1 cm and 1
  /// cm/s. A profile with more points than a record can contain is thinned; its ends remain.
  void add_sound_speed_profile(const GsfSoundSpeedProfile& profile);
  /// Writes one record. Times must not decrease, and must span less than 65.5 s.
  void add_attitude(std::span<const GsfAttitude> attitudes);

  /// Completes the file. No records can follow.
  void finish();

 private:
  struct Array;
  std::vector<Array> arrays(const GsfPing& ping) const;
  void write(std::uint32_t record, PacketBytes data);

  GsfOptions options_;
  StreamedFile file_;
  /// Identifiers of the first ping's arrays; empty before it.
  std::vector<std::uint8_t> arrays_of_file_;
};

}  // namespace tubefoot
