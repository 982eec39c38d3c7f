// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Writes SONAR-netCDF4 2.0 files of multibeam sonars, with the group Bathymetry of XSF 0.7.
// docs/exchange-formats.md describes the contents.

#include <array>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tubefoot {

/// A transmit sector of the sonar. The angles are those of its axis from the platform's down axis.
struct SonarTransmitBeam {
  double frequency_hz = 0, bandwidth_hz = 0, pulse_length_s = 0;
  double absorption_db_per_m = 0;                    ///< one way
  double width_across_deg = 0, width_along_deg = 0;  ///< one way
  double across_deg = 0;                             ///< starboard positive
  double tilt_deg = 0;                               ///< forward positive
  double delay_s = 0;                                ///< of its transmission after the time of the ping
};

/// Data of a SONAR-netCDF4 file that do not change between pings. The platform's axes are x forward, y
/// starboard, z down from its reference point.
struct SonarNetcdfHeader {
  std::string title, summary, keywords;
  std::string date_created;     ///< ISO 8601 with zone; a fixed time if equal runs are to give equal files
  std::string license, rights;  ///< omitted if empty
  std::string software_name = "tubefoot", software_version;
  std::string history;                    ///< lines "time user: what was done"
  std::vector<std::string> source_files;  ///< sources of the file's data

  std::string sonar_type = "multibeam echosounder";  ///< the convention's own terms have no multibeam
  std::string sonar_manufacturer, sonar_model, sonar_serial_number;
  std::string platform_name, platform_type;

  std::size_t beams = 0;
  double frequency_hz = 0;
  double bandwidth_hz = 0;
  double pulse_length_s = 0;
  double absorption_db_per_m = 0;  ///< one way
  double sound_speed_m_s = 0;
  std::optional<double> source_level_db;  ///< re 1 uPa at 1 m
  /// One-way widths at half power. Across is in the fan's plane, along is perpendicular to it.
  double receive_width_across_deg = 0, receive_width_along_deg = 0;
  double transmit_width_across_deg = 0, transmit_width_along_deg = 0;
  /// Transmit sectors; empty: one with the values above. By beam: its transmit sector; empty: 0.
  std::vector<SonarTransmitBeam> transmit_beams{};
  std::vector<std::size_t> transmit_beam_of{};
  double equivalent_beam_angle_sr = 0;  ///< of transmission and reception together
  glm::dvec3 transducer_offset_m{0};    ///< from the reference point
  glm::dvec3 transducer_rotation_deg{0};
  double water_level_m = 0;  ///< nominal water level below the reference point (negative under water)
  bool beams_stabilised = false;
  /// Beams are complex signals (SonarNetcdfPing::backscatter) instead of levels. The conversion equation is
  /// of type 1. Its transmit power makes 10 log |backscatter|^2 + 40 log r + 2 alpha r the target strength.
  bool complex_beams = false;
  /// Frequencies of a chirp; 0: a pulse of frequency_hz.
  double chirp_start_hz = 0, chirp_stop_hz = 0;
};

/// Detection of the seabed in one beam.
struct SonarDetection {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  bool found = false;                       ///< if false, only the beam's angle is used
  bool rejected = false, doubtful = false;  ///< flags of a detection
  double two_way_travel_time_s = none;
  double beam_angle_deg = none;  ///< of the beam's axis from the platform's down axis, starboard positive
  /// From the platform's reference point in the horizontal plane: along the heading, to its starboard, down.
  glm::dvec3 forward_starboard_down_m{none};
  double latitude_deg = none, longitude_deg = none;  ///< NaN in a scene without georeference
  double backscatter_db = none;
  double quality = none;  ///< standard deviation in per cent of the depth; NaN: unknown
};

/// A ping. Headings are clockwise from north, pitch is bow up, roll is starboard down.
struct SonarNetcdfPing {
  std::int64_t unix_time_ns = 0;
  double latitude_deg = SonarDetection::none, longitude_deg = SonarDetection::none;  ///< WGS 84
  double height_m = SonarDetection::none;  ///< of the reference point above the ellipsoid
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
  double waterline_below_reference_m = 0;  ///< negative for a platform under water
  double transducer_depth_m = 0;           ///< below the water line
  double waterline_to_chart_datum_m = 0;
  double sound_speed_m_s = 0;           ///< at the transducer, for ranges
  double steering_sound_speed_m_s = 0;  ///< at the transducer, for angles; 0: the same
  double sample_interval_s = 0;
  double blanking_interval_s = 0;        ///< two-way travel time of sample 0
  std::vector<double> across_angle_deg;  ///< by beam, from the platform's down axis, starboard positive
  /// By transmit beam: angles of the stabilisation, across the track and along it. Empty: not stabilised.
  std::vector<std::array<double, 2>> transmit_steering_deg{};
  /// By beam: levels in dB. header.summary states whether spreading and absorption are compensated. -inf: no
  /// echo.
  std::vector<std::vector<float>> backscatter_db{};
  /// By beam: complex signals; the levels are then empty. They are matched filtered, for a pulse of energy 1
  /// J/sr at 1 m and the time factor e^{-i omega t}.
  std::vector<std::vector<std::complex<float>>> backscatter{};
  std::vector<SonarDetection> detections;  ///< by beam
};

/// Components of `east_north_up_m`, relative to the reference point, along a heading, to its starboard and
/// down.
glm::dvec3 forward_starboard_down(glm::dvec3 east_north_up_m, double heading_deg);

/// A SONAR-netCDF4 2.0 file of a multibeam, with the XSF 0.7 group Bathymetry (docs/exchange-formats.md).
/// Pings are written as they arrive, with a few MB in memory for a line of any length. The file has a
/// temporary name ("line.partial.nc") until finish(). Without finish() it is removed.
class SonarNetcdfFile {
 public:
  /// Throws std::invalid_argument for a header without beams, frequency or sound speed. Throws
  /// std::runtime_error with the file's name if writing fails.
  SonarNetcdfFile(const std::filesystem::path& file, const SonarNetcdfHeader& header);
  ~SonarNetcdfFile();

  /// Throws std::invalid_argument that names the ping if it does not fit the header or goes back in time.
  /// Throws std::runtime_error if the disk is full; the file is then lost.
  void add(const SonarNetcdfPing& ping);
  /// Completes the file. Throws std::runtime_error if that fails.
  void finish();

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
