// SPDX-License-Identifier: GPL-3.0-or-later
// Tests drawings of scenes. The test reads positions back from the SVG by its own axes and compares them
// with the scene. It draws each shipped scene and typical mistakes, and runs the commands that write
// drawings.
#include "plan/scene_drawing.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <regex>
#include <sstream>

#include "files/input_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/test_folder.hpp"
#include "plan/sheet.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string drawing_of(const std::string& scene) {
  const auto survey = open_survey(read_scene_text(scene, "scene.toml"));
  return scene_drawing(*survey, placements(*survey));
}

using Texts = std::vector<std::tuple<double, double, std::string>>;

/// Elements of one name, each as its attributes; the content of a text has the key "".
std::vector<std::map<std::string, std::string>> elements(const std::string& svg, const std::string& name) {
  std::vector<std::map<std::string, std::string>> all;
  static const std::regex attribute("([a-z0-9-]+)=\"([^\"]*)\"");
  for (std::size_t at = 0; (at = svg.find("<" + name + " ", at)) != std::string::npos;) {
    const std::size_t end = svg.find('>', at);
    const std::string inner = svg.substr(at, end - at);
    auto& found = all.emplace_back();
    for (std::sregex_iterator k(inner.begin(), inner.end(), attribute), none; k != none; ++k)
      found[(*k)[1]] = (*k)[2];
    found[""] = svg.substr(end + 1, svg.find('<', end) - end - 1);
    at = end;
  }
  return all;
}

double number(const std::map<std::string, std::string>& element, const std::string& name) {
  return std::stod(element.at(name));
}

/// A panel of a drawing, found by its title: its frame, and metres by the labels of its ticks.
struct ReadPanel {
  Box frame;
  double right_m = 0, right_px = 0, right_slope = 0, up_m = 0, up_px = 0, up_slope = 0;

  ReadPanel(const std::string& svg, const std::string& title) {
    std::optional<glm::dvec2> corner;
    for (const auto& text : elements(svg, "text"))
      if (text.at("").starts_with(title)) corner = {number(text, "x"), number(text, "y") + 8};
    if (!corner) throw std::runtime_error("no panel has the title " + title);
    for (const auto& box : elements(svg, "rect"))
      if (box.contains("x") && std::abs(number(box, "x") - corner->x) < 0.2 &&
          std::abs(number(box, "y") - corner->y) < 0.2)
        frame = {corner->x, corner->y, corner->x + number(box, "width"), corner->y + number(box, "height")};
    std::vector<std::pair<double, double>> right, up;  // pixels, metres
    for (const auto& text : elements(svg, "text")) {
      if (!std::regex_match(text.at(""), std::regex("-?[0-9.]+"))) continue;
      const double x = number(text, "x"), y = number(text, "y"), value = std::stod(text.at(""));
      if (std::abs(y - frame.bottom - 17) < 0.2 && x > frame.left - 1 && x < frame.right + 1)
        right.push_back({x, value});
      if (std::abs(x - frame.left + 8) < 0.2 && y > frame.top && y < frame.bottom + 8)
        up.push_back({y - 4, value});
    }
    if (right.size() < 2 || up.size() < 2) throw std::runtime_error("too few ticks");
    right_px = right.front().first, right_m = right.front().second;
    right_slope = (right.back().second - right_m) / (right.back().first - right_px);
    up_px = up.front().first, up_m = up.front().second;
    up_slope = (up.back().second - up_m) / (up.back().first - up_px);
  }
  glm::dvec2 metres(glm::dvec2 at) const {
    return {right_m + (at.x - right_px) * right_slope, up_m + (at.y - up_px) * up_slope};
  }
  bool holds(glm::dvec2 at) const { return frame.holds({at.x, at.y, at.x, at.y}); }
  double metres_a_pixel() const { return std::abs(right_slope); }

