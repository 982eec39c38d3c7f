// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/echo_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tubefoot {

SurfaceProperties EchoModel::seabed(FacetId facet) const {
  if (facet >= material.size() || material[facet] >= material_mu.size())
    throw std::invalid_argument(fmt::format("facet {} has no material with a Lambert parameter", facet));
  if (!path.facet_factor.empty() && facet >= path.facet_factor.size())
    throw std::invalid_argument(fmt::format("facet {} has no factor, but other facets have one", facet));
  if (!path.tx.facet_map.empty() && facet >= path.tx.facet_map.size())
    throw std::invalid_argument(
        fmt::format("facet {} has no true position, but other facets have one", facet));
  const double factor = path.facet_factor.empty() ? 1 : path.facet_factor[facet];
  return {factor, material_mu[material[facet]] * factor, model_of(facet), texture(facet)};
}

void check(const EchoModel& model) {
  if (!(model.absorption_db_per_m >= 0 && std::isfinite(model.absorption_db_per_m)))
    throw std::invalid_argument(
        fmt::format("absorption must be finite and 0 or more, not {} dB/m", model.absorption_db_per_m));
  if (!model.scattering.empty() && model.scattering.size() != model.material_mu.size())
    throw std::invalid_argument(
        fmt::format("the number of scattering models, {}, differs from the number of materials, {}",
                    model.scattering.size(), model.material_mu.size()));
  if (!(model.pattern_tolerance >= 1e-12 && model.pattern_tolerance <= 0.01))
    throw std::invalid_argument(fmt::format(
        "the tolerance of beam patterns must be from 1e-12 to 0.01, not {}", model.pattern_tolerance));
  if (!model.reflectivity.empty() && model.reflectivity.size() != model.material_mu.size())
    throw std::invalid_argument(
        fmt::format("{} materials have a Lambert parameter, but the list of textures has {} entries",
                    model.material_mu.size(), model.reflectivity.size()));
}

double absorption_per_m(double absorption_db_per_m) { return absorption_db_per_m * std::numbers::ln10 / 10; }

BeamPatterns as_images_have(const BeamPatterns& patterns, const Path& path) {
  BeamPatterns seen = patterns;
  // A direction d of an image is M d at the true apex, and M d . axis = d . M^T axis.
  for (TransmitPattern& transmit : seen.transmit)
    for (Directivity& one : transmit.beams) one.axis = glm::transpose(path.tx.to_true) * one.axis;
  for (Directivity& one : seen.receive) one.axis = glm::transpose(path.back().to_true) * one.axis;
  return seen;
}

BeamPatterns patterns_of_fan(const BeamPatterns& patterns, std::uint32_t fan, std::size_t tubes) {
  BeamPatterns own;
  own.transmit = {patterns.transmit[fan]};
  own.receive = {patterns.receive[fan]};
  if (!patterns.least.empty()) own.least = {patterns.least[fan]};
  own.fan_of_tube.assign(tubes, 0);
  own.beams_of_tube.assign(tubes, {0, 1});
  return own;
}

}  // namespace tubefoot
