// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace tubefoot {

/// Compares the definition in a recording with the fields that tubefoot reads, and returns the first
/// difference. An example is "field 3 is 'uint64 ping_no', expected 'float32 ping_info.frequency'". The
/// result is empty if there is none.
///
/// The definition has the format ros2msg: the text of the type, then those of the types in it. The check is
/// necessary because types of one name have had different fields, and the bytes would then be read as other
/// numbers. An incomplete definition has no differences.
std::string difference_of_definition(std::string_view type, std::string_view definition);

}  // namespace tubefoot