  /// Positions of sensors.
  std::vector<glm::dvec2> sensors(const std::string& svg) const {
    std::vector<glm::dvec2> places;
    for (const auto& circle : elements(svg, "circle")) {
      const glm::dvec2 at(number(circle, "cx"), number(circle, "cy"));
      if (holds(at)) places.push_back(metres(at));
    }
    return places;
  }
  /// Bounding box of all solid paths of a colour.
  Box outline(const std::string& svg, const std::string& colour) const {
    Box box = Box::none();
    for (const auto& path : elements(svg, "path")) {
      if (!path.contains("stroke") || path.at("stroke") != colour || path.contains("stroke-dasharray"))
        continue;
      std::string data = path.at("d");
      for (char& c : data)
        if (std::string("MLZ").find(c) != std::string::npos) c = ' ';
      std::istringstream numbers(data);
      for (double x, y; numbers >> x >> y;)
        if (holds({x, y})) box.add(metres({x, y}));
    }
    return box;
  }
};

/// Returns whether a coordinate is NaN or infinite. The base64 text of pictures may contain such letters,
/// too.
bool has_no_number(const std::string& svg) {
  for (const char* word : {"nan", "inf"})
    for (std::size_t at = 0; (at = svg.find(word, at)) != std::string::npos; ++at) {
      const auto is_letter = [&](std::size_t k) {
        return std::isalnum(static_cast<unsigned char>(svg[k])) != 0 || svg[k] == '+' || svg[k] == '/';
      };
      if ((!is_letter(at - 1) || svg[at - 1] == 'M' || svg[at - 1] == 'L') && !is_letter(at + 3)) return true;
    }
  return false;
}

const std::string ground = still_water() + lambert_material("sand", -27);
constexpr const char *first_colour = "#0072b2", *object_colour = "#6d1b1b";

std::string imaging(const std::string& keys) {
  return "[[sensors]]\nname = \"eye\"\nkind = \"imaging\"\nbeams = 20\nsamples = 50\n" + keys;
}

TEST(SceneDrawing, AxesTellWhereASensorIsAndHowFarItReceives) {
  // 4 m over a flat seabed, looking east, 30 degrees down, a fan of 40 x 20 degrees.
  const std::string svg = drawing_of(
      ground + flat_terrain(40, 30) + fixed_at(-12, 3, 4, "heading_deg = 90\n") +
      imaging("horizontal_deg = 40\nvertical_deg = 20\ntilt_deg = 30\nrange_min_m = 2\nrange_max_m = 30\n"));
  const ReadPanel plan(svg, "Plan"), section(svg, "Section A");
  const double pixel = plan.metres_a_pixel(), near_pixel = section.metres_a_pixel();
  ASSERT_EQ(plan.sensors(svg).size(), 1u);
  EXPECT_NEAR(plan.sensors(svg)[0].x, -12, pixel);
  EXPECT_NEAR(plan.sensors(svg)[0].y, 3, pixel);
  EXPECT_NEAR(section.sensors(svg)[0].x, 0, near_pixel);
  EXPECT_NEAR(section.sensors(svg)[0].y, 4, near_pixel);
  // The corners of the fan, 20 degrees aside and 10 up or down from its middle, which is tilted 30 degrees
  // down.
  const auto rad = [](double degrees) { return degrees * std::numbers::pi / 180; };
  const auto ahead = [&](double up) {
    return std::cos(rad(20)) * std::cos(rad(up)) * std::cos(rad(30)) + std::sin(rad(up)) * std::sin(rad(30));
  };
  const double down = std::cos(rad(20)) * std::cos(rad(10)) * std::sin(rad(30)) -
                      std::sin(rad(10)) * std::cos(rad(30)),
               far_m = 4 / down;
  const Box received = plan.outline(svg, first_colour), from_side = section.outline(svg, first_colour);
  EXPECT_NEAR(received.right, -12 + far_m * ahead(10), 2 * pixel);
  EXPECT_NEAR(received.bottom, 3 + far_m * std::sin(rad(20)) * std::cos(rad(10)), 2 * pixel);
  EXPECT_NEAR(received.top, 3 - far_m * std::sin(rad(20)) * std::cos(rad(10)), 2 * pixel);
  EXPECT_NEAR(from_side.right, far_m * ahead(10), 2 * near_pixel);
  EXPECT_NEAR(from_side.top, 0, 2 * near_pixel) << "to the bed";
  EXPECT_NEAR(from_side.left, 2 * ahead(-10), 2 * near_pixel) << "from where the window begins";
}

