// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "validation/entry.hpp"

namespace tubefoot::atlas {

/// What the table says of an exact arithmetic: "0", or what is amiss.
std::string exact_cell(const Answer& answer);
/// "error 2e-01, 1 tube open", or "right".
std::string plain_text(const Answer& answer);
/// "39.1 %", "2e-05", "none": of the rays that are wrong.
std::string share_text(const RayResult& result);

/// Writes folder/atlas.md and its pictures, which stand in folder/pictures already.
/// Throws std::runtime_error naming the file.
void write_page(std::span<const Entry> entries, const std::filesystem::path& folder);

}  // namespace tubefoot::atlas
