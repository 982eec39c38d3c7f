// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the command `rays`: eigenrays and fans against closed forms, laws and independent searches; tables,
// pictures and rejected input.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "engine/water/eigenray.hpp"
#include "engine/water/unfolding.hpp"
#include "files/usage_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/test_folder.hpp"
#include "geometry/numbers/scalars.hpp"
#include "propagation/arrivals.hpp"
#include "propagation/ray_path.hpp"
#include "propagation/rays_output.hpp"
#include "propagation/rays_request.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

WaterColumn isovelocity(double speed = 1500) { return {SoundSpeedProfile(speed), {}}; }

WaterColumn gradient_water(double speed, double gradient, double bottom_m) {
  return {SoundSpeedProfile({{0, speed}, {bottom_m, speed + gradient * bottom_m}}), {}};
}

WaterColumn munk_water(double step_m) {
  return {
      SoundSpeedProfile(sample_profile([](double z) { return munk_sound_speed_m_s(z); }, 0, 5000, step_m)),
      {}};
}

/// A table with a header, by the names of its columns.
using Rows = std::vector<std::map<std::string, std::string>>;
Rows rows_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::vector<std::string> names;
  Rows rows;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == ',')
        cells.emplace_back();
      else
        cells.back() += c;
    }
    if (names.empty()) {
      names = cells;
      continue;
    }
    EXPECT_EQ(cells.size(), names.size()) << line;
    rows.emplace_back();
    for (std::size_t k = 0; k < std::min(cells.size(), names.size()); ++k) rows.back()[names[k]] = cells[k];
  }
  return rows;
}
double number_in(const std::map<std::string, std::string>& row, const std::string& column) {
  return std::stod(row.at(column));
}

// Images of the source in surface and bottom give every path of isovelocity water.
TEST(RayArrivals, EqualTheImagesInIsovelocityWater) {
  const WaterColumn water = isovelocity();
  constexpr double deep_m = 80, source_m = 23, point_m = 61;
  for (const double range_m : {40.0, 300.0, 5000.0, 100e3, 1e6}) {
    constexpr int most = 5;
    const std::vector<RayArrival> found =
        arrivals(water, source_m, point_m, range_m,
                 {.surface_m = 0, .bottom_m = deep_m, .most_turns = 0, .most_reflections = most});
    // Depths of the point's images: 2 n D + z and 2 n D - z.
    struct Image {
      double depth_m;
      int surface, bottom;
    };
    std::vector<Image> images;
    for (int n = -most; n <= most; ++n) {
      images.push_back({2 * n * deep_m + point_m, std::abs(n), std::abs(n)});
      images.push_back({2 * n * deep_m - point_m, n > 0 ? n - 1 : 1 - n, n > 0 ? n : -n});
    }
    std::erase_if(images, [](const Image& i) { return i.surface + i.bottom > most; });
    const auto length = [&](const Image& i) { return std::hypot(range_m, i.depth_m - source_m); };
    std::ranges::sort(images, {}, length);
    ASSERT_EQ(found.size(), images.size()) << range_m;
    for (std::size_t k = 0; k < images.size(); ++k) {
      const double launch = std::atan2(images[k].depth_m - source_m, range_m);
      EXPECT_NEAR(found[k].launch_rad, launch, 1e-11);
      const bool odd = (images[k].surface + images[k].bottom) % 2 != 0;
      EXPECT_NEAR(found[k].arrival_rad, odd ? -launch : launch, 1e-11);
      EXPECT_NEAR(found[k].time_s, length(images[k]) / 1500, 1e-13 * length(images[k]));
      EXPECT_NEAR(found[k].tube_area_m2_per_sr / std::pow(length(images[k]), 2), 1, 1e-9);
      EXPECT_EQ(found[k].surface_reflections, images[k].surface);
      EXPECT_EQ(found[k].bottom_reflections, images[k].bottom);
      EXPECT_FALSE(found[k].crossed);
    }
  }
}