TEST(SceneDrawing, SectionsLieWhereASensorLooks) {
  const auto title = [](const std::string& svg) {
    std::smatch found;
    EXPECT_TRUE(std::regex_search(svg, found, std::regex("Section A to A', towards ([0-9]+) degrees")) ||
                std::regex_search(svg, found, std::regex("towards ([0-9]+) degrees")));
    return found.empty() ? std::string() : found[1].str();
  };
  const std::string seabed = ground + flat_terrain(60, 60);
  const std::string way = fixed_at(0, 0, 5, "heading_deg = 30\n");
  EXPECT_EQ(title(drawing_of(seabed + way + imaging("tilt_deg = 25\nrange_max_m = 20\n"))), "30");
  const std::string line = "[trajectory]\nkind = \"line\"\nstart_m = [0, -10, 5]\nend_m = [0, 10, 5]\n";
  for (const char* kind : {"multibeam", "sidescan"}) {
    const std::string sensor = fmt::format(
        "[[sensors]]\nname = \"fan\"\nkind = \"{}\"\nrange_max_m = 25\nsamples = 50\n"
        "ping_interval_s = 1\npings = 2\n",
        kind);
    EXPECT_EQ(title(drawing_of(seabed + line + sensor)), "90") << kind << " looks across its track";
  }
}

TEST(SceneDrawing, ObjectsAreDrawnWhereTheyAreAndBuriedOnesAreReported) {
  const std::string svg = drawing_of(
      ground + flat_terrain(40, 30) + fixed_at(0, -10, 4) +
      "[[objects]]\nname = \"crate\"\nshape = \"box\"\nsize_m = [4, 2, 3]\nposition_m = [5, 6, 1.5]\n"
      "[[objects]]\nname = \"<chest>\"\nshape = \"box\"\nsize_m = [1, 1, 1]\nposition_m = [-8, 0, -3]\n" +
      imaging("horizontal_deg = 40\nvertical_deg = 20\ntilt_deg = 12\nrange_min_m = 1\nrange_max_m = 30\n"));
  const ReadPanel plan(svg, "Plan");
  const Box crate = plan.outline(svg, object_colour);
  const double pixel = plan.metres_a_pixel();
  EXPECT_NEAR(crate.left, 3, 2 * pixel);
  EXPECT_NEAR(crate.right, 7, 2 * pixel);
  EXPECT_NEAR(crate.top, 5, 2 * pixel);
  EXPECT_NEAR(crate.bottom, 7, 2 * pixel);
  EXPECT_THAT(svg, HasSubstr(">crate</text>"));
  EXPECT_THAT(svg, HasSubstr("&lt;chest&gt; (buried)</text>"));
  EXPECT_THAT(svg, HasSubstr("object below the seabed"));
}

TEST(SceneDrawing, WhatIsNotReceivedIsNotDrawnAsReceived) {
  const std::string seabed = ground + flat_terrain(40, 30) + fixed_at(0, 0, 3);
  const auto received = [](const std::string& svg) {
    for (const auto& path : elements(svg, "path"))
      if (path.contains("stroke") && path.at("stroke") == first_colour && !path.contains("stroke-dasharray"))
        return true;
    return false;
  };
  EXPECT_TRUE(received(drawing_of(seabed + imaging("tilt_deg = 25\nrange_min_m = 1\nrange_max_m = 20\n"))));
  EXPECT_FALSE(received(drawing_of(
      seabed +
      imaging(
          "horizontal_deg = 40\nvertical_deg = 15\ntilt_deg = 25\nrange_min_m = 60\nrange_max_m = 65\n"))))
      << "a window behind the bed";
}

