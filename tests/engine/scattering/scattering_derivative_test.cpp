// SPDX-License-Identifier: GPL-3.0-or-later
// Tests derivatives of scattering models and of textures against central differences.
#include "engine/scattering/scattering_derivative.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "engine/scattering/layered_reflectivity.hpp"
#include "engine/scattering/reflectivity_gradient.hpp"
#include "fixtures/world/textures.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using Parameter = ScatteringDerivative::Gsab;

const std::vector<double> angles_deg{8, 30, 60}, strengths_db{-30, -24, -10};

double cross_section_at(const ScatteringDerivative& derivative, double grazing) {
  return derivative.cross_section(std::sin(grazing), std::cos(grazing));
}

TEST(ScatteringDerivative, OfGsabAgreesWithCentralDifferences) {
  const ScatteringModel::Gsab base{0.03, 0.2, 1e-3, 1.5, 4e-3, 0.7};
  double ScatteringModel::Gsab::*const members[]{
      &ScatteringModel::Gsab::specular,   &ScatteringModel::Gsab::specular_width_rad,
      &ScatteringModel::Gsab::oblique,    &ScatteringModel::Gsab::oblique_exponent,
      &ScatteringModel::Gsab::transition, &ScatteringModel::Gsab::transition_width_rad};
  for (int k = 0; k < 6; ++k)
    for (const double grazing : {0.05, 0.4, 1.0, 1.5}) {
      const double step = 2e-5 * base.*members[k];
      ScatteringModel::Gsab more = base, less = base;
      more.*members[k] += step;
      less.*members[k] -= step;
      const double expected = (ScatteringModel::gsab(more).cross_section(grazing) -
                               ScatteringModel::gsab(less).cross_section(grazing)) /
                              (2 * step);
      EXPECT_NEAR(cross_section_at(ScatteringDerivative::gsab(base, Parameter(k)), grazing), expected,
                  1e-6 * std::abs(expected) + 1e-12)
          << k << " " << grazing;
    }
}

// A term with the level 0 is absent from the model.
TEST(ScatteringDerivative, ExistsAtALevelOfZero) {
  const ScatteringModel::Gsab base{0, 0.2, 1e-3, 1.5, 0, 0.7};
  const double lobe = std::exp(-0.3 * 0.3 / (2 * 0.2 * 0.2));
  EXPECT_NEAR(cross_section_at(ScatteringDerivative::gsab(base, Parameter::specular), pi / 2 - 0.3), lobe,
              1e-12);
  EXPECT_EQ(cross_section_at(ScatteringDerivative::gsab(base, Parameter::specular_width_rad), 1), 0);
}

TEST(ScatteringDerivative, OfATableAgreesWithCentralDifferences) {
  for (const double top : {60.0, 90.0})
    for (std::size_t k = 0; k < angles_deg.size(); ++k)
      for (const double grazing_deg : {3.0, 12.0, 28.0, 33.0, 55.0, 70.0, 88.0}) {
        std::vector<double> angles = angles_deg;
        angles.back() = top;
        const double grazing = grazing_deg * degree, step = 1e-4;
        const auto at = [&](double by_angle, double by_level) {
          std::vector<double> a = angles, s = strengths_db;
          a[k] += by_angle;
          s[k] += by_level;
          return ScatteringModel::table(a, s).cross_section(grazing);
        };
        const double by_level = (at(0, step) - at(0, -step)) / (2 * step);
        EXPECT_NEAR(cross_section_at(ScatteringDerivative::table_strength(angles, strengths_db, k), grazing),
                    by_level, 1e-7 * std::abs(by_level) + 1e-15)
            << k << " " << grazing_deg;
        if (angles[k] == 90) continue;
        const double by_angle = (at(step, 0) - at(-step, 0)) / (2 * step);
        EXPECT_NEAR(cross_section_at(ScatteringDerivative::table_angle(angles, strengths_db, k), grazing),
                    by_angle, 1e-7 * std::abs(by_angle) + 1e-15)
            << k << " " << grazing_deg;
      }
  EXPECT_THROW(ScatteringDerivative::table_strength(angles_deg, strengths_db, 3), std::invalid_argument);
}

TEST(ScatteringDerivative, SlopesAgreeWithCentralDifferences) {
  const ScatteringModel models[]{ScatteringModel::lambert(0.01),
                                 ScatteringModel::gsab({0.03, 0.2, 1e-3, 1.5, 4e-3, 0.7}),
                                 ScatteringModel::table(angles_deg, strengths_db)};
  for (const ScatteringModel& model : models)
    for (const double grazing : {0.1, 0.6, 1.2}) {
      const CrossSectionSlopes slopes = slopes_of(model, std::sin(grazing), std::cos(grazing));
      const double step = 1e-6;
      const double expected =
          (model.cross_section(grazing + step) - model.cross_section(grazing - step)) / (2 * step);
      EXPECT_NEAR(slopes.value, model.cross_section(grazing), 1e-12 * slopes.value);
      EXPECT_NEAR(slopes.by_log_sine * std::cos(grazing) / std::sin(grazing) - slopes.by_incidence, expected,
                  1e-7 * slopes.value);
    }
}

TEST(ReflectivityGradient, AgreesWithCentralDifferences) {
  const test::Field map = test::map_askew(), noise = test::perlin(0.8, 3, 0.5);
  const auto layered = std::make_shared<const LayeredReflectivity>(std::vector{map, noise});
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> coordinate(-3, 3);
  for (const test::Field& field : {map, noise, test::Field(layered)}) {
    const ReflectivityGradient gradient(*field);
    for (int n = 0; n < 50; ++n) {
      const glm::dvec3 place(120 + coordinate(random), -80 + coordinate(random), coordinate(random));
      const ReflectivityGradient::Value value = gradient.at(place);
      EXPECT_NEAR(value.factor, field->factor(place), 1e-13);
      for (int k = 0; k < 3; ++k) {
        glm::dvec3 step(0);
        step[k] = 1e-6;
        EXPECT_NEAR(value.gradient[k], (field->factor(place + step) - field->factor(place - step)) / 2e-6,
                    1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace tubefoot
