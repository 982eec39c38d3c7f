// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

namespace tubefoot {

/// Returns the column of `columns` that a header probably means by an unknown name. The name may have
/// another spelling ("Pitch", "depth (m)"), no unit or another unit ("heading", "heading_rad"), or a typing
/// error. It may also be another common name ("yaw_deg"). Returns an empty text if the name resembles no
/// column.
std::string_view meant_column(std::string_view name, std::span<const std::string_view> columns);

}  // namespace tubefoot
