// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the recordings of array elements. The comparisons are sums over the scatterers of the surface
// without polygons, and the energies of the same run.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <glm/geometric.hpp>

#include "engine/signal/surface_field.hpp"
#include "files/input_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/signals.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/recordings/signal_recording.hpp"
#include "sensors/signals/point_signals.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Complex = std::complex<double>;

constexpr double sound_speed = 1500;

/// The array is mounted so that it sees all of a small seabed, 6 m below and ahead.
std::string array_scene(const std::string& sensor, const std::string& more = "", double extent_m = 1.5) {
  return fmt::format(
      "[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 0\n"
      "[[materials]]\nname = \"sand\"\nlambert_db = -20\n"
      "[[terrain]]\nkind = \"flat\"\ncentre_m = [0.3, 6, -6]\nwidth_m = {}\nlength_m = {}\n{}"
      "[[sensors]]\nname = \"sonar\"\nkind = \"array\"\ntilt_deg = 45\nfrequency_khz = 30\n"
      "bandwidth_khz = 6\npulse_length_us = 500\npulse_taper = 0.4\nrange_min_m = 6.5\nrange_max_m = 11\n"
      "horizontal_deg = 50\nvertical_deg = 50\n{}",
      extent_m, extent_m, more, sensor);
}
const std::string at_rest = "[trajectory]\nkind = \"fixed\"\n";

struct SignalsRun : testing::Test {
  TestFolder folder;
  std::unique_ptr<const Survey> survey;
  std::vector<Recording> recordings;

  ElementSignals signals_of(const std::string& text, std::size_t sensor = 0) {
    const SceneDescription description = read_scene_file(folder.write("scene.toml", text));
    RunRequest request = request_of(description.run);
    survey = open_survey(description, facets_for_signals);
    SimulationStats stats;
    recordings = simulate(*survey, request, stats);
    return element_signals_of(recordings.at(sensor));
  }
  static constexpr Facets facets_for_signals = Facets::merged;
};

double largest(const ElementSignals& signals) {
  double most = 0;
  for (const Complex& value : signals.pressure) most = std::max(most, std::abs(value));
  return most;
}

double largest_difference(const ElementSignals& a, const ElementSignals& b) {
  double most = 0;
  EXPECT_EQ(a.pressure.size(), b.pressure.size());
  for (std::size_t k = 0; k < a.pressure.size(); ++k)
    most = std::max(most, std::abs(a.pressure[k] - b.pressure[k]));
  return most;
}

/// As of_points(), for ends that move: each sample has the delay of the motion of the vehicle.
ElementSignals of_points_on_the_way(const ElementSignals& like, const SurfaceField& field,
                                    glm::dvec3 middle_m, double half_m) {
  ElementSignals sum = like;
  std::fill(sum.pressure.begin(), sum.pressure.end(), 0);
  const double mu = std::pow(10, -2), until_s = like.sampling.end_s();
  const std::vector<glm::dvec3> corners{
      middle_m + glm::dvec3(-half_m, -half_m, 0), middle_m + glm::dvec3(half_m, -half_m, 0),
      middle_m + glm::dvec3(half_m, half_m, 0), middle_m + glm::dvec3(-half_m, half_m, 0)};
  for (std::size_t ping = 0; ping < like.pings(); ++ping) {
    const PlaceMotion sent(like.motion, ping, like.array.transmitter_m, until_s);
    for (std::size_t e = 0; e < like.receivers(); ++e) {
      const PlaceMotion received(like.motion, ping, like.array.receivers_m[e], until_s);
      field.for_scatterers(corners, {0, 0, 1}, [&](glm::dvec3 place, Complex z) {
        for (std::size_t k = 0; k < like.samples(); ++k) {
          const double t = like.sampling.time_s(k);
          const TwoWayPath path = path_received_at(t, sent, place, received, like.sound_speed_m_s);
          const double up = sent.at(path.emitted_s).z - place.z, over = received.at(t).z - place.z;
          sum.channel(ping, e)[k] += z * std::sqrt(mu * up / path.tx_m * over / path.rx_m) /
                                     (path.tx_m * path.rx_m) *
                                     baseband_at(like.waveform, like.sampling.baseband_hz, path.emitted_s) *
                                     std::polar(1.0, 2 * pi * like.sampling.baseband_hz * path.delay_s());
        }
      });
    }
  }
  return sum;
}

