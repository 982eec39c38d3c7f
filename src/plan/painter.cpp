// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the elements of a scene on plan and side views: seabed, sea surface, sectors, objects, tracks, pings,
// distances and section lines. Labels do not overlap.
#include "plan/painter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/steps/stop.hpp"
#include "plan/silhouette.hpp"
#include "run/water_targets.hpp"
#include "scene/water_target_places.hpp"
#include "study/diagram.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view object_colour = "#6d1b1b", track_colour = "#22262a";
constexpr std::string_view target_style = "fill=\"#0b5a8a\" stroke=\"#ffffff\" stroke-width=\"0.8\"",
                           population_style =
                               "fill=\"#0b5a8a\" fill-opacity=\"0.08\" stroke=\"#0b5a8a\" "
                               "stroke-width=\"1\" stroke-dasharray=\"4 2\"";
constexpr Lettering object_letters{.size = 10.5, .colour = object_colour},
    place_letters{.size = 10.5, .colour = track_colour};

Box grown(const Box& box, double by) {
  return {box.left - by, box.top - by, box.right + by, box.bottom + by};
}

Box common(const Box& a, const Box& b) {
  return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right),
          std::min(a.bottom, b.bottom)};
}

/// Returns the box of an extent on a panel.
Box seen(const Panel& panel, const Extent& extent) {
  Box box = Box::none();
  for (int corner = 0; corner < 8; ++corner)
    box.add(panel.at(glm::dvec3((corner & 1 ? extent.hi_m : extent.lo_m).x,
                                (corner & 2 ? extent.hi_m : extent.lo_m).y,
                                (corner & 4 ? extent.hi_m : extent.lo_m).z)));
  return box;
}

Box about(glm::dvec2 place, double by) { return {place.x - by, place.y - by, place.x + by, place.y + by}; }

/// Keeps labels away from points along a line.
void keep_line_free(Labels& labels, const std::vector<glm::dvec2>& line) {
  constexpr double step = 6;
  std::size_t left = 2000;
  for (std::size_t k = 0; k + 1 < line.size(); ++k)
    for (double at = 0; at < glm::distance(line[k], line[k + 1]) && left > 0; at += step, --left)
      labels.keep_free(
          about(line[k] + (line[k + 1] - line[k]) * (at / glm::distance(line[k], line[k + 1])), 2));
}

}  // namespace

std::vector<std::vector<glm::dvec2>> clipped(const std::vector<glm::dvec2>& line, const Box& box) {
  const Box wide = grown(box, 50);
  std::vector<std::vector<glm::dvec2>> pieces;
  bool goes_on = false;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const glm::dvec2 a = line[k], way = line[k + 1] - a;
    double first = 0, last = 1;
    const auto keep = [&](double from, double by, double lo, double hi) {
      if (by == 0) {
        if (!(from >= lo && from <= hi)) last = -1;
        return;
      }
      first = std::max(first, std::min((lo - from) / by, (hi - from) / by));
      last = std::min(last, std::max((lo - from) / by, (hi - from) / by));
    };
    keep(a.x, way.x, wide.left, wide.right);
    keep(a.y, way.y, wide.top, wide.bottom);
    if (!(first <= last)) {
      goes_on = false;
      continue;
    }
    if (!goes_on || first > 0) pieces.push_back({a + first * way});
    pieces.back().push_back(a + last * way);
    goes_on = last == 1;
  }
  return pieces;
}

void Painter::draw_plan(const Panel& panel, std::span<const Cut> cuts, bool near) {
  Labels labels(panel.box());
  sheet_.rectangle(panel.box(), "fill=\"#f3f5f7\"");
  sheet_.begin_clip(panel.box());
  draw_seabed(panel);
  draw_sectors(panel, near);
  for (const Cut& cut : cuts) draw_cut(panel, cut);
  draw_tracks(panel, true, labels);
  draw_terrain_mark(panel, labels);
  draw_distance(panel, labels);
  draw_objects(panel, nullptr, labels);
  draw_targets(panel, labels);
  draw_places(panel, near, labels);
  sheet_.end_clip();
}

void Painter::draw_side(const Panel& panel) {
  Labels labels(panel.box());
  sheet_.rectangle(panel.box(), "fill=\"#f3f5f7\"");
  sheet_.begin_clip(panel.box());
  draw_profile(panel, false);
  draw_surface(panel, labels);
  draw_sectors(panel, false);
  draw_tracks(panel, true, labels);
  draw_terrain_mark(panel, labels);
  draw_objects(panel, nullptr, labels);
  draw_targets(panel, labels);
  draw_places(panel, false, labels);
  sheet_.end_clip();
}

