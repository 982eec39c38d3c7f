// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures pings of one imaging sonar over rough ground, with one thread. The scenes are those of
/// validation/scaling/cost.py. `beams_1024_over_1` is the visibility of a fan as 1024 beams relative to one
/// beam, and `beams_1024_over_1_ping` the same for the whole ping. `hidden_million_over_none` is the
/// visibility with a million facets behind a wall relative to none.
void scaling_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
