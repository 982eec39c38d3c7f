// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace tubefoot {

/// A rectangle of a drawing, in its pixels: x to the right, y down.
struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;

  /// That holds nothing yet.
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

/// How a text is set.
struct Lettering {
  std::string_view anchor = "start";  ///< start, middle or end of it is at its place
  double size = 11;
  std::string_view colour = "#1b1e22";
  bool bold = false;
  bool halo = false;     ///< white about it, for a text on a picture
  bool upwards = false;  ///< turned by 90 degrees, as beside an axis
};

/// About how wide a text will be: fonts differ, this is for the widest that is usual.
double width_of(std::string_view text, double size);

/// An SVG drawing that is being made. Texts may hold anything (shown_markup).
class Sheet {
 public:
  void text(glm::dvec2 at, std::string_view words, const Lettering& how = {});
  void line(glm::dvec2 from, glm::dvec2 to, std::string_view style);
  void rectangle(const Box& box, std::string_view style);
  void circle(glm::dvec2 middle, double radius, std::string_view style);
  void polyline(const std::vector<glm::dvec2>& points, std::string_view style);
  /// `data`: of a path, as Silhouette::path() makes it.
  void path(const std::string& data, std::string_view style);
  /// A PNG, from the top left corner of the box to its bottom right one.
  void picture(const Box& box, std::string_view png);
  /// What is drawn until end_clip() is seen inside of the box only.
  void begin_clip(const Box& box);
  void end_clip();

  /// The whole drawing, on white.
  std::string svg(double width, double height) const;

 private:
  std::string body_;
  int clips_ = 0;
};

/// Names beside what they name, none over another.
class Labels {
 public:
  explicit Labels(const Box& within) : within_(within) {}

  /// Keeps a place free of names.
  void keep_free(const Box& box) { taken_.push_back(box); }
  /// Writes a name beside a box, where there is room; else leaves it out and returns false.
  bool put(Sheet& sheet, const Box& about, std::string_view name, const Lettering& how);

 private:
  Box within_;
  std::vector<Box> taken_;
};

}  // namespace tubefoot
