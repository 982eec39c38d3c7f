// SPDX-License-Identifier: GPL-3.0-or-later
#include "advice/chart_folder.hpp"

#include <fmt/format.h>

#include "files/checked_file.hpp"
#include "study/chart_page.hpp"
#include "study/svg_png.hpp"

namespace tubefoot {
namespace {

void write_pictures_of(const std::filesystem::path& folder, const std::string& scene,
                       std::span<const Trial> trials) {
  for (const auto& [measure, name] : {std::pair{ErrorMeasure::l1, "l1"}, {ErrorMeasure::rms_db, "rms-db"}}) {
    const std::string svg = to_svg(work_precision_plot(scene, trials, measure));
    const std::string stem = fmt::format("{}-{}", scene, name);
    write_file(folder / (stem + ".svg"), svg);
    write_png_of_svg(svg, folder / (stem + ".png"));
  }
}

}  // namespace

std::string chart_origin(const std::string& program, const std::string& pings, int repeats) {
  return fmt::format(
      "Made by {}, version {}: pings {} of the first sensor of each scene, one thread, median of {} runs. "
      "The reference is certified (docs/reference-results.md). Times do not include the construction of "
      "trees.",
      program, TUBEFOOT_VERSION, pings, repeats);
}

void write_chart(const std::filesystem::path& folder, std::span<const Trial> trials,
                 const std::string& origin) {
  for (const std::string& scene : scenes_of(trials)) write_pictures_of(folder, scene, trials);
  write_file(folder / "chart.csv", to_csv(trials));
  write_file(folder / "index.html", to_html(trials, origin));
}

}  // namespace tubefoot
