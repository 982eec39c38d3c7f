// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include "run/options.hpp"
#include "run/survey.hpp"
#include "run/transmission.hpp"
#include "viewer/view_data.hpp"

namespace tubefoot {

/// Limits of a page. Those named `unasked` apply if the user did not select pings.
struct ViewLimits {
  std::size_t footprints_unasked = 150'000;
  std::size_t footprints = 2'000'000;
  std::size_t cells_unasked = 4'000'000;  ///< cells of the picture: pings x beams x samples
  std::size_t mesh_facets = 300'000;
  std::size_t shadow_polygons = 300'000;
};

/// Traces pings of a sensor and determines the footprints behind each sample.
///
/// Without `range`, it starts with the first ping and continues up to the limits. Energies are those of the
/// ordinary echo of one scattering. With a separate receiver, footprints are those of both ends
/// (path_footprints.hpp). Throws UsageError for more footprints than the limit, and Interrupted if the user
/// stops the program.
ViewData gather_view(const Transmissions& transmissions, std::size_t sensor,
                     const std::optional<PingRange>& range, bool quiet, const ViewLimits& limits = {});

}  // namespace tubefoot
