// SPDX-License-Identifier: GPL-3.0-or-later
// Tests labels, which attribute each energy to objects and materials (docs/output-files.md). Shares add up to
// the energies for each engine, and means agree with closed forms.
#include "run/labels.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "fixtures/every_feature.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// relative error of energies that are integrated with other factors
constexpr double quadrature = 1e-5;

/// All data of the run of one sensor.
struct LabelledRun {
  std::shared_ptr<PingStore> store;
  LabelRecording labels;
  std::vector<double> energy;  ///< [ping][channel of the sensor][beam][sample]
  std::size_t samples = 0, pings = 0, sensor_channels = 1;
  RangeSamples window;

  std::size_t object(const std::string& name) const { return number(labels.objects, name); }
  std::size_t material(const std::string& name) const { return number(labels.materials, name); }
  /// Returns a value of a label channel before its conversion to a share.
  double raw(std::size_t ping, std::size_t channel, std::size_t cell) const {
    return labels.recorded.values[(ping * labels.channels() + channel) * labels.cells + cell];
  }
  double received(std::size_t ping, std::size_t cell) const {
    return energy[ping * sensor_channels * labels.cells + cell];
  }

 private:
  static std::size_t number(const std::vector<std::string>& names, const std::string& name) {
    return std::size_t(std::ranges::find(names, name) - names.begin());
  }
};

struct LabelsOf : testing::Test {
  TestFolder folder;

  LabelledRun told(const std::string& scene, const std::function<void(RunRequest&)>& ask = {},
                   bool labels = true) {
    const SceneDescription description = read_scene_file(folder.write("scene.toml", scene));
    const auto survey = open_survey(description);
    RunRequest request = request_of(description.run);
    request.labels = labels;
    if (ask) ask(request);
    LabelledRun told;
    told.store = std::make_shared<PingStore>(layout_of(*survey, request));
    simulate(*survey, request, *told.store, {});
    const auto values = told.store->in_memory(0, "energy");
    told.energy.assign(values.begin(), values.end());
    const Sensor& sensor = *survey->sensors[0].sensor;
    told.window = sensor.samples();
    told.samples = std::size_t(told.window.count);
    told.pings = survey->sensors[0].times_s.size();
    told.sensor_channels = std::size_t(sensor.channels());
    if (labels) told.labels = label_recordings_of(*survey, request, told.store).at(0);
    return told;
  }

  /// Expects that the energies by object and the energies without scattering add up to the energies, and
  /// shares to 1.
  static void expect_whole(const LabelledRun& told, double tolerance) {
    const LabelRecording& labels = told.labels;
    double largest = 0;
    for (std::size_t p = 0; p < told.pings; ++p)
      for (std::size_t cell = 0; cell < labels.cells; ++cell)
        largest = std::max(largest, told.received(p, cell));
    ASSERT_GT(largest, 0);
    for (std::size_t p = 0; p < told.pings; ++p) {
      const LabelPing ping = labels.of(p);
      for (std::size_t cell = 0; cell < labels.cells; ++cell) {
        double sum = 0;
        for (std::size_t k = 0; k < labels.owners.size(); ++k) sum += told.raw(p, k, cell);
        if (labels.has_unscattered) sum += told.raw(p, labels.owners.size() + 2, cell);
        const double energy = told.received(p, cell);
        EXPECT_NEAR(sum, energy, tolerance * std::max(energy, 1e-3 * largest))
            << "ping " << p << " beam " << cell / told.samples << " sample " << cell % told.samples;
        if (!(sum > 0)) continue;
        for (const auto* shares : {&ping.object_share, &ping.material_share}) {
          double whole = labels.has_unscattered ? ping.unscattered_share[cell] : 0;
          for (std::size_t k = cell; k < shares->size(); k += labels.cells) whole += (*shares)[k];
          EXPECT_NEAR(whole, 1, 1e-14);
        }
      }
    }
  }
};

