// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// Elements at any positions of a vehicle that record signals with phase, and the beams and images computed
/// from them. The duration of the pulse is pulse_length_us.
struct ArrayDescription {
  double frequency_khz = 100;                    ///< in the middle of the pulse's band
  double bandwidth_khz = 0;                      ///< upward sweep; 0: a pulse of one frequency
  double pulse_taper = 0.5;                      ///< share of both raised-cosine flanks in the pulse
  std::optional<double> sampling_frequency_khz;  ///< rate of complex samples; unset: 1.25 times the pulse's
                                                 ///< band
  std::optional<double> baseband_khz;            ///< unset: frequency_khz
  double range_min_m = 0.5, range_max_m = 50;
  double horizontal_deg = 60, vertical_deg = 20;  ///< insonified and received sector
  int receivers = 32;
  /// Vector from one receiver to the next, on the sensor's axes. Unset: half a wavelength to starboard.
  std::optional<std::array<double, 3>> receiver_spacing_m;
  std::vector<std::array<double, 3>> receivers_m;  ///< position of each receiver on the sensor's axes,
                                                   ///< instead of receivers and receiver_spacing_m
  bool own_views = false;                          ///< each receiver has its own visible polygons
  double signal_tolerance = 1e-3;

  std::vector<std::string> products;  ///< fan | sidescan | multibeam | aperture | interferogram
  std::vector<std::string> formats;   ///< jsf | sonar_netcdf
  int beams = 96;
  double beams_deg = 90;  ///< between the outermost axes
  double beams_depression_deg = 0;
  std::string beams_plane = "forward";  ///< forward | across_track
  std::string sides = "starboard";      ///< port | starboard | both
  std::string beam_window = "hann", range_window = "hann", ping_window = "hann";
  std::optional<std::array<double, 4>> picture_m;  ///< extent of an aperture's image: east from, to; north
                                                   ///< from, to
  double picture_up_m = 0, pixel_m = 0.05;
  std::optional<double> half_beam_deg;  ///< aperture: omits pings that see a pixel farther off abeam
  std::vector<int> upper, lower;        ///< receiver groups of an interferogram
  int looks_range = 4, looks_pings = 4;

  // Set by SensorKind::in_water():
  int samples = 0;
  double sound_speed_m_s = 0;

  static const SensorSection& kind();
};

}  // namespace tubefoot
