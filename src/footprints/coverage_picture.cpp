// SPDX-License-Identifier: GPL-3.0-or-later

// Draws the plan view of a coverage, and a side view of steep facets (docs/footprints.md). A depth buffer
// keeps the surface nearest to the viewer at each pixel centre. Colours show the number of pings on a
// logarithmic scale.

#include "footprints/coverage_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <span>

#include "geometry/numbers/scalars.hpp"
#include "geometry/steps/stop.hpp"
#include "run/tiles_in_view.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/decibel_scale.hpp"
#include "sensors/pictures/map_axes.hpp"

namespace tubefoot {
namespace {

constexpr int margin = 28, header = 2 * margin + 34, axis_height = 62, legend = 190;
constexpr int largest_side = 1000, smallest_side = 300, gap = 62;
constexpr int nothing = -3;  ///< value of a pixel without surface
/// Least share of the visible area that steep facets have in a picture with a side view.
constexpr double least_steep_share = 0.05;
constexpr Colour shadow_colour{0.80f, 0.13f, 0.16f}, ground_colour{0.33f, 0.34f, 0.36f};

/// Returns a colour between dark blue (one ping) and pale yellow (`most` pings), linear in the logarithm of
/// `pings`.
Colour colour_of(int pings, int most) {
  const double level =
      most > 1 ? std::log(static_cast<double>(pings)) / std::log(static_cast<double>(most)) : 1.0;
  constexpr std::array<Colour, 4> stops{
      {{0.16f, 0.25f, 0.55f}, {0.10f, 0.55f, 0.58f}, {0.45f, 0.77f, 0.40f}, {0.98f, 0.93f, 0.55f}}};
  const double at = level * (stops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mix(stops[k], stops[k + 1], at - static_cast<double>(k));
}

/// A direction of view, by the axes of its picture.
struct View {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, towards_viewer{0, 0, 1};
  glm::dvec3 operator()(glm::dvec3 p) const {
    return {glm::dot(p, right), glm::dot(p, up), glm::dot(p, towards_viewer)};
  }
};

glm::dvec3 area_vector(std::span<const glm::dvec3> corners) {
  glm::dvec3 sum(0);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    sum += glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]) / 2.0;
  return sum;
}

/// Returns whether a polygon is steeper than 60 degrees.
bool is_steep(glm::dvec3 area) { return std::abs(area.z) < 0.5 * glm::length(area); }

/// Values of the surface nearest to the viewer at the centre of each pixel, and its distance towards the
/// viewer. In plan view this is the highest surface.
struct Plan {
  glm::dvec2 origin_m;  ///< lower left corner
  double pixel_m;
  int width, height;
  std::vector<int> value;
  std::vector<double> top_m;

  Plan(glm::dvec2 lo, glm::dvec2 hi) {
    const glm::dvec2 size_m = glm::max(hi - lo, glm::dvec2(1e-3));
    pixel_m = std::max(size_m.x, size_m.y) * 1.04 / largest_side;
    width = std::max(1, static_cast<int>(std::ceil(size_m.x * 1.04 / pixel_m)));
    height = std::max(1, static_cast<int>(std::ceil(size_m.y * 1.04 / pixel_m)));
    origin_m = (lo + hi) / 2.0 - pixel_m / 2 * glm::dvec2(width, height);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    value.assign(pixels, nothing);
    top_m.assign(pixels, -infinite);
  }

  void draw(std::span<const glm::dvec3> corners, int what) {
    const glm::dvec3 normal = area_vector(corners);
    if (std::abs(normal.z) <= 1e-9 * glm::length(normal)) return;  // the polygon is a line in plan view
    glm::dvec2 lo(corners[0]), hi(corners[0]);
    for (const glm::dvec3& p : corners) {
      lo = glm::min(lo, glm::dvec2(p));
      hi = glm::max(hi, glm::dvec2(p));
    }
    const auto first = [&](double x, double origin) {
      return std::max(0, static_cast<int>(std::ceil(std::max(-1.0, (x - origin) / pixel_m - 0.5))));
    };
    const auto last = [&](double x, double origin, int count) {
      return static_cast<int>(std::floor(std::min(count - 1.0, (x - origin) / pixel_m - 0.5)));
    };
    const double turn = normal.z > 0 ? 1 : -1;
    for (int y = first(lo.y, origin_m.y); y <= last(hi.y, origin_m.y, height); ++y)
      for (int x = first(lo.x, origin_m.x); x <= last(hi.x, origin_m.x, width); ++x) {
        const glm::dvec2 at = origin_m + pixel_m * glm::dvec2(x + 0.5, y + 0.5);
        bool inside = true;
        for (std::size_t k = 0; k < corners.size() && inside; ++k) {
          const glm::dvec2 a(corners[k]), b(corners[(k + 1) % corners.size()]);
          // Rounding must not leave gaps between cells.
          const double rounding_m2 = 1e-12 * (std::abs(b.x - a.x) + std::abs(b.y - a.y));
          inside = turn * ((b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x)) >= -rounding_m2;
        }
        if (!inside) continue;
        const double up =
            corners[0].z - (normal.x * (at.x - corners[0].x) + normal.y * (at.y - corners[0].y)) / normal.z;
        const auto pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        // A cell lies in the plane of its facet, which was drawn before the cell.
        if (up < top_m[pixel] - 1e-6) continue;
        top_m[pixel] = std::max(up, top_m[pixel]);
        value[pixel] = what;
      }
  }
};

}  // namespace

