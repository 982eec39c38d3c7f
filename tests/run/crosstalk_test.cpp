// SPDX-License-Identifier: GPL-3.0-or-later
// Tests interlaced firing of an acoustic camera. A point-like target in beam 40 of 96 has levels in the
// other beams that follow from the product of the published patterns. Each firing cycle has the pose of its
// own time.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/world/echoes.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t beams = 96, cycles = 8, target = 40;
constexpr double aperture_m = 0.1015, wavelength_m = 1500 / 1.8e6;

double azimuth_of(std::size_t beam) { return (-14.5 + 29.0 / 96 * (double(beam) + 0.5)) * degree; }

/// A sphere of half a millimetre on the axis of the target's beam, at 4 m. The seabed is out of range.
std::string ball_scene(const std::string& patterns) {
  return fmt::format(R"([water]
sound_speed_m_s = 1500
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 10
length_m = 10
centre_m = [0, 0, -50]
[[objects]]
name = "ball"
shape = "sphere"
radius_m = 0.0005
chord_error_m = 0.00002
position_m = [{:.9f}, {:.9f}, 0]
[trajectory]
kind = "fixed"
[[sensors]]
name = "camera"
kind = "didson"
cycles = 8
window_start_m = 3.9
window_length_m = 0.5
samples = 4
{})",
                     4 * std::sin(azimuth_of(target)), 4 * std::cos(azimuth_of(target)), patterns);
}

/// Power of a uniform line that is steered to a beam, in the direction of another.
double line(std::size_t beam, std::size_t toward) {
  const double u = aperture_m / wavelength_m * (std::sin(azimuth_of(toward)) - std::sin(azimuth_of(beam)));
  const double x = std::numbers::pi * u;
  return std::abs(x) < 1e-9 ? 1 : std::pow(std::sin(x) / x, 2);
}

double db(double ratio) { return 10 * std::log10(ratio); }

TEST(CrossTalk, SideLobesHearWhatTheirCycleHasLit) {
  const Echoes echoes = echoes_of(
      ball_scene("transmit_pattern = \"line\"\ntransmit_aperture_m = 0.1015\n"
                 "receive_pattern = \"line\"\nreceive_aperture_m = 0.1015\nreceive_margin_deg = 1\n"));
  const double own = echoes.beam_total(0, target);
  ASSERT_GT(own, 0);
  double lit_by_own_cycle = 0;
  for (std::size_t sent = target % cycles; sent < beams; sent += cycles)
    lit_by_own_cycle += line(sent, target);
  for (std::size_t beam = 0; beam < beams; ++beam) {
    double lit = 0;
    for (std::size_t sent = beam % cycles; sent < beams; sent += cycles) lit += line(sent, target);
    const double expected = db(line(beam, target) * lit / lit_by_own_cycle);
    if (expected < -60) continue;  // near a null the sphere is no longer a point
    EXPECT_NEAR(db(echoes.beam_total(0, beam) / own), expected, 0.5) << "beam " << beam;
  }
  // Uniform lines of 0.3 degrees two-way at intervals of 0.302 degrees: these are the figures of the
  // patterns alone.
  for (const std::size_t ghost : {target - cycles, target + cycles}) {
    const double level = db(echoes.beam_total(0, ghost) / own);
    EXPECT_NEAR(level, -31.84, 0.5);
    EXPECT_GT(level - 2 * -31.84, 30) << "above what both ways of the side lobe would leave";
  }
}

TEST(CrossTalk, IdealBeamsHaveNone) {
  const Echoes echoes = echoes_of(ball_scene(""));
  for (std::size_t beam = 0; beam < beams; ++beam) {
    if (beam == target)
      EXPECT_GT(echoes.beam_total(0, beam), 0);
    else
      EXPECT_EQ(echoes.beam_total(0, beam), 0) << "beam " << beam;
  }
}

TEST(Interlacing, EachCycleSeesFromItsOwnTimeAndPlace) {
  const auto scene = [](const std::string& sensor) {
    return R"([[materials]]
name = "sand"
[[terrain]]
kind = "fractal"
width_m = 20
length_m = 24
cell_m = 0.5
[trajectory]
kind = "line"
start_m = [0, -4, 2]
end_m = [2, 4, 2]
[[sensors]]
name = "camera"
kind = "didson"
beams = 6
horizontal_deg = 6
tilt_deg = 30
vertical_deg = 20
samples = 64
window_start_m = 2
window_length_m = 4
)" + sensor;
  };
  const Echoes interlaced =
      echoes_of(scene("cycles = 3\ncycle_interval_s = 0.5\nfiring_order = [2, 0, 1]\n"));
  for (std::size_t place = 0; place < 3; ++place) {
    const std::size_t cycle = std::array{2, 0, 1}[place];
    const Echoes then = echoes_of(scene(fmt::format("first_ping_s = {}\n", 0.5 * double(place))));
    const std::size_t samples = then.energy.size() / 6;
    for (const std::size_t beam : {cycle, cycle + 3})
      for (std::size_t k = beam * samples; k < (beam + 1) * samples; ++k)
        EXPECT_NEAR(interlaced.energy[k], then.energy[k], 1e-12 * then.beam_total(0, beam));
    EXPECT_GT(then.beam_total(0, cycle), 0);
  }
}

}  // namespace
}  // namespace tubefoot