/// A sphere and a box on a seabed before a camera, in three materials.
const std::string still_life =
    still_water() + lambert_material("sand", -27) + lambert_material("steel", -15) +
    lambert_material("rubber", -20) + flat_terrain(20, 20, "name = \"bed\"\nmaterial = \"sand\"\n") +
    replaced(replaced(ball_and_box(), "radius_m = 0.5\n", "radius_m = 0.5\nmaterial = \"rubber\"\n"),
             "size_m = [0.6, 0.2, 0.5]\n", "size_m = [0.6, 0.2, 0.5]\nmaterial = \"steel\"\n") +
    fixed_at(0, 0, 2) +
    "[[sensors]]\nname = \"camera\"\nkind = \"imaging\"\nbeams = 12\n"
    "horizontal_deg = 24\nvertical_deg = 20\ntilt_deg = 25\nrange_min_m = 3\n"
    "range_max_m = 7\nsamples = 40\n";

TEST_F(LabelsOf, AStillLifeNamesItsThings) {
  const LabelledRun t = told(still_life);
  expect_whole(t, quadrature);
  const LabelPing ping = t.labels.of(0);
  const std::size_t seabed = t.object("bed"), ball = t.object("ball"), box = t.object("box");
  std::set<int> numbers;
  for (std::size_t cell = 0; cell < t.labels.cells; ++cell) {
    const double energy = t.received(0, cell);
    numbers.insert(ping.object_label[cell]);
    if (!(energy > 0)) {
      EXPECT_EQ(ping.object_label[cell], LabelRecording::no_label);
      EXPECT_TRUE(std::isnan(ping.mean_height[cell]));
      continue;
    }
    // Each object has its own material.
    EXPECT_EQ(ping.object_share[ball * t.labels.cells + cell],
              ping.material_share[t.material("rubber") * t.labels.cells + cell]);
    // Both legs are straight, so that the range is that of the range bin.
    const double near = t.window.first_m + double(cell % t.samples) * t.window.step_m;
    EXPECT_GE(ping.mean_range[cell], near - 1e-6);
    EXPECT_LE(ping.mean_range[cell], near + t.window.step_m + 1e-6);
    EXPECT_GE(ping.mean_height[cell], -1e-6);
    EXPECT_LE(ping.mean_height[cell], 0.9 + 1e-6);  // the top of the sphere
    if (ping.object_share[seabed * t.labels.cells + cell] > 1 - 1e-12) {
      EXPECT_NEAR(ping.mean_height[cell], 0, 2e-6);
    }
  }
  EXPECT_EQ(numbers, (std::set<int>{-1, int(seabed), int(ball), int(box)}));
}

TEST_F(LabelsOf, TheEnergiesAreTheSameToTheBit) {
  EXPECT_EQ(told(still_life).energy, told(still_life, {}, false).energy);
}

TEST_F(LabelsOf, NoResultDependsOnTheThreads) {
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const LabelledRun t = told(still_life);
    return std::vector<double>(t.labels.recorded.values.begin(), t.labels.recorded.values.end());
  };
  EXPECT_EQ(with(1), with(3));
}

// Hidden parts have no share: a wall stands before the box and the seabed below it.
TEST_F(LabelsOf, WhatIsHiddenHasNoShare) {
  const LabelledRun t = told(still_life +
                             "[[objects]]\nname = \"wall\"\nshape = \"box\"\nsize_m = [6, 0.2, 6]\n"
                             "position_m = [0, 3.6, 1]\nmaterial = \"steel\"\n");
  expect_whole(t, quadrature);
  const LabelPing ping = t.labels.of(0);
  for (const char* hidden : {"box", "ball"})
    for (std::size_t cell = 0; cell < t.labels.cells; ++cell)
      EXPECT_EQ(ping.object_share[t.object(hidden) * t.labels.cells + cell], 0) << hidden;
}

TEST_F(LabelsOf, RaysAgreeWithTubes) {
  const LabelledRun exact = told(still_life),
                    sampled = told(still_life, [](RunRequest&request) {
                      request.engine = Engine::ray;
                      request.rays = {RaySampling::stratified, 100000, RaySettings::Per::beam, 1};
                    });
  expect_whole(sampled, 1e-12);
  const LabelPing a = exact.labels.of(0), b = sampled.labels.of(0);
  double all = 0, apart = 0, lower = 0;
  for (std::size_t cell = 0; cell < exact.labels.cells; ++cell) {
    const double energy = exact.received(0, cell);
    if (!(energy > 0) || std::isnan(b.mean_height[cell])) continue;
    all += energy;
    lower += energy * std::abs(a.mean_height[cell] - b.mean_height[cell]);
    for (std::size_t k = 0; k < exact.labels.objects.size(); ++k)
      apart += energy * std::abs(a.object_share[k * exact.labels.cells + cell] -
                                 b.object_share[k * exact.labels.cells + cell]);
  }
  EXPECT_LT(apart, 0.02 * all);
  EXPECT_LT(lower, 0.02 * 0.9 * all);
}

