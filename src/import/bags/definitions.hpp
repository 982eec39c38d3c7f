// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace tubefoot {

/// In what a definition that a recording carries (ros2msg: the type's text, then those of the types in it)
/// differs from the one that is read here: "field 3 is 'uint64 ping_no', expected 'float32
/// ping_info.frequency'"; empty where it does not. Types of one name have had other fields: without the
/// right ones bytes become other numbers. Nothing is said of a definition that is not whole.
std::string difference_of_definition(std::string_view type, std::string_view definition);

}  // namespace tubefoot
