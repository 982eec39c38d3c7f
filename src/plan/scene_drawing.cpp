// SPDX-License-Identifier: GPL-3.0-or-later
// Arranges the views of a scene on one drawing: a plan and a side view of the whole scene. If the scene is
// much larger than the surroundings of the first sensor, it adds a plan and a section of these.
#include "plan/scene_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <new>
#include <optional>

#include "files/memory_at_hand.hpp"
#include "plan/legend.hpp"
#include "plan/painter.hpp"
#include "study/svg_png.hpp"

namespace tubefoot {
namespace {

// Dimensions of the drawing, in pixels.
constexpr double panel_width = 440, first_left = 76, second_left = 602, legend_left = 1066,
                 paper_width = 1316, first_top = 76, gap_below = 74, lowest_paper = 520;

/// Positions that a view must contain.
struct Places {
  std::vector<glm::dvec3> all_m;

  void add(glm::dvec3 place_m) {
    if (std::isfinite(place_m.x) && std::isfinite(place_m.y) && std::isfinite(place_m.z))
      all_m.push_back(place_m);
  }
  void add(const Extent& extent) {
    if (extent.empty()) return;
    for (int k = 0; k < 8; ++k)
      add(glm::dvec3((k & 1 ? extent.hi_m : extent.lo_m).x, (k & 2 ? extent.hi_m : extent.lo_m).y,
                     (k & 4 ? extent.hi_m : extent.lo_m).z));
  }
  Extent extent() const {
    Extent all;
    for (const glm::dvec3& place_m : all_m) all.add(place_m);
    return all;
  }
  /// Returns a window with a margin around the positions. Its least size ensures that labels have enough
  /// digits.
  Window window(const View& view) const {
    Window window;
    if (!all_m.empty()) window.lo_m = window.hi_m = view.of(all_m.front());
    for (const glm::dvec3& place_m : all_m) {
      window.lo_m = glm::min(window.lo_m, view.of(place_m));
      window.hi_m = glm::max(window.hi_m, view.of(place_m));
    }
    constexpr double room = 0.06, least_m = 0.1, digits = 1e-8;
    const glm::dvec2 size = window.hi_m - window.lo_m,
                     far = glm::max(glm::abs(window.lo_m), glm::abs(window.hi_m));
    const glm::dvec2 margin =
        glm::max(room * size, glm::dvec2(std::max({least_m / 2, digits * far.x, digits * far.y})));
    return {window.lo_m - margin, window.hi_m + margin};
  }
};

double largest_side_m(const Extent& extent) {
  const glm::dvec3 size = extent.hi_m - extent.lo_m;
  return extent.empty() ? 0 : std::max({size.x, size.y, size.z});
}

/// Adds the region in which a sector receives echoes, or its whole range gate if there are none.
void add_reach(const SectorMark& sector, Places& places) {
  places.add(sector.pose.position_m);
  for (const SectorCell& cell : sector.cells)
    for (std::size_t k = 0; k < 4; ++k) {
      places.add(cell.at(k, sector.first_m));
      places.add(cell.at(k, cell.is_received(sector.first_m) ? cell.recorded_to_m[k] : sector.last_m));
    }
}

/// Computes the ranges of the sectors on height maps of the seabed with sufficient resolution for each
/// sector.
void look_for_seabed(const Survey& survey, SceneMarks& marks) {
  constexpr int cells = 360;
  const std::optional<SeaSurfaceDescription>& sea = survey.scene.description.sea_surface;
  const std::optional<double> surface_m = sea ? std::optional(sea->height_m) : std::nullopt;
  const Window terrain{glm::dvec2(marks.terrain.lo_m), glm::dvec2(marks.terrain.hi_m)};
  const auto map_of = [&](const Window& window) {
    // A border ensures that directions along the edge of the window meet the map.
    const glm::dvec2 size = window.hi_m - window.lo_m, border(0.02 * std::max(size.x, size.y));
    PlanHeights map({window.lo_m - border, window.hi_m + border}, cells);
    each_terrain_facet(survey, map.window(), [&](const auto& facet) { map.add(facet); });
    return map;
  };
  std::optional<PlanHeights> coarse;
  for (SectorMark& sector : marks.sectors) {
    if (marks.terrain.empty()) {
      look_for_seabed(sector, PlanHeights({{0, 0}, {1, 1}}, 1), surface_m);
      continue;
    }
    Extent reach;
    for (const SectorCell& cell : sector.cells)
      for (std::size_t k = 0; k < 4; ++k) reach.add(cell.at(k, sector.last_m));
    reach.add(sector.pose.position_m);
    const Window window{glm::max(glm::dvec2(reach.lo_m), terrain.lo_m),
                        glm::min(glm::dvec2(reach.hi_m), terrain.hi_m)};
    const glm::dvec2 size = window.hi_m - window.lo_m;
    constexpr double much_smaller = 0.12;
    if (sector.chosen && size.x > 0 && size.y > 0 &&
        std::max(size.x, size.y) < much_smaller * largest_side_m(marks.terrain)) {
      look_for_seabed(sector, map_of(window), surface_m);
      continue;
    }
    if (!coarse) coarse.emplace(map_of(terrain));
    look_for_seabed(sector, *coarse, surface_m);
  }
}

/// Contents of the views of a drawing.
struct Scope {
  Places all, near;
  bool has_near = false;  ///< the surroundings of the first sensor need a plan of their own
  const SectorMark* first = nullptr;
};

Scope scope_of(const SceneMarks& marks) {
  Scope scope;
  Places still;  // without sectors
  still.add(marks.terrain);
  for (const ObjectMark& object : marks.objects) still.add(object.extent);
  for (const TrackMark& track : marks.tracks)
    for (const std::vector<glm::dvec3>& line : track.lines_m)
      for (const glm::dvec3& place_m : line) still.add(place_m);
  scope.all = still;
  for (const SectorMark& sector : marks.sectors) {
    add_reach(sector, scope.all);
    if (sector.chosen && (scope.first == nullptr)) scope.first = &sector;
  }
  if (scope.first == nullptr) return scope;
  add_reach(*scope.first, scope.near);
  const double reach_m = largest_side_m(scope.near.extent());
  for (const SectorMark& sector : marks.sectors)
    if (sector.chosen && &sector != scope.first &&
        glm::distance(sector.pose.position_m, scope.first->pose.position_m) < reach_m)
      add_reach(sector, scope.near);
  const Extent reached = scope.near.extent();
  for (const ObjectMark& object : marks.objects)
    if (glm::all(glm::lessThanEqual(glm::dvec2(reached.lo_m), glm::dvec2(object.extent.lo_m))) &&
        glm::all(glm::lessThanEqual(glm::dvec2(object.extent.hi_m), glm::dvec2(reached.hi_m))))
      scope.near.add(object.extent);
  constexpr double far_larger = 4, worth_it = 2;
  if (largest_side_m(scope.near.extent()) > far_larger * largest_side_m(still.extent()) &&
      largest_side_m(still.extent()) > 0)
    scope.near = still;
  scope.has_near = largest_side_m(scope.all.extent()) > worth_it * largest_side_m(scope.near.extent());
  return scope;
}

class Drawing {
 public:
  Drawing(const Survey& survey, std::span<const SeabedPlacement> placements)
      : survey_(survey), marks_(marks_of(survey, placements)), painter_(survey_, marks_, sheet_) {
    look_for_seabed(survey, marks_);
    scope_ = scope_of(marks_);
  }

