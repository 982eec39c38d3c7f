// SPDX-License-Identifier: GPL-3.0-or-later
// Draws ray paths over range and depth, with the sound speed profile beside them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "files/checked_file.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "geometry/numbers/scalars.hpp"
#include "propagation/ray_path.hpp"
#include "propagation/rays_output.hpp"
#include "sensors/pictures/canvas.hpp"
#include "study/diagram.hpp"
#include "study/svg_png.hpp"

namespace tubefoot {
namespace {

constexpr double sheet_width = 1000, sheet_height = 560, plot_top = 52, plot_bottom = 500;
constexpr double profile_left = 74, profile_right = 224, rays_left = 246, rays_right = 976;

/// A linear axis between two places on the sheet.
struct LinearAxis {
  double first = 0, last = 1, from = 0, to = 1;
  double at(double value) const { return from + (to - from) * (value - first) / (last - first); }
  void widen(double least) {
    if (last - first >= least) return;
    const double middle = (first + last) / 2;
    first = middle - least / 2;
    last = middle + least / 2;
  }
};

/// Kinds of rays, by colour.
constexpr std::array<const char*, 5> kinds{"direct", "with turning points", "via the surface",
                                           "via the bottom", "via surface and bottom"};

std::size_t kind_of(const DrawnRay& ray) {
  if (ray.surface_reflections > 0 && ray.bottom_reflections > 0) return 4;
  if (ray.bottom_reflections > 0) return 3;
  if (ray.surface_reflections > 0) return 2;
  return ray.turns > 0 ? 1 : 0;
}

std::string word(double x, double y, const char* anchor, const std::string& inner, int size = 12) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{}\">{}</text>\n", x, y,
                     anchor, size, shown_markup(inner));
}

std::string stroke(double x0, double y0, double x1, double y1, const char* colour) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x0,
                     y0, x1, y1, colour);
}

/// A line through points of the sheet, of which those within a third of a pixel of the last are omitted.
class Polyline {
 public:
  void add(double x, double y) {
    if (count_ > 0 && std::hypot(x - x_, y - y_) < 0.3) {
      skipped_ = {x, y};
      has_skipped_ = true;
      return;
    }
    put(x, y);
  }
  std::string drawn_in(const char* colour, double width) {
    if (has_skipped_) put(skipped_.first, skipped_.second);
    return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n", text_,
                       colour, width);
  }

 private:
  void put(double x, double y) {
    fmt::format_to(std::back_inserter(text_), "{}{:.1f},{:.1f}", count_++ > 0 ? " " : "", x, y);
    x_ = x;
    y_ = y;
    has_skipped_ = false;
  }
  std::string text_;
  std::size_t count_ = 0;
  double x_ = 0, y_ = 0;
  std::pair<double, double> skipped_;
  bool has_skipped_ = false;
};

std::string ticks_across(const LinearAxis& axis, int wanted, double label_y) {
  std::string svg;
  const double step = tick_step(axis.last - axis.first, wanted);
  for (const double value : ticks(axis.first, axis.last, step)) {
    svg += stroke(axis.at(value), plot_bottom, axis.at(value), plot_bottom + 5, "#444444");
    svg += word(axis.at(value), label_y, "middle", tick_label(value, step));
  }
  return svg;
}

std::string frame(double left, double right) {
  return fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#444444\"/>\n",
      left, plot_top, right - left, plot_bottom - plot_top);
}

/// Depths that the picture shows: the source, the points, the bottom and the rays. Rays that leave the
/// profile are cut.
LinearAxis depth_axis(const RaysRequest& request, const std::vector<DrawnRay>& rays,
                      const std::vector<std::pair<double, double>>& points) {
  const double source_m = request.depth_m(request.source_m);
  double least = source_m, most = source_m;
  const auto hold = [&](double depth_m) {
    least = std::min(least, depth_m);
    most = std::max(most, depth_m);
  };
  if (std::isfinite(request.options.surface_m)) hold(request.options.surface_m);
  if (std::isfinite(request.options.bottom_m)) hold(request.options.bottom_m);
  for (const auto& point : points) hold(point.second);
  double farthest = request.water.profile.is_constant() && points.empty()
                        ? std::numeric_limits<double>::infinity()
                        : std::max(most, request.water.profile.points().back().depth_m);
  double nearest = std::min(least, request.water.profile.points().front().depth_m);
  if (request.water.profile.is_constant() && points.empty()) nearest = -farthest;
  for (const DrawnRay& ray : rays)
    for (const PathPoint& point : points_along(ray.nodes, 2 * degree))
      hold(std::clamp(point.depth_m, nearest, farthest));
  LinearAxis axis{least, most, plot_top, plot_bottom};
  axis.widen(1);
  if (!std::isfinite(request.options.surface_m)) axis.first -= 0.03 * (axis.last - axis.first);
  axis.last += 0.03 * (axis.last - axis.first);
  return axis;
}

std::string profile_panel(const RaysRequest& request, const LinearAxis& depth) {
  const SoundSpeedProfile& profile = request.water.profile;
  std::vector<double> depths_m{depth.first, depth.last};
  for (const ProfilePoint& point : profile.points())
    if (point.depth_m > depth.first && point.depth_m < depth.last) depths_m.push_back(point.depth_m);
  std::ranges::sort(depths_m);
  LinearAxis speed{std::numeric_limits<double>::infinity(), 0, profile_left + 8, profile_right - 8};
  for (const double depth_m : depths_m) {
    speed.first = std::min(speed.first, profile.at(depth_m));
    speed.last = std::max(speed.last, profile.at(depth_m));
  }
  speed.widen(1);
  Polyline line;
  for (const double depth_m : depths_m) line.add(speed.at(profile.at(depth_m)), depth.at(depth_m));
  return line.drawn_in("#000000", 1.5) + ticks_across(speed, 3, plot_bottom + 20) +
         frame(profile_left, profile_right) +
         word((profile_left + profile_right) / 2, sheet_height - 22, "middle", "sound speed (m/s)");
}

