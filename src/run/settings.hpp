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

/// Reads the scene file; the options of the command line override its [run] section.
SceneDescription described(const CommonOptions& options);

/// Returns the scene file and every file that it names. No command may overwrite these.
Inputs inputs_of(const SceneDescription& description);

/// Limits the threads of the whole program during the lifetime of this object; 0 means all cores.
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

/// Parses a tolerance of the command line. Throws UsageError.
Tolerance requested_tolerance(const std::string& text);

/// The number of pings that a bare number meant in earlier versions of 'advise' and 'chart', with a warning
/// that names the present option. None for other texts. Throws UsageError for a number below `least`.
std::optional<std::size_t> number_of_pings(const std::string& text, std::int64_t least,
                                           const std::string& instead, bool quiet);

/// Parses a ping range and checks it against the number of pings of the named sensor. Throws UsageError.
PingRange resolved(const std::string& text, std::size_t pings, const std::string& sensor = {});

/// Parses the beams of a sensor with `beams` beams: "3", "2:5" (both included), ":5", "2:", or several of
/// these separated by commas. The result is sorted and without repetitions; it is empty for an empty text.
/// Throws UsageError.
std::vector<std::uint32_t> resolved_beams(const std::string& text, std::size_t beams,
                                          const std::string& sensor = {});

}  // namespace tubefoot
