// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kmall/kmall_datagrams.hpp"

// This header declares the contents of a survey line. A file .kmall contains soundings, attitude, positions
// and sound speeds. The file .kmwcd of the same name contains the water column, if it exists.

namespace tubefoot {

/// A ping of a mode.
struct KmallModePing {
  double time_s = 0;
  unsigned number = 0;
  std::optional<std::size_t> column;  ///< index of its record #MWC; none without a water column
};

/// A mode of the sonar: pings with the same sectors and beams. Angles are positive to starboard, and beams
/// and sectors are in order from port to starboard. A mode with a water column has the beams of the water
/// column. Otherwise it has the beams of the soundings.
struct KmallMode {
  std::string name;  ///< for example "mode-260-320-290", after the frequencies of the sectors in kHz
  unsigned transmitter = 0, receiver = 0;
  std::vector<KmallSector> sectors;
  std::vector<double> absorptions_db_per_km;  ///< mean of the soundings, by sector
  std::vector<double> sector_edges_deg;
  double swath_from_deg = -90, swath_to_deg = 90;  ///< in which the sonar looks for the seabed
  std::vector<double> beam_angles_deg;
  std::vector<std::size_t> beam_numbers;  ///< number in the file, by beam
  double sample_rate_hz = 0;
  std::size_t first_sample = 0,
              end_sample = 0;  ///< smallest range of samples that contains all beams and pings
  double transmit_width_deg = 0, receive_width_deg = 0;  ///< nominal widths of the arrays
  std::vector<KmallModePing> pings;
};

struct KmallSurvey {
  std::filesystem::path soundings_file;
  std::optional<std::filesystem::path> column_file;
  KmallInstallation installation;
  std::vector<KmallMotion> motion;  ///< in order of time
  std::vector<KmallPosition> positions;
  std::vector<KmallSoundSpeed> profile;  ///< the last one of the file; empty if there is none
  std::vector<KmallPing> pings;          ///< in order of time
  std::vector<KmallMode> modes;
  std::vector<std::string> notes;  ///< omissions and assumptions, one line each

  /// Returns the files that were read.
  std::vector<std::filesystem::path> inputs() const;
};

/// Largest number of modes of a survey line.
constexpr std::size_t most_kmall_modes = 64;

/// Reads a survey line. `file` is the file .kmall or the file .kmwcd of the same name, and `needs_column`
/// requires the latter. Throws InputError for a file that is missing, invalid or has no pings with attitude,
/// and for more than most_kmall_modes modes.
KmallSurvey read_kmall_survey(const std::filesystem::path& file, bool needs_column);

/// Largest time before the first and after the last sample of the motion sensor at which the attitude is
/// extrapolated.
constexpr double most_beyond_motion_s = 0.2;
/// Returns the attitude at a time: linear between samples, and extrapolated beyond them. Empty further away.
std::optional<KmallMotion> motion_at(const std::vector<KmallMotion>& motion, double time_s);

/// Returns whether a file name ends in .kmall or .kmwcd.
bool is_kmall_name(const std::filesystem::path& file);

}  // namespace tubefoot
