// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "run/transmission_ends.hpp"

namespace tubefoot {

/// Writes the visible pieces and the unobstructed region of tubes in exact coordinates, as text
/// (docs/footprints.md).
class RationalsFile {
 public:
  /// Throws std::runtime_error if writing fails, as do the other members.
  /// In stratified water, rays in doubles determine the apparent positions of vertices, and corners are
  /// exact for these positions. With plain double arithmetic, doubles choose the planes, and corners are
  /// exact intersections of these planes.
  RationalsFile(const std::filesystem::path& file, const Transmissions& transmissions, std::size_t sensor);
  ~RationalsFile();
  /// Writes the tubes of a transmission that belong to `beams` (sorted; empty: all). For a separate
  /// receiver, it writes these tubes of the receiver and all tubes of the transmitter. Returns the number
  /// of visible pieces.
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
