// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {

/// Pings of a sensor as pictures need them, of an echo file or picked from others: the sensor has beams,
/// range samples, a name and a frequency, and fires nothing. Copies share the sensor.
struct ReadRecording {
  std::shared_ptr<const Sensor> sensor;
  std::vector<double> energy;  ///< empty: the recording's energies are kept by others
  Recording recording;         ///< points to both
};

/// Of sensor `index` of an echo file that outlives it. What the file does not say is 0, or one second after
/// the other, at rest. Throws InputError where its samples are not evenly spaced.
ReadRecording recording_of(const WholeEchoFile& file, std::size_t index);

/// Pings of another recording, by their numbers there, in any order, and of the first of its channels. They
/// keep their numbers if these are consecutive, and are numbered anew if not.
ReadRecording picked(const Recording& all, const std::vector<std::size_t>& pings);

}  // namespace tubefoot
