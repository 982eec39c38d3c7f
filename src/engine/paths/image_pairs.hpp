// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/paths/image_tree.hpp"

namespace tubefoot {

/// An image of the transmitter and one of the receiver, by their numbers.
struct ImagePair {
  std::size_t sent = 0, heard = 0;
};

/// The pairs between which something may be scattered over mirrors: they see a facet in common, have fewer
/// than `order` mirrors together, but one at least, and let pass more than `least`. `one_place`: both are the
/// same images, and each two are a pair once. Throws std::length_error if there are more than `most`.
std::vector<ImagePair> pairs_of_images(std::span<const Image> sent, std::span<const Image> heard,
                                       bool one_place, int order, double least, std::size_t most);

}  // namespace tubefoot
