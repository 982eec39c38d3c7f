// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/settings.hpp"

#include <fmt/format.h>
#include <tbb/info.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <stdexcept>

#include "files/input_error.hpp"
#include "files/shown.hpp"
#include "files/threads_at_hand.hpp"
#include "files/usage_error.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "sensors/kinds/scene_file.hpp"

// This file reads the common options of commands: scene file, threads, tolerance, ping ranges and beam
// lists. It also limits the threads of the program.

namespace tubefoot {
namespace {

std::int64_t number(std::string_view text, std::int64_t otherwise) {
  if (text.empty()) return otherwise;
  std::int64_t value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0)
    throw std::invalid_argument("expected pings as N, A:B, A: or :B, counted from 0");
  return value;
}

std::string named(const std::string& sensor) {
  return sensor.empty() ? "the sensor" : fmt::format("sensor '{}'", sensor);
}

}  // namespace

PingRange parse_ping_range(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    if (text.empty()) throw std::invalid_argument("expected pings as N, A:B, A: or :B, counted from 0");
    const std::int64_t ping = number(text, 0);
    return {ping, ping};
  }
  return {number(std::string_view(text).substr(0, colon), 0),
          number(std::string_view(text).substr(colon + 1), -1)};
}

Tolerance requested_tolerance(const std::string& text) {
  try {
    return parse_tolerance(text);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--tolerance {}", error.what()));
  }
}

std::optional<std::size_t> number_of_pings(const std::string& text, std::int64_t least,
                                           const std::string& instead, bool quiet) {
  if (text.empty() || !std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; })) return {};
  const std::int64_t count = parse_ping_range(text).first;
  if (count < least)
    throw UsageError(fmt::format("--pings '{}': expected a number of pings of at least {}", text, least));
  if (!quiet) say("warning: a bare number of --pings is deprecated here: use {}\n", instead);
  return static_cast<std::size_t>(count);
}

PingRange resolved(const std::string& text, std::size_t pings, const std::string& sensor) {
  PingRange range;
  try {
    range = parse_ping_range(text);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--pings '{}': {}", text, error.what()));
  }
  const auto last = static_cast<std::int64_t>(pings) - 1;
  if (range.last < 0) range.last = last;
  if (range.first > range.last || range.last > last)
    throw UsageError(fmt::format("--pings '{}': {} has pings 0 to {}", text, named(sensor), last));
  return range;
}

std::vector<std::uint32_t> resolved_beams(const std::string& text, std::size_t beams,
                                          const std::string& sensor) {
  std::vector<std::uint32_t> chosen;
  const auto last = static_cast<std::int64_t>(beams) - 1;
  for (std::size_t begin = 0; begin < text.size() || (begin > 0 && text.back() == ',');) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    PingRange range;
    try {
      range = parse_ping_range(text.substr(begin, comma - begin));
    } catch (const std::invalid_argument&) {
      throw UsageError(fmt::format(
          "--beams '{}': expected beams as N, A:B, A: or :B, several of them between commas, counted from 0",
          text));
    }
    if (range.last < 0) range.last = last;
    if (range.first > range.last || range.last > last)
      throw UsageError(fmt::format("--beams '{}': {} has beams 0 to {}", text, named(sensor), last));
    for (std::int64_t beam = range.first; beam <= range.last; ++beam)
      chosen.push_back(static_cast<std::uint32_t>(beam));
    begin = comma + 1;
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

SceneDescription described(const CommonOptions& options) {
  const Progress reading("scene", 1, options.quiet);  // large files are hashed completely
  SceneDescription description = read_scene_file(options.scene, options.confined);
  if (options.arithmetic) description.run.arithmetic = *options.arithmetic;
  if (options.threads) description.run.threads = *options.threads;
  return description;
}

Inputs inputs_of(const SceneDescription& description) {
  Inputs inputs = description.inputs;
  if (description.refinement.file) inputs.emplace_back(*description.refinement.file);
  return inputs;
}

namespace {

/// Returns the number of threads that can start, up to `wanted`. oneTBB ends the program if it cannot start
/// a thread.
int threads_that_start(int wanted) {
  const int there = threads_at_hand(wanted);
  static std::atomic<bool> told{false};
  if (there < wanted && !told.exchange(true))
    say("warning: using {} of {} threads: a limit on memory (ulimit -v), on processes (ulimit -u) or of a "
        "container permits no more\n",
        there, wanted);
  return there;
}

}  // namespace

ThreadLimit::ThreadLimit(int threads)
    : threads_(threads_that_start(threads > 0 ? threads : tbb::info::default_concurrency())),
      control_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads_)) {}

void print_warnings(const std::vector<std::string>& warnings, bool quiet) {
  if (quiet) return;
  for (const std::string& warning : warnings) say("warning: {}\n", shown(warning));
}

}  // namespace tubefoot
