// SPDX-License-Identifier: GPL-3.0-or-later
// Walks over the table of feature combinations. Each pair of features either runs and keeps its law, or is
// rejected with a reason. The laws hold for all combinations. Rays, other arithmetics and other binnings
// find the same energy, the bounds of a reference contain this energy, and footprints add up to it.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "fixtures/csv_rows.hpp"
#include "fixtures/every_feature.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/program.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// The feature that a command or one of its options requests.
struct Requested {
  Feature feature;
  std::vector<std::string> words;
};
const std::vector<Requested> of_runs{{Feature::reference, {"run", "--reference", "--tolerance", "1e-2"}},
                                     {Feature::double_arithmetic, {"run", "--arithmetic", "double"}},
                                     {Feature::fast_binning, {"run", "--binning", "centroid"}},
                                     {Feature::labels, {"run", "--labels"}},
                                     {Feature::coarsening, {"run", "--coarsen", "1e-2"}},
                                     {Feature::gradient, {"run", "--gradient", "water.absorption"}},
                                     {Feature::rays, {"run", "--engine", "ray", "--rays-per-beam", "30000"}}};
const std::vector<Requested> of_commands{
    {Feature::audit, {"audit"}},
    {Feature::coverage, {"coverage", "-o", "covered.csv"}},
    {Feature::view, {"view", "-o", "page.html"}},
    {Feature::footprints, {"footprints", "--sensor", "sonar", "-o", "f.csv"}},
    {Feature::exact_corners, {"footprints", "--sensor", "sonar", "-o", "f.txt"}},
    {Feature::refine, {"refine", "-o", "bed.ply"}},
    {Feature::trial, {"advise", "--tolerance", "10%"}}};

struct AbilitiesWalk : testing::Test {
  AbilitiesWalk() { folder.write("bed.asc", seabed_of_steps()); }

  /// Paths in the words are relative to the folder of the test. `output`: output of a run.
  Outcome tried(const std::set<Feature>& features, std::vector<std::string> words,
                const std::filesystem::path& output) {
    for (std::string& word : words)
      if (word.find('.') != std::string::npos && !word.starts_with('-') && word != "1e-2" &&
          word != "water.absorption")
        word = (folder / word).string();
    words.insert(words.begin() + 1, folder.write("scene.toml", scene_with(features, size)).string());
    if (words.front() == "run") words.insert(words.end(), {"-o", output.string()});
    return run_program(words);
  }

  void walk(std::set<Feature> features, const std::vector<std::string>& words) {
    if (features.contains(Feature::scatterings)) features.insert(Feature::mirrors);  // paths unchanged
    if (features.contains(Feature::sea_waves)) features.insert(Feature::mirrors);
    if (features.contains(Feature::relief_each_transmission)) features.insert(Feature::relief);
    if (features.contains(Feature::two_receivers) && features.contains(Feature::signals))
      return;  // two kinds of sensors
    SCOPED_TRACE(fmt::format("{}\n{}", fmt::join(words, " "), scene_with(features, size)));
    const auto output = folder / fmt::format("out{}", ++runs);
    const Outcome outcome = tried(features, words, output);
    const auto reason = reason_of_the_table(features);
    EXPECT_EQ(outcome.exit_code, reason ? 2 : 0) << outcome.err;
    if (reason) {
      EXPECT_THAT(outcome.err, HasSubstr(*reason));
    } else if (outcome.exit_code == 0) {
      keep_model(features, words, output);
    }
  }

  /// Returns the energies of the scene features alone, by the tube engine.
  std::vector<double> measured(const std::set<Feature>& features) {
    std::set<Feature> scene;
    for (const InScene& one : of_scenes)
      if (features.contains(one.feature)) scene.insert(one.feature);
    if (const auto known = energies.find(scene); known != energies.end()) return known->second;
    const auto output = folder / fmt::format("measured{}", ++runs);
    const Outcome outcome = tried(scene, {"run"}, output);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return energies[scene] = NetcdfReader(output / "echoes.nc").values("/", "energy");
  }

