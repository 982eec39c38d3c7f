// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sensors/pictures/camera_fan.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/pictures/decibel_scale.hpp"

namespace tubefoot {

/// Colours of the pixels of a ping. The colour of a cell that fills many pixels is computed once.
class FanColours {
 public:
  FanColours(const CameraPixels& pixels, const PingEchoes& echoes, const DecibelScale& scale)
      : pixels_(pixels), echoes_(echoes), scale_(scale), of_cells_(echoes.energy.size()) {}

  /// The colour, and the part of the pixel that has it.
  struct Pixel {
    Colour colour;
    double coverage = 0;
  };
  Pixel at(int x, int y) {
    const std::int64_t cell = pixels_.only_cell_at(x, y);
    if (cell < 0) return found(x, y);
    std::optional<Colour>& colour = of_cells_[static_cast<std::size_t>(cell)];
    if (!colour) colour = found(x, y).colour;
    return {*colour, 1};
  }

 private:
  Pixel found(int x, int y) const {
    const PixelEcho echo = pixels_.echo_at(x, y, echoes_);
    if (!(echo.coverage > 0)) return {};
    return {scale_.colour(echo.energy_j, echo.beyond), echo.coverage};
  }

  const CameraPixels& pixels_;
  const PingEchoes& echoes_;
  const DecibelScale& scale_;
  std::vector<std::optional<Colour>> of_cells_;
};

/// A page with one fan of echoes, its range and angle frame, and the scale. Data that all echoes share are
/// computed once.
class FanPage {
 public:
  enum class Towards { up, down };  ///< direction of forward on the page
  explicit FanPage(CameraFan fan, Towards towards = Towards::up);

  const CameraFan& fan() const { return fan_; }
  struct Texts {
    std::string title, subtitle, footer;
  };
  /// Thread-safe.
  Canvas draw(const Texts& texts, const PingEchoes& echoes, const DecibelScale& scale,
              const std::string& font) const;

 private:
  /// Row on the page of a row of the fan, from the top of its box.
  int row_of(int y) const { return downwards_ ? fan_.height() - 1 - y : y; }
  void draw_labels(Canvas& canvas, int left, int top) const;

  CameraFan fan_;
  bool downwards_;
  CameraPixels pixels_;
  std::vector<CameraFan::Lines> lines_;  ///< of the same pixels
};

}  // namespace tubefoot