void Painter::draw_section(const Panel& panel, const Extent& about) {
  Labels labels(panel.box());
  sheet_.rectangle(panel.box(), "fill=\"#f3f5f7\"");
  sheet_.begin_clip(panel.box());
  draw_profile(panel, true);
  draw_surface(panel, labels);
  draw_sectors(panel, true);
  draw_tracks(panel, false, labels);
  draw_objects(panel, &about, labels);
  draw_places(panel, true, labels);
  sheet_.end_clip();
}

void Painter::draw_seabed(const Panel& panel) {
  if (marks_.terrain.empty()) return;
  constexpr double pixels_a_cell = 1.25;
  const Window& window = panel.window();
  PlanHeights map(window,
                  static_cast<int>(std::max(panel.box().width(), panel.box().height()) / pixels_a_cell));
  if (each_terrain_facet(survey_, window, [&](const auto& facet) { map.add(facet); })) coarse_ = true;
  if (map.empty()) return;
  const glm::dvec2 low = panel.at(window.lo_m),
                   high = panel.at(window.lo_m + map.cell_m() * glm::dvec2(map.columns(), map.rows()));
  sheet_.picture({low.x, high.y, high.x, low.y}, shaded(map, marks_.terrain.lo_m.z, marks_.terrain.hi_m.z));
}

/// Marks a terrain that is too small to be visible.
void Painter::draw_terrain_mark(const Panel& panel, Labels& labels) {
  if (marks_.terrain.empty()) return;
  const Box box = seen(panel, marks_.terrain);
  constexpr double small = 10;
  if (std::max(box.width(), box.height()) > small || !panel.box().meets(grown(box, 1))) return;
  const Box mark = about(box.middle(), small / 2);
  sheet_.rectangle(mark, "fill=\"none\" stroke=\"#7a6a3a\" stroke-width=\"1.5\"");
  labels.keep_free(mark);
  labels.put(sheet_, mark, "terrain", {.size = 10.5, .colour = "#5d4f26"});
}

void Painter::draw_profile(const Panel& panel, bool cut) {
  constexpr double pixels_a_column = 1;
  const Window& window = panel.window();
  const View& view = panel.view();
  Profile profile(window.lo_m.x, window.hi_m.x, static_cast<int>(panel.box().width() / pixels_a_column));
  // In the plan, a section is a line. A side view includes everything in front of and behind the plane.
  Window wanted{glm::dvec2(marks_.terrain.lo_m), glm::dvec2(marks_.terrain.hi_m)};
  if (cut) {
    const glm::dvec3 a = view.zero_m + window.lo_m.x * view.right,
                     b = view.zero_m + window.hi_m.x * view.right;
    wanted = {glm::min(glm::dvec2(a), glm::dvec2(b)), glm::max(glm::dvec2(a), glm::dvec2(b))};
  }
  const bool coarse = each_terrain_facet(survey_, wanted, [&](const std::array<glm::dvec3, 3>& facet) {
    std::array<glm::dvec3, 3> turned;
    for (std::size_t k = 0; k < 3; ++k) turned[k] = {view.of(facet[k]), view.depth_m(facet[k])};
    profile.add(turned, cut);
  });
  coarse_ = coarse_ || coarse;
  const auto fill_below = [&](bool highest, std::string_view style, std::string_view edge) {
    for (std::size_t first = 0; first < profile.columns(); ++first) {
      if (!profile.has(first)) continue;
      std::vector<glm::dvec2> top;
      std::size_t k = first;
      for (; k < profile.columns() && profile.has(k); ++k) {
        const glm::dvec2 p =
            panel.at(glm::dvec2(profile.along_m(k), highest ? profile.highest_m(k) : profile.lowest_m(k)));
        top.push_back({p.x, std::clamp(p.y, panel.box().top - 100, panel.box().bottom + 100)});
      }
      first = k;
      // Extends the outline by half a pixel at both sides, because a column is one pixel wide.
      top.insert(top.begin(), {top.front().x - 0.5, top.front().y});
      top.push_back({top.back().x + 0.5, top.back().y});
      top = simplified(top, 0.3);
      std::string data;
      for (const glm::dvec2& p : top)
        data += fmt::format("{}{:.1f} {:.1f}", data.empty() ? "M" : "L", p.x, p.y);
      const double floor = panel.box().bottom + 100;
      sheet_.path(
          data + fmt::format("L{:.1f} {:.1f}L{:.1f} {:.1f}Z", top.back().x, floor, top.front().x, floor),
          style);
      sheet_.polyline(top, edge);
    }
  };
  if (!cut) fill_below(true, "fill=\"#e9dfc4\"", "stroke=\"#b7a26a\" stroke-width=\"0.8\"");
  fill_below(cut, "fill=\"#d8c79a\"",
             cut ? "stroke=\"#6b5a24\" stroke-width=\"1.6\"" : "stroke=\"#b7a26a\" stroke-width=\"0.8\"");
  bool any = false;
  for (std::size_t k = 0; k < profile.columns(); ++k) any = any || profile.has(k);
  if (cut && !any && !marks_.terrain.empty())
    sheet_.text({panel.box().middle().x, panel.box().bottom - 10}, "no terrain in this section",
                {.anchor = "middle", .colour = "#5d4f26", .halo = true});
}

