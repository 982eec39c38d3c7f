// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "engine/signal/smooth_surface.hpp"

// What `strength` is asked for, in the words of a command line.
namespace tubefoot {

/// "FIRST:LAST:STEP" (LAST included where a step meets it), "FIRST:LAST" with a step of 1, or numbers between
/// commas; degrees. Increasing. Throws UsageError naming `what`.
std::vector<double> angles_of(const std::string& text, const std::string& what);

/// The same for frequencies; numbers end in Hz (or nothing), kHz or MHz, and a range has its step always.
std::vector<double> frequencies_of(const std::string& text);

/// "rigid", "soft", a pressure reflection coefficient from -1 to 1, or "fluid:DENSITY:SPEED" with ratios to
/// the water's and, if given, ":LOSS" in dB a wavelength.
SmoothSurface surface_of(const std::string& text, double roughness_m);

}  // namespace tubefoot