TEST(RayArrivals, EqualTheImagesOnAVerticalLine) {
  const std::vector<RayArrival> found =
      arrivals(isovelocity(), 20, 50, 0, {.surface_m = 0, .bottom_m = 80, .most_reflections = 3});
  std::vector<double> lengths_m;
  for (const RayArrival& ray : found) lengths_m.push_back(ray.time_s * 1500);
  EXPECT_THAT(lengths_m, testing::Pointwise(testing::DoubleNear(1e-9), {30, 70, 90, 130, 190, 230, 250}));
  EXPECT_EQ(found[1].surface_reflections, 1);
  EXPECT_NEAR(found[1].launch_rad, -90 * degree, 1e-12);
  EXPECT_NEAR(found[1].arrival_rad, 90 * degree, 1e-12);
  EXPECT_EQ(found[2].bottom_reflections, 1);
  EXPECT_NEAR(found[2].arrival_rad, -90 * degree, 1e-12);
}

// Closed forms of one gradient: cosh(g t) = 1 + g^2 d^2 / (2 c1 c2), A = (c2 sinh(g t) / g)^2.
TEST(RayArrivals, AreCirclesInOneGradient) {
  constexpr double c0 = 1490, g = 0.03;
  const WaterColumn water = gradient_water(c0, g, 2000);
  std::mt19937 random(20261130);
  std::uniform_real_distribution<double> depth(900, 1100), range(10, 3000);
  for (int k = 0; k < 50; ++k) {
    const double from_m = depth(random), to_m = depth(random), range_m = range(random);
    const std::vector<RayArrival> found = arrivals(water, from_m, to_m, range_m, {.surface_m = 0});
    ASSERT_GE(found.size(), 1U);
    const double c1 = c0 + g * from_m, c2 = c0 + g * to_m;
    const double cosh1 = g * g * (range_m * range_m + std::pow(to_m - from_m, 2)) / (2 * c1 * c2);
    const double time_s = std::log1p(cosh1 + std::sqrt(cosh1 * (cosh1 + 2))) / g;
    EXPECT_NEAR(found[0].time_s, time_s, 1e-12 * time_s);
    EXPECT_NEAR(found[0].tube_area_m2_per_sr / std::pow(c2 * std::sinh(g * time_s) / g, 2), 1, 1e-9);
    // The centre of the circle lies where the sound speed would be 0.
    const double centre_m =
        (range_m * range_m + (to_m - from_m) * (to_m + from_m + 2 * c0 / g)) / (2 * range_m);
    EXPECT_NEAR(found[0].launch_rad, std::atan2(centre_m, from_m + c0 / g), 1e-9);
  }
}

// The search for reflected rays must equal the monotone rays through the unfolded water, where no ray turns
// between its reflections.
TEST(RayArrivals, EqualTheUnfoldedWater) {
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {20, 1497}, {45, 1490}, {90, 1492}}), {}};
  const double source_m = 12;
  std::size_t compared = 0;
  for (const double range_m : {15.0, 60.0, 200.0})
    for (const double depth_m : {4.0, 33.0, 77.0}) {
      const ArrivalOptions options{.surface_m = 0, .bottom_m = 90, .most_turns = 3, .most_reflections = 3};
      const std::vector<RayArrival> found = arrivals(water, source_m, depth_m, range_m, options);
      for (const bool up_first : {true, false}) {
        std::vector<double> mirrors;
        bool up = up_first;
        for (int n = 1; n <= 3; ++n, up = !up) {
          mirrors.push_back(up ? 0 : -90);
          const UnfoldedWater unfolded = unfold(water, {0, 90, 0}, 0, mirrors, up_first);
          const EigenrayFinder finder(unfolded.water, source_m, unfolded.rays);
          const auto ray = finder.direct(-unfolded.unfolding.height_m(-depth_m), range_m);
          if (!ray) continue;
          const auto same = std::ranges::find_if(found, [&](const RayArrival& a) {
            return a.reflections() == n &&
                   std::abs(a.launch_rad - std::atan2(ray->launch_sine, ray->launch_cosine)) < 1e-9;
          });
          ASSERT_NE(same, found.end()) << range_m << " " << depth_m << " " << n;
          EXPECT_NEAR(same->time_s, ray->time_s, 1e-12);
          EXPECT_NEAR(same->tube_area_m2_per_sr / ray->tube_area_m2_per_sr, 1, 1e-8);
          ++compared;
        }
      }
    }
  EXPECT_GE(compared, 50U);
}

