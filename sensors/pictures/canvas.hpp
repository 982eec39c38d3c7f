// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A raster picture under construction: pixels in sRGB, fills, text, and PNG output. Also fonts, text widths
// and the ticks of axes.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace tubefoot {

/// Border of a page, and height of the labels below a horizontal axis, in pixels.
constexpr int page_margin = 28, axis_label_height = 62;

/// sRGB-coded components, 0..1.
struct Colour {
  float red = 0, green = 0, blue = 0;
};

/// Blends `amount` of b over a.
Colour mix(Colour a, Colour b, double amount);

/// The point of a text to which its position refers.
enum class Anchor { left, centre, right };

/// The pixels [left, right) x [top, bottom).
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// A picture under construction: x to the right, y down, with pixel (0, 0) at the top left. Coordinates name
/// pixels.
class Canvas {
 public:
  /// `font` is a name or file that OpenImageIO finds. If it is empty, texts are omitted (find_font).
  Canvas(int width, int height, Colour background, std::string font);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Blends a colour over a pixel; pixels outside the picture are ignored.
  void blend(int x, int y, Colour colour, double alpha = 1);
  /// Blends a colour over the pixels [x0, x1) x [y0, y1).
  void fill(int x0, int y0, int x1, int y1, Colour colour, double alpha = 1);
  /// Writes a line of ASCII text whose capitals are centred on the height y. The line may end with a degree
  /// sign.
  void text(int x, int y, const std::string& line, int size, Colour colour, Anchor anchor = Anchor::left);
  /// The same for one of several labels, for example of an axis. The label is omitted if it would touch an
  /// earlier text or leave the picture. Draw required texts first.
  void label(int x, int y, const std::string& line, int size, Colour colour, Anchor anchor = Anchor::left);
  /// Boxes of the texts drawn so far, in their order.
  const std::vector<PixelBox>& texts() const { return texts_; }

  /// Writes an RGB PNG of 8 or 16 bits per component. Throws std::runtime_error with the file's name.
  void write_png(const std::filesystem::path& file, const std::string& description, int bits = 8) const;
  /// The bytes of an 8-bit RGB PNG, for a screen. Throws std::runtime_error.
  std::vector<unsigned char> screen_png(const std::string& description) const;
  /// Red, green and blue of each pixel, 0 to 1, row by row from the top.
  std::span<const float> components() const { return components_.values(); }

 private:
  /// Red, green, blue of each pixel, row by row. The memory of an earlier canvas is reused if there is one.
  class Components {
   public:
    explicit Components(std::size_t count);
    ~Components();
    Components(const Components&) = default;
    Components(Components&&) = default;
    Components& operator=(const Components&) = default;
    Components& operator=(Components&&) = default;
    float& operator[](std::size_t k) { return values_[k]; }
    std::span<float> values() { return values_; }
    std::span<const float> values() const { return values_; }

   private:
    std::vector<float> values_;
  };

  int width_, height_;
  Components components_;
  std::string font_;
  std::vector<PixelBox> texts_;

  PixelBox box_of(int x, int y, const std::string& line, int size, Anchor anchor) const;
};

/// The first of `candidates` that OpenImageIO finds, or an empty string.
std::string find_font(const std::vector<std::string>& candidates);
/// A sans-serif font of the usual packages (Debian: fonts-dejavu-core), or an empty string. The search runs
/// once.
const std::string& label_font();

/// Width of a line of text in pixels; 0 without a font.
int text_width(const std::string& line, int size, const std::string& font);
/// Width of the widest line.
int widest_text(const std::vector<std::string>& lines, int size, const std::string& font);

/// The step 1, 2 or 5 times a power of ten that divides `extent` into at most `wanted` parts.
double tick_step(double extent, int wanted);
/// Multiples of `step` in [first, last], including those that rounding places just outside.
std::vector<double> ticks(double first, double last, double step);
/// A tick's label with as many decimals as its step needs.
std::string tick_label(double value, double step);

}  // namespace tubefoot
