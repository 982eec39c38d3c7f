// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include "run/options.hpp"
#include "run/survey.hpp"
#include "run/transmission.hpp"
#include "viewer/view_data.hpp"

namespace tubefoot {

/// Most footprints of a page that nobody asked for ping by ping, and of any page.
struct ViewLimits {
  std::size_t footprints_unasked = 150'000;
  std::size_t footprints = 2'000'000;
  std::size_t cells_unasked = 4'000'000;  ///< of the picture: pings, beams, samples
  std::size_t mesh_facets = 300'000;
  std::size_t shadow_polygons = 300'000;
};

/// Traces pings of a sensor and says which footprints made which samples. Unset `range`: from the first ping
/// on, as many as the limits allow. Energies are those of the ordinary
/// echo, one bounce. With a separate receiver footprints are those of both ends (path_footprints.hpp). Throws
/// UsageError for more footprints than a page holds; Interrupted when somebody wants to stop.
ViewData gather_view(const Transmissions& transmissions, std::size_t sensor,
                     const std::optional<PingRange>& range, bool quiet, const ViewLimits& limits = {});

}  // namespace tubefoot
