// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/paths/image_tree.hpp"

namespace tubefoot {

/// Indices of an image of the transmitter and of an image of the receiver.
struct ImagePair {
  std::size_t sent = 0, received = 0;
};

/// Pairs of images that contribute single scatterings over mirrors. The two images see a common facet and
/// pass more than `least`. Together they have at least one mirror and fewer than `order`. `one_place`: both
/// lists are the same images, and each pair occurs once. Throws std::length_error for more than `most`
/// pairs.
std::vector<ImagePair> pairs_of_images(std::span<const Image> sent, std::span<const Image> received,
                                       bool one_place, int order, double least, std::size_t most);

/// Echo model and beams between two images, derived from those between their apexes. The latter must outlive
/// this object.
struct PairModel {
  /// `true_apex`: position of the transmitter. `seabed`: mesh of the shared facets if `model` refers to
  /// another mesh, else null.
  PairModel(const Image& sent, const Image& received, GridPoint true_apex, double grid_unit_m,
            const EchoModel& model, const ReceiveBeams& beams, const FacetMesh* seabed);
  PairModel(const PairModel&) = delete;
  PairModel& operator=(const PairModel&) = delete;

  EchoModel model;
  BeamPatterns patterns;
  std::vector<std::uint32_t> beam, from, to;  ///< per window
  ReceiveBeams beams;
};

}  // namespace tubefoot
