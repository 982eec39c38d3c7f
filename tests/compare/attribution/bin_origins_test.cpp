// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the kinds of the range bins of a wall on a plane, where all edges have closed forms, and the
// attribution of their energies.
#include "compare/attribution/bin_origins.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "fixtures/world/echoes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "run/survey.hpp"

namespace tubefoot {
namespace {

constexpr double height_m = 3, front_m = 6, rear_m = 6.2, top_m = 1, first_m = 5, step_m = 0.05;
constexpr std::size_t samples = 280, beams = 5;

/// A sonar over a plane. It looks ahead from 30.3 to 10.3 degrees downwards at a wall across all beams.
std::string scene_text(const std::string& more = {}) {
  return still_water() + lambert_material("sand", -20) + lambert_material("steel", -10) +
         flat_terrain(60, 60, "name = \"bed\"\nmaterial = \"sand\"\n") +
         fmt::format(
             "[[objects]]\nname = \"wall\"\nmaterial = \"steel\"\nshape = \"box\"\n"
             "size_m = [20, {}, 3]\nposition_m = [0, {}, {}]\n",
             rear_m - front_m, (front_m + rear_m) / 2, top_m - 1.5) +
         fixed_at(0, 0, height_m) +
         fmt::format(
             "[[sensors]]\nname = \"sonar\"\nkind = \"didson\"\nbeams = {}\nhorizontal_deg = 1\n"
             "tilt_deg = 20.3\nvertical_deg = 20\nsamples = {}\nwindow_start_m = {}\nwindow_length_m = "
             "{}\n{}",
             beams, samples, first_m, step_m * samples, more);
}

struct Found {
  TestFolder folder;
  std::unique_ptr<const Survey> survey;
  BinOrigins origins;

  explicit Found(const std::string& text) : survey(open_survey(read_scene(folder, text))) {
    const Transmissions transmissions(*survey, RunRequest{});
    TransmissionsAround around(transmissions);
    origins = bin_origins(transmissions, around, 0, 0);
  }
  /// The kind of a bin of the middle beam.
  BinKind at(double range_m) const {
    return origins.kind[beams / 2 * samples + static_cast<std::size_t>((range_m - first_m) / step_m)];
  }
};

double range_of(double ahead_m, double down_m) { return std::hypot(ahead_m, down_m); }

TEST(BinOrigins, KindsAreWhereTheEdgesLie) {
  const Found found(scene_text());
  const double shadow_end = range_of(rear_m * height_m / (height_m - top_m), height_m);
  EXPECT_EQ(found.at(5.5), BinKind::open_water);
  EXPECT_EQ(found.at(height_m / std::sin(30.3 * M_PI / 180)), BinKind::near_edge);
  EXPECT_EQ(found.at(6.2), BinKind::interior);  // the seabed before the wall
  EXPECT_EQ(found.at(range_of(front_m, height_m - top_m)),
            BinKind::facet_edge);  // the upper front edge of the wall
  EXPECT_EQ(found.at(range_of(rear_m, height_m - top_m)), BinKind::silhouette);
  EXPECT_EQ(found.at(range_of(front_m, height_m)), BinKind::facet_edge);  // foot of the wall
  EXPECT_EQ(found.at(8), BinKind::shadow);
  EXPECT_EQ(found.at(shadow_end - step_m), BinKind::shadow);
  EXPECT_EQ(found.at(shadow_end), BinKind::shadow_edge);
  EXPECT_EQ(found.at(14), BinKind::interior);
  EXPECT_EQ(found.at(height_m / std::sin(10.3 * M_PI / 180)), BinKind::far_edge);
  EXPECT_EQ(found.at(18.5), BinKind::shadow);  // no more energy behind the visible part
}

TEST(BinOrigins, TheWindowCutsAtTheFirstAndTheLastSample) {
  const Found found(replaced(scene_text(), "window_start_m = 5", "window_start_m = 10.5"));
  EXPECT_EQ(found.origins.kind.front(), BinKind::near_edge);
  EXPECT_EQ(found.origins.kind[1], BinKind::interior);
  const Found shorter(replaced(scene_text(), "window_length_m = 14", "window_length_m = 7.2"));
  EXPECT_EQ(shorter.origins.kind[samples - 1], BinKind::far_edge);
}

TEST(BinOrigins, PartsAreTheEchoAndLieWhereTheirObjectsDo) {
  const Found found(scene_text());
  const Transmissions transmissions(*found.survey, RunRequest{});
  const Transmission transmission = transmissions.received_by(0, 0, 0);
  const Echo echo = transmission.echo(transmission.trace(), 0, transmission.model(0).model);
  std::vector<double> sum(echo.energy.size());
  std::uint32_t before = 0;
  for (const BinPart& part : found.origins.parts) {
    EXPECT_GE(part.bin, before);
    before = part.bin;
    sum.at(part.bin) += part.energy_j;
    const double range_m = first_m + step_m * (double(part.bin % samples) + 0.5);
    EXPECT_EQ(part.object, part.material);  // the seabed is of sand, the wall of steel
    if (part.object == 1) {
      EXPECT_GT(range_m, range_of(front_m, height_m - top_m) - step_m);
      EXPECT_LT(range_m, range_of(front_m, height_m) + step_m);
    }
  }
  const double peak = *std::max_element(echo.energy.begin(), echo.energy.end());
  for (std::size_t bin = 0; bin < sum.size(); ++bin) EXPECT_NEAR(sum[bin], echo.energy[bin], 1e-12 * peak);
}

// Each interval of the record has the parts of its own bins.
TEST(BinOrigins, PartsOfASonarThatMovesAreTheEchoOfARun) {
  const TestFolder folder;
  const std::string text =
      replaced(scene_text("stop_and_hop = false\nmotion_step_beams = 0.1\n"), fixed_at(0, 0, height_m),
               fmt::format("[trajectory]\nkind = \"line\"\nstart_m = [0, 0, {0}]\nend_m = [0, 3, {0}]\n"
                           "speed_m_s = 8\n",
                           height_m));
  const Found found(text);
  ASSERT_GT(found.survey->sensors[0].sensor->transmissions(), 2u);
  const Echoes run = echoes_in(folder, text);
  std::vector<double> sum(run.energy.size());
  for (const BinPart& part : found.origins.parts) sum.at(part.bin) += part.energy_j;
  const double peak = *std::max_element(run.energy.begin(), run.energy.end());
  for (std::size_t bin = 0; bin < sum.size(); ++bin) EXPECT_NEAR(sum[bin], run.energy[bin], 1e-9 * peak);
}

TEST(BinOrigins, ASeparateReceiverHasItsOwnEdges) {
  // The same wall seen from half a metre higher casts a shorter shadow.
  const Found found(scene_text("receiver_arm_m = [0, 0, 0.5]\n"));
  const double seen_from = rear_m * (height_m + 0.5) / (height_m + 0.5 - top_m),
               ahead = std::max(seen_from, rear_m * height_m / (height_m - top_m));
  const double half_path = (range_of(ahead, height_m) + range_of(ahead, height_m + 0.5)) / 2;
  EXPECT_EQ(found.at(half_path + 4 * step_m), BinKind::interior);
  EXPECT_EQ(found.at(8), BinKind::shadow);
}

}  // namespace
}  // namespace tubefoot
