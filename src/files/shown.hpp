// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

// Makes untrusted text safe for display. Terminals obey control characters, including those of C1 (U+0080
// to U+009F). Bidirectional marks change the displayed order of words. Bytes that are not UTF-8 have no
// defined meaning.
namespace tubefoot {

/// Replaces control characters (except line ends and tabs) and bytes that are not UTF-8 by `\x1b` and
/// similar escapes. Control characters of C1, bidirectional marks and line separators become `\u202e` and
/// similar escapes. Other text is unchanged.
std::string harmless(std::string_view text);

/// Does the same for a terminal or a log. If the text is longer than a few thousand characters, only its
/// beginning and its end remain.
std::string shown(std::string_view text);

/// Does the same for a title, a name or another single line. It also removes line ends, and keeps the first
/// 200 characters of longer text.
std::string shown_line(std::string_view text);

/// Does the same for HTML or SVG, and writes &lt; and similar entities. It replaces characters that begin a
/// tag, end an attribute (tubefoot uses double quotes) or begin an entity.
std::string shown_markup(std::string_view text);

}  // namespace tubefoot
