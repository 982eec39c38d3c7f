// SPDX-License-Identifier: GPL-3.0-or-later
// Tests scattering models: GSAB, tables and Lambert's law, their albedo by quadrature, and published levels
// of sediments (physics sheet 3.3).

#include "engine/scattering/scattering_model.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "engine/scattering/sediment.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

double decibels(double x) { return 10 * std::log10(x); }

/// Backscattering cross-section by Lambert's law.
double lambert_cross_section(double mu, double grazing_angle_rad) {
  return mu * std::sin(grazing_angle_rad) * std::sin(grazing_angle_rad);
}

TEST(ScatteringModel, GsabWithTheObliqueTermAloneIsLambert) {
  const double mu = std::pow(10, -2.7);
  for (const ScatteringModel& model :
       {ScatteringModel::lambert(mu), ScatteringModel::gsab({.oblique = mu, .oblique_exponent = 2})})
    for (double grazing = 0.5; grazing <= 90; grazing += 0.5) {
      const double expected = lambert_cross_section(mu, grazing * degree);
      EXPECT_NEAR(model.cross_section(grazing * degree), expected, 1e-15 * expected);
      EXPECT_NEAR(model.cross_section(std::sin(grazing * degree), std::cos(grazing * degree)), expected,
                  1e-15 * expected);
    }
}

TEST(ScatteringModel, GsabAtNormalIncidenceAndAtTheLobesHalfMaximum) {
  const double a = 0.3, c = 0.01, e = 0.04, b = 4 * degree, f = 17 * degree;
  const ScatteringModel all = ScatteringModel::gsab({a, b, c, 3, e, f});
  EXPECT_NEAR(all.cross_section(pi / 2), a + c + e, 1e-15);
  EXPECT_NEAR(all.cross_section(1, 0), a + c + e, 1e-15);
  const double half = std::sqrt(2 * std::numbers::ln2);
  const ScatteringModel specular = ScatteringModel::gsab({.specular = a, .specular_width_rad = b});
  EXPECT_NEAR(specular.cross_section(pi / 2 - b * half), a / 2, 1e-14);
  const ScatteringModel transition = ScatteringModel::gsab({.transition = e, .transition_width_rad = f});
  EXPECT_NEAR(transition.cross_section(pi / 2 - f * half), e / 2, 1e-15);
  for (const double phi : {0.01, 0.2, 0.9, 1.4})
    EXPECT_NEAR(all.cross_section(pi / 2 - phi),
                a * std::exp(-phi * phi / (2 * b * b)) + c * std::pow(std::cos(phi), 3) +
                    e * std::exp(-phi * phi / (2 * f * f)),
                1e-16);
}

TEST(ScatteringModel, TablesReproduceTheirNodesAndAreLinearInDecibelsBetween) {
  const std::vector<double> angle{4, 11, 35.5, 80, 88}, level{-44, -30, -21.5, -23, -6};
  const ScatteringModel model = ScatteringModel::table(angle, level);
  for (std::size_t k = 0; k < angle.size(); ++k)
    EXPECT_NEAR(decibels(model.cross_section(angle[k] * degree)), level[k], 1e-12);
  for (std::size_t k = 0; k + 1 < angle.size(); ++k)
    for (const double share : {0.1, 0.5, 0.9})
      EXPECT_NEAR(decibels(model.cross_section((angle[k] + share * (angle[k + 1] - angle[k])) * degree)),
                  level[k] + share * (level[k + 1] - level[k]), 1e-12);
  EXPECT_NEAR(decibels(model.cross_section(90 * degree)), -6, 1e-12);  // constant beyond the last node
  EXPECT_NEAR(model.cross_section(2 * degree) / model.cross_section(4 * degree),
              std::pow(std::sin(2 * degree) / std::sin(4 * degree), 2), 1e-13);  // Lambert's law below
  EXPECT_FALSE(model.is_pointed());
  EXPECT_TRUE(ScatteringModel::table(std::vector{10.0, 90.0}, std::vector{-30.0, -20.0}).is_pointed());
  EXPECT_NEAR(
      decibels(ScatteringModel::table(std::vector{90.0}, std::vector{-20.0}).cross_section(30 * degree)),
      -20 + 20 * std::log10(0.5), 1e-12);
}

TEST(ScatteringModel, LambertAsATableConvergesToLambertAtSecondOrder) {
  const double mu = 0.02;
  double worst[2] = {0, 0};
  for (const int fine : {0, 1}) {
    std::vector<double> angle, level;
    const double step = fine == 0 ? 2 : 1;
    for (double grazing = 4; grazing <= 90; grazing += step) {
      angle.push_back(grazing);
      level.push_back(decibels(lambert_cross_section(mu, grazing * degree)));
    }
    const ScatteringModel model = ScatteringModel::table(angle, level);
    for (double grazing = 0.3; grazing < 90; grazing += 0.3)
      worst[fine] = std::max(
          worst[fine],
          std::abs(model.cross_section(grazing * degree) / lambert_cross_section(mu, grazing * degree) - 1));
  }
  EXPECT_LT(worst[0], 0.07);
  EXPECT_LT(worst[1], worst[0] / 3);
  EXPECT_GT(worst[1], worst[0] / 6);
}

