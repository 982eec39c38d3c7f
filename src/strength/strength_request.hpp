// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "engine/signal/smooth_surface.hpp"

// Parses the arguments of the command `strength`.
namespace tubefoot {

/// Parses angles in degrees. The formats are "FIRST:LAST:STEP" (with LAST if a step meets it), "FIRST:LAST"
/// with a step of 1, or numbers separated by commas. The result is increasing. Throws UsageError, which
/// names `what`.
std::vector<double> angles_of(const std::string& text, const std::string& what);

/// Parses frequencies in the same formats. Numbers end in Hz (or nothing), kHz or MHz; a range must have a
/// step.
std::vector<double> frequencies_of(const std::string& text);

/// Parses "rigid", "soft", a pressure reflection coefficient from -1 to 1, or "fluid:DENSITY:SPEED". The
/// latter has ratios to the values of the water and, optionally, ":LOSS" in dB per wavelength.
SmoothSurface surface_of(const std::string& text, double roughness_m);

}  // namespace tubefoot
