// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// Multibeam echosounder: a fan of beams across the track; beam 0 is the port-most.
struct MultibeamDescription {
  double frequency_khz = 240;
  int beams = 101;
  double swath_deg = 150;               ///< between the axes of the outermost beams
  std::string spacing = "angle";        ///< angle | distance: the quantity that is equal between neighbours
  std::vector<double> beam_angles_deg;  ///< from port to starboard, instead of `beams` over `swath_deg`
  double beam_across_deg = 1.5, along_track_deg = 1.5;  ///< one-way widths of the ideal rectangular beam
  /// Width of the receive beams along the track, with stop_and_hop = false.
  double receive_along_track_deg = 30;
  std::vector<std::string> stabilisation;  ///< of roll, pitch, yaw
  double stabilisation_heading_s = 10;     ///< duration of the mean heading for yaw
  int samples = 2000;
  double range_min_m = 0.5, range_max_m = 100;
  // Transmit sectors: one value per sector, or empty.
  std::vector<double> sector_edges_deg;  ///< between the sectors, from straight down; empty: one sector
  std::vector<double> sector_frequencies_khz, sector_tilts_deg, sector_delays_us, sector_pulse_lengths_us,
      sector_absorptions_db_per_km;
  std::string detection = "energy_centroid";  ///< first_return | energy_centroid | maximum
  double detection_threshold_db = -20;        ///< threshold of the detection relative to the beam's largest
                                              ///< sample
  double grid_cell_m = 0;                     ///< of the depth grid; 0: automatic

  static const SensorSection& kind();
};

}  // namespace tubefoot