TEST(ScatteringModel, PiecesMeetAndCoverAllAngles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(0.5, 12), jump(-5, 5);
  for (int run = 0; run < 50; ++run) {
    std::vector<double> angle{step(random)}, level{-30};
    while (angle.back() < 75) {
      angle.push_back(angle.back() + step(random));
      level.push_back(level.back() + jump(random));
    }
    const ScatteringModel model = ScatteringModel::table(angle, level);
    const auto& pieces = model.pieces();
    EXPECT_EQ(pieces.front().from, 0);
    EXPECT_EQ(pieces.back().to, pi / 2);
    for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
      ASSERT_EQ(pieces[k].to, pieces[k + 1].from);
      const double at = pieces[k].to;
      EXPECT_NEAR(ScatteringModel::in_piece(pieces[k], at, std::cos(at)) /
                      ScatteringModel::in_piece(pieces[k + 1], at, std::cos(at)),
                  1, 1e-12);
      EXPECT_EQ(model.piece_at(at), k + 1);
      EXPECT_EQ(model.piece_at(std::nextafter(at, 0)), k);
    }
  }
}

/// Returns the ratio of scattered to incident energy, by a quadrature that does not use the pieces of the
/// model.
double albedo_by_quadrature(const ScatteringModel& model, double grazing) {
  const auto ring = [&](double s) {
    return 2 * pi * std::cos(s) * std::sqrt(model.cross_section(grazing) * model.cross_section(s));
  };
  double sum = 0;
  for (int k = 0; k < 360; ++k)
    sum += boost::math::quadrature::gauss_kronrod<double, 15>::integrate(ring, k * degree / 4,
                                                                         (k + 1) * degree / 4, 4, 1e-10);
  return sum / std::sin(grazing);
}

TEST(ScatteringModel, AlbedoIsWhatAQuadratureFinds) {
  const double mu = 0.03;
  const ScatteringModel lambert = ScatteringModel::lambert(mu);
  for (const double grazing : {0.01, 0.3, 1.0, pi / 2}) EXPECT_NEAR(lambert.albedo(grazing), pi * mu, 1e-13);
  EXPECT_NEAR(lambert.largest_albedo().value, pi * mu, 1e-13);
  EXPECT_NEAR(ScatteringModel::lambert(1 / pi).albedo(0.5), 1, 1e-12);

  const ScatteringModel gsab = ScatteringModel::gsab({0.4, 5 * degree, 0.01, 1.5, 0.02, 25 * degree});
  const std::vector<double> angle{5, 20, 40, 70, 90}, level{-35, -20, -18, -25, -5};
  const ScatteringModel table = ScatteringModel::table(angle, level);
  for (const ScatteringModel* model : {&gsab, &table}) {
    double largest = 0;
    for (const double grazing : {0.1, 1.0, 5.0, 20.0, 40.0, 62.0, 70.0, 90.0}) {
      const double expected = albedo_by_quadrature(*model, grazing * degree);
      EXPECT_NEAR(model->albedo(grazing * degree), expected, 1e-7 * expected);
      largest = std::max(largest, expected);
    }
    EXPECT_GT(model->largest_albedo().value, largest * (1 - 1e-7));
    EXPECT_NEAR(model->albedo(model->largest_albedo().grazing_rad), model->largest_albedo().value, 1e-12);
  }
  // An exponent below Lambert's gives a larger albedo at lower grazing angles: 2 pi C / (1 + D / 2)
  // sin^(D/2 - 1).
  const ScatteringModel flat = ScatteringModel::gsab({.oblique = 0.01, .oblique_exponent = 1});
  EXPECT_NEAR(flat.albedo(0.02), 2 * pi * 0.01 / 1.5 / std::sqrt(std::sin(0.02)), 1e-6);
  EXPECT_NEAR(flat.largest_albedo().grazing_rad, 0.1 * degree, 1e-9);
}

TEST(ScatteringModel, LargestAlbedoIsFoundAtAKinkBetweenTheSteps) {
  const double grazing_deg[] = {10, 30.05, 60}, strength_db[] = {-60, -10, -60};
  const ScatteringModel model = ScatteringModel::table(grazing_deg, strength_db);
  EXPECT_NEAR(model.largest_albedo().grazing_rad, 30.05 * degree, 1e-12);
}