/// Sums over all scatterers of an unobstructed level square with Lambert's law, as points. Both legs are
/// straight, with the amplitude a(x) = sqrt(mu sin sin) / (r s).
ElementSignals of_points(const ElementSignals& like, const SurfaceField& field, glm::dvec3 middle_m,
                         double half_m) {
  ElementSignals sum = like;
  std::fill(sum.pressure.begin(), sum.pressure.end(), 0);
  const double mu = std::pow(10, -2);
  const std::vector<glm::dvec3> corners{
      middle_m + glm::dvec3(-half_m, -half_m, 0), middle_m + glm::dvec3(half_m, -half_m, 0),
      middle_m + glm::dvec3(half_m, half_m, 0), middle_m + glm::dvec3(-half_m, half_m, 0)};
  std::vector<std::pair<glm::dvec3, Complex>> scatterers;
  field.for_scatterers(corners, {0, 0, 1},
                       [&](glm::dvec3 place, Complex z) { scatterers.emplace_back(place, z); });
  EXPECT_GT(scatterers.size(), 50u);
  for (std::size_t ping = 0; ping < like.pings(); ++ping) {
    const Pose pose = like.motion.ping_pose(ping);
    const glm::dvec3 sent = pose.position_m + pose.attitude * like.array.transmitter_m;
    for (std::size_t e = 0; e < like.receivers(); ++e) {
      const glm::dvec3 received = pose.position_m + pose.attitude * like.array.receivers_m[e];
      for (const auto& [place, z] : scatterers) {
        const double r = glm::distance(place, sent), s = glm::distance(place, received),
                     tau = (r + s) / like.sound_speed_m_s;
        const Complex amplitude = z * std::sqrt(mu * (sent.z - place.z) / r * (received.z - place.z) / s) /
                                  (r * s) * std::polar(1.0, 2 * pi * like.sampling.baseband_hz * tau);
        for (std::size_t k = 0; k < like.samples(); ++k)
          sum.channel(ping, e)[k] += amplitude * baseband_at(like.waveform, like.sampling.baseband_hz,
                                                             like.sampling.time_s(k) - tau);
      }
    }
  }
  return sum;
}

// From the scene file to the recordings of the elements. The scene has motion from ping to ping, elements
// off the middle, a mounting, and a mixing frequency off the middle of the band.
TEST_F(SignalsRun, AreThoseOfTheSurfacesScatterers) {
  const ElementSignals signals = signals_of(array_scene(
      "baseband_khz = 30.5\nsampling_frequency_khz = 20\nsignal_tolerance = 1e-6\nlever_arm_m = [0.1, 0.2, "
      "0.3]\n"
      "receivers_m = [[0, 0, 0], [0.4, 0, -0.1], [-0.2, 0.3, 0]]\npings = 2\nping_interval_s = 1\n",
      "[trajectory]\nkind = \"line\"\nstart_m = [0.1, -0.3, 0]\nend_m = [0.2, 0.7, 0.2]\nspeed_m_s = 0.5\n"));
  ASSERT_EQ(signals.pings(), 2u);
  ASSERT_EQ(signals.receivers(), 3u);
  const ElementSignals points = of_points(signals, surface_field_of(*survey), {0.3, 6, -6}, 0.75);
  ASSERT_GT(largest(points), 0);
  EXPECT_LE(largest_difference(signals, points), 1e-5 * largest(points));
  EXPECT_NEAR(glm::distance(signals.motion.ping_pose(1).position_m, signals.motion.ping_pose(0).position_m),
              0.5, 1e-9);
}

// The mean of |signal|^2 over many scatterer fields is the energy, without the parts that a box hides.
TEST_F(SignalsRun, HaveTheEnergiesOfTheSameVisibility) {
  const std::string box =
      "[[objects]]\nname = \"box\"\nshape = \"box\"\nsize_m = [0.5, 0.2, 0.6]\nposition_m = [0.2, 5.8, "
      "-5.7]\n";
  constexpr int surface_meshes = 60;
  std::vector<double> mean, energy;
  for (int seed = 1; seed <= surface_meshes; ++seed) {
    const ElementSignals signals = signals_of(
        array_scene("receivers = 1\n", at_rest + box + fmt::format("[run]\nseed = {}\n", seed), 3));
    mean.resize(signals.samples());
    for (std::size_t k = 0; k < signals.samples(); ++k)
      mean[k] += std::norm(signals.channel(0, 0)[k]) / signals.sampling.rate_hz / surface_meshes;
    energy.assign(recordings[0].energy.begin(), recordings[0].energy.end());
  }
  ASSERT_EQ(mean.size(), energy.size());
  double all = 0, expected = 0;
  for (std::size_t k = 0; k < mean.size(); ++k) {
    all += mean[k];
    expected += energy[k];
  }
  // A few dozen resolution cells with exponential intensities, over 60 scatterer fields.
  EXPECT_NEAR(all / expected, 1, 0.1);
}

