// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/rasters/georeference.hpp"

namespace tubefoot::fuzz {

inline const LocalFrame& frame_on_earth() {
  static const LocalFrame frame =
      LocalFrame::projected("EPSG:32602", 492000, 7060000, 0, SourcePlace{"scene.toml", 1, 1});
  return frame;
}

}  // namespace tubefoot::fuzz