void Painter::draw_surface(const Panel& panel, Labels& labels) {
  if (!survey_.scene.description.sea_surface) return;
  const double y = panel.at(glm::dvec2(0, survey_.scene.description.sea_surface->height_m)).y;
  if (y < panel.box().top || y > panel.box().bottom) return;
  sheet_.line({panel.box().left, y}, {panel.box().right, y},
              "stroke=\"#2b7bba\" stroke-width=\"1.4\" stroke-dasharray=\"9 3\"");
  labels.put(sheet_, {panel.box().right - 90, y, panel.box().right - 8, y}, "sea surface",
             {.size = 10.5, .colour = "#1d5f94"});
}

void Painter::draw_sectors(const Panel& panel, bool near) {
  for (const SectorMark& sector : marks_.sectors) {
    if (near && !sector.chosen) continue;
    stop_if_wanted();
    const Box box = grown(panel.box(), 3);
    Silhouette nearer(box), window(box), received(box);
    for (const SectorCell& cell : sector.cells) {
      std::vector<glm::dvec2> to_window{panel.at(cell.apex_m)}, to_end, to_seabed;
      for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec2 first = panel.at(cell.at(k, sector.first_m));
        to_window.push_back(first);
        to_end.push_back(first);
        to_end.push_back(panel.at(cell.at(k, sector.last_m)));
        to_seabed.push_back(panel.at(cell.at(k, std::min(sector.first_m, cell.recorded_to_m[k]))));
        to_seabed.push_back(panel.at(cell.at(k, cell.recorded_to_m[k])));
      }
      nearer.add(to_window);
      window.add(to_end);
      if (cell.is_received(sector.first_m)) received.add(to_seabed);
    }
    const std::string colour = series_colour(sector.sensor);
    const double weight = sector.chosen ? 1 : 0.55;
    const auto draw = [&](const Silhouette& part, double fill, double stroke, std::string_view dashes) {
      sheet_.path(part.path(),
                  fmt::format("fill=\"{0}\" fill-opacity=\"{1:.2f}\" stroke=\"{0}\" "
                              "stroke-opacity=\"{2:.2f}\" stroke-width=\"{3}\"{4}",
                              colour, fill * weight, stroke * weight, dashes.empty() ? 1 : 0.8, dashes));
    };
    draw(nearer, 0.07, 0.6, " stroke-dasharray=\"1 3\"");
    draw(window, 0.17, 0.85, " stroke-dasharray=\"4 3\"");
    draw(received, 0.32, 1, "");
  }
}

void Painter::draw_targets(const Panel& panel, Labels& labels) {
  const SceneDescription& description = survey_.scene.description;
  for (const TargetPopulationDescription& population : description.target_populations) {
    const Box box = seen(panel, extent_of(population, sea_surface_height_m(description)));
    if (panel.box().meets(grown(box, 1))) sheet_.rectangle(box, population_style);
  }
  constexpr std::size_t most_names = 30;
  std::size_t names = 0;
  const auto& targets = survey_.loaded_scene->targets;
  for (std::size_t k = 0; k < targets->single.size(); ++k) {
    const glm::dvec2 at = panel.at(survey_.scene.grid.to_metres(targets->single[k].at));
    if (!panel.box().holds(about(at, 0))) continue;
    sheet_.circle(at, 2.4, target_style);
    if (++names <= most_names) labels.put(sheet_, about(at, 4), description.targets[k].name, object_letters);
  }
}

