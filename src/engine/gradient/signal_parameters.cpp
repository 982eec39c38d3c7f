// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/signal_parameters.hpp"

#include "engine/gradient/checked_arguments.hpp"

// Computes the velocities of visible polygons and of channels for derivatives of signals. Source:
// docs/notes/gradients.md, "Signals of smooth surfaces".

namespace tubefoot {

std::vector<SignalParameter> signal_parameters(const FacetMesh& mesh, const History& history,
                                               const VisiblePolygons& patches,
                                               std::span<const SignalChannel> channels,
                                               std::span<const EchoParameter> parameters) {
  const FootprintSet& set = history.footprints;
  if (set.corner_names.size() != set.corners_m.size())
    reject_gradient("the history has no names of corners: set VisibilityOptions::corner_names");
  const NameContext context{mesh, history.tubes.apex, set.name_rays};
  const NamedPoints points(context, history.grid_unit_m);
  std::vector<SignalParameter> all(parameters.size());
  std::vector<PointVelocity> velocities;
  std::vector<SignalParameter*> moving;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    const EchoParameter& parameter = parameters[n];
    all[n].by_sound_speed = parameter.by_range_scale;
    all[n].by_absorption = parameter.by_absorption;
    if (!parameter.velocity) continue;
    velocities.push_back(parameter.velocity);
    moving.push_back(&all[n]);
    for (const SignalChannel& channel : channels) {
      all[n].transmit.push_back(parameter.velocity(ray_bit, channel.transmit_m - patches.origin_m));
      all[n].receive.push_back(parameter.velocity(ray_bit, channel.receive_m - patches.origin_m));
    }
  }
  CornerVelocities corners(points, velocities);
  for (const VisiblePolygon& patch : patches.patches) {
    if (moving.empty()) break;
    corners.select(patch.facet);
    for (std::size_t n = 0; n < moving.size(); ++n) {
      const CornerVelocities::UnitPlane plane = corners.of_plane(n);
      moving[n]->polygons.push_back({{}, plane.normal, plane.distance});
    }
    const std::uint32_t first = set.pieces[patch.piece].first;
    for (std::uint32_t c = 0; c < patch.corner_count; ++c) {
      const std::vector<glm::dvec3>& of = corners.of_corner(set.corner_names[first + c]);
      for (std::size_t n = 0; n < moving.size(); ++n) moving[n]->polygons.back().corners.push_back(of[n]);
    }
  }
  return all;
}

}  // namespace tubefoot