TEST(SceneDrawing, ASensorBesideTheTerrainIsDrawnWithItAndTheWayBetween) {
  const std::string svg = drawing_of(ground + flat_terrain(40, 30) + fixed_at(3020, 15, 3) +
                                     imaging("tilt_deg = 25\nrange_max_m = 20\n"));
  EXPECT_THAT(svg, HasSubstr("3 km to the terrain"));
  EXPECT_THAT(svg, HasSubstr("no terrain in this section"));
  EXPECT_THAT(svg, HasSubstr(">terrain</text>"));
  const ReadPanel all(svg, "Plan of the scene"), near(svg, "Plan near");
  EXPECT_NEAR(all.sensors(svg)[0].x, 3020, all.metres_a_pixel());
  EXPECT_NEAR(near.sensors(svg)[0].x, 3020, near.metres_a_pixel());
  EXPECT_LT(near.metres_a_pixel(), 0.1);
}

TEST(SceneDrawing, SoundEndsAtTheSeaSurface) {
  const std::string svg = drawing_of(
      ground + flat_terrain(60, 60, "centre_m = [0, 0, -10]\n") + "[sea_surface]\nheight_m = 0\n" +
      fixed_at(0, 0, -5) + imaging("vertical_deg = 60\ntilt_deg = 0\nrange_min_m = 1\nrange_max_m = 20\n"));
  const ReadPanel section(svg, "Section A");
  EXPECT_NEAR(section.outline(svg, first_colour).bottom, 0, 2 * std::abs(section.up_slope));
  EXPECT_THAT(svg, HasSubstr("sea surface"));
}