  std::string svg() {
    const SceneDescription& scene = survey_.scene.description;
    const double bottom = scope_.has_near ? draw_whole_and_near() : draw_plan_and_sections();
    sheet_.text({first_left, 26}, scene.title.empty() ? scene.file.filename().string() : scene.title,
                {.size = 16, .bold = true});
    sheet_.text({first_left, 46}, frame_words(survey_.scene), {.size = 11, .colour = "#5c646d"});
    const double end =
        draw_legend(sheet_, {legend_left, first_top - 8}, survey_, marks_, painter_.was_coarse());
    return sheet_.svg(paper_width, std::max({bottom, end + 16, lowest_paper}));
  }

 private:
  static std::string stretched(const std::string& title, double stretch) {
    return stretch > 1 ? fmt::format("{} (heights x {:g})", title, stretch) : title;
  }

  static double height_for(const Window& window, double least, double most) {
    const glm::dvec2 size = window.hi_m - window.lo_m;
    return std::clamp(panel_width * size.y / size.x, least, most);
  }

  /// Returns the view of a section. Its origin is below the sensor, at height 0 of the scene.
  Painter::Cut cut(const std::string& letter, glm::dvec3 right) const {
    const glm::dvec3 at_m = scope_.first->pose.position_m;
    return {{{at_m.x, at_m.y, 0}, right, {0, 0, 1}}, letter};
  }

  std::string path_words(const Painter::Cut& cut) const {
    const glm::dvec3 right = cut.view.right;
    double bearing = std::fmod(glm::degrees(std::atan2(right.x, right.y)) + 360, 360.0);
    if (bearing > 359.5) bearing = 0;
    return fmt::format("{} to {}', towards {:.0f} degrees", cut.letter, cut.letter, bearing);
  }

  void draw_section(const Box& box, const Painter::Cut& cut, const Places& places, const Extent& about) {
    Window window = places.window(cut.view);
    include_seabed(cut.view, window);
    const double stretch = stretch_of(window.hi_m - window.lo_m, box.width(), box.height());
    const Panel panel(box, cut.view, window, stretch);
    painter_.draw_section(panel, about);
    panel.draw_axes(sheet_, stretched("Section " + path_words(cut), stretch), "from the sensor", "up");
  }

