// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/panel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/pictures/canvas.hpp"

namespace tubefoot {
namespace {

/// Ticks of one axis, few enough that their labels do not overlap.
struct Ticks {
  std::vector<double> places_m;
  std::vector<std::string> labels;
  std::string unit;

  /// `room_of`: returns the size of a label in pixels.
  template <class Room>
  Ticks(double lo_m, double hi_m, double pixels, const Room& room_of) {
    constexpr double kilometres_from_m = 2e4;
    const double in_m = hi_m - lo_m >= kilometres_from_m ? 1000 : 1;
    unit = in_m > 1 ? "km" : "m";
    for (int wanted = 8; wanted >= 1; --wanted) {
      const double step = tick_step((hi_m - lo_m) / in_m, wanted);
      places_m.clear(), labels.clear();
      double widest = 0;
      for (const double value : ticks(lo_m / in_m, hi_m / in_m, step)) {
        places_m.push_back(value * in_m);
        labels.push_back(tick_label(value, step));
        widest = std::max(widest, room_of(labels.back()));
      }
      if (widest <= pixels * step * in_m / (hi_m - lo_m)) return;
    }
  }
};

}  // namespace

Panel::Panel(const Box& box, const View& view, const Window& window, double stretch)
    : box_(box), view_(view), window_(window) {
  const glm::dvec2 paper(box.width(), box.height() / stretch), size = window.hi_m - window.lo_m;
  const double metres_a_pixel = std::max(size.x / paper.x, size.y / paper.y);
  scale_ = glm::dvec2(1, stretch) / metres_a_pixel;
  const glm::dvec2 middle = (window.lo_m + window.hi_m) / 2.0;
  window_ = {middle - paper * metres_a_pixel / 2.0, middle + paper * metres_a_pixel / 2.0};
}

void Panel::draw_axes(Sheet& sheet, const std::string& title, const std::string& right_name,
                      const std::string& up_name) const {
  constexpr std::string_view rule = "stroke=\"#4b535b\"";
  constexpr double size = 10.5, gap = 14;
  const Ticks right(window_.lo_m.x, window_.hi_m.x, box_.width(),
                    [&](const std::string& label) { return width_of(label, size) + gap; });
  const Ticks up(window_.lo_m.y, window_.hi_m.y, box_.height(),
                 [&](const std::string&) { return size + gap; });
  const Lettering below{.anchor = "middle", .size = size, .colour = "#4b535b"},
      beside{.anchor = "end", .size = size, .colour = "#4b535b"};
  for (std::size_t k = 0; k < right.places_m.size(); ++k) {
    const double x = at(glm::dvec2(right.places_m[k], window_.lo_m.y)).x;
    sheet.line({x, box_.bottom}, {x, box_.bottom + 5}, rule);
    sheet.text({x, box_.bottom + 17}, right.labels[k], below);
  }
  double widest = 0;
  for (std::size_t k = 0; k < up.places_m.size(); ++k) {
    const double y = at(glm::dvec2(window_.lo_m.x, up.places_m[k])).y;
    sheet.line({box_.left - 5, y}, {box_.left, y}, rule);
    sheet.text({box_.left - 8, y + 4}, up.labels[k], beside);
    widest = std::max(widest, width_of(up.labels[k], size));
  }
  sheet.rectangle(box_, "fill=\"none\" stroke=\"#4b535b\"");
  sheet.text({box_.middle().x, box_.bottom + 33}, fmt::format("{} ({})", right_name, right.unit),
             {.anchor = "middle", .size = size});
  sheet.text({box_.left - std::min(widest + 14, 66.0), box_.middle().y},
             fmt::format("{} ({})", up_name, up.unit), {.anchor = "middle", .size = size, .upwards = true});
  sheet.text({box_.left, box_.top - 8}, title, {.size = 12, .bold = true});
}

double stretch_of(glm::dvec2 size_m, double width, double height) {
  const double flat = size_m.y / size_m.x * width;  // height without a stretch
  constexpr double enough = 0.4;
  if (!(flat > 0) || flat > enough * height) return 1;
  const double largest = 0.9 * height / flat, power = std::pow(10.0, std::floor(std::log10(largest)));
  return power * (largest >= 5 * power ? 5 : largest >= 2 * power ? 2 : 1);
}

}  // namespace tubefoot
