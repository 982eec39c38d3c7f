// SPDX-License-Identifier: GPL-3.0-or-later
// tubefoot_pairs PAGE: writes a page with the costs of combined features. A cost is the processor time of a
// ping with two features, divided by the sum of the times with one of them each.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <optional>
#include <set>

#include "files/usage_error.hpp"
#include "fixtures/every_feature.hpp"
#include "fixtures/test_folder.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

constexpr int rounds = 5;
constexpr double least_seconds = 0.02;  // of one measurement, by repetition

const std::vector<Feature> of_runs{Feature::reference, Feature::double_arithmetic, Feature::fast_binning,
                                   Feature::rays};

RunRequest request_with(const std::set<Feature>& chosen, const Survey& survey) {
  RunRequest request = request_of(survey.scene.description.run);
  if (chosen.contains(Feature::reference)) request.reference_tolerance = 1e-2;
  if (chosen.contains(Feature::double_arithmetic)) request.visibility.arithmetic = Arithmetic::plain_double;
  if (chosen.contains(Feature::fast_binning)) request.binning = Binning::centroid;
  if (chosen.contains(Feature::rays)) request.engine = Engine::ray;
  return request;
}

/// A scene that can be run repeatedly.
class Combination {
 public:
  Combination(const TestFolder& folder, const std::set<Feature>& chosen, const SceneSize& size)
      : survey_(open_survey(read_scene_text(scene_with(chosen, size), folder / "scene.toml"))),
        request_(request_with(chosen, *survey_)) {
    require_able_to_run(*survey_, request_);
    while (seconds() < least_seconds) repeats_ *= 2;
  }

  /// Returns processor seconds of one run.
  double measure() { return seconds() / repeats_; }

 private:
  double seconds() {
    const std::clock_t start = std::clock();
    for (int k = 0; k < repeats_; ++k) {
      PingStore store(layout_of(*survey_, request_));
      simulate(*survey_, request_, store, {});
    }
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }

  std::shared_ptr<const Survey> survey_;
  RunRequest request_;
  int repeats_ = 1;
};

/// Returns the time with both features divided by the sum of the times with each. The result is the median
/// of rounds, in which all three take turns. Returns nothing if the features cannot be combined.
std::optional<double> ratio_of(const TestFolder& folder, Feature a, Feature b) {
  const bool paths = a == Feature::scatterings || b == Feature::scatterings;
  const SceneSize size{8, 64, paths || a == Feature::mirrors || b == Feature::mirrors};
  const auto with = [](std::set<Feature> chosen) {
    if (chosen.contains(Feature::scatterings)) chosen.insert(Feature::mirrors);  // paths as they are
    return chosen;
  };
  try {
    Combination both(folder, with({a, b}), size), first(folder, with({a}), size),
        second(folder, with({b}), size);
    std::vector<double> ratios;
    for (int round = 0; round < rounds; ++round) {
      const double together = both.measure();
      ratios.push_back(together / (first.measure() + second.measure()));
    }
    std::ranges::nth_element(ratios, ratios.begin() + rounds / 2);
    return ratios[rounds / 2];
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

std::string page(const TestFolder& folder) {
  std::vector<Feature> chosen;
  for (const InScene& one : of_scenes) chosen.push_back(one.feature);
  const std::size_t of_scene = chosen.size();
  chosen.insert(chosen.end(), of_runs.begin(), of_runs.end());
  std::string text =
      "# Cost of combinations\n\n`make pairs` (`validation/pairs/`) writes this page. Each value is the "
      "processor time of a ping of a small scene with two\nfeatures of the [table](../docs/limits.md), "
      "divided by the sum of the times with one feature each (one thread, medians\nof alternating rounds). "
      "An empty cell is an impossible combination.\n\n|  |";
  for (std::size_t a = 0; a < of_scene; ++a) text += fmt::format(" {} |", name_of(chosen[a]));
  text += "\n|---|";
  for (std::size_t a = 0; a < of_scene; ++a) text += "---:|";
  text += '\n';
  double largest = 0;
  std::size_t above = 0, measured = 0;
  for (std::size_t b = 1; b < chosen.size(); ++b) {
    text += fmt::format("| {} |", name_of(chosen[b]));
    for (std::size_t a = 0; a < of_scene; ++a) {
      if (a >= b) {
        text += " |";
        continue;
      }
      const auto ratio = ratio_of(folder, chosen[a], chosen[b]);
      text += ratio ? fmt::format(" {:.2f} |", *ratio) : std::string(" |");
      if (!ratio) continue;
      largest = std::max(largest, *ratio);
      ++measured;
      above += *ratio > 2;
    }
    text += '\n';
    fmt::print("{}\n", name_of(chosen[b]));
    std::fflush(stdout);
  }
  return text +
         fmt::format(
             "\nOf {} pairs, {} cost more than twice the sum of their parts; the largest ratio is {:.2f}.\n",
             measured, above, largest);
}

}  // namespace
}  // namespace tubefoot

int main(int count, char** words) {
  using namespace tubefoot;
  if (count != 2) {
    fmt::print(stderr, "usage: tubefoot_pairs PAGE\n");
    return 2;
  }
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TestFolder folder;
  folder.write("bed.asc", seabed_of_steps());
  const std::string text = page(folder);
  std::ofstream(words[1]) << text;
  fmt::print("{}", text);
}
