// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the forecast of the error of a perfect engine with few rays. The comparison is engines that draw
// random rays.
#include "compare/attribution/perfect_engine.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "compare/attribution/cut_tubes.hpp"
#include "engine/rays/ray_patch.hpp"
#include "files/usage_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/world/echoes.hpp"
#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

std::string scene_text(int beams, const std::string& more = {}) {
  return still_water() + lambert_material("sand", -18) + flat_terrain(40, 40) +
         "[[objects]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.6\nchord_error_m = 0.005\n"
         "position_m = [0, 6, 0.5]\n" +
         fixed_at(0, 0, 3) +
         fmt::format(
             "[[sensors]]\nname = \"sonar\"\nkind = \"didson\"\nbeams = {}\nhorizontal_deg = 24\n"
             "tilt_deg = 20\nvertical_deg = 20\nsamples = 120\nwindow_start_m = 5\nwindow_length_m = 12\n{}",
             beams, more);
}

struct Ran {
  TestFolder folder;
  SceneDescription description;
  EchoContents reference;

  explicit Ran(const std::string& text) : description(read_scene(folder, text)) {
    reference = run("reference", {"--reference", "--tolerance", "1e-6"});
  }
  EchoContents run(const std::string& name, const std::vector<std::string>& more) const {
    std::vector<std::string> words{
        "run", (folder / "scene.toml").string(), "-o", (folder / name).string(), "--quiet", "--pictures",
        "none"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    if (outcome.exit_code != 0) throw std::runtime_error(outcome.err);
    return read_echo_file(folder / name / "echoes.nc");
  }
  SceneAtHand scene() const {
    std::vector<std::string> notes;
    return {description, reference, false, notes};
  }
  EchoErrors errors(const EchoContents& candidate) const {
    const SensorEchoes& r = reference.sensors.front();
    return echo_errors(
        {{r.pings, r.beams, r.samples}, r.energy, candidate.sensors.front().energy, {}, r.slant_range_m});
  }
};

TEST(PerfectEngine, PoissonsMomentsAreTheirSums) {
  for (const double mean : {0.01, 0.3, 1.0, 2.5, 7.0, 40.0, 300.0}) {
    double deviation = 0, square = 0;
    for (int k = 0; k < 2000; ++k) {
      const double chance = std::exp(k * std::log(mean) - mean - std::lgamma(k + 1.0));
      deviation += chance * std::abs(k - mean) / mean;
      const double db = k == 0 ? -30 : 10 * std::log10(k / mean);
      square += chance * std::pow(std::clamp(db, -30.0, 30.0), 2);
    }
    EXPECT_NEAR(poisson_mean_deviation(mean) / deviation, 1, 1e-9) << mean;
    EXPECT_NEAR(poisson_square_db(mean) / square, 1, 1e-9) << mean;
  }
  // Many rays: a normal distribution.
  EXPECT_NEAR(poisson_mean_deviation(1e6) / (std::sqrt(2 / M_PI) * 1e-3), 1, 1e-5);
  EXPECT_NEAR(poisson_square_db(1001) / poisson_square_db(999), 999.0 / 1001, 2e-3);
  EXPECT_EQ(poisson_mean_deviation(0), 0);
}

TEST(PerfectEngine, RandomPointsHaveTheErrorThatIsForecast) {
  const Ran run(scene_text(24));
  const SceneAtHand scene = run.scene();
  for (const int points : {100, 2000}) {
    SCOPED_TRACE(points);
    const auto forecast = points_forecast(scene, run.reference.sensors.front(), {0, points});
    ASSERT_TRUE(forecast);
    constexpr int draws = 12;
    double l1 = 0, rms = 0, empty = 0;
    for (int seed = 1; seed <= draws; ++seed) {
      const EchoErrors errors =
          run.errors(run.run(fmt::format("r{}-{}", points, seed),
                             {"--engine", "ray", "--sampling", "random", "--rays-per-beam",
                              fmt::format("{}", points), "--seed", fmt::format("{}", seed)}));
      EXPECT_NEAR(errors.l1, forecast->l1, 5 * forecast->l1_deviation);
      l1 += errors.l1 / draws;
      rms += errors.rms_db / draws;
      empty += double(errors.empty_where_lit) / draws;
    }
    EXPECT_NEAR(l1, forecast->l1, 4 * forecast->l1_deviation / std::sqrt(draws) + 0.01 * forecast->l1);
    EXPECT_NEAR(rms, forecast->rms_db, 0.05 * forecast->rms_db);
    EXPECT_NEAR(empty, forecast->empty_where_lit, 0.05 * forecast->empty_where_lit + 3);
  }
}

TEST(PerfectEngine, OneColumnIsTheRayEngines) {
  const Ran run(scene_text(24));
  const EchoContents ideal = perfect_echoes(run.scene(), run.reference, {1, 300}, {}, false, true).energies;
  const EchoContents rays =
      run.run("column", {"--engine", "ray", "--sampling", "column", "--rays-per-beam", "300"});
  EXPECT_EQ(ideal.sensors.front().energy, rays.sensors.front().energy);
}

TEST(PerfectEngine, SolidAnglesAreThoseOfItsOwnRays) {
  const Ran run(scene_text(24));
  for (const BeamSampling& sampling : {BeamSampling{1, 300}, BeamSampling{4, 100}, BeamSampling{0, 500}}) {
    SCOPED_TRACE(sampling.option());
    const PerfectEchoes ideal = perfect_echoes(run.scene(), run.reference, sampling, {}, true, true);
    const SensorEchoes &energies = ideal.energies.sensors.front(),
                       &angles = ideal.solid_angles->sensors.front();
    // The mean strength of a bin, mu sin^2 of the grazing angle, is at most mu, up to the length of the bin.
    const double mu = std::pow(10, -1.8);
    double sum = 0;
    for (std::size_t bin = 0; bin < energies.energy.size(); ++bin) {
      EXPECT_EQ(energies.energy[bin] > 0, angles.energy[bin] > 0);
      const double r = energies.slant_range_m[bin % energies.samples];
      if (angles.energy[bin] > 0) {
        EXPECT_LT(energies.energy[bin] / angles.energy[bin], 1.05 * mu);
      }
      sum += angles.energy[bin] * r * r;
    }
    // Beams of 1 x 20 degrees; the seabed and the sphere fill less than all of them.
    const double whole = 24 * (M_PI / 180) * 2 * std::sin(10 * M_PI / 180);
    EXPECT_GT(sum, 0.5 * whole);
    EXPECT_LT(sum, 1.01 * whole);
    if (sampling.columns != 1) continue;
    // The ray engine merges facets in one plane, which changes the rounding only.
    const std::vector<double> same =
        perfect_echoes(run.scene(), run.reference, sampling, {}, false, true).energies.sensors.front().energy;
    double off = 0, total = 0;
    for (std::size_t bin = 0; bin < same.size(); ++bin) {
      off += std::abs(same[bin] - energies.energy[bin]);
      total += same[bin];
    }
    EXPECT_LT(off, 1e-9 * total);
  }
}

TEST(PerfectEngine, ColumnsAreThoseOfBeamsAsManyTimesNarrower) {
  const Ran run(scene_text(24)), narrow(scene_text(96));
  const EchoContents ideal = perfect_echoes(run.scene(), run.reference, {4, 500}, {}, false, true).energies;
  const EchoContents rays =
      narrow.run("column", {"--engine", "ray", "--sampling", "column", "--rays-per-beam", "500"});
  const SensorEchoes &four = ideal.sensors.front(), &quarter = rays.sensors.front();
  double apart = 0, total = 0;
  for (std::size_t b = 0; b < four.beams; ++b)
    for (std::size_t k = 0; k < four.samples; ++k) {
      double sum = 0;
      for (std::size_t c = 0; c < 4; ++c) sum += quarter.at(0, 4 * b + c, k);
      apart += std::abs(sum - four.at(0, b, k));
      total += sum;
    }
  EXPECT_LT(apart / total, 2e-3);
  EXPECT_LT(run.errors(ideal).l1,
            run.errors(perfect_echoes(run.scene(), run.reference, {1, 500}, {}, false, true).energies).l1);
}

TEST(PerfectEngine, CutTubesAreTheTubeAndTheirColumnsAreStacks) {
  // A beam of 2 x 3 tubes, longer upwards, and one of a single tube, longer sideways.
  TubeSet set;
  append_tubes(set, {{0, 0.01, 0.02}, {-0.3, -0.2, -0.1, 0}});
  append_tubes(set, {{0.5, 1.0}, {0, 0.05}});
  const std::vector<std::uint32_t> beams{0, 0, 0, 0, 0, 0, 1};
  const CutTubes cut = cut_into_columns(set, beams, 4);
  ASSERT_EQ(cut.set.tubes.size(), 2U * 6 + 4);
  std::vector<double> solid_angle(set.tubes.size());
  std::map<std::uint32_t, std::vector<std::uint32_t>> columns;
  for (std::size_t part = 0; part < cut.set.tubes.size(); ++part) {
    const RayPatch patch(cut.set, cut.set.tubes[part]);
    EXPECT_TRUE(patch.is_convex());
    solid_angle.at(cut.whole[part]) += patch.solid_angle(0, 1, 0, 1);
    columns[cut.column[part]].push_back(static_cast<std::uint32_t>(part));
  }
  for (std::size_t tube = 0; tube < set.tubes.size(); ++tube)
    EXPECT_NEAR(solid_angle[tube] / RayPatch(set, set.tubes[tube]).solid_angle(0, 1, 0, 1), 1, 1e-6) << tube;
  // Columns of the first beam are stacks of three parts that share their walls. Those of the other beam
  // have one part each.
  EXPECT_EQ(columns.size(), 8U);
  for (const auto& [column, parts] : columns) {
    EXPECT_EQ(parts.size(), beams[cut.whole[parts[0]]] == 0 ? 3U : 1U);
    std::set<std::uint32_t> rays;
    for (const std::uint32_t part : parts)
      rays.insert(cut.set.tubes[part].begin(), cut.set.tubes[part].end());
    EXPECT_EQ(rays.size(), 2 * parts.size() + 2);
  }
  EXPECT_THROW(cut_into_columns(set, beams, 3), std::invalid_argument);
}

TEST(PerfectEngine, SamplingIsReadOrAFile) {
  EXPECT_EQ(beam_sampling("1x512")->words(), "1 x 512 rays per beam");
  EXPECT_EQ(beam_sampling("3x20")->columns, 3);
  EXPECT_EQ(beam_sampling("points:77")->words(), "77 random points per beam");
  for (const char* file : {"out/1x5/echoes.nc", "x", "1x", "x5", "ideal.nc", "-1x5", "1x5x7", "./1x512", ""})
    EXPECT_FALSE(beam_sampling(file)) << file;
  for (const char* wrong : {"0x5", "1x0", "1001x5", "points:0", "points:-3", "points:", "points:1e3"})
    EXPECT_THROW(beam_sampling(wrong), UsageError) << wrong;
}

TEST(PerfectEngine, SeparateReceiversHaveOneColumnAndNoForecast) {
  const Ran run(scene_text(8, "receiver_arm_m = [0.3, 0, 0]\n"));
  const SceneAtHand scene = run.scene();
  EXPECT_FALSE(points_forecast(scene, run.reference.sensors.front(), {0, 100}));
  EXPECT_THROW(perfect_echoes(scene, run.reference, {4, 100}, {}, false, true).energies, UsageError);
  EXPECT_LT(run.errors(perfect_echoes(scene, run.reference, {1, 20000}, {}, false, true).energies).l1, 0.2);
}

TEST(PerfectEngine, SharesAreOfTheErrorAndAtMostAll) {
  IdealShare share{"1 x 512 rays per beam", 0.051, 3.1, 0.052, {}};
  EXPECT_NEAR(share.explained(), 0.98, 0.005);
  EXPECT_THAT(ideal_text(share),
              testing::HasSubstr("a perfect engine with 1 x 512 rays per beam would have L1 0.051"));
  EXPECT_THAT(ideal_text(share),
              testing::HasSubstr("the candidate has 0.052: sampling explains 98 % of the error"));
  share.yours_l1 = 0.05;
  EXPECT_EQ(share.explained(), 1);
  share.yours_l1 = 0;
  EXPECT_EQ(share.explained(), 1);
}

}  // namespace
}  // namespace tubefoot