void CoveragePicture::add(const CoveredFacet& facet) {
  for (std::size_t k = 0; k < facet.coverage.cells.size(); ++k) {
    const CoverageCell& cell = facet.coverage.cells[k];
    if (cell.pings == 0 && cell.in_sector == 0) continue;
    const std::vector<glm::dvec3> corners = facet.polygon_m(k);
    for (const glm::dvec3& p : corners) {
      lo_ = glm::min(lo_, glm::dvec2(p));
      hi_ = glm::max(hi_, glm::dvec2(p));
    }
    const int pings = cell.pings > 0 ? static_cast<int>(cell.pings) : static_cast<int>(in_shadow);
    most_ = std::max(most_, pings);
    polygons_.push_back({corners_.size(), corners.size(), pings});
    corners_.insert(corners_.end(), corners.begin(), corners.end());
  }
}

Canvas CoveragePicture::draw(const std::string& title) const {
  if (polygons_.empty())
    throw std::runtime_error("no facet lies in the sector of a ping, so there is nothing to draw");
  const auto corners_of = [&](const Polygon& polygon) {
    return std::span(corners_).subspan(polygon.first, polygon.count);
  };
  std::vector<glm::dvec3> turned;
  const auto draw_in = [&](Plan& plan, const View& view, std::span<const glm::dvec3> corners, int what) {
    turned.clear();
    for (const glm::dvec3& p : corners) turned.push_back(view(p));
    plan.draw(turned, what);
  };
  const auto drawn = [&](Plan& plan, const View& view, bool steep_only) {
    const auto draw_surface = [&](const Scene& scene) {
      for (const auto& facet : scene.mesh.facets) {
        stop_if_wanted();
        std::array<glm::dvec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) corners[k] = scene.grid.to_metres(scene.mesh.vertices[facet[k]]);
        if (!steep_only || is_steep(area_vector(corners))) draw_in(plan, view, corners, out_of_sector);
      }
    };
    draw_surface(survey_.scene);
    const glm::dvec2 extent = plan.pixel_m * glm::dvec2(plan.width, plan.height);
    if (steep_only)
      for_tiles_within(survey_, {lo_, -infinite}, {hi_, infinite}, draw_surface);
    else
      for_tiles_within(survey_, {plan.origin_m, -infinite}, {plan.origin_m + extent, infinite}, draw_surface);
    for (const Polygon& polygon : polygons_) {
      stop_if_wanted();
      if (!steep_only || is_steep(area_vector(corners_of(polygon))))
        draw_in(plan, view, corners_of(polygon), polygon.pings);
    }
  };
  Plan plan(lo_, hi_);
  drawn(plan, View{}, false);

  // The side view faces the steep facets that pings see.
  std::vector<glm::dvec3> steep;
  double visible_m2 = 0, steep_m2 = 0;
  for (const Polygon& polygon : polygons_) {
    if (polygon.pings < 1) continue;
    const glm::dvec3 area = area_vector(corners_of(polygon));
    visible_m2 += glm::length(area);
    if (!is_steep(area)) continue;
    steep_m2 += glm::length(area);
    steep.push_back(area);
  }
  std::optional<Plan> side;
  View view;
  if (steep_m2 > least_steep_share * visible_m2) {
    constexpr int directions = 72;
    double most = -1;
    glm::dvec3 towards(0);
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * pi * k / directions;
      const glm::dvec3 direction(std::sin(angle), std::cos(angle), 0);
      double facing = 0;
      for (const glm::dvec3& area : steep) facing += std::max(0.0, glm::dot(area, direction));
      if (facing > most * (1 + 1e-9)) towards = direction;
      most = std::max(most, facing);
    }
    glm::dvec3 mean(0);
    for (const glm::dvec3& area : steep)
      if (glm::dot(area, towards) > 0.9 * glm::length(area)) mean += glm::dvec3(area.x, area.y, 0);
    if (glm::length(mean) > 0) towards = glm::normalize(mean);
    view = {glm::cross(glm::dvec3(0, 0, 1), towards), {0, 0, 1}, towards};
    glm::dvec2 lo(1e300), hi(-1e300);
    for (const Polygon& polygon : polygons_)
      if (is_steep(area_vector(corners_of(polygon))))
        for (const glm::dvec3& p : corners_of(polygon)) {
          lo = glm::min(lo, glm::dvec2(view(p)));
          hi = glm::max(hi, glm::dvec2(view(p)));
        }
    side.emplace(lo, hi);
    drawn(*side, view, true);
  }

  const std::string& font = label_font();
  MapPlot map{0, header, plan.width, plan.height, plan.origin_m.x, plan.origin_m.y, 1 / plan.pixel_m};
  map.left = margin + map.northings_width(font);
  const int left = map.left, top = header, right = left + plan.width, bottom = top + plan.height;
  int last_row = std::max(bottom, top + smallest_side) + axis_height, last_column = right + 24 + legend;
  MapPlot beside;
  if (side) {
    const double azimuth = std::fmod(std::atan2(view.right.x, view.right.y) * 180 / pi + 360, 360);
    beside = {0,
              last_row + gap,
              side->width,
              side->height,
              side->origin_m.x,
              side->origin_m.y,
              1 / side->pixel_m,
              std::abs(azimuth - 90) < 0.05 ? "east (m)" : fmt::format("towards {:.1f}\u00b0 (m)", azimuth),
              "up (m)"};
    beside.left = margin + beside.northings_width(font);
    last_row = beside.top + side->height + axis_height;
    last_column = std::max(last_column, beside.left + side->width);
  }
  Canvas canvas(std::max(last_column + margin, 2 * margin + text_width(title, title_size, font)),
                last_row + margin, palette.background, font);
  const auto paint = [&](const Plan& from, int first_column, int lowest_row) {
    for (int y = 0; y < from.height; ++y)
      for (int x = 0; x < from.width; ++x) {
        const int value = from.value[static_cast<std::size_t>(y) * static_cast<std::size_t>(from.width) +
                                     static_cast<std::size_t>(x)];
        if (value == nothing) continue;
        canvas.blend(first_column + x, lowest_row - y,
                     value == out_of_sector ? ground_colour
                     : value == in_shadow   ? shadow_colour
                                            : colour_of(value, most_));
      }
  };
  paint(plan, left, bottom - 1);
  canvas.text(margin, margin, title, title_size, palette.ink);
  map.draw_axes(canvas);
  if (side) {
    paint(*side, beside.left, beside.top + side->height - 1);
    beside.draw_axes(canvas);
  }

  int y = top + label_size;
  const int x = right + 24;
  const auto entry = [&](Colour colour, const std::string& text) {
    canvas.fill(x, y - 9, x + 20, y + 9, colour);
    canvas.text(x + 28, y, text, label_size, palette.ink);
    y += 26;
  };
  canvas.text(x, y, "visible in", label_size, palette.ink);
  y += 26;
  constexpr int few = 8;
  std::vector<int> steps;
  for (int pings = 1; pings <= std::min(most_, few); ++pings) steps.push_back(pings);
  if (most_ > few) {
    steps = {1, 2, 5};
    for (int decade = 10; decade <= most_; decade *= 10)
      for (const int digit : {1, 2, 5})
        if (decade * digit <= most_) steps.push_back(decade * digit);
    if (steps.back() != most_) steps.push_back(most_);
  }
  for (const int pings : steps)
    entry(colour_of(pings, most_), fmt::format("{} ping{}", pings, pings > 1 ? "s" : ""));
  entry(shadow_colour, "hidden");
  entry(ground_colour, "out of sector");
  return canvas;
}

void CoveragePicture::write(const std::filesystem::path& file, const std::string& title) const {
  draw(title).write_png(file, "tubefoot: " + title);
}

}  // namespace tubefoot
