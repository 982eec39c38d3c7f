// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

namespace tubefoot {

/// A file of every suite of a version, in addition to its scenes and answers. embed.cmake embeds its content
/// in the program.
struct SuiteText {
  std::string_view file;  ///< path in the suite
  std::string_view content;
};
/// Bodies and published tables of target strength, instead of a version.
constexpr int suite_bodies = 0;
std::span<const SuiteText> suite_texts(int version);

}  // namespace tubefoot
