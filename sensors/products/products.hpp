// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "scene/rasters/georeference.hpp"
#include "sensors/receiver/receiver.hpp"
#include "sensors/recordings/heard.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// What the files of a recording need to know of its run.
struct RunContext {
  LocalFrame frame;         ///< where the scene lies on Earth, if it says so
  double start_unix_s = 0;  ///< UTC of the recording's time 0
  std::uint64_t seed = 1;   ///< of speckle and noise
  WaterDescription water;
  std::string title;
};

/// The receiver that a sensor's description asks for. With a pulse length its levels are those of that pulse.
ReceiverChain receiver_of(const Recording& recording, const RunContext& run);

/// The energies [J] of a ping as the sensor's receiver has them, [beam][sample]: spread over the pulse, then
/// through receiver_of(). Every file that a sonar would write is made of these; echoes.nc is not.
std::vector<double> received(const Recording& recording, const RunContext& run, std::size_t ping);

/// The same for pictures; nothing where the receiver leaves energies as they are.
std::optional<Heard> heard_by(const Recording& recording, const RunContext& run);

/// Writes the files that a sonar of the recording's kind makes, pictures included (write_pictures), into
/// `folder`, ping by ping, and returns their names. Throws std::runtime_error naming the file and what
/// failed.
std::vector<std::filesystem::path> write_products(const std::filesystem::path& folder,
                                                  const Recording& recording, const RunContext& run,
                                                  std::vector<std::string>& warnings);

/// Which files a recording of those poses and times will not have, and why, as far as that can be said before
/// there are echoes: what write_products() says then, as well.
std::vector<std::string> files_left_out(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
