// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/paths/image_tree.hpp"

namespace tubefoot {

/// An image of the transmitter and one of the receiver, by their numbers.
struct ImagePair {
  std::size_t sent = 0, received = 0;
};

/// The pairs between which something may be scattered over mirrors: they see a facet in common, have fewer
/// than `order` mirrors together, but one at least, and let pass more than `least`. `one_place`: both are the
/// same images, and each two are a pair once. Throws std::length_error if there are more than `most`.
std::vector<ImagePair> pairs_of_images(std::span<const Image> sent, std::span<const Image> received,
                                       bool one_place, int order, double least, std::size_t most);

/// The law and the beams between two images, made of those between their apexes, which outlive it.
struct PairModel {
  /// `true_apex`: of the transmitter. `seabed`: the facets that are shared, where they are not those of
  /// `model`; null: they are.
  PairModel(const Image& sent, const Image& received, GridPoint true_apex, double grid_unit_m,
            const EchoModel& model, const ReceiveBeams& beams, const FacetMesh* seabed);
  PairModel(const PairModel&) = delete;
  PairModel& operator=(const PairModel&) = delete;

  EchoModel model;
  BeamPatterns patterns;
  std::vector<std::uint32_t> beam, from, to;  ///< by window
  ReceiveBeams beams;
};

}  // namespace tubefoot
