// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "validation/entry.hpp"

namespace tubefoot::atlas {

/// Draws four panels side by side, with the tubes as seen from their apex. The first panel shows the exact
/// result with one colour per facet. The others show it faintly, with red for errors of double without
/// tolerance, of double with its best tolerance, and of Embree. Throws std::runtime_error, which names the
/// file.
void draw(const Entry& entry, const std::filesystem::path& file);

}  // namespace tubefoot::atlas
