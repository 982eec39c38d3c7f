// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "run/survey.hpp"

namespace tubefoot {

/// The visible pieces and the open water of tubes in exact coordinates, as text (docs/footprints.md).
class RationalsFile {
 public:
  /// Throws std::runtime_error where writing fails, as all else here; UsageError for a run whose corners are
  /// not exact: plain double, or water that refracts.
  RationalsFile(const std::filesystem::path& file, const Survey& survey, std::size_t sensor);
  ~RationalsFile();
  /// A shot's tubes of `beams` (sorted; empty: all). Returns the number of pieces seen.
  std::size_t add(std::size_t ping, std::size_t shot, std::span<const std::uint32_t> beams);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
