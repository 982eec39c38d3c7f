// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "compare/diagnosis/alignment.hpp"

namespace tubefoot {

/// What is found by trying, on blurred pictures: the order of the beams and a shift, then scales of range and
/// azimuth and beams equidistant. Each must be clearly better than what is without it.
Warp coarse_warp(const Pictures& pictures);

/// How a picture is seen: rows over their levels, up to twice the level as it is, so that noise of sampling
/// has no bias, and highlights by their logarithm.
std::vector<double> as_seen(const EchoShape& shape, const std::vector<double>& energy_j,
                            const std::vector<double>& levels_j);

/// sum |a - b| / sum (a + b).
double misfit_of(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace tubefoot
