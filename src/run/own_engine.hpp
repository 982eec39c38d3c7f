// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "run/survey.hpp"

namespace tubefoot {

/// A shot as one sensor hears it.
struct HeardShot {
  std::size_t sensor = 0, ping = 0, shot = 0;
};

/// An engine that is not built in. It runs, and is charted and compared, like those that are.
struct OwnEngine {
  std::string name;
  /// Fills the energies [J] of a shot, [beam of the shot][sample], which are 0 before. Called from several
  /// threads at a time. What it throws ends the run.
  std::function<void(const Survey& survey, const HeardShot& shot, std::span<double> energy)> echo;
};

}  // namespace tubefoot
