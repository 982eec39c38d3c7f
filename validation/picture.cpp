// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the panels of a case of the stability atlas: the exact visible polygons, and the points at which
// each method is wrong.
#include "validation/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/pictures/canvas.hpp"
#include "validation/page.hpp"

namespace tubefoot::atlas {
namespace {

constexpr int panel = 240, margin = 12, head = 30, foot = 30, text_size = 14;
/// Number of test points per pixel in each direction. The red of a pixel increases with the number of wrong
/// points. A single wrong point is clearly visible, so that thin cracks appear.
constexpr int fine = 3;

constexpr Colour paper{1, 1, 1}, ink{0.1f, 0.1f, 0.12f}, open_water{0.9f, 0.92f, 0.94f},
    wrong{0.87f, 0, 0.05f};

/// Hues from yellow over green and blue to violet, because red marks errors.
Colour colour_of(FacetId facet) {
  if (facet >= several_there) return open_water;
  const double spread = facet * 0.6180339887498949, hue = 0.13 + 0.67 * (spread - std::floor(spread));
  const double light = 0.5 + 0.15 * (facet % 3);
  const auto component = [&](double shift) {
    const double t = std::abs(std::fmod(hue + shift, 1.0) * 6 - 3) - 1, pure = t < 0 ? 0 : t > 1 ? 1 : t;
    return static_cast<float>(light + (pure - 0.5) * 0.55 * (1 - std::abs(2 * light - 1)));
  };
  return {component(0), component(2.0 / 3), component(1.0 / 3)};
}

/// Returns the test points of the part of a panel that shows one tube, `fine` per pixel in each direction.
/// They avoid the centres, on which scenes on lattices have their edges.
std::vector<glm::dvec2> points_of(std::uint32_t n) {
  std::vector<glm::dvec2> points;
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) points.emplace_back((i + 0.5137) / n, (j + 0.4871) / n);
  return points;
}

using Answers = std::vector<std::vector<FacetId>>;  ///< by tube and point

class Strip {
 public:
  Strip(const Entry& entry, Canvas& canvas)
      : scene_(entry.scene),
        canvas_(canvas),
        pixels_(panel / scene_.columns),
        points_(points_of(static_cast<std::uint32_t>(pixels_ * fine))),
        exact_(read_off(entry.rational.visibility)) {}

  Answers read_off(const CommonVisibility& visibility) const {
    Answers answers;
    for (const CommonVisibility::OfTube& tube : visibility.tubes)
      answers.push_back(locate(tube.polygons, points_, static_cast<std::uint32_t>(pixels_ * fine)));
    return answers;
  }
  Answers transmission(const NaiveRays& rays) const {
    Answers answers;
    for (std::uint32_t t = 0; t < exact_.size(); ++t) {
      const Chart chart(scene_.tubes, t);
      for (answers.emplace_back(); const glm::dvec2 p : points_)
        answers.back().push_back(rays.first_hit(chart.direction(p)));
    }
    return answers;
  }

  void draw_exact(int index, const std::string& title, const std::string& verdict) {
    draw(index, title, verdict,
         [&](std::size_t tube, std::size_t middle, const auto&) { return colour_of(exact_[tube][middle]); });
  }
  void draw_wrong(int index, const std::string& title, const std::string& verdict, const Answers& found) {
    draw(index, title, verdict, [&](std::size_t tube, std::size_t middle, const auto& share_of) {
      const double share = share_of([&](std::size_t k) { return found[tube][k] != exact_[tube][k]; });
      if (share == 0) return mix(colour_of(exact_[tube][middle]), paper, 0.72);
      return mix(paper, wrong, share > 0.6 ? 1 : share > 0.3 ? 0.7 : 0.45);  // few tints keep the file small
    });
  }

 private:
  template <class Paint>
  void draw(int index, const std::string& title, const std::string& verdict, const Paint& paint) {
    const int x0 = margin + index * (panel + margin);
    canvas_.text(x0, head / 2 + 2, title, text_size, ink);
    canvas_.text(x0, head + panel + foot / 2 - 1, verdict, text_size, ink);
    for (int y = 0; y < panel; ++y)
      for (int x = 0; x < panel; ++x) {
        const int i = x / pixels_, up = panel - 1 - y, j = up / pixels_;
        const auto tube = static_cast<std::size_t>(j * scene_.columns + i);
        const auto point = [&](int a, int b) {
          return static_cast<std::size_t>((up % pixels_ * fine + b) * pixels_ * fine + x % pixels_ * fine +
                                          a);
        };
        const auto share_of = [&](const auto& condition) {
          int count = 0;
          for (int k = 0; k < fine * fine; ++k) count += condition(point(k % fine, k / fine));
          return double(count) / (fine * fine);
        };
        canvas_.blend(x0 + x, head + y, paint(tube, point(fine / 2, fine / 2), share_of));
      }
    for (int k = 0; k <= scene_.columns; ++k) {
      const int at = std::min(k * pixels_, panel - 1);
      canvas_.fill(x0 + at, head, x0 + at + 1, head + panel, ink);
      canvas_.fill(x0, head + at, x0 + panel, head + at + 1, ink);
    }
  }

  const Case& scene_;
  Canvas& canvas_;
  int pixels_;
  std::vector<glm::dvec2> points_;
  Answers exact_;
};

}  // namespace

void draw(const Entry& entry, const std::filesystem::path& file) {
  Canvas canvas(4 * panel + 5 * margin, head + panel + foot, paper, label_font());
  Strip strip(entry, canvas);
  strip.draw_exact(0, "exact", fmt::format("{} visible facets", entry.rational.visibility.facets));
  strip.draw_wrong(1, "double, tolerance 0", plain_text(entry.plain), strip.read_off(entry.plain.visibility));
  strip.draw_wrong(2, fmt::format("double, tolerance {:.0e}", entry.tolerance), plain_text(entry.tuned),
                   strip.read_off(entry.tuned.visibility));
  const NaiveRays rays(entry.scene, NaiveRays::Flags::usual);
  strip.draw_wrong(3, "Embree (float)", "wrong rays: " + share_text(entry.usual), strip.transmission(rays));
  canvas.write_png(file, "tubefoot stability atlas: " + entry.scene.title);
}

}  // namespace tubefoot::atlas
