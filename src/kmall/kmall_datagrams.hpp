// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kmall/kmall_file.hpp"

// This header declares the contents of the datagrams that tubefoot reads. Coordinates of the vessel are those
// of the format: x forward, y to starboard, z down, from the reference point of the vessel. Roll is positive
// if the starboard side is down, pitch if the bow is up. Angles across the track are positive to port.

namespace tubefoot {

/// Position and mounting angles of a part of the sonar (#IIP).
struct KmallMounting {
  glm::dvec3 position_m{0};
  double roll_deg = 0, pitch_deg = 0, heading_deg = 0;
  /// Phase centres of the parts of a transmitter (sub-arrays 0, 1 and 2), in its own axes. A receiver has
  /// one.
  std::array<glm::dvec3, 3> phase_centres_m{};
};

/// Installation parameters (#IIP).
struct KmallInstallation {
  std::string sonar;     ///< for example "EM 2042 - Single Tx single Rx"
  std::string revision;  ///< revision of the format, for example "Rev J 2023-09-15"
  std::array<std::optional<KmallMounting>, 4> transmitters, receivers;
  KmallMounting motion_sensor;
  double waterline_m = 0;  ///< z of the water line without heave
};

/// A sample of the motion sensor (#SKM).
struct KmallMotion {
  double time_s = 0;
  double roll_deg = 0, pitch_deg = 0, heading_deg = 0;
  double heave_m = 0;  ///< positive down
};

/// A position (#SPO), at the reference point of the vessel.
struct KmallPosition {
  double time_s = 0, latitude_deg = 0, longitude_deg = 0;
};

/// A point of the sound-speed profile (#SVP).
struct KmallSoundSpeed {
  double depth_m = 0, sound_speed_m_s = 0;
};

/// A transmit sector (#MRZ, #MWC). Values that only soundings contain are 0 in a water column.
struct KmallSector {
  double tilt_deg = 0;        ///< relative to the transmitter
  std::size_t sub_array = 1;  ///< part of the transmitter
  double frequency_hz = 0;
  double delay_s = 0, source_level_db = 0, bandwidth_hz = 0;
  double effective_pulse_s = 0;     ///< of the matched filter; the total length if the file has none
  double beam_width_along_deg = 0;  ///< #MWC only
};

/// A sounding (#MRZ).
struct KmallSounding {
  bool is_valid = false;  ///< detected by amplitude or phase, not rejected, with a possible absorption
  std::size_t sector = 0;
  double angle_re_receiver_deg = 0, two_way_travel_time_s = 0;  ///< with their corrections
  double water_column_angle_deg = 0;
  double absorption_db_per_km = 0;  ///< mean along the path
  double latitude_deg = 0, longitude_deg = 0;
  double x_m = 0, y_m = 0,
         z_m = 0;  ///< from the reference point, in the horizontal frame of the ping's heading
};

/// The soundings of a ping (#MRZ).
struct KmallPing {
  double time_s = 0;
  unsigned number = 0;
  unsigned receiver = 0, transmitter = 0;  ///< index of the head
  unsigned fan = 0, fans = 1;              ///< index of the receive fan of the ping, and their number
  double heading_deg = 0, latitude_deg = 0, longitude_deg = 0;
  double sound_speed_m_s = 0;  ///< at the transducer
  double waterline_m = 0;      ///< z of the water line, with heave
  /// Edges of the swath in which the sonar looks for the seabed, positive to port, from the vertical.
  double swath_port_deg = 90, swath_starboard_deg = -90;
  double transmit_width_deg = 0, receive_width_deg = 0;  ///< nominal widths of the arrays in use
  double water_column_rate_hz = 0;
  std::vector<KmallSector> sectors;
  std::vector<KmallSounding> soundings;
};

/// A beam of a water column (#MWC).
struct KmallWaterBeam {
  double angle_deg = 0;  ///< from the vertical
  std::size_t sector = 0;
  std::size_t first_sample = 0;  ///< number of the first recorded sample
  double detected_sample = 0;    ///< 0: nothing detected
  std::vector<std::int8_t>
      levels;  ///< in steps of 0.5 dB, with the gain of the ping; -128: at or below that level
};

/// The water column of a ping (#MWC). Sample k belongs to the two-way travel time k / sample_rate_hz.
struct KmallWaterColumn {
  double time_s = 0;
  unsigned number = 0;
  unsigned receiver = 0, transmitter = 0;
  unsigned fan = 0, fans = 1;
  double gain_exponent = 0;  ///< X of the gain X log10 R + 2 alpha R + offset
  double gain_offset_db = 0;
  double sample_rate_hz = 0, sound_speed_m_s = 0;
  std::vector<KmallSector> sectors;
  std::vector<KmallWaterBeam> beams;
};

/// These functions read one record. They throw InputError for a record that is shorter than its fields, has
/// an unknown version, or contains values that are not finite. The message names the offset.
KmallInstallation read_kmall_installation(KmallFile& file, const KmallRecord& record);
std::vector<KmallMotion> read_kmall_motion(KmallFile& file, const KmallRecord& record);
KmallPosition read_kmall_position(KmallFile& file, const KmallRecord& record);
std::vector<KmallSoundSpeed> read_kmall_profile(KmallFile& file, const KmallRecord& record);
KmallPing read_kmall_ping(KmallFile& file, const KmallRecord& record);
KmallWaterColumn read_kmall_water_column(KmallFile& file, const KmallRecord& record);

}  // namespace tubefoot
