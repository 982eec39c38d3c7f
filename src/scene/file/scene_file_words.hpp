// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace tubefoot {

/// A key's name, cut into what it measures and the unit it ends in: "heading_deg" is "heading" in "degrees".
struct MeasuredName {
  std::string_view stem;  ///< the whole name where it ends in no unit
  std::string_view unit;  ///< in words; empty where it ends in no unit
};
MeasuredName measured_name(std::string_view key);

}  // namespace tubefoot
