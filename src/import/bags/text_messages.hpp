// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "import/bags/sonar_messages.hpp"

namespace tubefoot {

/// Reads messages as `ros2 topic echo --full-length` prints them (YAML, each followed by ---). Their type
/// is `type`, or the type that has their fields. Throws InputError with the line of the error. If `take`
/// throws MessageError, the line is that of the message.
void read_message_text(const std::filesystem::path& file, const std::optional<std::string>& type,
                       const std::function<void(const ros::Message&)>& take);

}  // namespace tubefoot
