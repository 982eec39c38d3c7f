// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of target strength: the BeTSSi models M3, M5A and M5B (validation/target-strength.md).
#include <utility>

#include "suite/suite_scene.hpp"

namespace tubefoot {
namespace {

/// Draws one aspect from each interval of five degrees, a multiple of the step of the published tables.
SuiteScene strength_scene(Draw& draw, std::string title, std::string_view body,
                          std::vector<double> frequencies_hz) {
  constexpr int interval_tenths = 50, last_tenths = 1800, published_step_tenths = 2;
  SuiteScene scene;
  scene.title = std::move(title);
  scene.strength = StrengthBody{body, {}, std::move(frequencies_hz)};
  for (int first = 0; first < last_tenths; first += interval_tenths)
    scene.strength->azimuths_deg.push_back(
        draw.among(first, first, first + interval_tenths - published_step_tenths, published_step_tenths) /
        10);
  scene.strength->azimuths_deg.push_back(last_tenths / 10.0);
  scene.deciders = {{"kirchhoff_db", 1}, {"boundary_db", 1}};
  scene.certified = 1e-2;
  return scene;
}

}  // namespace

SuiteScene strength_m3_scene(Draw& draw) {
  return strength_scene(draw, "A tapered cylinder of 41 m with half spheres at its ends (BeTSSi M3)", "m3",
                        {1000});
}

SuiteScene strength_m5a_scene(Draw& draw) {
  return strength_scene(draw, "Two parallel cylinders, neither of which hides the other (BeTSSi M5A)", "m5a",
                        {1000, 3000, 10000});
}

SuiteScene strength_m5b_scene(Draw& draw) {
  return strength_scene(draw, "Two parallel cylinders, one of which can hide the other (BeTSSi M5B)", "m5b",
                        {1000, 3000, 10000});
}

}  // namespace tubefoot