// Exchanging source and point reverses every path. Time, loss and reflections stay, and A c^2 at the start is
// the same.
TEST(RayArrivals, AreReciprocal) {
  const WaterColumn water = munk_water(50);
  const ArrivalOptions options{.surface_m = 0, .bottom_m = 5000, .most_turns = 8, .most_reflections = 3};
  const double a_m = 700, b_m = 1900;
  const std::vector<RayArrival> there = arrivals(water, a_m, b_m, 55e3, options),
                                back = arrivals(water, b_m, a_m, 55e3, options);
  ASSERT_EQ(there.size(), back.size());
  ASSERT_GE(there.size(), 6U);
  const double ratio = std::pow(water.profile.at(a_m) / water.profile.at(b_m), 2);
  for (const RayArrival& ray : there) {
    const auto same = std::ranges::min_element(back, {}, [&](const RayArrival& other) {
      return std::abs(other.launch_rad + ray.arrival_rad) + std::abs(other.arrival_rad + ray.launch_rad);
    });
    EXPECT_NEAR(same->time_s, ray.time_s, 1e-9);
    EXPECT_NEAR(same->launch_rad, -ray.arrival_rad, 1e-9);
    EXPECT_EQ(same->reflections(), ray.reflections());
    EXPECT_EQ(same->crossed, ray.crossed);
    EXPECT_NEAR(ray.tube_area_m2_per_sr * ratio / same->tube_area_m2_per_sr, 1, 1e-5);
    EXPECT_EQ(same->turning_depths_m.size(), ray.turning_depths_m.size());
  }
}

// A ray that is refracted upwards and reflected at the surface repeatedly turns between its reflections.
TEST(RayArrivals, SkipAlongASurfaceDuct) {
  constexpr double c0 = 1500, g = 0.016, depth_m = 20;
  const WaterColumn water = gradient_water(c0, g, 3000);
  const std::vector<RayArrival> found =
      arrivals(water, depth_m, depth_m, 30e3, {.surface_m = 0, .most_turns = 0, .most_reflections = 4});
  // A cycle from surface to surface at the angle t is 2 c0 tan(t) / g long. Three cycles lead to 30 km.
  const double at_surface = std::atan(g * 10e3 / (2 * c0)),
               launch = std::acos(std::cos(at_surface) * (c0 + g * depth_m) / c0);
  std::size_t full_cycles = 0;
  for (const RayArrival& ray : found) {
    if (std::abs(ray.launch_rad - ray.arrival_rad) > 1e-6 || ray.surface_reflections != 3) continue;
    ++full_cycles;
    EXPECT_NEAR(std::abs(ray.launch_rad), launch, 1e-9);
    ASSERT_EQ(ray.turning_depths_m.size(), 3U);
    for (const double turned_m : ray.turning_depths_m)
      EXPECT_NEAR(turned_m, c0 / g * (1 / std::cos(at_surface) - 1), 1e-6);
    EXPECT_NEAR(ray.time_s, 3 * 2 * std::atanh(std::sin(at_surface)) / g, 1e-9);
  }
  EXPECT_EQ(full_cycles, 2U);  // launched upwards and downwards
}

// A finer search finds the same rays.
TEST(RayArrivals, DoNotDependOnTheStep) {
  const WaterColumn water = munk_water(100);
  std::size_t rays = 0;
  for (int k = 0; k < 8; ++k) {
    ArrivalOptions options{.surface_m = 0, .bottom_m = 5000, .most_turns = 0, .most_reflections = 4};
    const double depth_m = 300 + 350 * k, range_m = 11e3 + 6.1e3 * k;
    const std::vector<RayArrival> coarse = arrivals(water, 1000, depth_m, range_m, options);
    options.finest_rad = 4e-4;
    const std::vector<RayArrival> fine = arrivals(water, 1000, depth_m, range_m, options);
    ASSERT_EQ(coarse.size(), fine.size()) << range_m;
    for (std::size_t i = 0; i < fine.size(); ++i) EXPECT_NEAR(coarse[i].time_s, fine[i].time_s, 1e-9);
    rays += fine.size();
  }
  EXPECT_GE(rays, 40U);
}