TEST(SceneDrawing, NeitherVastNorTinyNorMissingThingsHangIt) {
  const std::string eye = imaging("tilt_deg = 25\nrange_min_m = 1\nrange_max_m = 20\n"),
                    vast = imaging("tilt_deg = 5\nrange_min_m = 1\nrange_max_m = 1e5\n"),
                    here = fixed_at(0, 0, 3), in_utm = fixed_at(500'000, 6'500'000, 3);
  const std::string box =
      "[[objects]]\nname = \"box\"\nshape = \"box\"\nsize_m = [1, 1, 1]\nposition_m = [0, 7, 0.5]\n";
  for (const std::string& scene :
       {ground + flat_terrain(1e6, 1e6) + here + eye, ground + flat_terrain(1e-3, 1e-3) + here + eye,
        ground + flat_terrain(30, 1e-3) + here + eye, ground + flat_terrain(40, 40) + in_utm + eye,
        ground + flat_terrain(40, 40) + here + vast, ground + box + here + eye,
        ground + flat_terrain(1e-3, 1e6) + in_utm + vast}) {
    const auto start = std::chrono::steady_clock::now();
    const std::string svg = drawing_of(scene);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
    EXPECT_LT(svg.size(), 1'000'000u);
    EXPECT_FALSE(has_no_number(svg));
    EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
  }
}

TEST(SceneDrawing, ItsTicksStayApart) {
  for (const double width : {1e-3, 7.0, 123.0, 45'678.0, 1e6}) {
    const std::string svg = drawing_of(ground + flat_terrain(width, width) + fixed_at(0, 0, 3) +
                                       imaging("tilt_deg = 25\nrange_min_m = 1\nrange_max_m = 20\n"));
    std::map<double, std::vector<std::pair<double, double>>> rows;  // by height: middles and widths
    for (const auto& text : elements(svg, "text"))
      if (text.contains("text-anchor") && text.at("text-anchor") == "middle" &&
          std::regex_match(text.at(""), std::regex("-?[0-9.]+")))
        rows[number(text, "y")].push_back({number(text, "x"), width_of(text.at(""), 10.5)});
    EXPECT_GE(rows.size(), 2u);
    for (auto& [y, labels] : rows) {
      std::ranges::sort(labels);
      for (std::size_t k = 0; k + 1 < labels.size(); ++k)
        EXPECT_GT(labels[k + 1].first - labels[k].first, (labels[k].second + labels[k + 1].second) / 2)
            << width;
    }
  }
}

// --- the commands

class ScenePicture : public testing::Test {
 protected:
  ScenePicture() {
    folder.write("scene.toml", small_scene);
    folder.write("thing.obj", tetrahedron);
  }
  Outcome check(const std::string& picture) {
    return run_program({"check", (folder / "scene.toml").string(), "--png", (folder / picture).string()});
  }
  TestFolder folder;
};

bool is_png(const fs::path& file) { return bytes_of(file).starts_with("\x89PNG\r\n\x1a\n"); }

TEST_F(ScenePicture, CheckWritesIt) {
  const Outcome outcome = check("new/scene.png");
  ASSERT_NE(outcome.exit_code, 0) << "its folder is not there";
  const Outcome second = check("scene.png");
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_TRUE(is_png(folder / "scene.png"));
  EXPECT_THAT(second.out, HasSubstr("wrote " + (folder / "scene.png").string()));
}

TEST_F(ScenePicture, PlacesThatCannotBeWrittenAreRefusedBeforeAnythingIsLoaded) {
  folder.write("scene.toml", replaced(small_scene, "thing.obj", "broken.obj"));
  folder.write("broken.obj", "f 1 2 3\n");
  for (const auto& [name, what] : {std::pair{"missing/scene.png", "missing"}, std::pair{"scene.jpg", ".png"},
                                   std::pair{"scene.toml", ".png"}}) {
    const Outcome outcome = check(name);
    EXPECT_EQ(outcome.exit_code, 2) << name << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(what));
    EXPECT_THAT(outcome.err, Not(HasSubstr("broken.obj")));
  }
  // The command never overwrites an input, for any name.
  folder.write("thing.png", tetrahedron);
  folder.write("scene.toml", replaced(small_scene, "thing.obj", "thing.png"));
  EXPECT_NE(check("thing.png").exit_code, 0);
  EXPECT_EQ(bytes_of(folder / "thing.png"), tetrahedron);
}

TEST_F(ScenePicture, ABadSceneLeavesNoneAndTheEarlierOneInPlace) {
  ASSERT_EQ(check("scene.png").exit_code, 0);
  const std::string before = bytes_of(folder / "scene.png");
  folder.write("scene.toml", replaced(small_scene, "beams = 4", "beams = -4"));
  EXPECT_NE(check("scene.png").exit_code, 0);
  EXPECT_EQ(bytes_of(folder / "scene.png"), before);
}

TEST_F(ScenePicture, LiesInARunsFolderAndOnAPageOfTheViewer) {
  const Outcome ran =
      run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string(), "--quiet"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_TRUE(is_png(folder / "out/scene.png"));
  EXPECT_THAT(ran.out, HasSubstr("out/scene.png"));
  const Outcome viewed =
      run_program({"view", (folder / "scene.toml").string(), "-o", (folder / "page.html").string()});
  ASSERT_EQ(viewed.exit_code, 0) << viewed.err;
  const std::string page = bytes_of(folder / "page.html");
  EXPECT_THAT(page, HasSubstr("<summary>Plan and sections</summary><div><svg "));
  EXPECT_THAT(page, Not(HasSubstr("<!--{")));
}

TEST(ScenesShipped, AreAllDrawn) {
  const fs::path scenes = fs::path(TUBEFOOT_SOURCE_DIR) / "scenes";
  std::size_t drawn = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(scenes)) {
    const fs::path& file = entry.path();
    if (file.extension() != ".toml" || file.parent_path().filename() == "presets") continue;
    SCOPED_TRACE(file.string());
    std::unique_ptr<const Survey> survey;
    try {
      survey = open_survey(read_scene_file(file));
    } catch (const InputError& error) {
      if (std::string(error.what()).find("there is no file") == std::string::npos) throw;
      continue;  // data that is generated or downloaded
    }
    const auto start = std::chrono::steady_clock::now();
    const std::string svg = scene_drawing(*survey, {});
    std::printf("%s: drawn in %.2f s, %zu kB\n", file.c_str(),
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                svg.size() / 1000);
    EXPECT_THAT(svg, HasSubstr(">Plan"));
    EXPECT_THAT(svg, HasSubstr("Section A to A'"));
    EXPECT_FALSE(has_no_number(svg));
    EXPECT_LT(svg.size(), 1'500'000u);
    ++drawn;
  }
  EXPECT_GE(drawn, 25u);
}

}  // namespace
}  // namespace tubefoot
