// SPDX-License-Identifier: GPL-3.0-or-later

// Draws the plan view of a coverage (docs/footprints.md). A depth buffer keeps the highest surface at each
// pixel centre. Colours show the number of pings on a logarithmic scale.

#include "footprints/coverage_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
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
constexpr int largest_side = 1000, smallest_side = 300;
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

/// Values and heights of the highest surface at the centre of each pixel.
struct Plan {
  glm::dvec2 origin_m;  ///< south-west corner
  double pixel_m;
  int width, height;
  std::vector<int> value;
  std::vector<double> top_m;

  void draw(std::span<const glm::dvec3> corners, int what) {
    glm::dvec3 normal(0);
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      normal += glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
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
          inside = turn * ((b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x)) >= 0;
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
  const glm::dvec2 size_m = glm::max(hi_ - lo_, glm::dvec2(1e-3));
  Plan plan;
  plan.pixel_m = std::max(size_m.x, size_m.y) * 1.04 / largest_side;
  plan.width = std::max(1, static_cast<int>(std::ceil(size_m.x * 1.04 / plan.pixel_m)));
  plan.height = std::max(1, static_cast<int>(std::ceil(size_m.y * 1.04 / plan.pixel_m)));
  plan.origin_m = (lo_ + hi_) / 2.0 - plan.pixel_m / 2 * glm::dvec2(plan.width, plan.height);
  const auto pixels = static_cast<std::size_t>(plan.width) * static_cast<std::size_t>(plan.height);
  constexpr int nothing = -3;
  plan.value.assign(pixels, nothing);
  plan.top_m.assign(pixels, -infinite);
  const auto draw_surface = [&](const Scene& scene) {
    for (const auto& facet : scene.mesh.facets) {
      stop_if_wanted();
      std::array<glm::dvec3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = scene.grid.to_metres(scene.mesh.vertices[facet[k]]);
      plan.draw(corners, out_of_sector);
    }
  };
  draw_surface(survey_.scene);
  for_tiles_within(survey_, {plan.origin_m, -infinite},
                   {plan.origin_m + plan.pixel_m * glm::dvec2(plan.width, plan.height), infinite},
                   draw_surface);
  for (const Polygon& polygon : polygons_) {
    stop_if_wanted();
    plan.draw(std::span(corners_).subspan(polygon.first, polygon.count), polygon.pings);
  }

  const std::string& font = label_font();
  MapPlot map{0, header, plan.width, plan.height, plan.origin_m.x, plan.origin_m.y, 1 / plan.pixel_m};
  map.left = margin + map.northings_width(font);
  const int left = map.left, top = header, right = left + plan.width, bottom = top + plan.height;
  Canvas canvas(std::max(right + 24 + legend + margin, 2 * margin + text_width(title, title_size, font)),
                std::max(bottom, top + smallest_side) + axis_height + margin, palette.background, font);
  for (int y = 0; y < plan.height; ++y)
    for (int x = 0; x < plan.width; ++x) {
      const int value = plan.value[static_cast<std::size_t>(y) * static_cast<std::size_t>(plan.width) +
                                   static_cast<std::size_t>(x)];
      if (value == nothing) continue;
      canvas.blend(left + x, bottom - 1 - y,
                   value == out_of_sector ? ground_colour
                   : value == in_shadow   ? shadow_colour
                                          : colour_of(value, most_));
    }
  canvas.text(margin, margin, title, title_size, palette.ink);
  map.draw_axes(canvas);

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
