// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

/// A key's name, split into the quantity and its unit: "heading_deg" is "heading" in "degrees".
struct MeasuredName {
  std::string_view stem;  ///< the whole name if it ends in no unit
  std::string_view unit;  ///< in words; empty if the name ends in no unit
};
MeasuredName measured_name(std::string_view key);

}  // namespace tubefoot
