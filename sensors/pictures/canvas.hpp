// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
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

/// The pixels [left, right) x [top, bottom).
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
};

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
  /// The same for one of a row of labels, such as an axis's: left out where it would touch a text that is
  /// there already, or leave the picture. Texts that must be there come first.
  void label(int x, int y, const std::string& line, int size, Colour colour, Anchor anchor = Anchor::left);
  /// What the texts written so far take, in their order.
  const std::vector<PixelBox>& texts() const { return texts_; }

  /// Writes an RGB PNG of 8 or 16 bits a component. Throws std::runtime_error naming the file.
  void write_png(const std::filesystem::path& file, const std::string& description, int bits = 8) const;
  /// The bytes of an 8-bit RGB PNG, for a screen. Throws std::runtime_error.
  std::vector<unsigned char> screen_png(const std::string& description) const;
  /// Red, green and blue of each pixel, 0 to 1, row by row from the top.
  std::span<const float> components() const { return components_.values(); }

 private:
  /// Red, green, blue of each pixel, row by row, in memory of a canvas before it, where there was one.
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
/// A sans-serif font of the usual packages (Debian: fonts-dejavu-core), or an empty string; looked for once.
const std::string& label_font();

/// Width of a line of text in pixels; 0 without a font.
int text_width(const std::string& line, int size, const std::string& font);
/// That of the widest of some.
int widest_text(const std::vector<std::string>& lines, int size, const std::string& font);

/// The step 1, 2 or 5 times a power of ten that cuts `extent` into `wanted` parts at most.
double tick_step(double extent, int wanted);
/// Multiples of `step` in [first, last], a rounding outside included.
std::vector<double> ticks(double first, double last, double step);
/// A tick's label with as many decimals as its step needs.
std::string tick_label(double value, double step);

}  // namespace tubefoot
