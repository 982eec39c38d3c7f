// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "engine/paths/path_images.hpp"
#include "engine/visibility/bistatic_audit.hpp"

namespace tubefoot {

/// Audit of an image.
/// Law C1 (closure) is tested in rational numbers for each window, in the scene beyond the window.
/// Law I4 (windows): the windows fill the visible part of the mirror, within the rounding of their
/// corners.
struct ImageAudit {
  bool of_receiver = false;
  std::uint32_t mirrors = 0;
  std::vector<TubeAudit> windows;
  double mirror_sr = 0, windows_sr = 0, rounding_sr = 0;

  bool fills() const;
};

/// `image` must have its unobstructed region.
ImageAudit audit_image(const Image& image, bool of_receiver, std::uint64_t label);

/// Audit of the paths with one scattering over mirrors. It covers all images of these paths.
/// Law S5 (parts) is tested for the common visibility of each pair of images and each facet that both see.
struct PathAudit {
  std::vector<ImageAudit> images;
  std::size_t pairs = 0;
  std::vector<SharedAudit> shared;
};

/// `images` must have their unobstructed regions. `label` distinguishes transmissions in the hash. In
/// isovelocity water the audit of the transmission itself covers the tubes of the apexes, so they are
/// omitted here.
PathAudit audit_paths(const PathImages& images, std::uint64_t label);

}  // namespace tubefoot
