// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

// Text that may hold what a stranger wrote, on its way to somebody's eyes. Terminals obey control
// characters, those of C1 (U+0080 to U+009F) too; bidirectional marks show words in another order than they
// have; bytes that are no UTF-8 are anything.
namespace tubefoot {

/// With `\x1b` for control characters but line ends and tabs, and for bytes that are no UTF-8, and `\u202e`
/// for C1's, for bidirectional marks and for separators of lines. Text without any, as our own, is unchanged.
std::string harmless(std::string_view text);

/// The same for a terminal or a log: of more than a few thousand characters the beginning and the end.
std::string shown(std::string_view text);

/// For a title, a name or what else has one line and some width to be shown in: without line ends, too, and
/// of more than 200 characters the beginning.
std::string shown_line(std::string_view text);

/// For a page (HTML) or a drawing (SVG): harmless, and with &lt; and its like for what begins a tag, ends an
/// attribute (ours are in double quotes) or names a character.
std::string shown_markup(std::string_view text);

}  // namespace tubefoot
