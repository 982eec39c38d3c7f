// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "run/shot_ends.hpp"

namespace tubefoot {

/// The visible pieces and the open water of tubes in exact coordinates, as text (docs/footprints.md).
class RationalsFile {
 public:
  /// Throws std::runtime_error where writing fails, as all else here. In refracting water corners are those
  /// between vertices that are seen where rays in doubles put them, and lie where they lie; by plain double
  /// arithmetic those where the planes meet that doubles chose.
  RationalsFile(const std::filesystem::path& file, const Shots& shots, std::size_t sensor);
  ~RationalsFile();
  /// A shot's tubes of `beams` (sorted; empty: all); of a receiver apart its own, and all of the transmitter.
  /// Returns the number of pieces seen.
  std::size_t add(const Shot& shot, std::span<const std::uint32_t> beams);
  void close();

 private:
  std::size_t add_end(const Shot& shot, const ShotEnd& end, std::span<const std::uint32_t> numbers,
                      std::vector<TubeVisibility>* kept);
  void add_shared(const ShotEnd& out, std::span<const std::uint32_t> receive_tubes,
                  const FootprintSharer& sharer, const WorldGrid& grid);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
