// SPDX-License-Identifier: GPL-3.0-or-later
// The inverse of a small positive definite matrix.
#pragma once

#include <cstddef>
#include <vector>

namespace tubefoot {

/// Returns the inverse of a positive definite matrix of n rows. The matrix is scaled to a unit diagonal and
/// regularised by 1e-6, so that terms with nearly the same effect share it.
std::vector<double> inverted(std::vector<double> a, std::size_t n);

}  // namespace tubefoot
