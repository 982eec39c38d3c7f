// SPDX-License-Identifier: GPL-3.0-or-later
// A raster picture with colours, text and axis ticks. OpenImageIO draws the text; png_bytes.hpp encodes the
// picture. Texts are limited to ASCII and a degree sign at the end.

#include "sensors/pictures/canvas.hpp"

#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "files/checked_file.hpp"
#include "sensors/pictures/png_bytes.hpp"
#include "sensors/pictures/text_mask.hpp"

namespace tubefoot {

namespace fs = std::filesystem;
namespace {

constexpr std::string_view degree_sign = "\u00b0";

/// OpenImageIO 2.4 draws a character beyond ASCII by its last six bits. A degree sign at the end of a line
/// is drawn as a ring instead. Any other such character (of a sensor's name) becomes a question mark.
std::string drawable(std::string_view line) {
  if (line.ends_with(degree_sign)) line.remove_suffix(degree_sign.size());
  std::string ascii;
  for (const char c : line) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f)
      ascii += c;
    else if (byte >= 0xc0)
      ascii += '?';  // the first byte of a longer character; the other bytes are skipped
  }
  return ascii;
}

int ring_width(int size) { return static_cast<int>(std::lround(0.4 * size)); }

}  // namespace

Colour mix(Colour a, Colour b, double amount) {
  const auto t = static_cast<float>(amount);
  return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green), a.blue + t * (b.blue - a.blue)};
}

namespace {

/// Pixels of a destroyed canvas, per thread. The system clears fresh pages, which takes a quarter of the
/// time of a ping's picture.
thread_local std::vector<float> spare;

}  // namespace

Canvas::Components::Components(std::size_t count) {
  values_.swap(spare);
  values_.resize(count);  // old contents: the background covers them all
}
Canvas::Components::~Components() {
  constexpr std::size_t most = (std::size_t{32} << 20) / sizeof(float);
  if (values_.capacity() > spare.capacity() && values_.capacity() <= most) spare.swap(values_);
}

Canvas::Canvas(int width, int height, Colour background, std::string font)
    : width_(width),
      height_(height),
      components_(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      font_(std::move(font)) {
  const std::span<float> values = components_.values();
  for (std::size_t k = 0; k + 2 < values.size(); k += 3) {
    values[k] = background.red;
    values[k + 1] = background.green;
    values[k + 2] = background.blue;
  }
}

void Canvas::blend(int x, int y, Colour colour, double alpha) {
  if (x < 0 || y < 0 || x >= width() || y >= height()) return;
  float* pixel = &components_[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(x))];
  const Colour mixed = mix({pixel[0], pixel[1], pixel[2]}, colour, alpha);
  pixel[0] = mixed.red;
  pixel[1] = mixed.green;
  pixel[2] = mixed.blue;
}

void Canvas::fill(int x0, int y0, int x1, int y1, Colour colour, double alpha) {
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) blend(x, y, colour, alpha);
}

PixelBox Canvas::box_of(int x, int y, const std::string& line, int size, Anchor anchor) const {
  const int length = text_width(line, size, font_), half = static_cast<int>(std::lround(0.55 * size));
  if (anchor == Anchor::right) x -= length;
  if (anchor == Anchor::centre) x -= length / 2;
  return {x, y - half, x + length, y + half};
}

void Canvas::label(int x, int y, const std::string& line, int size, Colour colour, Anchor anchor) {
  if (font_.empty() || line.empty()) return;
  constexpr int gap = 4;  // between neighbours on one line, so that they do not read as one
  const PixelBox box = box_of(x, y, line, size, anchor);
  if (box.left < 0 || box.top < 0 || box.right > width_ || box.bottom > height_) return;
  for (const PixelBox& other : texts_)
    if (box.left < other.right + gap && other.left < box.right + gap && box.top < other.bottom &&
        other.top < box.bottom)
      return;
  text(x, y, line, size, colour, anchor);
}