// Source and point may lie on the reflectors.
TEST(RayArrivals, EqualTheImagesOfEndsOnTheReflectors) {
  const ArrivalOptions options{.surface_m = 0, .bottom_m = 80, .most_turns = 0, .most_reflections = 4};
  for (const double range_m : {0.0, 150.0}) {
    const std::vector<RayArrival> found = arrivals(isovelocity(), 0, 80, range_m, options);
    ASSERT_EQ(found.size(), 3U) << range_m;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double length_m = std::hypot(range_m, 80.0 * static_cast<double>(2 * k + 1));
      EXPECT_NEAR(found[k].time_s * 1500, length_m, 2e-6);
      EXPECT_EQ(found[k].surface_reflections, static_cast<int>(k));
      EXPECT_EQ(found[k].bottom_reflections, static_cast<int>(k));
    }
  }
}

TEST(RayPoints, LieOnTheCircle) {
  constexpr double c0 = 1500, g = 0.05;
  const WaterColumn water = gradient_water(c0, g, 1000);
  const auto nodes = trace_ray(water, 500, 8 * degree, {.longest_range_m = 8000});
  const std::vector<PathPoint> points = points_along(nodes, 0.5 * degree);
  ASSERT_GE(points.size(), 20U);
  const double p = std::cos(8 * degree) / water.profile.at(500);
  for (const PathPoint& point : points) {
    if (point.range_m > nodes[1].state.range_m) break;
    EXPECT_NEAR(std::cos(point.angle_rad) / p, c0 + g * point.depth_m, 1e-8);
    // The trace to this range ends at the same place and time.
    if (point.range_m == 0) continue;
    const RayState end = trace_ray(water, 500, 8 * degree, {.longest_range_m = point.range_m}).back().state;
    EXPECT_NEAR(point.depth_m, end.depth_m, 1e-7);
    EXPECT_NEAR(point.time_s, end.time_s, 1e-11);
    EXPECT_NEAR(point.length_m, end.length_m, 1e-7);
  }
}

TEST(RayPoints, KeepTheSideOfAReflection) {
  const auto nodes = trace_ray(isovelocity(), 30, -20 * degree, {.surface_m = 0, .longest_range_m = 200});
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_EQ(points_along(nodes, degree).size(), 3U);  // straight pieces need no points
  EXPECT_EQ(nodes[1].event, RayEvent::surface);
}

struct RaysCommand : testing::Test {
  TestFolder folder;
  const std::string profile = (folder / "channel.csv").string(), scene = (folder / "scene.toml").string();
  RaysCommand() {
    folder.write("channel.csv", "depth_m,sound_speed_m_s\n0,1500\n100,1490\n200,1500\n");
    folder.write("thing.obj", tetrahedron);
    folder.write("scene.toml", small_scene);
  }
};

