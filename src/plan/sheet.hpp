// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// A rectangle of a drawing in pixels: x to the right, y down.
struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;

  /// Returns a box that contains nothing.
  static Box none() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {infinity, infinity, -infinity, -infinity};
  }
  double width() const { return right - left; }
  double height() const { return bottom - top; }
  glm::dvec2 middle() const { return {(left + right) / 2, (top + bottom) / 2}; }
  bool empty() const { return left > right; }
  bool meets(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool holds(const Box& other) const {
    return left <= other.left && other.right <= right && top <= other.top && other.bottom <= bottom;
  }
  void add(glm::dvec2 point);
};

/// Style of a text.
struct Lettering {
  std::string_view anchor = "start";  ///< part of the text at its position: start, middle or end
  double size = 11;
  std::string_view colour = "#1b1e22";
  bool bold = false;
  bool halo = false;     ///< white outline, for a text on a picture
  bool upwards = false;  ///< rotated by 90 degrees, as along an axis
};

/// Returns an upper estimate of the width of a text, for the widest of the usual fonts.
double width_of(std::string_view text, double size);

/// Builds an SVG drawing. Texts may contain any characters; shown_markup() escapes them.
class Sheet {
 public:
  void text(glm::dvec2 at, std::string_view words, const Lettering& how = {});
  void line(glm::dvec2 from, glm::dvec2 to, std::string_view style);
  void rectangle(const Box& box, std::string_view style);
  void circle(glm::dvec2 middle, double radius, std::string_view style);
  void polyline(const std::vector<glm::dvec2>& points, std::string_view style);
  /// `data`: data of an SVG path, as from Silhouette::path().
  void path(const std::string& data, std::string_view style);
  /// Adds a PNG that fills the box.
  void picture(const Box& box, std::string_view png);
  /// Restricts everything drawn until end_clip() to the box.
  void begin_clip(const Box& box);
  void end_clip();

  /// Returns the whole drawing on a white background.
  std::string svg(double width, double height) const;

 private:
  std::string body_;
  int clips_ = 0;
};

/// Places labels next to the marks that they name, without overlaps.
class Labels {
 public:
  explicit Labels(const Box& within) : within_(within) {}

  /// Keeps a region free of labels.
  void keep_free(const Box& box) { taken_.push_back(box); }
  /// Writes a label next to a box. Returns false, without writing, if there is no free position.
  bool put(Sheet& sheet, const Box& about, std::string_view name, const Lettering& how);

 private:
  Box within_;
  std::vector<Box> taken_;
};

}  // namespace tubefoot