  /// The file reports the footprints of a receiver pair with the energy that a receiver at the transmitter
  /// would receive.
  static double footprints_tolerance(const std::set<Feature>& features) {
    return features.contains(Feature::two_receivers) ? 0.02 : 1e-9;
  }

  void keep_model(const std::set<Feature>& features, const std::vector<std::string>& words,
                  const std::filesystem::path& output) {
    const std::vector<double> sure = measured(features);
    const double total = std::reduce(sure.begin(), sure.end()), largest = *std::ranges::max_element(sure);
    ASSERT_GT(total, 0);
    for (const double energy : sure) ASSERT_TRUE(energy >= 0 && std::isfinite(energy));
    if (words.front() == "run") {
      const NetcdfReader file(output / "echoes.nc");
      const std::vector<double> here = file.values("/", "energy");
      ASSERT_EQ(here.size(), sure.size());
      const double sum = std::reduce(here.begin(), here.end());
      if (features.contains(Feature::rays) || features.contains(Feature::fast_binning) ||
          features.contains(Feature::coarsening)) {
        EXPECT_NEAR(sum, total, 0.02 * total);
      } else if (features.contains(Feature::double_arithmetic)) {
        // Plain doubles may lose slivers that the range gates of mirrors cut along facet edges.
        const double lost = (features.contains(Feature::mirrors) ? 2e-5 : 1e-9) * largest;
        for (std::size_t k = 0; k < sure.size(); ++k) EXPECT_NEAR(here[k], sure[k], lost);
      }
      if (features.contains(Feature::labels)) add_up(file, here);
      if (features.contains(Feature::gradient)) {
        if (!features.contains(Feature::reference)) {
          EXPECT_EQ(here, sure);
        }
        // Absorption reduces each energy.
        const std::vector<double> derivatives = file.values("/", "gradient.water.absorption");
        for (std::size_t k = 0; k < sure.size(); ++k) EXPECT_EQ(derivatives[k]<0, sure[k]> 0) << k;
      }
      if (!features.contains(Feature::reference)) return;
      const std::vector<double> bound = file.values("/", "energy_bound");
      for (std::size_t k = 0; k < sure.size(); ++k) {
        EXPECT_NEAR(here[k], sure[k], bound[k] + 1e-6 * largest) << "bin " << k;
        // if a bound is wider than requested, the run reports it
        EXPECT_LE(bound[k], 3e-2 * largest) << "bin " << k;
      }
    } else if (words.front() == "footprints" && !features.contains(Feature::exact_corners) &&
               // their footprints are those of the path without mirrors; targets and the water have none
               !features.contains(Feature::mirrors) && !features.contains(Feature::water_targets) &&
               !features.contains(Feature::volume)) {
      double sum = 0;
      for (const auto& row : csv_rows(folder / "f.csv")) sum += std::stod(row.at("energy_j"));
      EXPECT_NEAR(sum, total, footprints_tolerance(features) * total);
    }
  }

  /// Shares exist in each bin with energy, and add up to the whole.
  static void add_up(const NetcdfReader& file, const std::vector<double>& energy) {
    const std::vector<std::string> names = file.variables("/");
    std::vector<double> whole(energy.size());
    for (const char* name : {"object_share", "unscattered_share"}) {
      if (std::ranges::find(names, name) == names.end()) continue;
      const std::vector<double> shares = file.values("/", name);
      for (std::size_t k = 0; k < shares.size(); ++k) {
        EXPECT_TRUE(shares[k] >= 0 && shares[k] <= 1);
        whole[k % whole.size()] += shares[k];
      }
    }
    for (std::size_t k = 0; k < energy.size(); ++k)
      EXPECT_NEAR(whole[k], energy[k] > 0 ? 1 : 0, 1e-14) << "bin " << k;
  }