TEST_F(RaysCommand, PrintsATableWithUnitsAndFullPrecision) {
  const Outcome outcome = run_program({"rays", "--profile", profile, "--from", "0,0,-100", "--to",
                                       "3000,4000,-150", "--frequency-khz", "12", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              StartsWith("point,x_m,y_m,z_m,range_m,depth_m,bearing_deg,eigenrays,eigenray,launch_down_deg,"
                         "arrival_down_deg,time_s,length_m,spreading_loss_db,absorption_db,"
                         "transmission_loss_db,tube_area_m2_per_sr,crossed,surface_reflections,"
                         "bottom_reflections,turns,turning_depths_m\n"));
  const Rows rows = rows_of(outcome.out);
  ASSERT_GE(rows.size(), 1U);
  const WaterColumn water{SoundSpeedProfile({{0, 1500}, {100, 1490}, {200, 1500}}), {}};
  const std::vector<Eigenray> rays = EigenrayFinder(water, 100, {.most_turns = 16}).all(150, 5000);
  ASSERT_EQ(rows.size(), rays.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(number_in(rows[k], "range_m"), 5000);
    EXPECT_NEAR(number_in(rows[k], "bearing_deg"), 36.8698976458, 1e-9);
    EXPECT_EQ(number_in(rows[k], "eigenrays"), static_cast<double>(rays.size()));
    EXPECT_NEAR(number_in(rows[k], "time_s"), rays[k].time_s, 1e-13);
    EXPECT_NEAR(number_in(rows[k], "launch_down_deg"),
                std::atan2(rays[k].launch_sine, rays[k].launch_cosine) / degree, 1e-12);
    EXPECT_EQ(number_in(rows[k], "turns"), rays[k].turns);
    EXPECT_NEAR(number_in(rows[k], "spreading_loss_db"),
                10 * std::log10(rays[k].tube_area_m2_per_sr * 1490 / 1495), 1e-6);
    EXPECT_GT(number_in(rows[k], "absorption_db"), 3);
    EXPECT_NEAR(number_in(rows[k], "transmission_loss_db"),
                number_in(rows[k], "spreading_loss_db") + number_in(rows[k], "absorption_db"), 2e-6);
  }
}

TEST_F(RaysCommand, NamesPointsInShadow) {
  // Sound bends upwards from a source near the surface; far below and far away no ray arrives.
  folder.write("duct.csv", "depth_m,sound_speed_m_s\n0,1480\n50,1490\n500,1400\n");
  const std::vector<std::string> words{"rays",      "--profile", (folder / "duct.csv").string(),
                                       "--from",    "0,0,-45",   "--ranges",
                                       "100m,20km", "--depths",  "70"};
  const Outcome outcome = run_program(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Rows rows = rows_of(outcome.out);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("eigenrays"), "1");
  EXPECT_EQ(rows[1].at("eigenrays"), "0");
  EXPECT_EQ(rows[1].at("time_s"), "");
  EXPECT_THAT(outcome.err, HasSubstr("1 of 2 points lie in a shadow zone, without an eigenray: 2"));
}

TEST_F(RaysCommand, TracesAFanAndDrawsIt) {
  const std::string table = (folder / "fan.csv").string(), svg = (folder / "fan.svg").string(),
                    png = (folder / "fan.png").string();
  const Outcome outcome =
      run_program({"rays", "--profile", profile, "--from", "0,0,-100", "--angles", "-6:6:1", "--ranges",
                   "4km", "--bottom", "200", "-o", table, "--picture", svg});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Rows rows = rows_of(bytes_of(table));
  std::size_t ends = 0, arcs = 0;
  for (const auto& row : rows) {
    if (row.at("event") == "end") {
      ++ends;
      EXPECT_NEAR(number_in(row, "range_m"), 4000, 1e-9);
    }
    arcs += row.at("event") == "arc" ? 1 : 0;
    EXPECT_GE(number_in(row, "depth_m"), -1e-9);
    EXPECT_LE(number_in(row, "depth_m"), 200 + 1e-9);
  }
  EXPECT_EQ(ends, 13U);
  EXPECT_GT(arcs, 20U);
  const std::string drawing = bytes_of(svg);
  EXPECT_THAT(drawing, AllOf(HasSubstr("sound speed (m/s)"), HasSubstr("depth (m)"), HasSubstr("</svg>")));
  std::size_t lines = 0;
  for (std::size_t at = 0; (at = drawing.find("<polyline", at)) != std::string::npos; ++at) ++lines;
  EXPECT_EQ(lines, 14U);  // thirteen rays and the profile
  const Outcome eigenrays = run_program(
      {"rays", "--profile", profile, "--from", "0,0,-100", "--to", "2000,0,-60", "--picture", png});
  ASSERT_EQ(eigenrays.exit_code, 0) << eigenrays.err;
  EXPECT_THAT(bytes_of(png), StartsWith("\x89PNG"));
}

// BELLHOP reads the same points of the profile, the source, the points of the table and the range.
TEST_F(RaysCommand, WritesABellhopEnvironment) {
  const std::string env = (folder / "run.env").string();
  const std::vector<std::string> source{"rays", "--profile", profile, "--from", "0,0,-80"};
  const auto lines = [&](std::vector<std::string> words) {
    words.insert(words.begin(), source.begin(), source.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    std::vector<std::string> read;
    std::istringstream text(bytes_of(env));
    for (std::string line; std::getline(text, line);) read.push_back(line);
    return read;
  };
  using testing::ElementsAre;
  EXPECT_THAT(lines({"--ranges", "1km,2km", "--depths", "60", "--bottom", "150", "--environment", env}),
              ElementsAre("'channel.csv'", "1000", "1", "'CVW'", "3 0.0 150", "0 1500 /", "100 1490 /",
                          "150 1495 /", "'R' 0.0", "1", "80 /", "1", "60 /", "2", "1 2 /", "'A'", "5001",
                          testing::MatchesRegex("-[0-9.]+ [0-9.]+ /"), "0.0 151.5 2.02"));
  const std::vector<std::string> fan = lines({"--ranges", "2km", "--angles", "-3:3:3", "--environment", env});
  ASSERT_EQ(fan.size(), 21U);
  EXPECT_THAT(fan[10], StartsWith("202 1500 0.0 1.0 /"));  // a half-space like the water
  EXPECT_EQ(fan[17], "'R'");
  EXPECT_EQ(fan[19], "-3 0 3 /");
  EXPECT_THAT(fan[20], StartsWith("0.0 204.02"));
}

// The sensor of the scene is the source, and its frequency determines the absorption.
TEST_F(RaysCommand, StartsAtTheSensorOfAScene) {
  folder.write("points.csv", "x_m,y_m,z_m\n0,10,0\n3,4,2\n");
  const Outcome outcome = run_program({"rays", scene, "--to", (folder / "points.csv").string(), "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Rows rows = rows_of(outcome.out);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR(number_in(rows[0], "length_m"), std::hypot(10, 2), 1e-9);
  EXPECT_NEAR(number_in(rows[0], "launch_down_deg"), std::atan2(2, 10) / degree, 1e-9);
  EXPECT_NEAR(number_in(rows[1], "length_m"), 5, 1e-9);
  EXPECT_GT(number_in(rows[0], "absorption_db"), 0.1);
  EXPECT_NEAR(number_in(rows[0], "absorption_db") / number_in(rows[1], "absorption_db"),
              std::hypot(10, 2) / 5, 1e-4);
}

TEST_F(RaysCommand, SaysWhatIsWrong) {
  folder.write("bad.csv", "x_m,y_m,z_m\n0,10,nan\n");
  folder.write("empty.csv", "x_m,y_m,z_m\n");
  const std::vector<std::string> source{"rays", "--profile", profile, "--from", "0,0,-100"};
  const auto refused = [&](std::vector<std::string> words, const std::string& why, bool with_source = true) {
    if (with_source) words.insert(words.begin(), source.begin(), source.end());
    words.push_back("--quiet");
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(why));
    EXPECT_EQ(outcome.out, "");
  };
  refused({"rays"}, "expected a scene file or --profile", false);
  refused({"rays", "--profile", profile, "--to", "1,2,-3"}, "give the position of the source", false);
  refused({}, "no points");
  refused({"--to", "1,2"}, "--to '1,2': expected a position X,Y,Z");
  refused({"--to", "1,2,nan"}, "expected a position X,Y,Z");
  refused({"--to", "1,2,1e9"}, "coordinates must be within");
  refused({"--to", "1,2,3"}, "is at a depth of -3 m, but the water extends from 0");
  refused({"--to", "0,0,-100"}, "point 1 is the source");
  refused({"--to", (folder / "bad.csv").string()}, "bad.csv:2");
  refused({"--to", (folder / "empty.csv").string()}, "has a header but no rows");
  refused({"--ranges", "1km"}, "--ranges and --depths belong together");
  refused({"--ranges", "1,x", "--depths", "5"}, "'x' is not a number");
  refused({"--ranges", "-5", "--depths", "5"}, "at least 0 m");
  refused({"--ranges", "0:1e6:1", "--depths", "1:2:1"}, "--ranges");
  refused({"--angles", "0:10"}, "--angles needs --ranges");
  refused({"--angles", "90", "--ranges", "1km"}, "a vertical ray reaches no range");
  refused({"--angles", "5", "--ranges", "0"}, "expected a range above 0 m");
  refused({"--angles", "5", "--ranges", "10", "--to", "1,2,-3"}, "remove --to");
  refused({"--to", "9,0,-5", "--bottom", "-5"}, "expected a depth below the surface");
  refused({"--to", "9,0,-5", "--bottom", "50"}, "the source is at a depth of 100 m");
  refused({"--to", "9,0,-5", "--picture", (folder / "a.jpg").string()}, "expected .png or .svg");
  refused({"--to", "9,0,-5", "-o", profile}, "channel.csv");
  refused({"--to", "9,0,-5", "--environment", (folder / "a.env").string()}, "needs points on a grid");
  refused({"rays", scene, "--from", "0,0,2", "--to", "9,0,5", "--reflections", "1"},
          "no sea surface and no bottom", false);
}

}  // namespace
}  // namespace tubefoot