/// Two triangles.
std::string sheet(double west, double east, double rise) {
  return fmt::format("v {0} -40 {2}\nv {1} -40 {2}\nv {1} 40 {3}\nv {0} 40 {3}\nf 1 2 3\nf 1 3 4\n", west,
                     east, -40 * rise, 40 * rise);
}
std::string of_sheet(const char* name, const char* material) {
  return fmt::format(
      "[[objects]]\nname = \"{0}\"\nshape = \"mesh\"\nfile = \"{0}.obj\"\nmaterial = \"{1}\"\n", name,
      material);
}

// A beam of 4 degrees over the straight border below the sonar has one degree to port and three to
// starboard. On a level seabed the azimuths are proportional to the areas.
TEST_F(LabelsOf, ABeamOverTwoFacetsHasSharesAsTheirAzimuths) {
  folder.write("west.obj", sheet(-50, 0, 0));
  folder.write("east.obj", sheet(0, 50, 0));
  const LabelledRun t = told(still_water() + lambert_material("dull", -30) + lambert_material("bright", -20) +
                             of_sheet("west", "dull") + of_sheet("east", "bright") +
                             fixed_at(0, 0, 10, "heading_deg = 1\n") + downward_fan(1, 4, 100));
  expect_whole(t, quadrature);
  const LabelPing ping = t.labels.of(0);
  const double east = 3 * 0.01 / (3 * 0.01 + 1 * 0.001);
  int compared = 0;
  for (std::size_t k = 0; k < t.samples; ++k) {
    if (t.window.first_m + double(k) * t.window.step_m < 10.05) continue;
    EXPECT_NEAR(ping.object_share[t.object("east") * t.labels.cells + k], east, 1e-6);
    EXPECT_NEAR(ping.material_share[t.material("dull") * t.labels.cells + k], 1 - east, 1e-6);
    EXPECT_EQ(ping.object_label[k], int(t.object("east")));
    EXPECT_NEAR(ping.mean_height[k], 0, 5e-5);
    ++compared;
  }
  EXPECT_GT(compared, 80);
}

