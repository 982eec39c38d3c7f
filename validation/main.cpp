// SPDX-License-Identifier: GPL-3.0-or-later
// The stability atlas. tubefoot_atlas FOLDER writes FOLDER/atlas.md and its pictures. tubefoot_atlas
// --quick only checks, on smaller scenes. The exit code is 1 if an exact arithmetic is not exact.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string_view>

#include "validation/entry.hpp"
#include "validation/page.hpp"
#include "validation/picture.hpp"

namespace {

using namespace tubefoot::atlas;

/// Returns whether the claims of the atlas are true. Prints the reasons to stderr if not.
bool check(const std::vector<Entry>& entries) {
  bool holds = true;
  const auto demand = [&](bool condition, const std::string& reason) {
    if (!condition) fmt::print(stderr, "tubefoot_atlas: {}\n", reason);
    holds = holds && condition;
  };
  for (const Entry& e : entries) {
    demand(e.exact_ones_agree(),
           fmt::format("{}: the exact arithmetics differ or do not close: fixed {}, filtered {}, rational {}",
                       e.scene.name, exact_cell(e.fixed), exact_cell(e.filtered), exact_cell(e.rational)));
    demand(!e.rational.visibility.tubes.empty() && e.rational.visibility.facets > 1,
           e.scene.name + ": no facet is visible");
  }
  // The atlas must also contain failures of the other methods.
  const auto some = [&](const auto& is_wrong) {
    return std::any_of(entries.begin(), entries.end(), is_wrong);
  };
  constexpr double measurable = 1e-6;
  demand(some([](const Entry& e) { return e.plain.error > measurable; }),
         "double without tolerance is never wrong");
  demand(some([](const Entry& e) { return e.tuned.error > measurable; }),
         "double with tolerance is never wrong");
  demand(some([](const Entry& e) { return fails(e.usual, e.sampling) && fails(e.robust, e.sampling); }),
         "Embree is never wrong");
  return holds;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: tubefoot_atlas FOLDER | --quick\n");
    return 2;
  }
  try {
    const bool quick = std::string_view(argv[1]) == "--quick";
    const Size size = quick ? Size::quick : Size::page;
    const std::filesystem::path folder = argv[1];
    if (!quick) std::filesystem::create_directories(folder / "pictures");
    std::vector<Entry> entries;
    for (Case& scene : all_cases(size)) {
      const bool one_tube = scene.tubes.tubes.size() == 1;
      const Entry& e = entries.emplace_back(evaluate(std::move(scene), rays_of(size, one_tube)));
      fmt::print("{:<24} double: {}; with tolerance {:.0e}: {}; Embree's wrong rays: {}\n", e.scene.name,
                 plain_text(e.plain), e.tolerance, plain_text(e.tuned), share_text(e.usual));
      std::fflush(stdout);
      if (!quick) draw(e, folder / "pictures" / (e.scene.name + ".png"));
    }
    if (!quick) write_page(entries, folder);
    return check(entries) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "tubefoot_atlas: {}\n", error.what());
    return 1;
  }
}
