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

/// What of a scene a run is asked for, in the words of a command line; unset: all.
struct Selection {
  std::optional<std::string> sensor;  ///< its name
  std::optional<std::string> pings;   ///< of each sensor, as resolved() reads them
  std::optional<std::string> beams;   ///< of each sensor, as resolved_beams() reads them

  bool is_all() const { return !sensor && !pings && !beams; }
};

/// That of one sensor. Its transmissions are those of the whole scene, with the same numbers and neighbours,
/// so that what is kept of them does not depend on what else is.
struct ChosenEchoes {
  std::size_t first_ping = 0, pings = 0;  ///< none: nothing of the sensor is kept
  std::vector<std::uint32_t> beams;       ///< sorted
  bool all_beams = true;

  /// Of a sensor's beam, its place among those that are kept; none of one that is not.
  std::optional<std::size_t> place_of(std::uint32_t beam) const;
};

/// By sensor of a survey. Throws UsageError saying what there is, where nothing is chosen or what there is
/// not.
std::vector<ChosenEchoes> chosen_of(const Survey& survey, const Selection& selection);

/// The first ping that is kept of sensors that share their transmissions; 0 where none is.
std::size_t first_ping(const SharedTransmissions& group, const std::vector<ChosenEchoes>& chosen);

/// What is kept of a sensor, without its energies: as Recording, numbers of pings and beams included where
/// not all are kept.
Recording recording_of(const Survey& survey, std::size_t sensor, const Selection& selection,
                       const ChosenEchoes& chosen);

}  // namespace tubefoot