TEST_F(SignalsRun, AreTheSurfacesForEveryoneAndEveryThread) {
  const std::string two =
      array_scene("receivers = 3\n", at_rest) +
      "[[sensors]]\nname = \"other\"\nkind = \"array\"\ntilt_deg = 45\nfrequency_khz = 30\nbandwidth_khz = "
      "6\n"
      "pulse_length_us = 500\npulse_taper = 0.4\nrange_min_m = 6.5\nrange_max_m = 11\nhorizontal_deg = 52\n"
      "vertical_deg = 52\nreceivers = 3\n[scatterers]\nspacing_m = 0.006\n";
  const ElementSignals first = signals_of(two), second = element_signals_of(recordings.at(1)),
                       again = signals_of(two + "[run]\nthreads = 1\n");
  // Another sector has the same scatterers, to the tolerance of both.
  EXPECT_LE(largest_difference(first, second), 2e-3 * largest(first));
  EXPECT_EQ(first.pressure, again.pressure);
  EXPECT_GT(largest_difference(first, signals_of(two + "[run]\nseed = 2\n")), 0.3 * largest(first));
}

TEST_F(SignalsRun, OfASeparateReceiverAreThoseOfTheSurfacesScatterers) {
  const ElementSignals signals = signals_of(array_scene(
      "receiver_arm_m = [1, 0.5, 0.2]\nreceivers_m = [[0, 0, 0], [0.1, 0, 0]]\nsignal_tolerance = 1e-6\n",
      at_rest));
  EXPECT_NEAR(signals.array.receivers_m[1].x, 1.1, 1e-12);
  const ElementSignals points = of_points(signals, surface_field_of(*survey), {0.3, 6, -6}, 0.75);
  EXPECT_LE(largest_difference(signals, points), 1e-5 * largest(points));
}

// For distant elements with their own views, the signals equal those of separate receivers. They differ
// from the transmitter's view, because a wall stands between.
TEST_F(SignalsRun, OfOwnViewsAreThoseOfSeparateReceivers) {
  const std::string wall =
      "[[objects]]\nname = \"wall\"\nshape = \"box\"\nsize_m = [0.1, 1, 1.2]\nposition_m = [0.3, 5.8, "
      "-5.5]\n";
  const auto only = [&](const std::string& sensor) {
    return signals_of(array_scene(sensor, at_rest + wall, 3));
  };
  const std::string fine = "signal_tolerance = 1e-6\n";
  const ElementSignals own =
                           only("own_sights = true\nreceivers_m = [[-1, 0.2, 0.1], [1.5, 0, 0.2]]\n" + fine),
                       shared = only("receivers_m = [[-1, 0.2, 0.1], [1.5, 0, 0.2]]\n" + fine);
  // The arms are in the axes of the vehicle, 45 degrees from those of the sensor.
  const glm::dvec3 places[] = {own.array.receivers_m[0], own.array.receivers_m[1]};
  for (std::size_t e = 0; e < 2; ++e) {
    const ElementSignals apart =
        only(fmt::format("receiver_arm_m = [{:.17g}, {:.17g}, {:.17g}]\nreceivers = 1\n{}", places[e].x,
                         places[e].y, places[e].z, fine));
    for (std::size_t k = 0; k < own.samples(); ++k)
      ASSERT_NEAR(std::abs(own.channel(0, e)[k] - apart.channel(0, 0)[k]), 0, 1e-5 * largest(own)) << k;
  }
  EXPECT_GT(largest_difference(own, shared), 0.05 * largest(own));
}

