// SPDX-License-Identifier: GPL-3.0-or-later
// Tests runs of sonars of underwater robots: beams at listed angles, vertical patterns on both legs, and a
// scanning head.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/csv_rows.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double height_m = 4;

std::string scene(const std::string& sensor, const std::string& carried = fixed_at(0, 0, height_m)) {
  return still_water() + lambert_material("bed", -27) + flat_terrain(128, 128) +
         "[[objects]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 1\nposition_m = [1, 9, 1]\n" +
         carried + "[[sensors]]\nname = \"s\"\nrange_min_m = 5\nrange_max_m = 20\nsamples = 60\n" + sensor;
}

std::vector<double> by_sample(const Echoes& echoes) {
  std::vector<double> sums(echoes.samples, 0);
  for (std::size_t beam = 0; beam < echoes.beams; ++beam)
    for (std::size_t k = 0; k < echoes.samples; ++k) sums[k] += echoes.at(0, beam, k);
  return sums;
}

// Borders of the listed beams, midway between their axes: -30, -20, -12, 0, 12, 20, 30.
TEST(ListedBeams, ShareOutTheSameEnergy) {
  const std::string fan = "kind = \"imaging\"\nvertical_deg = 30\ntilt_deg = 15\ncone_tolerance = 1e-7\n";
  const Echoes even = echoes_of(scene(fan + "beams = 6\nhorizontal_deg = 60\n")),
               listed = echoes_of(scene(fan + "beam_angles_deg = [-25, -15, -9, 9, 15, 25]\n"));
  ASSERT_EQ(listed.beams, 6u);
  EXPECT_THAT(listed.beam_azimuth_deg,
              testing::Pointwise(testing::DoubleNear(1e-12), {-25, -15, -9, 9, 15, 25}));
  const std::vector<double> a = by_sample(even), b = by_sample(listed);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-6 * a[k]) << k;
  for (const std::size_t outermost : {0u, 5u})
    EXPECT_NEAR(listed.beam_total(0, outermost), even.beam_total(0, outermost),
                1e-6 * even.beam_total(0, outermost));
  EXPECT_GT(listed.beam_total(0, 2), 1.05 * even.beam_total(0, 2)) << "12 degrees wide, not 10";
}

TEST(ListedBeams, OfEqualAnglesAreAnEquiangularFan) {
  const std::string fan = "tilt_deg = 15\ncone_tolerance = 1e-7\n";
  EXPECT_LT(largest_relative_difference(
                echoes_of(scene("kind = \"imaging\"\nbeams = 4\nhorizontal_deg = 8\n" + fan)),
                echoes_of(scene("kind = \"imaging\"\nbeam_angles_deg = [-3, -1, 1, 3]\n" + fan))),
            1e-6);
  EXPECT_LT(largest_relative_difference(
                echoes_of(scene("kind = \"multibeam\"\nbeams = 5\nswath_deg = 80\nspacing = \"angle\"\n")),
                echoes_of(scene("kind = \"multibeam\"\nbeam_angles_deg = [-40, -20, 0, 20, 40]\n"))),
            1e-9);
}

