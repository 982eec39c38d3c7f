// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

namespace tubefoot {

/// The column that the header of a table means by a name that is none of `columns`: the same quantity in
/// another spelling ("Pitch", "depth (m)"), without its unit or with another one ("heading", "heading_rad"),
/// by another common name ("yaw_deg"), or with a slip of the pen. Empty where the name resembles none.
std::string_view meant_column(std::string_view name, std::span<const std::string_view> columns);

}  // namespace tubefoot
