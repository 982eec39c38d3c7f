// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

/// How an array of a ping is stored: the integer nearest to (value + offset) * multiplier, in 1, 2 or 4 bytes
/// (the field sizes that an array may have are those of the Leidos library).
struct GsfScale {
  std::int32_t multiplier = 1;  ///< 1 or more
  std::int32_t offset = 0;      ///< pygsf has its sign wrong: leave 0 for it
  int bytes = 4;
};

struct GsfOptions {
  std::string version = "GSF-v03.09";  ///< of the format, at most 11 bytes
  /// A sum of its bytes before each record. pygsf cannot read files that have them.
  bool checksums = false;
  GsfScale depth{1000, 0, 4};             ///< 1 mm; not signed; 2 or 4 bytes
  GsfScale across{1000, 0, 4};            ///< 1 mm; 2 or 4 bytes
  GsfScale along{1000, 0, 4};             ///< 1 mm; 2 or 4 bytes
  GsfScale two_way_time{10000000, 0, 4};  ///< 0.1 us; not signed; 2 or 4 bytes
  GsfScale beam_angle{100, 0, 2};         ///< 0.01 degree; 2 bytes
  GsfScale mean_amplitude{100, 0, 2};     ///< 0.01 dB; 1 or 2 bytes
};

/// One ping. Each array has a value for every beam, port-most beam first; an array but `depth_m` may be empty
/// and is then left out, but not in one ping and not in another (the format's readers carry scales on).
struct GsfPing {
  double unix_time_s = 0;                      ///< UTC, seconds since 1970 without leap seconds, until 2038
  double longitude_deg = 0, latitude_deg = 0;  ///< WGS 84, east and north positive
  double heading_deg = 0;                      ///< clockwise from north, 0 to 360
  double pitch_deg = 0;                        ///< bow up, -90 to 90
  double roll_deg = 0;                         ///< starboard down, -180 to 180
  double heave_m = 0;                          ///< down, as all of the format's z
  double course_deg = 0;                       ///< made good, clockwise from north, 0 to 360
  double speed_m_s = 0;                        ///< over the surface
  double tide_m = 0;                           ///< tide corrector, already in the depths
  double depth_corrector_m = 0;                ///< depth of the sonar, already in the depths
  double height_m = 0;                         ///< above the ellipsoid
  double separation_m = 0;                     ///< ellipsoid to the vertical datum
  double gps_tide_m = 0;

  std::vector<double> depth_m;         ///< down from the surface
  std::vector<double> across_m;        ///< horizontal, starboard positive
  std::vector<double> along_m;         ///< horizontal, forward positive
  std::vector<double> two_way_time_s;  ///< 0: no bottom found
  std::vector<double> beam_angle_deg;  ///< from straight down, starboard positive
  std::vector<double> mean_amplitude_db;
  std::vector<std::uint8_t> flags;  ///< 0 accepted; bit 0 rejects the beam

  std::optional<Reson8101Settings>
      reson_8101{};               ///< what the sonar says of itself; of one that is no 8101, none
  std::uint32_t ping_number = 0;  ///< goes with reson_8101
};

/// Sound speed against depth, and when and where it was measured and holds from.
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

/// Writes a GSF file (Generic Sensor Format of Leidos, version 3) record by record; no more than one record
/// is in memory. docs/files-gsf.md says which fields are filled and what is uncertain.
///
/// Values that their fields do not hold, or that are not numbers, are refused with std::invalid_argument
/// before anything of the record is written: the file can go on. Errors of the disk are std::runtime_error,
/// naming the file and the reason; the file is then gone. A file that is not finished is taken away.
class GsfFile {
 public:
  explicit GsfFile(const std::filesystem::path& path, const GsfOptions& options = {});

  void add_ping(const GsfPing& ping);
  /// What has been done to the data that follow, "KEYWORD=VALUE" each.
  void add_processing_parameters(double unix_time_s, std::span<const std::string> parameters);
  /// The profile by which the soundings that follow were placed. Depths and speeds are kept to 1 cm and 1
  /// cm/s. A profile of more points than a record holds is thinned: its ends stay.
  void add_sound_speed_profile(const GsfSoundSpeedProfile& profile);
  /// One record; times must not go back and span less than 65.5 s.
  void add_attitude(std::span<const GsfAttitude> attitudes);

  /// Completes the file. Nothing can be added afterwards.
  void finish();

 private:
  struct Array;
  std::vector<Array> arrays(const GsfPing& ping) const;
  void write(std::uint32_t record, PacketBytes data);

  GsfOptions options_;
  StreamedFile file_;
  /// Identifiers of the arrays that the first ping had; empty before it.
  std::vector<std::uint8_t> arrays_of_file_;
};

}  // namespace tubefoot
