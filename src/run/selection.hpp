// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sensors/recordings/recording.hpp"

namespace tubefoot {

struct SharedTransmissions;
struct Survey;

/// Part of a scene that a run stores, in the words of the command line. An unset member selects all.
struct Selection {
  std::optional<std::string> sensor;  ///< name of the sensor
  std::optional<std::string> pings;   ///< pings of each sensor, as resolved() parses them
  std::optional<std::string> beams;   ///< beams of each sensor, as resolved_beams() parses them

  bool is_all() const { return !sensor && !pings && !beams; }
};

/// Selected pings and beams of one sensor. Its transmissions are those of the whole scene, with the same
/// numbers and neighbours. The stored values therefore do not depend on the rest of the selection.
struct ChosenEchoes {
  std::size_t first_ping = 0, pings = 0;  ///< 0 pings: nothing of the sensor is stored
  std::vector<std::uint32_t> beams;       ///< sorted
  bool all_beams = true;

  /// Returns the index of a sensor's beam among the stored beams, or nothing if it is not stored.
  std::optional<std::size_t> place_of(std::uint32_t beam) const;
};

/// Returns the selection by sensor of a survey. Throws UsageError that lists the valid values if the
/// selection is empty or contains a name or number that does not exist.
std::vector<ChosenEchoes> chosen_of(const Survey& survey, const Selection& selection);

/// Returns the first stored ping of sensors that share their transmissions; 0 if none is stored.
std::size_t first_ping(const SharedTransmissions& group, const std::vector<ChosenEchoes>& chosen);

/// Returns the recording of a sensor without its energies. It contains the numbers of pings and beams if not
/// all are stored.
Recording recording_of(const Survey& survey, std::size_t sensor, const Selection& selection,
                       const ChosenEchoes& chosen);

}  // namespace tubefoot
