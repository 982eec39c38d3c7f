// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "validation/entry.hpp"

namespace tubefoot::atlas {

/// Draws four panels side by side, each the tubes as their apex sees them: the exact answer, a colour a
/// facet; then, pale, the same with red where double without tolerance, double with its best tolerance and
/// Embree are wrong. Throws std::runtime_error naming the file.
void draw(const Entry& entry, const std::filesystem::path& file);

}  // namespace tubefoot::atlas
