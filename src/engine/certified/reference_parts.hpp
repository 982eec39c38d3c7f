// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "engine/certified/reference.hpp"

// What references of one apex and of two have in common. Heavy: include only in .cpp files.
namespace tubefoot {

constexpr double least_allowed = 1e-300;

/// Enclosures by bin, of one task.
using Bins = std::map<std::size_t, Ball>;

/// Energies and bounds of enclosures, held against a tolerance.
CertifiedEcho enclosed_echo(const Echo& ordinary, const std::vector<Ball>& total, double tolerance);

/// How a bin's tolerance is shared out among its parts is a guess, which a bin of very many small parts may
/// prove wrong: then all of them are done again, as much narrower as that bin needs, at most twice.
/// `enclose(working, coarse)`: parts enclosed to `working`; `coarse`: no narrower try would help.
CertifiedEcho narrowed(double tolerance, const std::function<CertifiedEcho(double, bool&)>& enclose);

}  // namespace tubefoot
