// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {

/// Pings of a sensor for pictures, from an echo file or selected from other pings. The sensor has beams,
/// range samples, a name and a frequency, but no transmissions. Copies share the sensor.
struct ReadRecording {
  std::shared_ptr<const Sensor> sensor;
  std::vector<double> energy;  ///< empty: another object keeps the recording's energies
  Recording recording;         ///< refers to both
};

/// The recording of sensor `index` of an echo file, which must outlive it. Missing data are 0; missing ping
/// times are one second apart, at rest. Throws InputError if its samples are not uniformly spaced.
ReadRecording recording_of(const WholeEchoFile& file, std::size_t index);

/// Pings of another recording, selected by their numbers there, in any order, with the first of its
/// channels. Consecutive pings keep their numbers; others get new ones.
ReadRecording picked(const Recording& all, const std::vector<std::size_t>& pings);

}  // namespace tubefoot
