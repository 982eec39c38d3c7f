// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "fixtures/world/differentiated_scenes.hpp"
#include "gradient_oracle.hpp"

// Derivatives of the energy of the seabed behind the wall of wall_before_seabed(), in 50 digits. In each
// vertical plane, the energy per radian is mu H^2 / 4 (r_s^-4 - r_1^-4). The shadow ends at the range r_s,
// and x = d H / (H - h) from the sonar along the normal of the wall.
namespace tubefoot::test {

/// A tube so narrow that energies are proportional to its width within 1e-10.
constexpr std::int32_t narrow_wall_half_width = 1024;

struct WallDerivatives {
  Real width_rad = 0, energy = 0, by_wall = 0, by_distance = 0, by_height = 0;
};

/// The parameters of by_wall, by_distance and by_height.
inline std::vector<EchoParameter> wall_parameters(const FacetMesh& mesh) {
  return {{[](PointId id, glm::dvec3) { return glm::dvec3(0, 0, id == 6 || id == 7); }},
          EchoParameter::object_translation(mesh, 1, {1, 0, 0}),
          EchoParameter::sonar_translation({0, 0, 1})};
}

inline WallDerivatives wall_derivatives(std::int32_t half_width, double mu) {
  const Real H = Wall::height_m, h = Wall::wall_m, d = Wall::distance_m, far = Wall::to_m;
  const Real x = d * H / (H - h), factor = mu * H * H / 4, half = atan(Real(half_width) / Real(1 << 28));
  const auto integral = [&](const auto& f) { return factor * real_rule()(-half, half, f); };
  const auto stretch = [](const Real& phi) { return 1 / (cos(phi) * cos(phi)); };
  const auto r2 = [&](const Real& phi) { return H * H + x * x * stretch(phi); };
  WallDerivatives all;
  all.width_rad = 2 * half;
  all.energy = integral([&](const Real& phi) { return pow(r2(phi), -2) - pow(far, -4); });
  const Real by_x = integral([&](const Real& phi) { return -4 * pow(r2(phi), -3) * x * stretch(phi); });
  all.by_wall = by_x * d * H / ((H - h) * (H - h));
  all.by_distance = by_x * H / (H - h);
  all.by_height = 2 * all.energy / H - by_x * d * h / ((H - h) * (H - h)) +
                  integral([&](const Real& phi) { return -4 * H * pow(r2(phi), -3); });
  return all;
}

}  // namespace tubefoot::test