void Painter::draw_objects(const Panel& panel, const Extent* about_m, Labels& labels) {
  const Scene& scene = survey_.scene;
  constexpr std::size_t most_names = 60;
  std::size_t names = 0;
  struct Named {
    Box box;
    const ObjectMark* object;
  };
  std::vector<Named> named;
  for (const ObjectMark& object : marks_.objects) {
    stop_if_wanted();
    if (about_m != nullptr &&
        (object.extent.lo_m.x > about_m->hi_m.x || object.extent.hi_m.x < about_m->lo_m.x ||
         object.extent.lo_m.y > about_m->hi_m.y || object.extent.hi_m.y < about_m->lo_m.y))
      continue;
    const Box box = seen(panel, object.extent);
    if (!panel.box().meets(grown(box, 1))) continue;
    const std::string style =
        fmt::format("fill=\"{0}\" fill-opacity=\"{1}\" stroke=\"{0}\" stroke-width=\"1.2\"{2}", object_colour,
                    object.is_buried ? "0.12" : "0.4", object.is_buried ? " stroke-dasharray=\"3 2\"" : "");
    constexpr double small = 5;
    Box drawn = box;
    if (std::max(box.width(), box.height()) < small) {
      drawn = about(box.middle(), small / 2);
      sheet_.rectangle(drawn, style);
    } else {
      Silhouette outline(grown(common(box, grown(panel.box(), 3)), 1));
      const auto [first, last] =
          std::equal_range(scene.mesh.component.begin(), scene.mesh.component.end(), object.component);
      for (auto at = first; at != last; ++at) {
        std::array<glm::dvec2, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
          corners[k] =
              panel.at(scene.grid.to_metres(scene.mesh.vertices[scene.mesh.facets[static_cast<std::size_t>(
                  at - scene.mesh.component.begin())][k]]));
        outline.add(corners);
      }
      sheet_.path(outline.path(), style);
    }
    named.push_back({common(drawn, panel.box()), &object});
    if (named.size() <= most_names) labels.keep_free(named.back().box);
  }
  for (const auto& [box, object] : named) {
    if (++names > most_names) break;
    constexpr std::size_t longest = 24;
    std::string name = object->name;
    if (name.size() > longest) {
      name.resize(longest);
      while (!name.empty() && (name.back() & 0xC0) == 0x80) name.pop_back();
      if (!name.empty() && (name.back() & 0x80) != 0) name.pop_back();
      name += "...";
    }
    labels.put(sheet_, box, object->is_buried ? name + " (buried)" : name, object_letters);
  }
}

void Painter::draw_tracks(const Panel& panel, bool with_headings, Labels& labels) {
  for (const TrackMark& track : marks_.tracks) {
    for (const std::vector<glm::dvec3>& line_m : track.lines_m) {
      std::vector<glm::dvec2> line;
      for (const glm::dvec3& place_m : line_m) line.push_back(panel.at(place_m));
      for (const std::vector<glm::dvec2>& piece : clipped(simplified(line, 0.4), panel.box())) {
        sheet_.polyline(piece, fmt::format("stroke=\"{}\" stroke-width=\"1.3\"", track_colour));
        keep_line_free(labels, piece);
      }
    }
    if (!with_headings) continue;
    constexpr double length = 20, apart = 30;
    std::vector<glm::dvec2> drawn;
    for (const Heading& heading : track.headings) {
      const glm::dvec2 from = panel.at(heading.place_m);
      // The length of the arrow is the projected one, without the vertical stretch.
      const glm::dvec2 level(glm::dot(heading.ahead, panel.view().right),
                             -glm::dot(heading.ahead, panel.view().up));
      if (!panel.box().holds(about(from, 0)) || glm::length(level) < 0.2 ||
          std::ranges::any_of(drawn, [&](glm::dvec2 other) { return glm::distance(other, from) < apart; }))
        continue;
      drawn.push_back(from);
      const glm::dvec2 way = level / glm::length(level), side(-way.y, way.x), tip = from + length * way,
                       neck = from + (length - 7) * way;
      sheet_.line(from, neck, fmt::format("stroke=\"{}\" stroke-width=\"1.8\"", track_colour));
      const std::array<glm::dvec2, 3> head{tip, neck + 3.5 * side, neck - 3.5 * side};
      sheet_.path(fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z", head[0].x, head[0].y, head[1].x,
                              head[1].y, head[2].x, head[2].y),
                  fmt::format("fill=\"{}\"", track_colour));
      Box box = Box::none();
      for (const glm::dvec2& p : {from, tip, head[1], head[2]}) box.add(p);
      labels.keep_free(box);
    }
  }
}

