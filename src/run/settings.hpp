// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/global_control.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "files/outlet.hpp"
#include "geometry/visibility/visibility.hpp"
#include "scene/description/scene_description.hpp"

namespace tubefoot {

/// Reads the scene file and lets the command line's options override its [run] section.
SceneDescription described(const CommonOptions& options);

/// Every file that the scene names, and its own: what no command may write over.
Inputs inputs_of(const SceneDescription& description);

/// How a run sees: its arithmetic and what goes with it.
VisibilityOptions options_of(const RunDescription& run);

/// Limits the threads of everything while it lives; 0 is all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  int threads() const { return threads_; }

 private:
  int threads_;
  tbb::global_control control_;
};

/// Prints the warnings of a scene to stderr, unless quiet.
void print_warnings(const std::vector<std::string>& warnings, bool quiet);

/// Checks a ping range against a number of pings; throws UsageError.
PingRange resolved(const std::string& text, std::size_t pings);

/// Beams of a sensor that has so many, "3", "2:5" (both included), ":5", "2:" or several of these between
/// commas: sorted, each once; none for an empty text. Throws UsageError.
std::vector<std::uint32_t> resolved_beams(const std::string& text, std::size_t beams);

}  // namespace tubefoot