// On a flat seabed a range bin is a band of elevations, over which a Gaussian about the horizontal
// decreases.
TEST(VerticalPatterns, WeighEachElevationByTheirProduct) {
  const std::string fan =
      "kind = \"imaging\"\nbeams = 3\nhorizontal_deg = 9\nyaw_deg = 120\nvertical_deg = 120\n";
  const auto gaussian = [](const std::string& way, double width_deg) {
    return way + "_pattern = \"gaussian\"\n" + way + "_pattern_angle = \"elevation\"\n" + way +
           "_beam_width_deg = " + std::to_string(width_deg) + "\n";
  };
  const Echoes ideal = echoes_of(scene(fan)), received = echoes_of(scene(fan + gaussian("receive", 25))),
               sent = echoes_of(scene(fan + gaussian("transmit", 25))),
               both = echoes_of(scene(fan + gaussian("transmit", 40) + gaussian("receive", 25)));
  const auto power = [](double range_m, double width_deg) {
    const double angle = std::asin(height_m / range_m) / degree;
    return std::exp(-4 * std::numbers::ln2 * angle * angle / width_deg / width_deg);
  };
  for (std::size_t beam = 0; beam < 3; ++beam)
    for (std::size_t k = 0; k < ideal.samples; ++k) {
      const double near = ideal.first_m(k), far = ideal.last_m(k), energy = ideal.at(0, beam, k);
      ASSERT_GT(energy, 0);
      EXPECT_GE(received.at(0, beam, k) / energy, power(near, 25) * (1 - 1e-9)) << beam << ' ' << k;
      EXPECT_LE(received.at(0, beam, k) / energy, power(far, 25) * (1 + 1e-9)) << beam << ' ' << k;
      EXPECT_GE(both.at(0, beam, k) / energy, power(near, 25) * power(near, 40) * (1 - 1e-9));
      EXPECT_LE(both.at(0, beam, k) / energy, power(far, 25) * power(far, 40) * (1 + 1e-9));
      EXPECT_NEAR(received.at(0, beam, k), sent.at(0, beam, k), 1e-9 * energy)
          << "the way back is the way there";
    }
}

// A receive pattern along the track does not move the beams of a multibeam.
TEST(VerticalPatterns, AlongTheTrackAMultibeamKeepsItsBeams) {
  const std::string fan = "kind = \"multibeam\"\nbeams = 7\nswath_deg = 90\nalong_track_deg = 4\n";
  const Echoes ideal = echoes_of(scene(fan)),
               wide =
                   echoes_of(scene(fan + "receive_pattern = \"gaussian\"\nreceive_beam_width_deg = 170\n"));
  ASSERT_GT(ideal.total(), 0);
  for (std::size_t beam = 0; beam < 7; ++beam)
    for (std::size_t k = 0; k < ideal.samples; ++k) {
      // At 2 degrees off the track the pattern is exp(-4 ln 2 (2 / 170)^2).
      EXPECT_LE(wide.at(0, beam, k), ideal.at(0, beam, k) * (1 + 1e-9));
      EXPECT_GE(wide.at(0, beam, k), ideal.at(0, beam, k) * (1 - 4e-4));
    }
}

// The integration error of patterns is pattern_tolerance (src/engine/scattering/echo_model.hpp, 1e-6) times
// the energy of the peak gain, for each piece of a range bin.
TEST(VerticalPatterns, AreWithinTheirToleranceOfTheReference) {
  const std::string along = "receive_pattern = \"gaussian\"\nreceive_beam_width_deg = 2\n";
  const std::string both =
      "transmit_pattern = \"gaussian\"\ntransmit_pattern_angle = \"elevation\"\n"
      "transmit_beam_width_deg = 12\nreceive_pattern = \"gaussian\"\n"
      "receive_pattern_angle = \"elevation\"\nreceive_beam_width_deg = 15\n";
  const std::pair<std::string, std::string> sensors[] = {
      {"kind = \"imaging\"\nbeam_angles_deg = [-9, -2, 1, 6]\ntilt_deg = 30\n", both},
      {"kind = \"multibeam\"\nbeam_angles_deg = [-60, -50, 40]\nbeam_across_deg = 5\n", along}};
  for (const auto& [fan, patterns] : sensors) {
    SCOPED_TRACE(fan);
    const Echoes ideal = echoes_of(scene(fan)), plain = echoes_of(scene(fan + patterns)),
                 certified = echoes_of(scene(fan + patterns), {"--reference", "--tolerance", "1e-8"});
    for (std::size_t beam = 0; beam < plain.beams; ++beam) {
      double loudest = 0;
      for (std::size_t k = 0; k < plain.samples; ++k) loudest = std::max(loudest, ideal.at(0, beam, k));
      ASSERT_GT(loudest, 0) << beam;
      for (std::size_t k = 0; k < plain.samples; ++k)
        EXPECT_NEAR(plain.at(0, beam, k), certified.at(0, beam, k), 1e-5 * loudest) << beam << ' ' << k;
    }
  }
}

