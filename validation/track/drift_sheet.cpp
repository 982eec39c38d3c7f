// SPDX-License-Identifier: GPL-3.0-or-later
// Draws consecutive camera frames as seen from above, with a marked place of the seabed that moves through
// them. The positions of the place follow from the true track.
#include "track/drift_sheet.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {
namespace {

constexpr std::size_t frames_shown = 8, in_a_row = 4;
constexpr double sheet_pixel_m = 0.005, ahead_m = 4.0;  // of the centres of the squares
constexpr int side = 300, gap = 12, head = 84, label = 30;
constexpr double swing = 0.2;  // range of the flattened energies, from dark to bright
constexpr Colour mark{0.25f, 0.95f, 1.0f};

/// A pixel of a square: (0, 0) is the upper left one, which is farthest to port and ahead.
struct Spot {
  double x = 0, y = 0;
};

Spot spot_of(TrackStep place) {
  return {side / 2.0 + place.starboard_m / sheet_pixel_m,
          side / 2.0 - (place.ahead_m - ahead_m) / sheet_pixel_m};
}

TrackStep place_of(int x, int y) {
  return {(x + 0.5 - side / 2.0) * sheet_pixel_m, ahead_m - (y + 0.5 - side / 2.0) * sheet_pixel_m};
}

double value_at(const PixelMap& map, TrackStep place) {
  const double column = place.starboard_m / sheet_pixel_m + static_cast<double>(map.columns - 1) / 2,
               row = place.ahead_m / sheet_pixel_m;
  if (!(column >= 0 && row >= 0)) return std::nan("");
  const auto c = static_cast<std::size_t>(std::lround(column)),
             r = static_cast<std::size_t>(std::lround(row));
  return c < map.columns && r < map.rows ? map.at(c, r) : std::nan("");
}

TrackStep brightest(const PixelMap& map) {
  constexpr int reach = 60;
  TrackStep best;
  double most = -1;
  for (int y = side / 2 - reach; y < side / 2 + reach; ++y)
    for (int x = side / 2 - reach; x < side / 2 + reach; ++x)
      if (const double value = value_at(map, place_of(x, y)); value > most) {
        most = value;
        best = place_of(x, y);
      }
  if (most < 0) throw std::invalid_argument("the camera does not see the seabed 4 m ahead");
  return best;
}

void ring(Canvas& canvas, double x, double y, double radius) {
  for (int dy = -24; dy <= 24; ++dy)
    for (int dx = -24; dx <= 24; ++dx) {
      const double px = std::floor(x) + dx, py = std::floor(y) + dy;
      const double off = std::abs(std::hypot(px + 0.5 - x, py + 0.5 - y) - radius);
      if (off < 1.8) canvas.blend(static_cast<int>(px), static_cast<int>(py), mark, std::min(1.0, 1.8 - off));
    }
}

}  // namespace

Canvas draw_drift(const Recording& recording, const std::vector<std::vector<double>>& frames, double seabed_m,
                  const std::string& font) {
  if (frames.size() < frames_shown) throw std::invalid_argument("a sheet of drift needs eight frames");
  std::vector<PixelMap> maps;
  for (std::size_t ping = 0; ping < frames_shown; ++ping)
    maps.push_back(ground_picture(recording, ping, frames[ping], {seabed_m, sheet_pixel_m}));
  const glm::dvec3 place_m = place_seen(recording.ping_pose[0], brightest(maps[0]), seabed_m);

  constexpr int rows = static_cast<int>(frames_shown / in_a_row), columns = static_cast<int>(in_a_row);
  Canvas canvas(columns * (side + gap) + gap, head + rows * (side + label) + gap, palette.background, font);
  canvas.text(gap, 26, "eight consecutive frames, seen from above", title_size, palette.ink);
  canvas.text(
      gap, 58,
      fmt::format(
          "squares of {} m; ring: one point of the seabed, from the true track; dots: its earlier positions",
          side * sheet_pixel_m),
      label_size, palette.faint_ink);
  std::vector<Spot> way;
  for (std::size_t ping = 0; ping < frames_shown; ++ping) {
    const int x0 = gap + static_cast<int>(ping % in_a_row) * (side + gap),
              y0 = head + static_cast<int>(ping / in_a_row) * (side + label);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (const double value = value_at(maps[ping], place_of(x, y)); !std::isnan(value))
          canvas.fill(x0 + x, y0 + y, x0 + x + 1, y0 + y + 1,
                      DecibelScale::at_level(0.55 + value / (2 * swing)));
    for (const Spot& before : way) {
      const int x = x0 + static_cast<int>(before.x), y = y0 + static_cast<int>(before.y);
      canvas.fill(x - 1, y - 1, x + 2, y + 2, mark);
    }
    way.push_back(spot_of(seen_from(recording.ping_pose[ping], place_m)));
    ring(canvas, x0 + way.back().x, y0 + way.back().y, 20);
    canvas.text(x0, y0 + side + label / 2,
                fmt::format("frame {}   t = {:.1f} s", ping, recording.ping_time_s[ping]), label_size,
                palette.ink);
  }
  return canvas;
}

}  // namespace tubefoot