  /// Extends the window of a section to the seabed at any depth.
  void include_seabed(const View& view, Window& window) {
    Profile profile(window.lo_m.x, window.hi_m.x, 100);
    const glm::dvec3 a = view.zero_m + window.lo_m.x * view.right,
                     b = view.zero_m + window.hi_m.x * view.right;
    each_terrain_facet(survey_,
                       {glm::min(glm::dvec2(a), glm::dvec2(b)), glm::max(glm::dvec2(a), glm::dvec2(b))},
                       [&](const std::array<glm::dvec3, 3>& facet) {
                         std::array<glm::dvec3, 3> turned;
                         for (std::size_t k = 0; k < 3; ++k)
                           turned[k] = {view.of(facet[k]), view.depth_m(facet[k])};
                         profile.add(turned, true);
                       });
    for (std::size_t k = 0; k < profile.columns(); ++k) {
      if (!profile.has(k)) continue;
      window.lo_m.y = std::min(window.lo_m.y, profile.lowest_m(k));
      window.hi_m.y = std::max(window.hi_m.y, profile.highest_m(k));
    }
    const double margin = 0.08 * (window.hi_m.y - window.lo_m.y);
    window.lo_m.y -= margin, window.hi_m.y += margin;
  }

  /// Draws plan and side view of the whole scene and of the surroundings of the first sensor. Returns their
  /// lower end in pixels.
  double draw_whole_and_near() {
    const View plan;
    const Window whole = scope_.all.window(plan), near = scope_.near.window(plan);
    const double above = std::max(height_for(whole, 260, 460), height_for(near, 260, 460));
    const Painter::Cut section = cut("A", section_direction(*scope_.first));
    const Panel whole_panel({first_left, first_top, first_left + panel_width, first_top + above}, plan,
                            whole);
    painter_.draw_plan(whole_panel, {}, false);
    whole_panel.draw_axes(sheet_, "Plan of the scene", "east", "north");
    const Panel near_panel({second_left, first_top, second_left + panel_width, first_top + above}, plan,
                           near);
    painter_.draw_plan(near_panel, {&section, 1}, true);
    near_panel.draw_axes(sheet_, near_title(), "east", "north");

    // The side view shows the longer side.
    const glm::dvec2 size = whole.hi_m - whole.lo_m;
    const bool from_south = size.x >= size.y;
    const View side{glm::dvec3(0), from_south ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), {0, 0, 1}};
    const Window side_window = scope_.all.window(side);
    const double top = first_top + above + gap_below, below = 240;
    const double stretch = stretch_of(side_window.hi_m - side_window.lo_m, panel_width, below);
    const Panel side_panel({first_left, top, first_left + panel_width, top + below}, side, side_window,
                           stretch);
    painter_.draw_side(side_panel);
    side_panel.draw_axes(sheet_,
                         stretched(from_south ? "Scene from the south" : "Scene from the east", stretch),
                         from_south ? "east" : "north", "up");
    draw_section({second_left, top, second_left + panel_width, top + below}, section, scope_.near,
                 scope_.near.extent());
    return top + below + 50;
  }

  std::string near_title() const {
    const SensorPings& pings = survey_.sensors[scope_.first->sensor];
    std::string name = pings.sensor->description().name;
    constexpr std::size_t longest = 28;
    if (name.size() > longest) name = name.substr(0, longest) + "...";
    return pings.times_s.size() > 1 ? fmt::format("Plan near {} at ping {}", name, scope_.first->ping)
                                    : "Plan near " + name;
  }

  /// Draws one plan and two sections of the whole scene. Returns their lower end in pixels.
  double draw_plan_and_sections() {
    const View plan;
    const Window whole = scope_.all.window(plan);
    constexpr double section_height = 226;
    const double height = height_for(whole, 300, 2 * section_height + gap_below);
    const Panel panel({first_left, first_top, first_left + panel_width, first_top + height}, plan, whole);
    std::vector<Painter::Cut> cuts;
    if (scope_.first != nullptr) {
      const glm::dvec3 right = section_direction(*scope_.first);
      cuts = {cut("A", right), cut("B", {right.y, -right.x, 0})};
    }
    painter_.draw_plan(panel, cuts, false);
    panel.draw_axes(sheet_, "Plan", "east", "north");
    double top = first_top;
    for (const Painter::Cut& section : cuts) {
      draw_section({second_left, top, second_left + panel_width, top + section_height}, section, scope_.all,
                   scope_.all.extent());
      top += section_height + gap_below;
    }
    return std::max(first_top + height + gap_below, top) - 24;
  }

  const Survey& survey_;
  SceneMarks marks_;
  Sheet sheet_;
  Painter painter_;
  Scope scope_;
};

}  // namespace

std::string scene_drawing(const Survey& survey, std::span<const SeabedPlacement> placements) {
  return Drawing(survey, placements).svg();
}

void write_scene_picture(const std::filesystem::path& file, const Survey& survey,
                         std::span<const SeabedPlacement> placements) {
  // With less memory librsvg or one of its libraries terminates the program without an error message.
  constexpr double needed_bytes = 100e6;
  if (memory_at_hand() < needed_bytes) throw std::bad_alloc();
  write_png_of_svg(scene_drawing(survey, placements), file);
}

void write_scene_picture(const std::filesystem::path& file, const Survey& survey) {
  const bool soon = !survey.loaded_scene->has_surface_per_transmission() && !survey.loaded_scene->is_tiled();
  write_scene_picture(file, survey, soon ? placements(survey) : std::vector<SeabedPlacement>());
}

}  // namespace tubefoot
