// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// sRGB-coded components, 0..1.
struct Colour {
  float red = 0, green = 0, blue = 0;
};

/// `amount` of b over a.
Colour mix(Colour a, Colour b, double amount);

/// Which point of a text its position names.
enum class Anchor { left, centre, right };

/// A picture being drawn. x to the right, y down, pixel (0, 0) is the top left one; coordinates name pixels.
class Canvas {
 public:
  /// `font` is a name or file that OpenImageIO finds; empty: texts are left out (find_font).
  Canvas(int width, int height, Colour background, std::string font);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Lays a colour over a pixel; pixels outside the picture are ignored.
  void blend(int x, int y, Colour colour, double alpha = 1);
  /// Lays a colour over the pixels [x0, x1) x [y0, y1).
  void fill(int x0, int y0, int x1, int y1, Colour colour, double alpha = 1);
  /// Writes a line of ASCII text whose capitals are centred on the height y. It may end with a degree sign.
  void text(int x, int y, const std::string& line, int size, Colour colour, Anchor anchor = Anchor::left);

  /// Writes a 16-bit RGB PNG. Throws std::runtime_error naming the file.
  void write_png(const std::filesystem::path& file, const std::string& description) const;

 private:
  int width_, height_;
  std::vector<float> components_;  ///< red, green, blue of each pixel, row by row
  std::string font_;
};

/// The first of `candidates` that OpenImageIO finds, or an empty string.
std::string find_font(const std::vector<std::string>& candidates);
/// A sans-serif font of the usual packages (Debian: fonts-dejavu-core), or an empty string; looked for once.
const std::string& label_font();

/// Width of a line of text in pixels; 0 without a font.
int text_width(const std::string& line, int size, const std::string& font);

/// The step 1, 2 or 5 times a power of ten that cuts `extent` into `wanted` parts at most.
double tick_step(double extent, int wanted);
/// Multiples of `step` in [first, last], a rounding outside included.
std::vector<double> ticks(double first, double last, double step);
/// A tick's label with as many decimals as its step needs.
std::string tick_label(double value, double step);

}  // namespace tubefoot