std::string legend(const std::set<std::size_t>& drawn_kinds) {
  std::string svg;
  double x = rays_left;
  for (const std::size_t kind : drawn_kinds) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" y1=\"42\" x2=\"{1:.1f}\" y2=\"42\" stroke=\"{2}\" stroke-width=\"3\"/>\n", x,
        x + 18, series_colour(kind));
    svg += word(x + 23, 46, "start", kinds[kind]);
    x += 40 + 7.2 * static_cast<double>(std::string_view(kinds[kind]).size());
  }
  return svg;
}

}  // namespace

std::vector<DrawnRay> drawn(const RaysRequest& request, const std::vector<PointArrivals>& points) {
  std::vector<DrawnRay> rays;
  for (const PointArrivals& point : points)
    for (const RayArrival& arrival : point.arrivals)
      rays.push_back({path_of(arrival, request.water, request.depth_m(request.source_m), point.depth_m,
                              point.range_m, request.options),
                      static_cast<int>(arrival.turning_depths_m.size()), arrival.surface_reflections,
                      arrival.bottom_reflections});
  return rays;
}

std::vector<DrawnRay> drawn(const std::vector<FanRay>& fan) {
  std::vector<DrawnRay> rays;
  for (const FanRay& ray : fan) {
    DrawnRay shape{ray.nodes, static_cast<int>(turning_depths(ray.nodes).size()), 0, 0};
    for (const RayNode& node : ray.nodes) {
      shape.surface_reflections += node.event == RayEvent::surface ? 1 : 0;
      shape.bottom_reflections += node.event == RayEvent::bottom ? 1 : 0;
    }
    rays.push_back(std::move(shape));
  }
  return rays;
}

std::string to_svg(const RaysRequest& request, const std::vector<DrawnRay>& rays,
                   const std::vector<std::pair<double, double>>& points) {
  const LinearAxis depth = depth_axis(request, rays, points);
  double farthest_m = 0;
  for (const DrawnRay& ray : rays) farthest_m = std::max(farthest_m, ray.nodes.back().state.range_m);
  for (const auto& point : points) farthest_m = std::max(farthest_m, point.first);
  const double unit = farthest_m >= 10e3 ? 1e3 : 1;
  LinearAxis range{0, farthest_m / unit, rays_left, rays_right};
  range.widen(1e-3);
  const auto across = [&](double range_m) { return range.at(range_m / unit); };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      sheet_width, sheet_height);
  svg += word(profile_left, 24, "start", "Rays in " + request.water_name, 15);
  const double step = tick_step(depth.last - depth.first, 8);
  for (const double value : ticks(depth.first, depth.last, step)) {
    svg += stroke(profile_left - 5, depth.at(value), profile_left, depth.at(value), "#444444");
    svg += stroke(rays_left, depth.at(value), rays_right, depth.at(value), "#e4e4e4");
    svg += word(profile_left - 9, depth.at(value) + 4, "end", tick_label(value, step));
  }
  svg += fmt::format(
      "<text x=\"20\" y=\"{0:.1f}\" text-anchor=\"middle\" font-size=\"12\" transform=\"rotate(-90 20 "
      "{0:.1f})\">"
      "depth (m)</text>\n",
      (plot_top + plot_bottom) / 2);
  svg += profile_panel(request, depth);
  svg += ticks_across(range, 8, plot_bottom + 20);
  svg += word((rays_left + rays_right) / 2, sheet_height - 22, "middle",
              unit > 1 ? "horizontal range (km)" : "horizontal range (m)");
  svg += fmt::format(
      "<clipPath id=\"plot\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"/></clipPath>\n"
      "<g clip-path=\"url(#plot)\">\n",
      rays_left, plot_top, rays_right - rays_left, plot_bottom - plot_top);
  std::set<std::size_t> drawn_kinds;
  for (const DrawnRay& ray : rays) {
    Polyline line;
    for (const PathPoint& point : points_along(ray.nodes, degree / 2))
      line.add(across(point.range_m), std::clamp(depth.at(point.depth_m), -2000.0, 3000.0));
    svg += line.drawn_in(series_colour(kind_of(ray)), 1);
    drawn_kinds.insert(kind_of(ray));
  }
  for (const double level_m : {request.options.surface_m, request.options.bottom_m})
    if (std::isfinite(level_m))
      svg += stroke(rays_left, depth.at(level_m), rays_right, depth.at(level_m), "#000000");
  svg += "</g>\n" + frame(rays_left, rays_right) + legend(drawn_kinds);
  const auto dot = [&](double range_m, double depth_m, const char* fill) {
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\" stroke=\"black\"/>\n",
                       across(range_m), depth.at(depth_m), fill);
  };
  for (const auto& [range_m, depth_m] : points) dot(range_m, depth_m, "white");
  dot(0, request.depth_m(request.source_m), "black");
  return svg + "</svg>\n";
}

RaysPicture::RaysPicture(const std::filesystem::path& file, const Inputs& inputs)
    : file_(file, inputs), svg_(file.extension() == ".svg") {
  if (!svg_ && file.extension() != ".png")
    throw UsageError(fmt::format("--picture '{}': unknown suffix: expected .png or .svg", file.string()));
}

void RaysPicture::write(const std::string& svg) {
  if (svg_)
    write_file(file_.path(), svg);
  else
    write_png_of_svg(svg, file_.path(), 1.5);
  file_.commit();
}

}  // namespace tubefoot