// On a slope the density is known in polar coordinates about the foot point of the sonar: distance rho,
// azimuth psi.
TEST_F(LabelsOf, HeightsAndRangesOnASlopeAreThoseOfTheClosedForm) {
  constexpr double rise = 0.25, height = 10, half_rad = 2 * std::numbers::pi / 180;
  folder.write("slope.obj", sheet(-50, 50, rise));
  const LabelledRun t = told(still_water() + lambert_material("rock", -20) + of_sheet("slope", "rock") +
                             fixed_at(0, 0, height) + downward_fan(1, 4, 40));
  expect_whole(t, quadrature);
  const LabelPing ping = t.labels.of(0);
  int compared = 0;
  for (std::size_t k = 0; k < t.samples; ++k) {
    const double near = t.window.first_m + double(k) * t.window.step_m, far = near + t.window.step_m;
    if (near < 10.1 || far > 35) continue;
    double all = 0, heights = 0, ranges = 0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i) {
      const double ahead = std::cos(((i + 0.5) / n * 2 - 1) * half_rad), a = 1 + std::pow(rise * ahead, 2),
                   b = height * rise * ahead;
      const auto rho_at = [&](double r) {  // a rho^2 - 2 b rho + height^2 = r^2
        return (b + std::sqrt(b * b - a * (height * height - r * r))) / a;
      };
      const double first = rho_at(near), step = (rho_at(far) - first) / n;
      for (int j = 0; j < n; ++j) {
        const double rho = first + (j + 0.5) * step, z = rise * rho * ahead, r = std::hypot(rho, height - z),
                     weight = rho * step * std::pow(r, -6);
        all += weight;
        heights += weight * z;
        ranges += weight * r;
      }
    }
    EXPECT_NEAR(ping.mean_height[k], heights / all, 5e-5) << near;
    EXPECT_NEAR(ping.mean_range[k], ranges / all, 5e-5) << near;
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

// For each feature of a scene and each pair of features, the energies by object add up to the energies.
TEST_F(LabelsOf, EveryFeatureOfASceneKeepsTheWhole) {
  folder.write("bed.asc", seabed_of_steps());
  for (std::size_t a = 0; a < of_scenes.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      std::set<Feature> features{of_scenes[a].feature, of_scenes[b].feature};
      if (features.contains(Feature::scatterings)) features.insert(Feature::mirrors);
      std::set<Feature> with_labels = features;
      with_labels.insert(Feature::labels);
      if (reason_of_the_table(with_labels)) continue;  // and two kinds of sensors
      if (features.contains(Feature::two_receivers) && features.contains(Feature::signals)) continue;
      SCOPED_TRACE(scene_with(features));
      const LabelledRun t = told(scene_with(features) +
                                 "[[objects]]\nname = \"box\"\nshape = \"box\"\nmaterial = \"rock\"\n"
                                 "size_m = [0.5, 0.5, 0.5]\nposition_m = [0.1, 5, 0.2]\n");
      expect_whole(t, quadrature);
      const LabelPing ping = t.labels.of(0);
      for (std::size_t cell = 0; cell < t.labels.cells; ++cell)
        if (!std::isnan(ping.mean_height[cell]) && !features.contains(Feature::sea_waves)) {
          EXPECT_GE(ping.mean_height[cell], -0.35);
          EXPECT_LE(ping.mean_height[cell], 0.6);
        }
    }
}

TEST_F(LabelsOf, OtherEnginesKeepTheWholeToo) {
  for (const Binning binning : {Binning::spread, Binning::centroid})
    expect_whole(told(still_life, [&](RunRequest& request) { request.binning = binning; }), 1e-12);
  expect_whole(told(still_life, [](RunRequest& request) { request.reference_tolerance = 1e-6; }), quadrature);
}

TEST_F(LabelsOf, TheFileHasItAndTheFolderPictures) {
  const auto scene = folder.write("scene.toml", still_life), out = folder / "out", plain = folder / "plain";
  const Outcome outcome = run_program({"run", scene.string(), "-o", out.string(), "--labels"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("camera-labels-0000.png"));
  EXPECT_TRUE(names_below(out).contains("camera-labels-0000.png"));
  const NetcdfReader file(out / "echoes.nc");
  EXPECT_EQ(file.dimensions("/", "object_share"), "ping,object,beam,sample");
  EXPECT_EQ(file.dimensions("/", "material_share"), "ping,material,beam,sample");
  EXPECT_EQ(file.dimensions("/", "mean_height"), "ping,beam,sample");
  EXPECT_EQ(file.text("/", "flag_meanings", "object_label"), "bed ball box");
  EXPECT_EQ(file.text("/", "units", "mean_range"), "m");
  const LabelledRun t = told(still_life);
  EXPECT_EQ(file.values("/", "object_share"), t.labels.of(0).object_share);
  EXPECT_EQ(file.values("/", "material_share"), t.labels.of(0).material_share);
  EXPECT_EQ(file.values("/", "energy"), t.energy);
  // Without the option a run writes the same files as before.
  ASSERT_EQ(run_program({"run", scene.string(), "-o", plain.string()}).exit_code, 0);
  const std::vector<std::string> before = NetcdfReader(plain / "echoes.nc").variables("/");
  EXPECT_THAT(before, testing::Not(testing::Contains("object_share")));
  EXPECT_FALSE(names_below(plain).contains("camera-labels-0000.png"));
}

// Several sensors, of few beams and many, each in its group.
TEST_F(LabelsOf, EverySensorHasItsOwn) {
  const std::string two =
      still_life + "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\nrange_max_m = 10\nsamples = 30\n" +
      "[[sensors]]\nname = \"below\"\nkind = \"echosounder\"\nrange_max_m = 5\nsamples = 20\n";
  const auto out = folder / "out";
  const Outcome outcome =
      run_program({"run", folder.write("scene.toml", two).string(), "-o", out.string(), "--labels"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const NetcdfReader file(out / "echoes.nc");
  for (const char* group : {"/camera", "/side", "/below"}) {
    const std::vector<double> energy = file.values(group, "energy"),
                              share = file.values(group, "object_share");
    for (std::size_t cell = 0; cell < energy.size(); ++cell) {
      double sum = 0;
      for (std::size_t k = cell; k < share.size(); k += energy.size()) sum += share[k];
      EXPECT_NEAR(sum, energy[cell] > 0 ? 1 : 0, 1e-14) << group << cell;
    }
  }
  for (const char* picture : {"camera-labels-0000.png", "side-labels.png", "below-labels.png"})
    EXPECT_TRUE(names_below(out).contains(picture)) << picture;
}

TEST(RequestOfLabels, IsReadFromItsPresentAndItsFormerName) {
  RunRequest request = request_of(RunDescription());
  request.labels = true;
  nlohmann::ordered_json settings = json_of(request);
  EXPECT_EQ(settings.at("labels"), true);
  EXPECT_TRUE(request_of(settings, request_of(RunDescription())).labels);
  settings.erase("labels");
  EXPECT_FALSE(request_of(settings, request_of(RunDescription())).labels);
  settings["truth"] = true;  // files of version 0.1
  EXPECT_TRUE(request_of(settings, request_of(RunDescription())).labels);
}

// --- beam patterns: labels use only directions near the peak

/// 60 beams of 1 degree before a small sphere straight ahead. A line of 10 wavelengths receives the sphere
/// in all beams.
constexpr int line_beams = 60;
constexpr double wavelengths = 10;
std::string ball_in_side_lobes(double tilt_deg = 0, std::string_view more = {}) {
  return still_water() + lambert_material("steel", -10) + lambert_material("mud", -45) +
         "[[objects]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.02\nchord_error_m = "
         "0.005\nposition_m = [0, 5, 3]\n"
         "material = \"steel\"\n" +
         fixed_at(0, 0, 3) +
         fmt::format(
             "[[sensors]]\nname = \"camera\"\nkind = \"imaging\"\nbeams = {}\n"
             "horizontal_deg = 60\nvertical_deg = 40\ntilt_deg = {}\nfrequency_khz = 300\n"
             "range_min_m = 4.5\nrange_max_m = 5.5\nsamples = 10\n"
             "receive_pattern = \"line\"\nreceive_aperture_m = {}\n"
             "transmit_pattern = \"gaussian\"\ntransmit_pattern_angle = \"elevation\"\n"
             "transmit_beam_width_deg = 20\n{}",
             line_beams, tilt_deg, wavelengths * 1500 / 300e3, more);
}
/// Level of a beam in the direction of the sphere, in dB below its peak.
double down_db(int beam) {
  const double u = wavelengths * std::sin((beam + 0.5 - line_beams / 2.) * std::numbers::pi / 180);
  return -20 * std::log10(std::abs(std::sin(std::numbers::pi * u) / (std::numbers::pi * u)));
}

void expect_labels_within(const LabelledRun& t, double level_db) {
  const LabelPing ping = t.labels.of(0);
  const auto ball = std::int16_t(t.object("ball"));
  int labelled = 0, unlabelled = 0;
  for (int beam = 0; beam < line_beams; ++beam)
    for (std::size_t k = 0; k < t.samples; ++k) {
      const std::size_t cell = std::size_t(beam) * t.samples + k;
      if (!(t.received(0, cell) > 0)) continue;
      EXPECT_NEAR(ping.object_share[std::size_t(ball) * t.labels.cells + cell], 1, 1e-12);
      constexpr double edge_db = 1.5;  // the sphere is half a degree wide
      if (std::abs(down_db(beam) - level_db) < edge_db) continue;
      const bool near_peak = down_db(beam) < level_db;
      EXPECT_EQ(ping.object_label[cell], near_peak ? ball : LabelRecording::no_label) << "beam " << beam;
      ++(near_peak ? labelled : unlabelled);
    }
  EXPECT_GT(labelled, 4);
  EXPECT_GT(unlabelled, 4);
}

TEST_F(LabelsOf, ASideLobeFarBelowThePeakOwnsNoLabel) {
  const LabelledRun t = told(ball_in_side_lobes());
  expect_whole(t, quadrature);
  expect_labels_within(t, 20);
}

TEST_F(LabelsOf, TheLevelOfLabelsIsRequested) {
  for (const double level_db : {8., 15., 28.})
    expect_labels_within(told(ball_in_side_lobes(), [&](RunRequest& r) { r.label_level_db = level_db; }),
                         level_db);
}

TEST_F(LabelsOf, RaysAndCentroidsHaveTheSameLabels) {
  expect_labels_within(told(ball_in_side_lobes(),
                            [](RunRequest& r) {
                              r.engine = Engine::ray;
                              r.rays = {RaySampling::stratified, 200000, RaySettings::Per::beam, 1};
                            }),
                       20);
  for (const Binning binning : {Binning::spread, Binning::centroid})
    expect_labels_within(told(ball_in_side_lobes(), [&](RunRequest& r) { r.binning = binning; }), 20);
}

TEST_F(LabelsOf, AReceiverThatIsApartHasTheSameLabels) {
  expect_labels_within(told(ball_in_side_lobes(0, "receiver_arm_m = [0, 0, 0.01]\n")), 20);
}

// The two-way gain counts: 8 degrees below the axis a transmitter of 20 degrees has lost 1.9 dB.
TEST_F(LabelsOf, WhatIsSentCountsForLabelsToo) {
  const LabelledRun level = told(ball_in_side_lobes(), [](RunRequest&r) { r.label_level_db = 1; }),
                    tilted = told(ball_in_side_lobes(8), [](RunRequest&r) { r.label_level_db = 1; });
  const auto labelled = [](const LabelledRun& t) {
    return std::ranges::count(t.labels.of(0).object_label, std::int16_t(t.object("ball")));
  };
  EXPECT_GT(labelled(level), 0);
  EXPECT_EQ(labelled(tilted), 0);
}

// Mud in the main lobe has the label, although the sphere in the side lobes returns more.
TEST_F(LabelsOf, TheMainLobeOwnsTheLabelThoughASideLobeReturnsMore) {
  const LabelledRun t = told(ball_in_side_lobes() +
                             "[[objects]]\nname = \"wall\"\nshape = \"box\"\nsize_m = [8, 0.5, 0.02]\n"
                             "position_m = [0, 4.98, 2.9]\nmaterial = \"mud\"\n");
  const LabelPing ping = t.labels.of(0);
  const auto ball = t.object("ball"), wall = t.object("wall");
  int compared = 0;
  for (std::size_t cell = 0; cell < t.labels.cells; ++cell) {
    const double share = ping.object_share[ball * t.labels.cells + cell];
    if (down_db(int(cell / t.samples)) < 24 || !(share > 0.6 && share < 0.99)) continue;
    EXPECT_EQ(ping.object_label[cell], std::int16_t(wall));
    EXPECT_EQ(ping.material_label[cell], std::int16_t(t.material("mud")));
    ++compared;
  }
  EXPECT_GT(compared, 3);
}

// A level of 1000 dB below the peak includes everything: for any scene, the same integrals take part.
TEST_F(LabelsOf, AllOfTheEnergyIsNearThePeakWhereTheLevelIsLow) {
  folder.write("bed.asc", seabed_of_steps());
  std::vector<std::set<Feature>> scenes{{Feature::mirrors, Feature::refraction},
                                        {Feature::mirrors, Feature::separate_receiver},
                                        {Feature::mirrors, Feature::two_receivers}};
  for (const InScene& one : of_scenes) {
    std::set<Feature> features{one.feature};
    if (features.contains(Feature::scatterings)) features.insert(Feature::mirrors);
    std::set<Feature> with_labels = features;
    with_labels.insert(Feature::labels);
    if (!features.contains(Feature::signals) && !reason_of_the_table(with_labels)) scenes.push_back(features);
  }
  for (const std::set<Feature>& features : scenes) {
    // The axis of the camera over mirrors has a depression of 20 degrees. The seabed within its range gate
    // has 37 degrees or more, where a transmit pattern of 30 degrees has lost 3.8 dB.
    const int width_deg = features.contains(Feature::mirrors) ? 70 : 30;
    const std::string scene =
        scene_with(features) + fmt::format(
                                   "transmit_pattern = \"gaussian\"\ntransmit_pattern_angle = \"elevation\"\n"
                                   "transmit_beam_width_deg = {}\n"
                                   "receive_pattern = \"gaussian\"\nreceive_pattern_angle = \"azimuth\"\n"
                                   "receive_beam_width_deg = 3\n",
                                   width_deg);
    SCOPED_TRACE(scene);
    const auto told_at = [&](double level_db) {
      return told(scene, [&](RunRequest& r) { r.label_level_db = level_db; });
    };
    const LabelledRun low = told_at(1000), high = told_at(3);
    const std::size_t first = low.labels.first_near_peak();
    double all = 0, near = 0;
    for (std::size_t k = 0; k < low.labels.owners.size(); ++k)
      for (std::size_t cell = 0; cell < low.labels.cells; ++cell) {
        const double energy = low.raw(0, k, cell);
        EXPECT_NEAR(low.raw(0, first + k, cell), energy, 1e-4 * std::abs(energy) + 1e-15);
        EXPECT_LE(high.raw(0, first + k, cell), energy * (1 + 1e-4) + 1e-15);
        all += energy;
        near += high.raw(0, first + k, cell);
      }
    EXPECT_GT(near, 0);
    EXPECT_LT(near, 0.999 * all);
    EXPECT_EQ(low.labels.of(0).object_label.size(), low.labels.cells);
  }
}

/// A camera 3 m above a flat seabed and 1 m below the surface. The range gate contains the seabed echo of
/// one reflection.
std::string seabed_via_the_surface(std::string_view paths) {
  return still_water() + lambert_material("rock", -20) +
         flat_terrain(60, 60, "name = \"bed\"\nmaterial = \"rock\"\n") + fixed_at(0, 0, 3) +
         fmt::format(
             "[sea_surface]\nheight_m = 4\n[paths]\n{}"
             "[[sensors]]\nname = \"camera\"\nkind = \"imaging\"\nbeams = 1\nhorizontal_deg = 40\n"
             "vertical_deg = 160\ntilt_deg = 0\nrange_min_m = 6\nrange_max_m = 10\nsamples = 1\n"
             "transmit_pattern = \"gaussian\"\ntransmit_pattern_angle = \"elevation\"\n"
             "transmit_beam_width_deg = 60\nreceive_pattern = \"gaussian\"\n"
             "receive_pattern_angle = \"azimuth\"\nreceive_beam_width_deg = 10\n",
             paths);
}
/// Returns the energy of the beam over one reflection, on the transmit leg or on the receive leg. It counts
/// directions in which the product of both gains is at least `least`. It uses the midpoint rule in polar
/// coordinates about the foot point of the sonar. The camera looks north.
double received_over_the_surface(double least) {
  constexpr double below_m = 3, image_m = 5, mu = 0.01;
  constexpr int distances = 1000, azimuths = 600;
  constexpr double farthest_m = 12, widest_rad = 19 * degree;
  const auto gain = [](double angle, double width) {
    return std::exp(-4 * std::numbers::ln2 * (angle / width) * (angle / width));
  };
  double sum = 0;
  for (int i = 0; i < distances; ++i) {
    const double d = (i + 0.5) * farthest_m / distances, straight = std::hypot(d, below_m),
                 reflected = std::hypot(d, image_m), half = (straight + reflected) / 2;
    if (half < 6 || half >= 10) continue;
    const double density = mu * below_m * image_m / std::pow(straight * reflected, 3);
    for (const bool out_reflected : {false, true}) {
      const double sent =
          gain(out_reflected ? std::asin(image_m / reflected) : -std::asin(below_m / straight), 60 * degree);
      for (int j = 0; j < azimuths; ++j) {
        const double azimuth = (2 * (j + 0.5) / azimuths - 1) * widest_rad,
                     across = std::sin(azimuth) * d / (out_reflected ? straight : reflected),
                     received = gain(std::asin(across), 10 * degree);
        if (sent * received < least) continue;
        sum += density * sent * received * d * (farthest_m / distances) * (2 * widest_rad / azimuths);
      }
    }
  }
  return sum;
}

// Each leg has its own direction at the sonar. The comparison uses neither images nor visibility.
TEST_F(LabelsOf, OverAMirrorWhatIsNearThePeakIsThatOfBothLegs) {
  constexpr double level_db = 6;
  const LabelledRun t = told(seabed_via_the_surface("order = 2\nonly_order = 2\n"),
                             [&](RunRequest& r) { r.label_level_db = level_db; });
  ASSERT_EQ(t.labels.owners.size(), 1u);
  ASSERT_EQ(t.labels.cells, 1u);
  const double near = t.raw(0, t.labels.first_near_peak(), 0),
               expected = received_over_the_surface(std::pow(10, -level_db / 10));
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(near, expected, 0.02 * expected);
  EXPECT_LT(near, 0.9 * t.raw(0, 0, 0));
}

// After two scatterings the peak of the receive pattern alone counts. Each beam is steered 20 degrees off
// the transmit pattern, so that its two-way peak lies 24 dB below its receive peak.
TEST_F(LabelsOf, AfterTwoScatteringsTheLevelIsBelowThePeakOfTheReceivePattern) {
  const auto box_at = [](const char* name, double azimuth_deg) {
    const double azimuth = azimuth_deg * std::numbers::pi / 180;
    return fmt::format(
        "[[objects]]\nname = \"{}\"\nshape = \"box\"\nmaterial = \"rock\"\nsize_m = [0.3, 0.3, 0.3]\n"
        "position_m = [{}, {}, 1.2]\n",
        name, 6 * std::sin(azimuth), 6 * std::cos(azimuth));
  };
  const LabelledRun t = told(still_water() + lambert_material("rock", -10) +
                                 flat_terrain(20, 20, "name = \"bed\"\nmaterial = \"rock\"\n") +
                                 box_at("aside", 6) + box_at("ahead", 20) + fixed_at(0, 0, 2) +
                                 "[paths]\norder = 2\nonly_order = 2\nscatterings = 2\npatch_m = 1\n"
                                 "[[sensors]]\nname = \"camera\"\nkind = \"imaging\"\nbeams = 2\n"
                                 "horizontal_deg = 80\nvertical_deg = 30\ntilt_deg = 15\nrange_min_m = 4\n"
                                 "range_max_m = 9\nsamples = 5\ntransmit_pattern = \"gaussian\"\n"
                                 "transmit_pattern_angle = \"azimuth\"\ntransmit_beam_width_deg = 10\n"
                                 "receive_pattern = \"gaussian\"\nreceive_pattern_angle = \"azimuth\"\n"
                                 "receive_beam_width_deg = 10\n",
                             [](RunRequest& r) { r.label_level_db = 10; });
  const auto sums = [&](const char* name) {  // all of the energy, and that near the peak
    std::pair<double, double> sum;
    for (std::size_t k = 0; k < t.labels.owners.size(); ++k)
      for (std::size_t cell = 0; cell < t.labels.cells; ++cell) {
        if (t.labels.owners[k].object != t.object(name)) continue;
        sum.first += t.raw(0, k, cell);
        sum.second += t.raw(0, t.labels.first_near_peak() + k, cell);
      }
    return sum;
  };
  EXPECT_GT(sums("ahead").second, 0.99 * sums("ahead").first);
  EXPECT_GT(sums("aside").first, 0);
  EXPECT_EQ(sums("aside").second, 0);  // 14 degrees off the nearer beam: 23 dB
}

TEST_F(LabelsOf, TheFileNamesTheLevelOfItsLabels) {
  const auto scene = folder.write("scene.toml", ball_in_side_lobes());
  const auto out = folder / "out";
  const Outcome outcome =
      run_program({"run", scene.string(), "-o", out.string(), "--labels", "--label-level", "12"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const NetcdfReader file(out / "echoes.nc");
  EXPECT_THAT(file.text("/", "long_name", "object_label"),
              HasSubstr("within 12 dB of the two-way peak of its pattern"));
  for (const auto& [words, why] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--label-level", "12"}, "add --labels"},
           {{"--labels", "--label-level", "0"}, "--label-level 0: expected decibels"},
           {{"--labels", "--label-level", "nan"}, "--label-level"}}) {
    std::vector<std::string> command{"run", scene.string(), "-o", (folder / "none").string()};
    command.insert(command.end(), words.begin(), words.end());
    const Outcome refused = run_program(command);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr(why));
  }
}

}  // namespace
}  // namespace tubefoot
