// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "import/bags/sonar_messages.hpp"

namespace tubefoot {

/// A message of a known type from its serialized form: plain CDR (XCDR1) of either byte order, as the four
/// bytes before it say. Throws MessageError for what is cut off, claims more than there is, is serialized
/// otherwise, or goes on behind the last field.
ros::Message read_cdr(std::string_view type, std::span<const std::uint8_t> bytes);

}  // namespace tubefoot
