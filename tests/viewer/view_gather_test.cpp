// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the data of a viewer page: the terms of each sample are complete and correct, and shadows are at
// their positions.
#include "viewer/view_gather.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "engine/echo/echo.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "files/usage_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "scene/description/scene_description.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "viewer/page.hpp"

namespace tubefoot {
namespace {

constexpr double most_bytes_a_footprint = 140;

/// A box on a rough seabed that extends beyond the range samples on both sides.
std::string rough_scene(const std::string& material, const std::string& sensor) {
  return lambert_material("sand", -27) + material + "\n" + lambert_material("steel", -8) +
         rough_terrain(40, 60, 0.5, "material = \"sand\"\nrms_height_m = 0.05\n") + box_ahead(5) +
         "[[sensors]]\nname = \"sonar\"\n" + sensor;
}

const std::string camera = R"(kind = "didson"
pings = 2
tilt_deg = 25
beams = 12
window_start_m = 5
window_length_m = 2.5
samples = 100
)",
                  lobes = R"(transmit_pattern = "line"
transmit_aperture_m = 0.02
receive_pattern = "line"
receive_aperture_m = 0.06
)",
                  in_motion = "stop_and_hop = false\nmotion_step_beams = 0.002\n",
                  camera_with_lobes = camera + lobes, apart = camera + "receiver_arm_m = [0.4, 0, 0.1]\n",
                  refracted = R"([water]
profile = "gradient"
sound_speed_m_s = 1500
gradient_per_s = 0.5
profile_bottom_m = 30
surface_height_m = 10
)",
                  sidescan = R"(kind = "sidescan"
pings = 5
range_max_m = 15
samples = 200
)",
                  ripples = R"([[materials.reflectivity]]
kind = "perlin"
wavelength_m = 0.2
)";

struct Case {
  std::string name, material, sensor, run;
};

/// Gathers the data as `tubefoot view` does.
ViewData view_of(const Survey& survey, std::size_t sensor, const std::optional<PingRange>& pings,
                 const ViewLimits& limits = {}) {
  return gather_view(Transmissions(survey, request_of(survey.scene.description.run)), sensor, pings, true,
                     limits);
}

class Links : public testing::TestWithParam<Case> {
 protected:
  TestFolder folder;
  std::string scene = rough_scene(GetParam().material, GetParam().sensor) + GetParam().run;
  std::unique_ptr<const Survey> survey = open_survey(read_scene_file(folder.write("scene.toml", scene)));
};

INSTANTIATE_TEST_SUITE_P(
    Scenes, Links,
    testing::Values(Case{"Camera", "", camera, ""}, Case{"Sidescan", "", sidescan, ""},
                    Case{"Moving", "", sidescan + in_motion, ""}, Case{"Lobes", "", camera_with_lobes, ""},
                    Case{"Apart", "", apart, ""}, Case{"ApartLobes", "", apart + lobes, ""},
                    Case{"ApartBent", refracted, apart, ""}, Case{"Texture", ripples, camera, ""},
                    Case{"Spread", "", camera, "[run]\nbinning = \"spread\"\n"},
                    Case{"Centroid", ripples, camera, "[run]\nbinning = \"centroid\"\n"}),
    [](const auto& one) { return one.param.name; });

TEST_P(Links, AddUpToTheEchoOfARun) {
  const Echoes run = echoes_in(folder, scene);
  const ViewData view = view_of(*survey, 0, PingRange{1, 1});
  ASSERT_EQ(view.pings.size(), 1u);
  EXPECT_EQ(view.pings[0].number, 1u);
  ASSERT_EQ(view.energy_j.size(), run.beams * run.samples);
  std::vector<double> sum(view.energy_j.size(), 0.0);
  std::vector<double> of_footprint(view.footprints.size(), 0.0);
  for (const ViewLink& link : view.links) {
    EXPECT_GT(link.energy_j, 0);
    sum.at(link.cell) += link.energy_j;
    of_footprint.at(link.footprint) += link.energy_j;
  }
  // For two apexes each integral has a tolerance of 1e-10: of a tube in one case, of a facet in the other.
  const double error = view.separate_receiver ? 1e-7 : 1e-12;
  double total = 0, left_out = 0;
  for (std::size_t cell = 0; cell < sum.size(); ++cell) {
    const double recorded = run.at(1, cell / run.samples, cell % run.samples);
    EXPECT_NEAR(view.energy_j[cell], recorded, error * recorded) << "cell " << cell;
    if (!view.weak_links_left_out) {
      EXPECT_NEAR(sum[cell], recorded, error * recorded) << "cell " << cell;
    }
    EXPECT_LE(sum[cell], recorded * (1 + std::max(error, 1e-9)));
    total += recorded;
    left_out += recorded - sum[cell];
  }
  EXPECT_GT(total, 0);
  EXPECT_LT(left_out, 0.2 * total);
  for (std::size_t f = 0; f < of_footprint.size(); ++f)
    EXPECT_NEAR(of_footprint[f], view.footprints[f].energy_j, 1e-12 * of_footprint[f]);
}

