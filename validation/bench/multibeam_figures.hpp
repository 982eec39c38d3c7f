// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures lines of multibeams on two threads, from the first ping to the last file. `mbes_pings_per_s` is
/// that of a RESON 8101 over the whole real grid (scenes/multibeam/real-grid.toml).
/// `multibeam_real_time_factor` is the duration of the line of scenes/multibeam/real-time.toml divided by its
/// computing time.
void multibeam_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
