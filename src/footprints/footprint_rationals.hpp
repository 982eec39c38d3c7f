// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "run/transmission_ends.hpp"

namespace tubefoot {

/// The visible pieces and the open water of tubes in exact coordinates, as text (docs/footprints.md).
class RationalsFile {
 public:
  /// Throws std::runtime_error where writing fails, as all else here. In refracting water corners are those
  /// between vertices that are seen where rays in doubles put them, and lie where they lie; by plain double
  /// arithmetic those where the planes meet that doubles chose.
  RationalsFile(const std::filesystem::path& file, const Transmissions& transmissions, std::size_t sensor);
  ~RationalsFile();
  /// A transmission's tubes of `beams` (sorted; empty: all); of a separate receiver its own, and all of the
  /// transmitter. Returns the number of pieces seen.
  std::size_t add(const Transmission& transmission, std::span<const std::uint32_t> beams);
  void close();

 private:
  std::size_t add_end(const Transmission& transmission, const TransmissionEnd& end,
                      std::span<const std::uint32_t> numbers, std::vector<TubeVisibility>* kept);
  void add_shared(const TransmissionEnd& out, std::span<const std::uint32_t> receive_tubes,
                  const FootprintSharer& sharer, const WorldGrid& grid);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tubefoot