TEST_P(Links, LeadFromEveryFootprintInReachToSamplesThatItMeets) {
  const ViewData view = view_of(*survey, 0, PingRange{0, 1});
  const double last_m = view.first_m + view.samples * view.step_m;
  std::vector<int> links(view.footprints.size(), 0);
  std::uint32_t before = 0;
  for (const ViewLink& link : view.links) {
    EXPECT_GE(link.footprint, before) << "links lie footprint by footprint";
    before = link.footprint;
    ++links[link.footprint];
    const ViewFootprint& f = view.footprints[link.footprint];
    const std::uint32_t sample = link.cell % view.samples, beam = link.cell / view.samples % view.beams,
                        ping = link.cell / view.samples / view.beams;
    EXPECT_EQ(ping, f.ping);
    if (!view.weak_links_left_out) {
      EXPECT_EQ(beam, f.beam);
    }
    EXPECT_GT(f.far_m, view.first_m + sample * view.step_m - 1e-9);
    EXPECT_LT(f.near_m, view.first_m + (sample + 1) * view.step_m + 1e-9);
  }
  std::size_t in_reach = 0, beyond = 0;
  for (std::size_t f = 0; f < view.footprints.size(); ++f) {
    const ViewFootprint& footprint = view.footprints[f];
    if (footprint.far_m < view.first_m || footprint.near_m > last_m) {
      ++beyond;
      EXPECT_EQ(links[f], 0);
    } else if (footprint.near_m > view.first_m && footprint.far_m < last_m && footprint.area_m2 > 1e-12) {
      ++in_reach;
      EXPECT_GT(links[f], 0) << "footprint " << f;
    }
  }
  EXPECT_GT(in_reach, 20u);
  // Otherwise the first of these two expectations is empty.
  if (view.kind == "didson") {
    EXPECT_GT(beyond, 0u);
  }
}

/// All terms of any size, with patterns too.
TEST_P(Links, LoseNothingIfNothingIsLeftOut) {
  if (survey->sensors[0].sensor->has_separate_receiver()) GTEST_SKIP() << "told by facets, not by footprints";
  const Transmissions transmissions(*survey, request_of(survey->scene.description.run));
  const Transmission transmission = transmissions.received_by(0, 0, 0);
  const Sensor& sensor = transmission.sensor(0);
  const History history = transmission.trace();
  const SensorModel model = transmission.model(0);
  const Echo echo = transmission.echo(history, 0, model.model);
  std::vector<double> sum(echo.energy.size(), 0.0);
  for (const Contribution& c :
       contributions(history, {transmission.beams(0), sensor.beam_of_tube(0)}, sensor.samples(), model.model,
                     transmissions.request().binning, echo))
    sum.at(std::size_t(c.beam) * echo.samples + c.sample) += c.energy_j;
  const double peak = *std::max_element(echo.energy.begin(), echo.energy.end());
  EXPECT_GT(peak, 0);
  for (std::size_t cell = 0; cell < sum.size(); ++cell)
    EXPECT_NEAR(sum[cell], echo.energy[cell], 1e-12 * (model.model.patterns ? peak : echo.energy[cell]))
        << "cell " << cell;
}

TEST(ViewedPings, AreAsManyAsFit) {
  const TestFolder folder;
  const auto cameras = open_survey(read_scene_file(folder.write("camera.toml", rough_scene("", camera))));
  const ViewData frame = view_of(*cameras, 0, {});
  EXPECT_EQ(frame.pings.size(), 2u);
  EXPECT_EQ(frame.layout, PictureLayout::fan);
  EXPECT_TRUE(frame.notes.empty());
  ViewLimits one_frame;
  one_frame.cells_unasked = 2 * 12 * 100 - 1;
  const ViewData first = view_of(*cameras, 0, {}, one_frame);
  EXPECT_EQ(first.pings.size(), 1u);
  EXPECT_THAT(first.notes, testing::Contains(testing::HasSubstr("Pings 0 to 0 of 2")));
  const auto lines = open_survey(read_scene_file(folder.write("sidescan.toml", rough_scene("", sidescan))));
  const ViewData line = view_of(*lines, 0, {});
  EXPECT_EQ(line.pings.size(), 5u);
  EXPECT_EQ(line.layout, PictureLayout::waterfall);
  EXPECT_TRUE(line.notes.empty());
  // As many footprints as the limit permits, with a message about the rest.
  ViewLimits limits;
  limits.footprints_unasked = line.footprints.size() / 2;
  const ViewData part = view_of(*lines, 0, {}, limits);
  EXPECT_LT(part.pings.size(), 5u);
  EXPECT_GE(part.footprints.size(), limits.footprints_unasked);
  EXPECT_THAT(part.notes, testing::Contains(testing::HasSubstr("of 5: tubefoot view --pings A:B")));
  // A page with too much data reports the amount.
  limits.footprints = line.footprints.size() - 1;
  try {
    view_of(*lines, 0, PingRange{0, 4}, limits);
    FAIL() << "one footprint too many";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("use --pings 0:3"));
  }
  limits.footprints = 10;
  EXPECT_THROW(view_of(*lines, 0, PingRange{0, 4}, limits), UsageError);
}

