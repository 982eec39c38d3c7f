// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "compare/diagnosis/alignment.hpp"

namespace tubefoot {

/// Searches on blurred pictures for the order of the beams and a shift. Then it tries scales of range and
/// azimuth, and equidistant beams. Each addition must reduce the misfit clearly.
Warp coarse_warp(const Pictures& pictures);

/// Divides rows by their levels. Values up to twice the level stay linear, so that sampling noise has no
/// bias. Larger values are compressed logarithmically.
std::vector<double> as_seen(const EchoShape& shape, const std::vector<double>& energy_j,
                            const std::vector<double>& levels_j);

/// sum |a - b| / sum (a + b).
double misfit_of(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace tubefoot