// At 12 m/s the Doppler shift turns the pulse of a ping by a quarter of a cycle. The vehicle moves 6 m from
// ping to ping.
TEST_F(SignalsRun, OfAVehicleOnTheWayAreThoseOfTheSurfacesScatterers) {
  const std::string track =
      "[trajectory]\nkind = \"line\"\nstart_m = [0.1, -3, 0]\nend_m = [0.2, 9, 0.2]\nspeed_m_s = 12\n";
  const std::string sensor =
      "lever_arm_m = [0.1, 0.2, 0.3]\nreceivers_m = [[0, 0, 0], [0.4, 0, -0.1]]\nsignal_tolerance = 1e-6\n"
      "first_ping_s = 0.2\n";
  const ElementSignals moving = signals_of(array_scene(sensor + "stop_and_hop = false\n", track));
  const ElementSignals points = of_points_on_the_way(moving, surface_field_of(*survey), {0.3, 6, -6}, 0.75);
  EXPECT_FALSE(moving.motion.stop_and_hop());
  EXPECT_LE(largest_difference(moving, points), 1e-5 * largest(points));
  const ElementSignals hopping = signals_of(array_scene(sensor, track));
  EXPECT_GT(largest_difference(moving, hopping), 0.1 * largest(points));
}

// Clocks count seconds since 1970, which doubles round to a quarter of a microsecond. Positions within a
// ping do not jump.
TEST_F(SignalsRun, OfAVehicleOnTheWayLateOnItsClock) {
  constexpr double epoch_s = 1.7e9;
  const auto at = [&](double start_s) {
    folder.write("track.csv",
                 fmt::format("time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n{:.17g},0.1,0,0,0,"
                             "0,0\n{:.17g},0.1,8,0,0,0,0\n",
                             start_s, start_s + 2));
    return signals_of(array_scene(fmt::format("receivers = 2\nsignal_tolerance = 1e-5\nstop_and_hop = false\n"
                                              "first_ping_s = {:.17g}\n",
                                              start_s + 0.5),
                                  "[trajectory]\nkind = \"waypoints\"\nfile = \"track.csv\"\n"));
  };
  const ElementSignals early = at(0), late = at(epoch_s);
  EXPECT_GT(largest(early), 0);
  // A quarter of a microsecond at the start of the ping is a micrometre of motion.
  EXPECT_LE(largest_difference(early, late), 1e-3 * largest(early));
}

// The range limit of a distant receiver is that of its own path.
TEST_F(SignalsRun, OfOwnViewsReachAsFarAsThoseOfSeparateReceivers) {
  const std::string far =
      replaced(array_scene("receiver_arm_m = [0, -4, 0]\nreceivers_m = [[0, 0, 0]]\n", at_rest),
               "range_max_m = 11", "range_max_m = 10.6");
  const ElementSignals apart = signals_of(far), own = signals_of(far + "own_sights = true\n");
  EXPECT_GT(largest(apart), 0);
  EXPECT_LE(largest_difference(apart, own), 1e-9 * largest(apart));
}

TEST_F(SignalsRun, OfOneThatIsTurnedToLook) {
  const ElementSignals signals = signals_of(
      replaced(array_scene("look_at_m = [0.3, 6, -6]\nreceivers = 2\nsignal_tolerance = 1e-6\n", at_rest),
               "tilt_deg = 45\n", ""));
  const ElementSignals points = of_points(signals, surface_field_of(*survey), {0.3, 6, -6}, 0.75);
  EXPECT_LE(largest_difference(signals, points), 1e-5 * largest(points));
}