/// A flat seabed of two facets seen from 2 m, with or without a cube of 1 m on it.
std::string flat_scene(bool with_box) {
  return std::string(R"([[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 40
length_m = 60
)") + (with_box ? "[[objects]]\nname = \"cube\"\nshape = \"box\"\nposition_m = [0, 5, 0.5]\n" : "") +
         R"([trajectory]
kind = "fixed"
position_m = [0, 0, 2]
[[sensors]]
name = "sonar"
kind = "didson"
beams = 24
tilt_deg = 22
vertical_deg = 28
window_start_m = 1
window_length_m = 20
)";
}

/// Number of polygons of a list that contain a point of the seabed in plan view.
int holding(const ViewPolygons& polygons, double x, double y) {
  int count = 0;
  std::size_t corner = 0;
  for (const std::uint16_t n : polygons.corners_of) {
    bool left = true, right = true, surface_apex = true;
    for (std::size_t k = 0; k < n; ++k) {
      const glm::dvec3 a = polygons.corners_m[corner + k], b = polygons.corners_m[corner + (k + 1) % n];
      const double side = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
      left = left && side >= 0;
      right = right && side <= 0;
      surface_apex = surface_apex && std::abs(a.z) < 1e-6;
    }
    corner += n;
    count += surface_apex && (left || right);
  }
  return count;
}

TEST(ViewedShadows, LieBehindWhatHides) {
  const TestFolder folder;
  const auto empty = open_survey(read_scene_file(folder.write("empty.toml", flat_scene(false))));
  const ViewData seabed = view_of(*empty, 0, {});
  EXPECT_TRUE(seabed.shadows.corners_of.empty()) << "nothing hides anything on a flat bed";
  EXPECT_GT(holding(seabed.shapes, 0.013, 5), 0);

  const auto survey = open_survey(read_scene_file(folder.write("cube.toml", flat_scene(true))));
  const ViewData view = view_of(*survey, 0, {});
  EXPECT_EQ(view.pings[0].shadows, view.shadows.corners_of.size());
  // The far upper edge of the cube, 5.5 m ahead and 1 m lower than the sonar, casts its shadow to 11 m.
  EXPECT_GT(holding(view.shadows, 0.013, 10.9), 0);
  EXPECT_EQ(holding(view.shapes, 0.013, 10.9), 0);
  EXPECT_GT(holding(view.shapes, 0.013, 11.1), 0);
  EXPECT_GT(holding(view.shapes, 0.013, 4.4), 0);
  // A point in the tubes is either part of a footprint or covered by a shadow.
  for (double y = 4; y < 14; y += 0.0917)
    EXPECT_GT(holding(view.shapes, 0.013, y) + holding(view.shadows, 0.013, y), 0) << y;
}

