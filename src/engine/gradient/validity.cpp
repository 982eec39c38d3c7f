// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/validity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/certified/certified_driver.hpp"
#include "engine/gradient/visibility_certificate.hpp"
#include "geometry/numbers/scalars.hpp"

// Extends an interval of the parameter step by step, from 0 outwards, as long as the certificate of each tube
// holds.

namespace tubefoot {
namespace {

/// The last step is at most this fraction of the whole.
constexpr double finest_step = 1.0 / 64;
/// The first step is at least this fraction of the largest one.
constexpr double smallest_first_step = 0x1p-60;

/// Returns a step up to `most` to which the certificate holds, in the sense of `sign`.
double proven_step(VisibilityCertificate& certificate, double sign, double most) {
  double reached = 0;
  for (double step = most; reached < most;) {
    const double end = std::min(reached + step, most);
    const bool holds = sign > 0 ? certificate.holds(reached, end) : certificate.holds(-end, -reached);
    if (holds) {
      reached = end;
      step *= 2;
      continue;
    }
    if (step <= (reached > 0 ? finest_step * reached : smallest_first_step * most)) break;
    step /= 2;
  }
  return reached;
}

}  // namespace

ValidSteps common_steps(const ValidSteps& a, const ValidSteps& b) {
  return {std::min(a.forward, b.forward), std::min(a.backward, b.backward), a.on_change || b.on_change};
}

std::vector<std::vector<ValidSteps>> valid_steps(const FacetMesh& mesh, const SceneTree& tree,
                                                 const TubeSet& tubes, double grid_unit_m,
                                                 const VisibilityOptions& options,
                                                 std::span<const EchoParameter> parameters,
                                                 std::span<const double> largest,
                                                 const std::vector<bool>& wanted) {
  require_exact(options);
  if (largest.size() != parameters.size() ||
      !std::ranges::all_of(largest, [](double step) { return step > 0 && std::isfinite(step); }))
    throw std::invalid_argument(fmt::format(
        "valid steps: expected a finite positive largest step for each of {} parameters", parameters.size()));
  VisibilityOptions whole = options;
  whole.open_water = true;
  const std::vector<ValidSteps> unlimited(tubes.tubes.size(), ValidSteps{infinite, infinite, false});
  std::vector<std::vector<ValidSteps>> all(parameters.size(), unlimited);
  std::vector<double> speed;
  const std::vector<GridPoint> no_rays;
  const NameContext vertices{mesh, tubes.apex, no_rays};
  for (const EchoParameter& parameter : parameters) {
    const SceneMotion motion(vertices, parameter, grid_unit_m);
    speed.push_back(0);
    for (VertexId v = 0; parameter.velocity && v < mesh.vertices.size(); ++v)
      speed.back() = std::max(speed.back(), motion.reach(v, 1));
  }
  struct Nothing {};
  enclose_tubes<Nothing>(
      mesh, tree, tubes, whole,
      [&](std::uint32_t tube, const NameContext& context, const TubeVisibility& seen, Nothing&) {
        for (std::size_t n = 0; n < parameters.size(); ++n) {
          if (!parameters[n].velocity || (!wanted.empty() && !wanted[tube])) continue;
          ValidSteps& valid = all[n][tube];
          const SceneMotion motion(context, parameters[n], grid_unit_m);
          VisibilityCertificate certificate(context, seen, tree, tubes.reach, motion, speed[n]);
          valid.on_change = !certificate.holds(0, 0);
          valid.forward = valid.on_change ? 0 : proven_step(certificate, 1, largest[n]);
          valid.backward = valid.on_change ? 0 : proven_step(certificate, -1, largest[n]);
        }
      });
  return all;
}

}  // namespace tubefoot
