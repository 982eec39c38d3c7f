// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "files/input_error.hpp"

// What a scene file says: scene/scene_description.hpp.
namespace tubefoot {

/// Acoustic camera: a fan of beams side by side, one elevation cell.
struct DidsonDescription {
  double frequency_khz = 1800;
  int beams = 96;
  /// even: equal cells over `horizontal_deg` | lens: where the lens of a DIDSON has its 48 or 96 beams
  std::string beam_centres = "even";
  double horizontal_deg = 29, vertical_deg = 14;  ///< receive sector
  /// Transmit sector, about the same axis; without it, the receive sector. Tubes cover what both look at.
  std::optional<double> transmit_horizontal_deg, transmit_vertical_deg;
  /// With a receive pattern: how far the sector that is lit and heard reaches beyond the outermost beams.
  double receive_margin_deg = 0;
  int cycles = 1;                          ///< shots of a frame: beam b belongs to cycle b mod cycles
  std::optional<double> cycle_interval_s;  ///< else as long as the echo of the window's end takes, and 420 us
  std::vector<int> firing_order;           ///< cycles as they follow one another; empty: 0, 1, 2, ...
  std::optional<std::string> transmit_steering;  ///< fan | beams; else beams if there are cycles
  int samples = 512;
  double window_start_m = 0.84, window_length_m = 5;
  std::string pictures = "all";  ///< all | sequence
};
/// Two fans about the along-track axis, port (beam 0) and starboard (beam 1).
struct SidescanDescription {
  double frequency_khz = 455;
  double along_track_deg = 0.5;                            ///< one-way width of the ideal rectangular beam
  double depression_min_deg = 2, depression_max_deg = 85;  ///< the fan's limits below the horizontal
  std::optional<double> axis_depression_deg;               ///< what patterns are about; else the fan's middle
  int samples = 1000;
  std::optional<double> sampling_frequency_khz;  ///< instead of samples: each is c / (2 f) long
  double range_min_m = 0.5, range_max_m = 50;
};
/// Imaging or forward-looking sonar: `beams` equal azimuth cells over `horizontal_deg`, one elevation cell.
struct ImagingDescription {
  double frequency_khz = 700;
  int beams = 256;
  double horizontal_deg = 130, vertical_deg = 20;
  int samples = 512;
  double range_min_m = 0.5, range_max_m = 20;
};
/// One beam straight down. Where no patterns are given it sends and hears with a Gaussian about its axis.
struct EchosounderDescription {
  double frequency_khz = 200;
  double beam_deg = 7;               ///< full one-way width at -3 dB
  std::optional<double> sector_deg;  ///< side of the square that is looked at; none: three beam widths
  int samples = 1000;
  double range_min_m = 0.5, range_max_m = 50;
  std::string detection = "energy_centroid";  ///< first_return | energy_centroid | maximum
  double detection_threshold_db = -20;        ///< of samples that count, over the largest
};
/// Sidescan whose two receivers a side sit on a staff, above and below the transmitter.
struct InterferometricDescription : SidescanDescription {
  double baseline_m = 0.012;   ///< from receiver to receiver
  double staff_tilt_deg = 30;  ///< of the direction that the staff faces, below the horizontal
  bool phase_noise = false;    ///< soundings from phases with the noise of a single look
};

/// Multibeam echosounder: a fan of beams across the track, beam 0 port-most.
struct MultibeamDescription {
  double frequency_khz = 240;
  int beams = 101;
  double swath_deg = 150;                               ///< between the axes of the outermost beams
  std::string spacing = "angle";                        ///< angle | distance: what is equal from beam to beam
  double beam_across_deg = 1.5, along_track_deg = 1.5;  ///< one-way widths of the ideal rectangular beam
  int samples = 2000;
  double range_min_m = 0.5, range_max_m = 100;
  std::string detection = "energy_centroid";  ///< first_return | energy_centroid | maximum
  double detection_threshold_db = -20;        ///< of samples that count, over the beam's largest
  double grid_cell_m = 0;                     ///< of the depth grid; 0: chosen
};

/// Beam pattern (power) of a transmitter or a receiver.
struct PatternDescription {
  std::string pattern = "none";      ///< none | line | piston | gaussian | table
  std::string angle = "azimuth";     ///< azimuth | elevation | off_axis: what all but piston depend on
  std::optional<double> aperture_m;  ///< line: length; piston: diameter
  std::optional<double> width_deg;   ///< gaussian: full one-way width at -3 dB
  std::optional<std::filesystem::path> file;  ///< table
  SourcePlace file_place;
};

/// What the receiver makes of the echoes in the files that a sonar would write; echoes.nc keeps the energies.
struct SignalDescription {
  double source_level_db = 210;          ///< dB re 1 uPa at 1 m
  std::optional<double> noise_level_db;  ///< dB re 1 uPa in the receiver's band
  std::string speckle = "none";          ///< none | rayleigh | k
  int speckle_looks = 1;
  double speckle_shape = 1;             ///< nu of the K law
  std::optional<double> tvg_spreading;  ///< Sp of the gain Sp log10 R + 2 alpha R + G; none: no gain
  std::optional<double> tvg_absorption_db_per_km;  ///< alpha; else the water's own
  double tvg_gain_db = 0;
  double tvg_fixed_below_m = 10;          ///< nearer than this the gain stays what it is here
  std::optional<double> pulse_length_us;  ///< echoes are spread over c tau / 2; none: not spread
};

struct SensorDescription {
  SourcePlace place;
  std::string name;
  std::string preset = "none";  ///< of sensor_presets(); its keys are in here already
  std::string trajectory;       ///< may be empty when the scene has just one
  SourcePlace trajectory_place;
  std::array<double, 3> lever_arm_m{0, 0, 0};  ///< starboard, forward, up from the carrier's reference point
  std::optional<std::array<double, 3>> receiver_arm_m;  ///< of a receiver apart from the transmitter
  double yaw_deg = 0, tilt_deg = 0, roll_deg = 0;       ///< mounting: yaw to starboard, tilt downwards, roll
  double first_ping_s = 0;
  int pings = 1;
  double ping_interval_s = 0.1;
  /// How far off a beam's height may be, relative, as its cones are cut by planes (angles.hpp).
  double cone_tolerance = 4.5e-5;
  PatternDescription transmit, receive;
  SignalDescription signal;
  std::variant<DidsonDescription, SidescanDescription, MultibeamDescription, ImagingDescription,
               EchosounderDescription, InterferometricDescription>
      kind;
};

}  // namespace tubefoot