// The echo of a smooth plane is an image of the transmitter: R / 2h, with its sign. It precedes the echoes
// of its edges and of the sector. A rough plane would give speckle.
TEST_F(SignalsRun, OfASmoothPlaneAreItsImage) {
  const double height_m = 3, reflection = -0.5;
  const ElementSignals signals = signals_of(
      "[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 0\n"
      "[[materials]]\nname = \"foam\"\nsmooth = true\nreflection = -0.5\n"
      "[[terrain]]\nkind = \"flat\"\ncentre_m = [0.3, 0.1, -3]\nwidth_m = 16\nlength_m = 16\n" +
      at_rest +
      "[[sensors]]\nname = \"sonar\"\nkind = \"array\"\ntilt_deg = 90\nfrequency_khz = 30\nbandwidth_khz = "
      "6\n"
      "pulse_length_us = 500\npulse_taper = 1\nrange_min_m = 2.5\nrange_max_m = 3.6\nhorizontal_deg = 110\n"
      "vertical_deg = 110\nreceivers_m = [[0, 0, 0], [0.1, 0.05, 0.02]]\nsampling_frequency_khz = 40\n");
  for (std::size_t e = 0; e < 2; ++e) {
    // In the axes of the vehicle.
    const glm::dvec3 receiver = signals.array.receivers_m[e];
    const double way_m = std::hypot(receiver.x, receiver.y, 2 * height_m + receiver.z),
                 tau = way_m / sound_speed;
    double peak = 0;
    for (std::size_t k = 0; k < signals.samples(); ++k) {
      const Complex image =
          reflection / way_m *
          baseband_at(signals.waveform, signals.sampling.baseband_hz, signals.sampling.time_s(k) - tau) *
          std::polar(1.0, 2 * pi * signals.sampling.baseband_hz * tau);
      peak = std::max(peak, std::abs(image));
      EXPECT_NEAR(std::abs(signals.channel(0, e)[k] - image), 0,
                  2e-3 * std::abs(reflection) / way_m *
                      envelope_at(signals.waveform, signals.waveform.duration_s / 2))
          << e << ' ' << k;
    }
    EXPECT_GT(peak, 0);
  }
}

// Products that are impossible with few pings are omitted. The program reports this before the run and
// after it, and writes the others.
TEST_F(SignalsRun, ProductsThatCannotBeMadeAreLeftOut) {
  const auto file = folder.write(
      "scene.toml",
      array_scene(
          "receivers = 2\nproducts = [\"sidescan\", \"fan\", \"interferogram\"]\nupper = [0]\nlower = [1]\n"
          "pings = 6\n",
          at_rest));
  const auto out = folder / "out";
  const Outcome check = run_program({"check", file.string()}),
                run = run_program({"run", file.string(), "-o", out.string(), "--pings", "0:2"});
  EXPECT_EQ(check.exit_code, 0) << check.err;
  EXPECT_THAT(check.err + check.out, HasSubstr("'sonar': tubefoot does not compute the beams abeam: "));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("'sonar': tubefoot does not compute the beams abeam: "));
  EXPECT_TRUE(std::filesystem::exists(out / "sonar-signals.nc"));
  EXPECT_TRUE(std::filesystem::exists(out / "sonar-fan.png"));
  EXPECT_FALSE(std::filesystem::exists(out / "sonar-sidescan.png"));
  // A cell averages four pings, or as many as exist.
  EXPECT_TRUE(std::filesystem::exists(out / "sonar-interferogram.png"));
}

