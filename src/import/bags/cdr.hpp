// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "import/bags/sonar_messages.hpp"

namespace tubefoot {

/// Reads a message of a known type from plain CDR (XCDR1) of either byte order, which the four bytes before
/// the message select. Throws MessageError for messages that are truncated, claim more elements than they
/// contain, use another serialization, or continue after the last field.
ros::Message read_cdr(std::string_view type, std::span<const std::uint8_t> bytes);

}  // namespace tubefoot