void Canvas::text(int x, int y, const std::string& line, int size, Colour colour, Anchor anchor) {
  if (font_.empty() || line.empty()) return;
  const PixelBox box = box_of(x, y, line, size, anchor);
  texts_.push_back(box);
  const int length = box.right - box.left;
  x = box.left;
  const int baseline =
      y + static_cast<int>(std::lround(0.365 * size));  // half the height of DejaVu's capitals
  const std::string drawn = drawable(line);
  const TextMask& mask = text_mask(drawn, size, font_);
  auto coverage = mask.coverage.begin();
  for (int row = 0; row < mask.height; ++row)
    for (int column = 0; column < mask.width; ++column, ++coverage)
      if (*coverage > 0) blend(x + mask.left + column, baseline + mask.top + row, colour, *coverage / 255.0);
  if (!line.ends_with(degree_sign)) return;
  const double radius = ring_width(size) / 2.0 - 1.5, centre_x = x + length - 1 - radius,
               centre_y = y - 0.27 * size;
  for (int v = y - size; v < y; ++v)
    for (int u = x; u < x + length + 1; ++u)
      blend(u, v, colour,
            std::clamp(1.2 - std::abs(std::hypot(u - centre_x, v - centre_y) - radius), 0.0, 1.0));
}

void Canvas::write_png(const std::filesystem::path& file, const std::string& description, int bits) const {
  write_file(file, png_bytes(width_, height_, components_.values(), bits, description));
}

std::vector<unsigned char> Canvas::screen_png(const std::string& description) const {
  return png_bytes(width_, height_, components_.values(), 8, description);
}

namespace {

/// Font folders by the XDG base directories and older conventions. Missing folders are skipped.
std::vector<fs::path> font_folders() {
  std::vector<fs::path> folders;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != 0)
    folders = {fs::path(home) / ".local/share/fonts", fs::path(home) / ".fonts"};
  folders.insert(folders.end(), {"/usr/local/share/fonts", "/usr/share/fonts"});
  return folders;
}

/// Path of a font with this file name; empty if there is none.
fs::path font_file(const std::string& name) {
  constexpr int deepest = 4;
  for (const fs::path& folder : font_folders()) {
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error),
         end;
         !error && entry != end; entry.increment(error)) {
      if (entry.depth() >= deepest) entry.disable_recursion_pending();
      const fs::path& file = entry->path();
      if (file.stem() == name && (file.extension() == ".ttf" || file.extension() == ".otf")) return file;
    }
  }
  return {};
}

bool draws(const std::string& font) { return OIIO::ImageBufAlgo::text_size("0", 16, font).defined(); }

}  // namespace

// OpenImageIO 2.5 searches the folders without their subfolders, and Debian stores fonts in subfolders.
std::string find_font(const std::vector<std::string>& candidates) {
  for (const std::string& name : candidates) {
    if (draws(name)) return name;
    if (const fs::path file = font_file(name); !file.empty() && draws(file.string())) return file.string();
  }
  return {};
}

const std::string& label_font() {
  static const std::string font =
      find_font({"DejaVuSans", "LiberationSans-Regular", "NotoSans-Regular", "FreeSans"});
  return font;
}

int text_width(const std::string& line, int size, const std::string& font) {
  if (font.empty() || line.empty()) return 0;
  return text_mask(drawable(line), size, font).length +
         (line.ends_with(degree_sign) ? ring_width(size) + 1 : 0);
}

int widest_text(const std::vector<std::string>& lines, int size, const std::string& font) {
  int widest = 0;
  for (const std::string& line : lines) widest = std::max(widest, text_width(line, size, font));
  return widest;
}

double tick_step(double extent, int wanted) {
  const double power = std::pow(10, std::floor(std::log10(extent / wanted)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power * wanted >= extent * (1 - 1e-12)) return factor * power;
  return 10 * power;
}

std::vector<double> ticks(double first, double last, double step) {
  std::vector<double> values;
  for (double k = std::ceil(first / step - 1e-9); k * step <= last + 1e-9 * step; ++k)
    values.push_back(k * step + 0.0);
  return values;
}

std::string tick_label(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  // Avoids "-0": the tick nearest to zero is zero.
  const std::string number =
      fmt::format("{:.{}f}", std::abs(value) < step / 2 ? 0.0 : std::abs(value), decimals);
  return value <= -step / 2 ? "-" + number : number;
}

}  // namespace tubefoot