const std::string head =
    "kind = \"scanning\"\nscan_deg = 60\nstep_deg = 5\nbeam_horizontal_deg = 5\nbeam_vertical_deg = 30\n"
    "tilt_deg = 15\nstep_interval_s = 0.5\ncone_tolerance = 1e-7\n";

TEST(ScanningHead, AtRestReceivesWhatAFanOfItsStepsReceives) {
  const Echoes scan = echoes_of(scene(head)),
               fan = echoes_of(scene("kind = \"imaging\"\nfrequency_khz = 750\n"
                                     "beam_angles_deg = [-30, -25, -20, -15, -10, -5, 0, 5, 10, 15, 20, 25]\n"
                                     "vertical_deg = 30\ntilt_deg = 15\ncone_tolerance = 1e-7\n"));
  ASSERT_EQ(scan.beams, 12u);
  EXPECT_GT(scan.total(), 0);
  EXPECT_LT(largest_relative_difference(scan, fan), 1e-9);
  // A beam that is wider than its steps also receives the adjacent sectors: at three times the width, all
  // three.
  const Echoes wide = echoes_of(scene(replaced(head, "beam_horizontal_deg = 5", "beam_horizontal_deg = 15")));
  for (std::size_t k = 0; k < scan.samples; ++k) {
    const double three = scan.at(0, 5, k) + scan.at(0, 6, k) + scan.at(0, 7, k);
    EXPECT_NEAR(wide.at(0, 6, k), three, 1e-6 * three) << k;
  }
}

TEST(ScanningHead, LooksFromWhereItsCarrierIsByThen) {
  const std::string way =
      "[trajectory]\nkind = \"line\"\nstart_m = [0, 0, 4]\nend_m = [0, 3, 4]\nspeed_m_s = 0.5\n";
  const Echoes moving = echoes_of(scene(head, way));
  for (const std::size_t step : {0u, 4u, 11u}) {
    const Echoes there = echoes_of(scene(head, fixed_at(0, 0.25 * double(step), height_m)));
    for (std::size_t k = 0; k < there.samples; ++k)
      EXPECT_NEAR(moving.at(0, step, k), there.at(0, step, k), 1e-9 * there.beam_total(0, step))
          << step << ' ' << k;
  }
}

TEST(ScanningHead, WritesPicturesAndALineForEachStep) {
  const TestFolder folder;
  const Echoes scan = echoes_in(folder, scene(head + "pings = 2\nping_interval_s = 6\n"));
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    found += name == "s-0000.png" || name == "s-0001.exr" || name == "s-sequence.png";
    if (name != "s-steps.csv") continue;
    ++found;
    const auto rows = csv_rows(entry.path());
    ASSERT_EQ(rows.size(), 24u);
    const auto& row = rows[12 + 7];
    EXPECT_EQ(row.at("ping"), "1");
    EXPECT_EQ(row.at("step"), "7");
    EXPECT_DOUBLE_EQ(std::stod(row.at("time_s")), 6 + 7 * 0.5);
    EXPECT_NEAR(std::stod(row.at("head_deg")), -30 + 7 * 5, 1e-9);
    std::size_t loudest = 0;
    for (std::size_t k = 0; k < scan.samples; ++k)
      if (scan.at(1, 7, k) > scan.at(1, 7, loudest)) loudest = k;
    EXPECT_NEAR(std::stod(row.at("loudest_range_m")), (scan.first_m(loudest) + scan.last_m(loudest)) / 2,
                1e-6);
    EXPECT_NEAR(std::stod(row.at("loudest_energy_j")) / scan.at(1, 7, loudest), 1, 1e-8);
  }
  EXPECT_EQ(found, 4u);
}

}  // namespace
}  // namespace tubefoot