// Products depend on the mounting of the array: four elements along the keel make the beam of a sidescan,
// and no fan.
TEST_F(SignalsRun, ProductsAreOfArraysAsTheyAreMounted) {
  const auto file =
      folder.write("scene.toml",
                   array_scene("yaw_deg = 90\nreceivers = 4\nproducts = [\"sidescan\", \"fan\"]\n", at_rest));
  const Outcome outcome = run_program({"check", file.string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err + outcome.out, HasSubstr("tubefoot does not compute the fan"));
  EXPECT_THAT(outcome.err + outcome.out,
              testing::Not(HasSubstr("tubefoot does not compute the beams abeam")));
}

struct SignalRefusals : testing::Test {
  TestFolder folder;
  std::string said(const std::string& text) {
    const Outcome outcome = run_program({"check", folder.write("scene.toml", text).string()});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    return outcome.err;
  }
};

TEST_F(SignalRefusals, SayWhatIsWrongAndWhatToDo) {
  EXPECT_THAT(said(replaced(array_scene("", at_rest), "pulse_length_us = 500\n", "")),
              HasSubstr("pulse_length_us"));
  EXPECT_THAT(said(array_scene("sampling_frequency_khz = 5\n", at_rest)), HasSubstr("sample at"));
  EXPECT_THAT(
      said(replaced(array_scene("", at_rest), "pulse_length_us = 500\n", "pulse_length_us = 20000\n")),
      HasSubstr("longer than"));
  EXPECT_THAT(said(array_scene("receivers = 2\nreceivers_m = [[0, 0, 0]]\n", at_rest)),
              HasSubstr("remove 'receivers'"));
  EXPECT_THAT(said(array_scene("products = [\"aperture\"]\n", at_rest)), HasSubstr("'picture_m'"));
  EXPECT_THAT(said(array_scene("pixel_m = 0.1\n", at_rest)), HasSubstr("'pixel_m'"));
  EXPECT_THAT(said(array_scene("formats = [\"jsf\"]\n", at_rest)), HasSubstr("sidescan"));
  EXPECT_THAT(said(array_scene("products = [\"fan\"]\nformats = [\"sonar_netcdf\"]\n", at_rest)),
              HasSubstr("across the track"));
  EXPECT_THAT(said(array_scene("noise_level_db = 60\n", at_rest)), HasSubstr("'noise_level_db'"));
  EXPECT_THAT(said(array_scene("products = [\"sidescan\"]\nbeams = 5\n", at_rest)), HasSubstr("'beams'"));
  EXPECT_THAT(said(array_scene("products = [\"interferogram\"]\nupper = [0]\nlower = [1]\nsides = \"both\"\n",
                               at_rest)),
              HasSubstr("one side"));
  EXPECT_THAT(said(replaced(array_scene("receivers = 4096\nsampling_frequency_khz = 3000\n", at_rest),
                            "frequency_khz = 30\n", "frequency_khz = 2900\n")),
              HasSubstr("512 MB"));
  EXPECT_THAT(said(array_scene("products = [\"interferogram\"]\nupper = [0]\nlower = [40]\n", at_rest)),
              HasSubstr("receiver 40"));
  EXPECT_THAT(said(replaced(array_scene("", at_rest + "[run]\ngrid_exponent = 4\n"), "frequency_khz = 30\n",
                            "frequency_khz = 300\n")),
              HasSubstr("wavelength"));
  // Products that no run can make are an error at the position of the key, not omitted.
  EXPECT_THAT(said(array_scene("products = [\"fan\"]\nbeams = 1\n", at_rest)),
              HasSubstr("'beams' must be 2 to 4096"));
  EXPECT_THAT(said(array_scene("products = [\"interferogram\"]\nupper = [1]\nlower = [1]\n", at_rest)),
              HasSubstr("same receivers"));
  for (const char* pixels : {"picture_m = [-1e7, -1e7, 1e7, 1e7]\npixel_m = 1e-4\n",
                             "picture_m = [0, 0, 0.01, 0.01]\n", "picture_m = [0, 0, 0.04, 9]\n"})
    EXPECT_THAT(said(array_scene("pings = 2\nproducts = [\"aperture\"]\n" + std::string(pixels), at_rest)),
                HasSubstr("pixels, but the picture must have 2 x 2 or more, and 4194304 at most"))
        << pixels;
  // Absurd pulse lengths and sampling rates are reported with the keys of the array.
  for (const char* length : {"1e-9", "1e-300"})
    EXPECT_THAT(said(replaced(array_scene("", at_rest), "pulse_length_us = 500\n",
                              fmt::format("pulse_length_us = {}\n", length))),
                HasSubstr("too short for 27000 Hz"));
  EXPECT_THAT(said(replaced(array_scene("sampling_frequency_khz = 10000\n", at_rest), "range_max_m = 11",
                            "range_max_m = 100000")),
              HasSubstr("samples at 10000 kHz, but the limit is 65536"));
  // Scatterer fields that are too dense for the available time, or beyond the range of the lattice, are
  // rejected at once, with the position.
  const std::string dense = "[scatterers]\nspacing_m = 0.0001\n";
  EXPECT_THAT(said(replaced(array_scene("receivers = 1\n", at_rest + dense, 60), "range_max_m = 11",
                            "range_max_m = 60")),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("scatterers at a spacing of 0.0001 m"),
                    HasSubstr("'spacing_m' to")));
  EXPECT_THAT(
      said(replaced(array_scene("", "[trajectory]\nkind = \"fixed\"\nposition_m = [900000, 0, 0]\n" + dense),
                    "[0.3, 6, -6]", "[900000.3, 6, -6]")),
      AllOf(HasSubstr("scene.toml:"), HasSubstr("larger spacing")));
  EXPECT_THAT(said(array_scene(
                  "stop_and_hop = false\npings = 2\nping_interval_s = 0.5\n",
                  "[trajectory]\nkind = \"line\"\nstart_m = [0, 0, 0]\nend_m = [1, 0, 0]\nspeed_m_s = 2\n")),
              HasSubstr("last sample"));
}

}  // namespace
}  // namespace tubefoot
