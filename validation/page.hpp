// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "validation/entry.hpp"

namespace tubefoot::atlas {

/// Returns the table cell of an exact arithmetic: "0", or a description of its error.
std::string exact_cell(const Answer& answer);
/// Returns "error 2e-01, 1 tube open", or "right".
std::string plain_text(const Answer& answer);
/// Returns the share of wrong rays: "39.1 %", "2e-05", "none".
std::string share_text(const RayResult& result);

/// Writes folder/atlas.md and the links to its pictures, which are in folder/pictures already. Throws
/// std::runtime_error, which names the file.
void write_page(std::span<const Entry> entries, const std::filesystem::path& folder);

}  // namespace tubefoot::atlas