/// Both ends see the seabed except for the parts that the cube hides from either.
TEST(ViewedShadows, AreThoseOfBothEndsWhereTheReceiverIsApart) {
  const TestFolder folder;
  const auto survey = open_survey(
      read_scene_file(folder.write("scene.toml", flat_scene(true) + "receiver_arm_m = [3, 0, 0]\n")));
  const ViewData view = view_of(*survey, 0, {});
  EXPECT_TRUE(view.separate_receiver);
  EXPECT_EQ(view.pings[0].receiver_m, glm::dvec3(3, 0, 2));
  EXPECT_EQ(view.tubes.size(), 2 * survey->sensors[0].sensor->beam_of_tube(0).size());
  std::set<double> apexes;
  for (const ViewTube& tube : view.tubes) apexes.insert(std::round(tube.apex_m.x));
  EXPECT_EQ(apexes, (std::set<double>{0, 3}));
  const auto line_is_free = [](double from_x, double x,
                               double y) {  // over the cube, |x| < 0.5, 4.5 < y < 5.5
    for (double t = 0; t < 1; t += 1e-3) {
      const double z = 2 - 2 * t;
      if (z < 1 && std::abs(from_x + t * (x - from_x)) < 0.5 && std::abs(t * y - 5) < 0.5) return false;
    }
    return true;
  };
  std::size_t seen = 0, hidden = 0;
  for (double x = -0.9; x < 3; x += 0.317)
    for (double y = 6.05; y < 12; y += 0.473) {
      const bool both = line_is_free(0, x, y) && line_is_free(3, x, y);
      const int footprints = holding(view.shapes, x, y), shadows = holding(view.shadows, x, y);
      if (footprints > 0) {
        EXPECT_TRUE(both) << x << ' ' << y;
        ++seen;
      } else if (!both && shadows > 0) {
        ++hidden;
      }
    }
  EXPECT_GT(seen, 10u);
  EXPECT_GT(hidden, 5u);
  // Each footprint refers to the tubes of its two ends.
  for (const ViewFootprint& f : view.footprints) {
    EXPECT_EQ(std::round(view.tubes.at(f.drawn_tube).apex_m.x), 0);
    EXPECT_EQ(std::round(view.tubes.at(f.drawn_receive_tube).apex_m.x), 3);
    EXPECT_LE(f.near_m, f.far_m);
  }
}

/// Pings store common data once: the next ping adds only its own footprints and samples.
TEST(ViewedPages, GrowByTheFootprintsOfAPingOnly) {
  const TestFolder folder;
  const auto survey = open_survey(read_scene_file(folder.write("scene.toml", rough_scene("", camera))));
  const ViewData one = view_of(*survey, 0, PingRange{0, 0}), two = view_of(*survey, 0, PingRange{0, 1});
  const std::size_t first = view_page(one).size(), both = view_page(two).size();
  const auto more = static_cast<double>(two.footprints.size() - one.footprints.size());
  EXPECT_GT(more, 300);
  EXPECT_LT(static_cast<double>(both - first) / more, most_bytes_a_footprint);
  EXPECT_LT(static_cast<double>(both), 1.7 * static_cast<double>(first));
}

/// A camera with firing cycles on a carrier at 1 m/s.
TEST(ViewedPings, SayWhyTheirCyclesDiffer) {
  const TestFolder folder;
  const std::string cycles = camera + "cycles = 3\ncycle_interval_s = 0.05\n";
  const auto moving = open_survey(read_scene_file(folder.write("moving.toml", rough_scene("", cycles))));
  const ViewData view = view_of(*moving, 0, PingRange{0, 0});
  ASSERT_EQ(view.transmissions.size(), 3u);
  EXPECT_THAT(view.stripes, testing::HasSubstr("12 beams in 3 cycles within 100 ms"));
  const SensorPings& pings = moving->sensors[0];
  const double way_m =
      glm::distance(pings.transmission_pose(0, 0).position_m, pings.transmission_pose(0, 2).position_m);
  EXPECT_GT(way_m, 0.01);
  EXPECT_THAT(view.stripes, testing::HasSubstr(fmt::format("moves by {:.2g} cm", 100 * way_m)));
  EXPECT_THAT(view.notes, testing::Contains(view.stripes));
  const auto one = open_survey(read_scene_file(folder.write("one.toml", rough_scene("", camera))));
  EXPECT_EQ(view_of(*one, 0, PingRange{0, 0}).stripes, "");
}

TEST(ViewedMesh, IsThatAboutTheFootprints) {
  const TestFolder folder;
  const auto survey = open_survey(read_scene_file(folder.write("scene.toml", rough_scene("", camera))));
  const std::size_t all = survey->scene.mesh.facets.size();
  const ViewData view = view_of(*survey, 0, {});
  EXPECT_GT(view.mesh_facets.size() / 3, 0u);
  EXPECT_LT(view.mesh_facets.size() / 3, all);
  for (const std::uint32_t v : view.mesh_facets) ASSERT_LT(v, view.mesh_vertices_m.size());
  ViewLimits limits;
  limits.mesh_facets = 100;
  const ViewData thin = view_of(*survey, 0, {}, limits);
  EXPECT_LE(thin.mesh_facets.size(), 300u);
  EXPECT_GT(thin.mesh_facets.size(), 0u);
  EXPECT_THAT(thin.notes, testing::Contains(testing::HasSubstr(fmt::format(
                              "{} of the facets", (view.mesh_facets.size() - thin.mesh_facets.size()) / 3))));
}

}  // namespace
}  // namespace tubefoot
