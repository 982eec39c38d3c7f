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

The inputs on which methods of finding what is visible fail, and what each method does with them. Every
scene is made by a function of its own from a fixed seed (`validation/cases_*.cpp`); `make atlas` builds the
program, makes the scenes, runs every method, and writes this page and its pictures anew. It exits with an
error unless the three exact arithmetics agree on every case: equal rational areas of every facet in every
tube, equal topology hash, every tube closed. `ctest -R Atlas` does the same with smaller scenes.

**Error** is the sum over facets of |area found - true area| in the tube's gnomonic plane, divided by the
tube's area (mean over tubes): area credited to the wrong facet counts twice, once where it is missing and
once where it is not due. The truth is what `rational` finds. *Open* counts tubes whose visible pieces and
open water do not add up to the tube (the closure law of [docs/visibility.md](../docs/visibility.md)); where
that happens with an error of 0, the open water is wrong. **Bold** is wrong.

- **fixed, filtered, rational**: the exact arithmetics. 0 stands for an equality of rationals.
- **double**: the same algorithm, its signs taken from plain double, without a tolerance and with the best
  of a sweep of powers of ten from 1e-17 to 1e-3 (relative to the lengths of the factors); a range means
  that all of it is equally good. Only its decisions are judged: the corners it names are evaluated exactly,
  and the facets whose plane holds the apex are set aside exactly for it. In the scenes at offsets it
  computes in absolute coordinates.
- **Embree** @EMBREE@, as a ray engine in a hurry uses it: float, absolute coordinates in metres, rays from
  distance 0, the first hit counts; with default flags and with `RTC_SCENE_FLAG_ROBUST`. One ray from each
  cell of a grid of 512 x 512 over the tube, or 256 x 256 over each of four. Beside its error, the share of
  *wrong rays*: those that meet another facet than the exact answer has at that very point, so that sampling
  has no part in it.
- **sampling**: the error that so many rays make with nothing wrong: the exact answer read off at 8 other
  draws of the points, mean and standard deviation. An entry of Embree is bold if its error lies more than 5
  deviations above the mean, or if the wrong rays number more than 25, which is 5 times their own standard
  deviation.

Coincident facets are judged by the tie rule (the facet with the smaller vertices is seen). An engine
without a rule shows one of them as well, but which one is chance; the share that differs from the rule is
counted as error. No method crashed or failed to end: all run in one process, and there would be no page.
)";

void write_summary(std::string& page, std::span<const Entry> entries) {
  const auto count = [&](const auto& condition) {
    return std::count_if(entries.begin(), entries.end(), condition);
  };
  page += fmt::format(
      "\nOf {} cases the exact arithmetics get {} right, double without a tolerance {}, double with the best "
      "tolerance "
      "for each case {}; Embree fails beyond its noise on {}, and on {} with robust flags.\n",
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
      "\n## One tolerance for all\n\nAn engine cannot choose its tolerance scene by scene, knowing the "
      "answer. What one "
      "tolerance does to all cases (areas only):\n\n| tolerance | cases right | largest error | where "
      "|\n|---|---|---|---|\n";
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
      "\n## The cases\n\nEach picture shows the tubes as their apex sees them (gnomonic, stretched to a "
      "square), left the "
      "exact answer with a colour for each facet; then, pale, the same with red where a method is wrong: a "
      "pixel is the redder the more of nine points in it are wrong. Walls between tubes are dark lines.\n";
  for (const Entry& e : entries) {
    page += fmt::format(
        "\n<a id=\"{0}\"></a>\n### {1}\n\n{2}\n\n{3} facets, {4}; {5} footprints seen, in {6} pieces.",
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