TEST(ScatteringModel, FunctionOfAnotherAngleHasTheValuesAtItsOwnAngle) {
  const ScatteringModel::Gsab p{.specular = 0.3,
                                .specular_width_rad = 0.2,
                                .oblique = 0.1,
                                .oblique_exponent = 1.5,
                                .transition = 0.05,
                                .transition_width_rad = 0.7};
  const auto lobe = [](double angle, double width) { return std::exp(-angle * angle / (2 * width * width)); };
  constexpr double sines = 1.1;
  for (const double from : {-0.1, 0.0, 0.05})
    for (const double stretch : {0.9, 1.2}) {
      const ScatteringModel model = ScatteringModel::gsab(p).of_angle(from, stretch, sines);
      for (const double angle : {0.0, 0.05, 0.15, 0.6, 1.2}) {
        const double own = from + stretch * angle;
        const double expected = p.specular * lobe(own, p.specular_width_rad) +
                                p.oblique * std::pow(sines * std::cos(angle), p.oblique_exponent) +
                                p.transition * lobe(own, p.transition_width_rad);
        EXPECT_NEAR(model.cross_section(pi / 2 - angle) / expected, 1, 1e-13)
            << from << " " << stretch << " " << angle;
      }
    }
}

TEST(ScatteringModel, RefusesWhatIsNoLaw) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(ScatteringModel::gsab({}), std::invalid_argument);
  EXPECT_THROW(ScatteringModel::gsab({.oblique = -1}), std::invalid_argument);
  EXPECT_THROW(ScatteringModel::gsab({.oblique = nan}), std::invalid_argument);
  EXPECT_THROW(ScatteringModel::gsab({.oblique = 1, .oblique_exponent = -0.1}), std::invalid_argument);
  EXPECT_THROW(ScatteringModel::gsab({.oblique = 1, .oblique_exponent = infinite}), std::invalid_argument);
  EXPECT_THROW(ScatteringModel::gsab({.specular = 1, .specular_width_rad = 0}), std::invalid_argument);
  EXPECT_THROW(ScatteringModel::gsab({.transition = 1, .transition_width_rad = nan}), std::invalid_argument);
  using Values = std::vector<double>;
  const auto table = [](const Values& angle, const Values& level) { ScatteringModel::table(angle, level); };
  EXPECT_THROW(table({}, {}), std::invalid_argument);
  EXPECT_THROW(table({10, 20}, {-20}), std::invalid_argument);
  EXPECT_THROW(table({0, 20}, {-20, -20}), std::invalid_argument);
  EXPECT_THROW(table({20, 20}, {-20, -20}), std::invalid_argument);
  EXPECT_THROW(table({30, 20}, {-20, -20}), std::invalid_argument);
  EXPECT_THROW(table({30, 91}, {-20, -20}), std::invalid_argument);
  EXPECT_THROW(table({nan}, {-20}), std::invalid_argument);
  EXPECT_THROW(table({30}, {nan}), std::invalid_argument);
  EXPECT_THROW(table({30}, {-301}), std::invalid_argument);
  EXPECT_THROW(table({30, std::nextafter(30.0, 40.0)}, {-20, -20}), std::invalid_argument);
}

TEST(SedimentBackscatter, PublishedLevels) {
  EXPECT_EQ(sediment_names().size(), 8u);
  const auto at = [](std::string_view name, double khz, double grazing) {
    const SedimentBackscatter& s = sediment_backscatter(name, khz);
    return decibels(
        ScatteringModel::table(sediment_grazing_deg, s.strength_db).cross_section(grazing * degree));
  };
  EXPECT_NEAR(at("coarse sand", 300, 30), -14.97, 1e-9);
  EXPECT_NEAR(at("medium sand", 300, 60), -16.76, 1e-9);
  EXPECT_NEAR(at("sandy gravel", 300, 80), -22.74, 1e-9);
  EXPECT_NEAR(at("silt", 20, 90), -1.55, 1e-9);
  EXPECT_NEAR(at("rough rock", 20, 5), -30.59, 1e-9);
  // Equivalent Lambert parameters at 300 kHz from 20, 30 and 45 degrees (physics sheet 3.3), to 0.1 dB.
  const struct {
    const char* name;
    double mu_db[3];
  } lambert[] = {{"rock", {-5.4, -7.4, -11.0}},          {"cobble", {-3.1, -5.4, -13.4}},
                 {"sandy gravel", {-2.6, -5.2, -13.6}},  {"coarse sand", {-9.3, -9.0, -12.1}},
                 {"medium sand", {-12.3, -12.2, -15.7}}, {"fine sand", {-16.2, -17.5, -19.6}},
                 {"silt", {-22.5, -23.9, -25.3}}};
  for (const auto& s : lambert)
    for (int k = 0; k < 3; ++k) {
      const double grazing = std::array{20.0, 30.0, 45.0}[std::size_t(k)];
      EXPECT_NEAR(at(s.name, 300, grazing) - 20 * std::log10(std::sin(grazing * degree)), s.mu_db[k], 0.051)
          << s.name;
    }
  EXPECT_THROW(sediment_backscatter("granite", 300), std::invalid_argument);
  EXPECT_THROW(sediment_backscatter("rock", 100), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