  void walk_with(const std::vector<Requested>& requested) {
    for (const InScene& one : of_scenes)
      for (const Requested& two : requested) {
        // Only a seabed with relief can be refined. The relief distinguishes seabeds.
        if (two.feature == Feature::refine && one.feature != Feature::relief_each_transmission &&
            one.feature != Feature::tiles)
          continue;
        std::set<Feature> features{one.feature, two.feature};
        if (two.feature == Feature::refine) features.insert(Feature::relief_each_transmission);
        walk(features, two.words);
      }
  }

  TestFolder folder;
  SceneSize size;
  int runs = 0;
  std::map<std::set<Feature>, std::vector<double>> energies;
};

TEST_F(AbilitiesWalk, EveryPairOfASceneRunsOrIsRefused) {
  for (std::size_t a = 0; a < of_scenes.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      walk({of_scenes[a].feature, of_scenes[b].feature}, {"run"});
      walk({of_scenes[a].feature, of_scenes[b].feature, Feature::rays}, of_runs.back().words);
    }
}

TEST_F(AbilitiesWalk, EveryFeatureOfASceneWithEveryRun) { walk_with(of_runs); }

TEST_F(AbilitiesWalk, EveryFeatureOfASceneWithEveryCommand) { walk_with(of_commands); }

TEST_F(AbilitiesWalk, EveryPairOfWhatARunAsks) {
  for (std::size_t a = 0; a < of_runs.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      std::vector<std::string> words = of_runs[a].words;
      words.insert(words.end(), of_runs[b].words.begin() + 1, of_runs[b].words.end());
      const std::set both{of_runs[a].feature, of_runs[b].feature};
      if (both == std::set{Feature::rays, Feature::fast_binning}) {
        // Rays have no footprints to bin, so that the combination does not exist.
        const Outcome outcome = tried(both, words, folder / "no_bins");
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.err, HasSubstr("--binning is a setting of the tube engine"));
        continue;
      }
      walk({of_runs[a].feature, of_runs[b].feature}, words);
    }
}

// The phases of two receivers have their own integrals.
TEST_F(AbilitiesWalk, TwoReceiversWithWhatTheirProductsMeet) {
  using enum Feature;
  walk({two_receivers, separate_receiver, reference}, of_runs.front().words);
  walk({two_receivers, mirrors, reference}, of_runs.front().words);
  walk({two_receivers, mirrors, separate_receiver, reference}, of_runs.front().words);
  walk({two_receivers, refraction, reference}, of_runs.front().words);
  walk({two_receivers, refraction, separate_receiver, reference}, of_runs.front().words);
  walk({two_receivers, mirrors, refraction}, {"run"});
  walk({two_receivers, mirrors, refraction, separate_receiver}, {"run"});
  walk({two_receivers, scatterings, refraction}, {"run"});
  walk({two_receivers, scatterings, refraction, separate_receiver}, {"run"});
}

// A ping has several transmissions of one beam each.
TEST_F(AbilitiesWalk, AHeadThatTurnsWithEachFeature) {
  size.scanning = true;
  for (const InScene& one : of_scenes) {
    // other kinds of sensors
    if (one.feature == Feature::two_receivers || one.feature == Feature::signals) continue;
    walk({one.feature}, {"run"});
    for (const Requested& requested : of_runs) walk({one.feature, requested.feature}, requested.words);
    for (const Requested& requested : of_commands)
      if (requested.feature == Feature::view || requested.feature == Feature::footprints)
        walk({one.feature, requested.feature}, requested.words);
  }
}

// Combines more than two features: a real scene has four.
TEST_F(AbilitiesWalk, DrawnScenesOfManyFeatures) {
  const unsigned seed = 20;
  std::mt19937 random(seed);
  SCOPED_TRACE(fmt::format("seed {}", seed));
  for (int draw = 0; draw < 16; ++draw) {
    std::set<Feature> features;
    for (const InScene& one : of_scenes)
      if (random() % 2 == 0) features.insert(one.feature);
    const Requested& requested = of_runs[random() % of_runs.size()];
    walk(features, {"run"});
    features.insert(requested.feature);
    walk(features, requested.words);
  }
}

}  // namespace
}  // namespace tubefoot
