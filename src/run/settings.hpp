// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/global_control.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "files/atomic_output.hpp"
#include "run/options.hpp"
#include "scene/description/scene_description.hpp"
#include "study/tolerance.hpp"

namespace tubefoot {

/// Reads the scene file and lets the command line's options override its [run] section.
SceneDescription described(const CommonOptions& options);

/// Every file that the scene names, and its own: what no command may write over.
Inputs inputs_of(const SceneDescription& description);

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

/// A tolerance of the command line; throws UsageError.
Tolerance requested_tolerance(const std::string& text);

/// The number of pings that a bare number meant in earlier versions of 'advise' and 'chart', with a warning
/// that names the present option. None for other texts. Throws UsageError for 0.
std::optional<std::size_t> number_of_pings(const std::string& text, const std::string& instead, bool quiet);

/// Checks a ping range against a number of pings, of a sensor of that name; throws UsageError.
PingRange resolved(const std::string& text, std::size_t pings, const std::string& sensor = {});

/// Beams of a sensor that has so many, "3", "2:5" (both included), ":5", "2:" or several of these between
/// commas: sorted, each once; none for an empty text. Throws UsageError.
std::vector<std::uint32_t> resolved_beams(const std::string& text, std::size_t beams,
                                          const std::string& sensor = {});

}  // namespace tubefoot
