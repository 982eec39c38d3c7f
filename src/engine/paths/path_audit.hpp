// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "engine/paths/path_images.hpp"
#include "engine/visibility/bistatic_audit.hpp"

namespace tubefoot {

/// What holds of an image. Law C1 (closure) in rationals for each of its windows, in the world beyond them.
/// Law I4 (windows): they fill what is seen of the mirror from before it, to within what corners of windows
/// are rounded by.
struct ImageAudit {
  bool of_receiver = false;
  std::uint32_t mirrors = 0;
  std::vector<TubeAudit> windows;
  double mirror_sr = 0, windows_sr = 0, rounding_sr = 0;

  bool fills() const;
};

/// `image`: told with open water.
ImageAudit audit_image(const Image& image, bool of_receiver, std::uint64_t label);

/// What holds of the paths that are scattered once over mirrors: of all images that take part, and, by pair
/// of them and facet that both look at, Law S5 (parts) of what they share.
struct PathAudit {
  std::vector<ImageAudit> images;
  std::size_t pairs = 0;
  std::vector<SharedAudit> shared;
};

/// `images`: made with open water; `label` tells transmissions apart in the hash. In isovelocity water the
/// apexes' own tubes are left out: they are the transmission's.
PathAudit audit_paths(const PathImages& images, std::uint64_t label);

}  // namespace tubefoot
