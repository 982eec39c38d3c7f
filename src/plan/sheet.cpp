// SPDX-License-Identifier: GPL-3.0-or-later
// Writes SVG elements: texts, lines, boxes, pictures and clip regions.
// Places labels next to the marks that they name, without overlaps.
#include "plan/sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "files/base64.hpp"
#include "files/shown.hpp"

namespace tubefoot {

void Box::add(glm::dvec2 point) {
  left = std::min(left, point.x), right = std::max(right, point.x);
  top = std::min(top, point.y), bottom = std::max(bottom, point.y);
}

double width_of(std::string_view text, double size) {
  constexpr double em_a_letter = 0.62;  // DejaVu Sans is the widest of the usual fonts
  const auto letters = std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; });
  return em_a_letter * size * static_cast<double>(letters);
}

void Sheet::text(glm::dvec2 at, std::string_view words, const Lettering& how) {
  body_ += fmt::format("<text x=\"{0:.1f}\" y=\"{1:.1f}\" font-size=\"{2:g}\" fill=\"{3}\"", at.x, at.y,
                       how.size, how.colour);
  if (how.anchor != "start") body_ += fmt::format(" text-anchor=\"{}\"", how.anchor);
  if (how.bold) body_ += " font-weight=\"bold\"";
  if (how.halo)
    body_ += " stroke=\"#ffffff\" stroke-opacity=\"0.85\" stroke-width=\"3\" paint-order=\"stroke\"";
  if (how.upwards) body_ += fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", at.x, at.y);
  body_ += fmt::format(">{}</text>\n", shown_markup(shown_line(words)));
}

void Sheet::line(glm::dvec2 from, glm::dvec2 to, std::string_view style) {
  body_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", from.x, from.y,
                       to.x, to.y, style);
}

void Sheet::rectangle(const Box& box, std::string_view style) {
  body_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}/>\n", box.left,
                       box.top, box.width(), box.height(), style);
}

void Sheet::circle(glm::dvec2 middle, double radius, std::string_view style) {
  body_ +=
      fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" {}/>\n", middle.x, middle.y, radius, style);
}

void Sheet::polyline(const std::vector<glm::dvec2>& points, std::string_view style) {
  body_ += "<polyline points=\"";
  for (const glm::dvec2& p : points) body_ += fmt::format("{:.1f},{:.1f} ", p.x, p.y);
  body_ += fmt::format("\" fill=\"none\" {}/>\n", style);
}

void Sheet::path(const std::string& data, std::string_view style) {
  if (!data.empty()) body_ += fmt::format("<path d=\"{}\" fill-rule=\"evenodd\" {}/>\n", data, style);
}

void Sheet::picture(const Box& box, std::string_view png) {
  body_ += fmt::format(
      "<image x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\" "
      "href=\"data:image/png;base64,{}\"/>\n",
      box.left, box.top, box.width(), box.height(), base64(png));
}

void Sheet::begin_clip(const Box& box) {
  // Identifiers of an SVG drawing share the name space of the page that contains it.
  const std::string name = fmt::format("drawing-clip-{}", clips_++);
  body_ += fmt::format("<clipPath id=\"{}\">", name);
  rectangle(box, "");
  body_ += fmt::format("</clipPath><g clip-path=\"url(#{})\">\n", name);
}

void Sheet::end_clip() { body_ += "</g>\n"; }

std::string Sheet::svg(double width, double height) const {
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 "
             "{0:.0f} {1:.0f}\" font-family=\"DejaVu Sans, sans-serif\">\n<rect width=\"{0:.0f}\" "
             "height=\"{1:.0f}\" fill=\"white\"/>\n",
             width, height) +
         body_ + "</svg>\n";
}

bool Labels::put(Sheet& sheet, const Box& about, std::string_view name, const Lettering& how) {
  const double width = width_of(name, how.size), height = how.size * 1.2;
  constexpr double gap = 4, above = 5;
  const glm::dvec2 middle = about.middle();
  // Upper left corners of possible positions, the best first.
  const std::array<glm::dvec2, 8> corners{{{about.right + gap, middle.y - height / 2},
                                           {about.left - gap - width, middle.y - height / 2},
                                           {middle.x - width / 2, about.top - above - height},
                                           {middle.x - width / 2, about.bottom + above},
                                           {about.right + gap, about.top - above - height},
                                           {about.right + gap, about.bottom + above},
                                           {about.left - gap - width, about.top - above - height},
                                           {about.left - gap - width, about.bottom + above}}};
  for (const glm::dvec2& corner : corners) {
    const Box box{corner.x, corner.y, corner.x + width, corner.y + height};
    if (!within_.holds(box) || std::ranges::any_of(taken_, [&](const Box& b) { return b.meets(box); }))
      continue;
    taken_.push_back(box);
    Lettering beside = how;
    beside.anchor = "start";
    beside.halo = true;
    sheet.text({box.left, box.bottom - 0.25 * height}, name, beside);
    return true;
  }
  return false;
}

}  // namespace tubefoot