/// Draws the positions of pings and their numbers.
void Painter::draw_places(const Panel& panel, bool near, Labels& labels) {
  struct Place {
    glm::dvec2 at;
    std::size_t ping;
    bool one_of_many;
  };
  std::vector<Place> named;
  for (const SectorMark& sector : marks_.sectors) {
    if (near && !sector.chosen) continue;
    const glm::dvec2 at = panel.at(sector.pose.position_m);
    if (!panel.box().holds(about(at, 0))) continue;
    sheet_.circle(
        at, 3.6,
        fmt::format("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.2\"", series_colour(sector.sensor)));
    labels.keep_free(about(at, 5));
    if (sector.receiver_m)
      sheet_.circle(
          panel.at(*sector.receiver_m), 3.2,
          fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.6\"", series_colour(sector.sensor)));
    constexpr double same = 12;
    if (std::ranges::none_of(
            named, [&](const Place& p) { return p.ping == sector.ping && glm::distance(p.at, at) < same; }))
      named.push_back({at, sector.ping, survey_.sensors[sector.sensor].times_s.size() > 1});
  }
  for (const Place& place : named)
    if (place.one_of_many)
      labels.put(sheet_, about(place.at, 6), fmt::format("ping {}", place.ping), place_letters);
}

/// Draws the distance from the first sensor to the terrain if the sensor is not above it.
void Painter::draw_distance(const Panel& panel, Labels& labels) {
  if (marks_.terrain.empty() || marks_.sectors.empty()) return;
  for (const SectorMark& sector : marks_.sectors) {
    if (!sector.chosen) continue;
    const glm::dvec3 from_m = sector.pose.position_m;
    const double distance_m = marks_.terrain.distance_in_plan_m(from_m);
    const glm::dvec2 from = panel.at(from_m),
                     to = panel.at(glm::clamp(from_m, marks_.terrain.lo_m, marks_.terrain.hi_m));
    constexpr double worth_a_line = 40;
    if (!(distance_m > 0) || glm::distance(from, to) < worth_a_line) return;
    for (const std::vector<glm::dvec2>& piece : clipped({from, to}, panel.box()))
      sheet_.polyline(piece, "stroke=\"#b3125a\" stroke-width=\"1.3\" stroke-dasharray=\"2 3\"");
    keep_line_free(labels, {from, to});
    labels.put(sheet_, about((from + to) / 2.0, 6),
               distance_m < 1000 ? fmt::format("{:.3g} m to the terrain", distance_m)
                                 : fmt::format("{:.4g} km to the terrain", distance_m / 1000),
               {.size = 10.5, .colour = "#b3125a", .bold = true});
    return;
  }
}

void Painter::draw_cut(const Panel& panel, const Cut& cut) {
  // The line runs from border to border of the panel through the origin of the section.
  const glm::dvec2 middle = panel.at(cut.view.zero_m), way(cut.view.right.x, -cut.view.right.y);
  const Box inner = grown(panel.box(), -9);
  const double far = 2 * (panel.box().width() + panel.box().height());
  double back = -far, ahead = far;
  for (const auto& [from, by, lo, hi] : {std::array{middle.x, way.x, inner.left, inner.right},
                                         std::array{middle.y, way.y, inner.top, inner.bottom}}) {
    if (std::abs(by) < 1e-12) continue;
    back = std::max(back, std::min((lo - from) / by, (hi - from) / by));
    ahead = std::min(ahead, std::max((lo - from) / by, (hi - from) / by));
  }
  if (!(back < ahead)) return;
  const glm::dvec2 a = middle + back * way, b = middle + ahead * way;
  sheet_.line(a, b,
              "stroke=\"#22262a\" stroke-opacity=\"0.6\" stroke-width=\"0.9\" stroke-dasharray=\"10 3 2 3\"");
  sheet_.text(a + glm::dvec2(0, 4), cut.letter, {.anchor = "middle", .bold = true, .halo = true});
  sheet_.text(b + glm::dvec2(0, 4), cut.letter + "'", {.anchor = "middle", .bold = true, .halo = true});
}

}  // namespace tubefoot
