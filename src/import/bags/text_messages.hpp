// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "import/bags/sonar_messages.hpp"

namespace tubefoot {

/// Messages as `ros2 topic echo --full-length` prints them (YAML, --- behind each). Their type is `type`, or
/// the one whose fields they have. Throws InputError with the line; for what `take` throws as MessageError,
/// with that of the message.
void read_message_text(const std::filesystem::path& file, const std::optional<std::string>& type,
                       const std::function<void(const ros::Message&)>& take);

}  // namespace tubefoot
