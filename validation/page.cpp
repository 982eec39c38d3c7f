// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the page of the stability atlas: errors of each method per case, results of each tolerance, and
// pictures of the failures.
#include "validation/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "engine/rays/embree.hpp"

namespace tubefoot::atlas {
namespace {

/// Formats a number with at most two digits: 0, 0.19, 3e-12.
std::string number(double x) {
  if (x == 0) return "0";
  return x >= 0.001 ? fmt::format("{:.2g}", x) : fmt::format("{:.0e}", x);
}

std::string open_text(const CommonVisibility& visibility) {
  if (visibility.unclosed == 0) return "";
  return fmt::format(", {} of {} open", visibility.unclosed, visibility.tubes.size());
}

std::string double_cell(const Answer& answer) {
  if (answer.is_right()) return "0";
  return fmt::format("**{}{}**", number(answer.error), open_text(answer.visibility));
}

std::string tuned_cell(const Entry& entry) {
  const std::string at = entry.as_good_up_to > entry.tolerance
                             ? fmt::format("{:.0e} .. {:.0e}", entry.tolerance, entry.as_good_up_to)
                             : fmt::format("{:.0e}", entry.tolerance);
  return fmt::format("{} (at {})", double_cell(entry.tuned), at);
}

std::string ray_cell(const RayResult& result, const Sampling& sampling) {
  const std::string text = fmt::format("{} ({})", number(result.error), share_text(result));
  return fails(result, sampling) ? "**" + text + "**" : text;
}

constexpr std::string_view preface = R"(<!-- Written by `make atlas`; do not edit. -->
# Stability atlas

The atlas contains inputs on which methods for visibility fail, and the result of each method. A function with
a fixed seed creates each scene (`validation/cases_*.cpp`). `make atlas` builds the program, creates the scenes,
runs every method, and writes this page and its pictures. It exits with an error unless the three exact
arithmetics agree on every case: equal rational areas of every facet in every tube, equal topology hash, and
every tube closed. `ctest -R Atlas` does the same with smaller scenes.

**Error** is the sum over facets of |computed area - true area| in the gnomonic plane of the tube, divided by the
area of the tube (mean over tubes). Area of a wrong facet counts twice: as missing area of one facet and as
additional area of another. The true area is the result of `rational`. *Open* counts tubes whose visible pieces
and unobstructed region do not add up to the tube (the closure law of
[docs/visibility.md](../docs/visibility.md)). If a tube with an error of 0 is open, its unobstructed region is
wrong. **Bold** entries are wrong.

- **fixed, filtered, rational**: the exact arithmetics. 0 stands for an equality of rationals.
- **double**: the same algorithm with the signs of plain double arithmetic, without a tolerance and with the best
  of a sweep of powers of ten from 1e-17 to 1e-3 (relative to the lengths of the factors). A range of tolerances
  means that all of them are equally good. The atlas tests only the decisions: it evaluates the resulting corners
  exactly, and it excludes facets whose plane contains the apex exactly. In the scenes at offsets, double
  computes in absolute coordinates.
- **Embree** @EMBREE@, as in a simple ray engine: float, absolute coordinates in metres, rays from distance 0,
  and the first hit counts. The table has results with default flags and with `RTC_SCENE_FLAG_ROBUST`. There is
  one ray per cell of a grid of 512 x 512 over one tube, or of 256 x 256 over each of four tubes. Next to the error
  is the share of *wrong rays*. A wrong ray hits a facet other than the exact one at the same point, so that
  sampling has no influence.
- **sampling**: the error of this number of rays without mistakes, from the exact answer at 8 other draws of the
  points, as mean and standard deviation. An entry of Embree is bold if its error is more than 5 deviations above
  the mean, or if there are more than 25 wrong rays, which is 5 times their own standard deviation.

For coincident facets, the tie rule decides that the facet with the smaller vertices is visible. An engine without
a rule also shows one of them, but the choice is arbitrary. The share that differs from the rule counts as error.
No method crashed or ran endlessly: all run in one process, and otherwise this page would not exist.
)";

void write_summary(std::string& page, std::span<const Entry> entries) {
  const auto count = [&](const auto& condition) {
    return std::count_if(entries.begin(), entries.end(), condition);
  };
  page += fmt::format(
      "\nOf {} cases, the exact arithmetics solve {}, double without a tolerance {}, and double with the "
      "best tolerance for each case {}. Embree fails beyond its sampling noise in {} cases, and in {} with "
      "robust flags.\n",
      entries.size(), count([](const Entry& e) { return e.exact_ones_agree(); }),
      count([](const Entry& e) { return e.plain.is_right(); }),
      count([](const Entry& e) { return e.tuned.is_right(); }),
      count([](const Entry& e) { return fails(e.usual, e.sampling); }),
      count([](const Entry& e) { return fails(e.robust, e.sampling); }));
}

void write_table(std::string& page, std::span<const Entry> entries) {
  page +=
      "\n| case | fixed | filtered | rational | double, tolerance 0 | double, best tolerance | Embree (wrong "
      "rays) | "
      "Embree robust (wrong rays) | sampling |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const Entry& e : entries)
    page +=
        fmt::format("| [{}](#{}) | {} | {} | {} | {} | {} | {} | {} | {} ± {} |\n", e.scene.title,
                    e.scene.name, exact_cell(e.fixed), exact_cell(e.filtered), exact_cell(e.rational),
                    double_cell(e.plain), tuned_cell(e), ray_cell(e.usual, e.sampling),
                    ray_cell(e.robust, e.sampling), number(e.sampling.mean), number(e.sampling.deviation));
}

/// Writes the results of each single tolerance for all cases, because a user needs one tolerance for all
/// scenes.
void write_sweep(std::string& page, std::span<const Entry> entries) {
  page +=
      "\n## One tolerance for all cases\n\nAn engine cannot choose its tolerance per scene, because it does "
      "not know the answer. The table shows the effect of one tolerance on all cases (areas only):\n\n| "
      "tolerance | correct cases | largest error | case |\n|---|---|---|---|\n";
  const auto row = [&](const std::string& name, const auto& error_in) {
    std::size_t right = 0;
    const Entry* worst = &entries[0];
    for (const Entry& e : entries) {
      right += error_in(e) == 0;
      if (error_in(e) > error_in(*worst)) worst = &e;
    }
    page += fmt::format("| {} | {} of {} | {} | {} |\n", name, right, entries.size(),
                        number(error_in(*worst)), error_in(*worst) == 0 ? "" : worst->scene.title);
  };
  row("0", [](const Entry& e) { return e.plain.error; });
  for (std::size_t k = 0; k < entries[0].sweep.size(); ++k)
    row(fmt::format("{:.0e}", entries[0].sweep[k].value), [k](const Entry& e) { return e.sweep[k].error; });
}

void write_cases(std::string& page, std::span<const Entry> entries) {
  page +=
      "\n## The cases\n\nEach picture shows the tubes from their apex in a gnomonic projection that is "
      "stretched to a square. The left part is the exact answer, with one colour per facet. The other parts "
      "are pale and mark wrong pixels in red, with an intensity that depends on the number of wrong points "
      "among nine in the pixel. Dark lines are walls between tubes.\n";
  for (const Entry& e : entries) {
    page += fmt::format(
        "\n<a id=\"{0}\"></a>\n### {1}\n\n{2}\n\n{3} facets, {4}; {5} visible footprints in {6} pieces.",
        e.scene.name, e.scene.title, e.scene.why, e.scene.mesh.facets.size(),
        e.scene.tubes.tubes.size() == 1 ? "one tube" : fmt::format("{} tubes", e.scene.tubes.tubes.size()),
        e.rational.visibility.facets, e.rational.visibility.pieces);
    page += fmt::format("\n\n![{0}: exact, double, double with tolerance, Embree](pictures/{1}.png)\n",
                        e.scene.title, e.scene.name);
  }
}

std::string embree_version() {
  const RTCDevice device = rtcNewDevice(nullptr);
  const auto part = [&](RTCDeviceProperty p) { return rtcGetDeviceProperty(device, p); };
  std::string version =
      fmt::format("{}.{}.{}", part(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                  part(RTC_DEVICE_PROPERTY_VERSION_MINOR), part(RTC_DEVICE_PROPERTY_VERSION_PATCH));
  rtcReleaseDevice(device);
  return version;
}

}  // namespace

std::string exact_cell(const Answer& answer) {
  if (answer.is_exact()) return "0";
  return fmt::format("**{}{}{}**", number(answer.error), open_text(answer.visibility),
                     answer.same_hash ? "" : ", other hash");
}

std::string plain_text(const Answer& answer) {
  if (answer.is_right()) return "right";
  return "error " + number(answer.error) + open_text(answer.visibility);
}

std::string share_text(const RayResult& result) {
  if (result.wrong == 0) return "none";
  const double share = double(result.wrong) / double(result.rays);
  if (share >= 0.1) return fmt::format("{:.0f} %", 100 * share);
  return share >= 0.001 ? fmt::format("{:.2g} %", 100 * share) : fmt::format("{:.0e}", share);
}

void write_page(std::span<const Entry> entries, const std::filesystem::path& folder) {
  std::string page(preface);
  page.replace(page.find("@EMBREE@"), 8, embree_version());
  write_summary(page, entries);
  write_table(page, entries);
  write_sweep(page, entries);
  write_cases(page, entries);
  const std::filesystem::path file = folder / "atlas.md";
  std::ofstream out(file);
  out << page;
  out.close();
  if (!out) throw std::runtime_error(fmt::format("cannot write {}", file.string()));
}

}  // namespace tubefoot::atlas
