// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the diagnosis of faults that are planted in a ray engine, alone and in pairs, with their sizes. A
// faultless engine has no findings. docs/compared-figures.md has the table of the planted faults.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "compare/diagnosis/diagnosis_words.hpp"
#include "planted.hpp"

namespace tubefoot {
namespace {

// Number of pairs that may hide one of the two faults, and number that may have an additional finding.
constexpr std::size_t allowed_missed = 0, allowed_more = 3;

const PlantedFan& fan(std::size_t pings = 1) {
  static const PlantedFan one, three(3);
  return pings == 1 ? one : three;
}
/// Gains of pings need several pings.
const PlantedFan& fan_for(const Mistakes& mistakes) { return fan(mistakes.ping_gains ? 3 : 1); }

SceneLabels labels_of(const PlantedFan& of) {
  return {of.elevation_deg, of.object, of.caster, {"sand", "steel"}, {"rod"}};
}

struct Planted {
  const char* fault;
  std::function<void(Mistakes&)> plant;
  double size, within;  ///< 0: only the name is expected
};

std::ostream& operator<<(std::ostream& out, const Planted& p) { return out << p.fault; }

const std::vector<Planted>& planted() {
  static const std::vector<Planted> all{
      {"beam-shift", [](Mistakes& m) { m.beam_shift = 0.6; }, 0.6, 0.03},
      {"half-sample", [](Mistakes& m) { m.sample_shift = 0.5; }, 0.5, 0.03},
      {"sample-shift", [](Mistakes& m) { m.sample_shift = -1.3; }, -1.3, 0.04},
      {"mirror", [](Mistakes& m) { m.mirror = true; }, 0, 0},
      {"swapped-ports", [](Mistakes& m) { m.halves_swapped = true; }, 0, 0},
      {"azimuth-scale", [](Mistakes& m) { m.azimuth_scale = 0.03; }, 0.03, 0.003},
      {"range-scale", [](Mistakes& m) { m.range_scale = 0.015; }, 0.015, 0.0006},
      {"tangent-spacing", [](Mistakes& m) { m.tangent_views = 1; }, 1.08, 0.08},
      {"tangent-spacing", [](Mistakes& m) { m.tangent_views = 2; }, 0.128, 0.03},
      {"scalloped-edge", [](Mistakes& m) { m.scallop_samples = 1.3; }, 1.3, 0.25},
      {"near-clipping", [](Mistakes& m) { m.near_clipping = true; }, 190, 50},
      {"near-returns-missing", [](Mistakes& m) { m.cut_m = 6.3; }, 6.3, 0.1},
      {"range-law", [](Mistakes& m) { m.law = 0.5; }, 0.5, 0.02},
      {"level", [](Mistakes& m) { m.gain = 2; }, 3.0103, 0.05},
      {"missing-shadow", [](Mistakes& m) { m.no_shadow = true; }, 1150, 150},
      {"noise", [](Mistakes& m) { m.noise = 0.1; }, -14, 1.5},
      {"blur", [](Mistakes& m) { m.blur = 1; }, 0.97, 0.08},
      {"vertical-pattern", [](Mistakes& m) { m.taper = 0.3; }, 15.5, 1.5},
      {"ping-gain", [](Mistakes& m) { m.ping_gains = true; }, 6.99, 0.3},
      {"range-spread", [](Mistakes& m) { m.range_blur = 6; }, 2.45, 0.3},
      {"material-levels", [](Mistakes& m) { m.one_material = true; }, 6.02, 0.8},
      {"8-bits", [](Mistakes& m) { m.bits = 8; }, 0, 0}};
  return all;
}

Diagnosis diagnosis_of(const std::vector<double>& candidate, const std::vector<double>& ideal = {},
                       const PlantedFan& of = fan(), const SceneLabels* labels = nullptr) {
  return diagnose(
      {{of.shape(), of.truth, candidate, {}, of.ranges_m}, of.azimuths_deg, candidate, ideal, labels});
}

/// With the labels of the scene.
Diagnosis diagnosis_with_scene(const Mistakes& mistakes, int columns, int rows, unsigned seed) {
  const PlantedFan& of = fan_for(mistakes);
  const SceneLabels labels = labels_of(of);
  return diagnosis_of(of.picture(mistakes, columns, rows, seed), {}, of, &labels);
}

std::vector<std::string> names(const Diagnosis& diagnosis) {
  std::vector<std::string> found;
  for (const Finding& finding : diagnosis.findings) found.push_back(finding.fault);
  return found;
}

struct Alone : testing::TestWithParam<Planted> {};

TEST_P(Alone, IsNamedWithItsSizeAndNothingElseIs) {
  Mistakes mistakes;
  GetParam().plant(mistakes);
  const Diagnosis diagnosis = diagnosis_with_scene(mistakes, 4, 600, 7);
  std::vector<std::string> others;
  for (const Finding& finding : diagnosis.findings) {
    RecordProperty(finding.fault, finding.words);
    // Another range law also changes the level at the middle range.
    if (finding.fault != GetParam().fault && !(finding.fault == "level" && mistakes.law != 0))
      others.push_back(finding.fault);
    if (finding.fault != GetParam().fault || GetParam().within == 0) continue;
    EXPECT_NEAR(finding.size, GetParam().size, GetParam().within) << finding.words;
    EXPECT_GT(finding.error, 0) << finding.words;
    EXPECT_LT(finding.error, GetParam().within) << finding.words;
  }
  EXPECT_THAT(names(diagnosis), testing::Contains(GetParam().fault));
  EXPECT_THAT(others, testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Faults, Alone, testing::ValuesIn(planted()));

TEST(Pairs, AreNamedBoth) {
  struct Pair {
    const Planted *a, *b;
  };
  std::vector<Pair> pairs;
  for (const Planted& a : planted())
    for (const Planted& b : planted()) {
      Mistakes of_a, of_b;
      a.plant(of_a);
      b.plant(of_b);
      const std::string one = a.fault, other = b.fault;
      // There is one fault of each kind, but a cut removes the scalloped edge.
      const auto is_another = [](const std::string& fault, const Mistakes& m) {
        return fault == "sample-shift" || fault == "level" || m.tangent_views == 2;
      };
      const bool left_out = is_another(one, of_a) || is_another(other, of_b) ||
                            (one == "scalloped-edge" && other == "near-returns-missing") ||
                            // On a flat seabed, a taper contains a power of range.
                            (one == "range-law" && other == "vertical-pattern") ||
                            (one == "vertical-pattern" && other == "range-spread");
      if (&a < &b && !left_out) pairs.push_back({&a, &b});
    }
  std::vector<std::string> wrong(pairs.size());
  std::atomic<std::size_t> next = 0, extra = 0;
  fan_for({});
  const auto work = [&] {
    for (std::size_t k = next++; k < pairs.size(); k = next++) {
      const auto& [a, b] = pairs[k];
      Mistakes mistakes;
      a->plant(mistakes);
      b->plant(mistakes);
      const Diagnosis diagnosis = diagnosis_with_scene(mistakes, 4, 600, static_cast<unsigned>(100 + k));
      bool more = false;
      for (const Finding& finding : diagnosis.findings)
        // Steps that differ from ping to ping are more than 256.
        more = more || (!(mistakes.ping_gains && finding.fault == "steps") && finding.fault != a->fault &&
                        finding.fault != b->fault && finding.fault != "level");
      extra += more;
      if (!diagnosis.has(a->fault) ||
          !(diagnosis.has(b->fault) || (mistakes.ping_gains && diagnosis.has("steps"))) || more)
        wrong[k] = std::string(more ? "more: " : "missed: ") + a->fault + " and " + b->fault + ": found " +
                   testing::PrintToString(names(diagnosis)) + "\n";
    }
  };
  std::thread helper(work);
  work();
  helper.join();
  std::string all;
  std::size_t missed = 0;
  for (const std::string& words : wrong) {
    all += words;
    missed += words.starts_with("missed");
  }
  RecordProperty("pairs", static_cast<int>(pairs.size()));
  RecordProperty("missed", static_cast<int>(missed));
  RecordProperty("with_more", static_cast<int>(extra));
  EXPECT_LE(missed, allowed_missed) << all;
  EXPECT_LE(extra, allowed_more) << all;
}

TEST(CleanEngine, IsLeftInPeaceWhateverItsSampling) {
  for (const auto& [columns, rows] :
       std::vector<std::pair<int, int>>{{4, 600}, {1, 500}, {1, 200}, {1, 3000}, {8, 100}})
    for (unsigned seed = 1; seed <= 3; ++seed)
      EXPECT_THAT(names(diagnosis_of(fan().picture({}, columns, rows, seed))), testing::IsEmpty())
          << columns << " x " << rows << ", seed " << seed;
  EXPECT_THAT(names(diagnosis_of(fan().truth)), testing::IsEmpty());
}

TEST(CleanEngine, WhatIsLeftIsItsSampling) {
  const std::vector<double> ideal = fan().picture({}, 1, 500, 2);
  const Diagnosis clean = diagnosis_of(fan().picture({}, 1, 500, 1), ideal);
  EXPECT_NEAR(clean.l1_left, *clean.ideal_l1, 0.1 * *clean.ideal_l1);
  Mistakes mistakes;
  mistakes.range_scale = 0.015;
  mistakes.law = 1;
  const Diagnosis wrong = diagnosis_of(fan().picture(mistakes, 1, 500, 1), ideal);
  EXPECT_GT(wrong.l1, 10 * *wrong.ideal_l1);
  EXPECT_LT(wrong.l1_left, 2.5 * *wrong.ideal_l1);
}

TEST(CleanEngine, SpeckleIsToldFromSamplingByAnIdeal) {
  Mistakes mistakes;
  mistakes.speckle = 0.5;
  const std::vector<double> ideal = fan().picture({}, 4, 600, 2);
  EXPECT_TRUE(diagnosis_of(fan().picture(mistakes, 4, 600, 1), ideal).has("speckle"));
  EXPECT_FALSE(diagnosis_of(fan().picture({}, 4, 600, 1), ideal).has("speckle"));
}

/// Converts energies as a renderer does: uniform rows, faint values removed, bright values clamped, 8 bits.
/// The faintest value then has many steps, and a uniform seabed is equal to the last bit.
std::vector<double> rendered(std::vector<double> energy_j, double bits) {
  std::vector<double> lit;
  for (std::size_t k = 0; k < energy_j.size(); ++k) {
    energy_j[k] *= std::pow(fan().ranges_m[k % PlantedFan::samples], 5);
    if (energy_j[k] > 0) lit.push_back(energy_j[k]);
  }
  std::nth_element(lit.begin(), lit.begin() + static_cast<std::ptrdiff_t>(lit.size() / 2), lit.end());
  const double seabed = lit[lit.size() / 2], steps = std::exp2(bits) - 1;
  for (double& e : energy_j)
    e = e < 0.5 * seabed ? 0
        : bits > 0       ? std::round(steps * std::min(1.0, e / (4 * seabed))) / steps
                         : std::min(1.0, e / (4 * seabed));
  return energy_j;
}

TEST(Diagnosis, ANearObjectIsNamedWithTheShareOfItsOwnShadow) {
  Mistakes mistakes;
  mistakes.near_clipping = true;
  const std::vector<double> picture = fan().picture(mistakes, 4, 600, 3);
  const SceneLabels labels = labels_of(fan());
  const auto words = [&](const SceneLabels* of) {
    for (const Finding& finding : diagnosis_of(picture, {}, fan(), of).findings)
      if (finding.fault == "near-clipping") return finding.words;
    return std::string();
  };
  EXPECT_THAT(words(&labels),
              testing::AllOf(testing::StartsWith("rod, nearer"), testing::HasSubstr("100 % of")));
  // The dark parts of the fan that touch the shadow do not count.
  EXPECT_THAT(words(nullptr), testing::ContainsRegex("9[0-9] % of|100 % of"));
}

TEST(Diagnosis, MeansAndVerticalPatternsAreNotDisplacements) {
  for (const bool mean : {false, true}) {
    Mistakes mistakes;
    mistakes.mean = mean;
    mistakes.taper = mean ? 0 : 0.25;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Diagnosis diagnosis = diagnosis_of(fan().picture(mistakes, 1, 600, seed));
      for (const char* fault :
           {"beam-shift", "half-sample", "sample-shift", "range-scale", "azimuth-scale", "tangent-spacing"})
        EXPECT_FALSE(diagnosis.has(fault)) << fault << ", mean " << mean << ", seed " << seed;
      EXPECT_TRUE(mean || diagnosis.has("range-curve"));
    }
  }
}

TEST(Diagnosis, FindingsBeginWithTheFitAndFollowByTheirShares) {
  Mistakes mistakes;
  mistakes.law = 0.5;
  mistakes.sample_shift = 1.3;
  mistakes.near_clipping = true;
  mistakes.bits = 8;
  const Diagnosis diagnosis = diagnosis_of(fan().picture(mistakes, 4, 600, 5));
  ASSERT_GE(diagnosis.findings.size(), 4U);
  EXPECT_THAT(diagnosis.findings.front().fault, testing::AnyOf("level", "range-law"));
  double before = 1;
  for (const Finding& finding : diagnosis.findings) {
    EXPECT_NE(look_for(finding.fault), "") << finding.fault;
    if (finding.fault == "level" || finding.fault == "range-law") continue;
    if (finding.share) {
      EXPECT_LE(*finding.share, before) << finding.fault;
    }
    before = finding.share.value_or(-1);
  }
  for (const Planted& p : planted()) EXPECT_NE(look_for(p.fault), "") << p.fault;
  EXPECT_EQ(look_for("unknown"), "");
}

TEST(Diagnosis, SizesThatAreNotResolvedAreStated) {
  const Diagnosis diagnosis = diagnosis_of(fan().picture({}, 1, 500, 1));
  std::vector<std::string> faults;
  for (const ResolvableSize& size : diagnosis.not_found) {
    faults.push_back(size.fault);
    EXPECT_GT(size.size, 0) << size.fault;
  }
  EXPECT_THAT(faults, testing::UnorderedElementsAre("sample-shift", "range-scale", "beam-shift",
                                                    "azimuth-scale", "tangent-spacing", "scalloped-edge"));
}

TEST(Diagnosis, APictureWhoseFaintestValueIsManyStepsSaysAsMuch) {
  Mistakes mistakes;
  mistakes.sample_shift = -1.3;
  const std::vector<double> truth = rendered(fan().truth, 0),
                            candidate = rendered(fan().picture(mistakes, 4, 2000, 7), 8);
  const Diagnosis diagnosis =
      diagnose({{fan().shape(), truth, candidate, {}, fan().ranges_m}, fan().azimuths_deg, candidate, {}});
  EXPECT_TRUE(diagnosis.has("8-bits"));
  EXPECT_NEAR(diagnosis.alignment.warp.samples, -1.3, 0.1);
}

TEST(Diagnosis, FewLevelsAtTheNearEdgeAreNoScallops) {
  const std::vector<double> truth = rendered(fan().truth, 0);
  for (const double bits : {4, 5, 6})
    for (const double shift : {0.0, 0.5})
      for (unsigned seed = 1; seed <= 3; ++seed) {
        Mistakes mistakes;
        mistakes.sample_shift = shift;
        const std::vector<double> candidate = rendered(fan().picture(mistakes, 1, 600, seed), bits);
        const Diagnosis diagnosis = diagnose(
            {{fan().shape(), truth, candidate, {}, fan().ranges_m}, fan().azimuths_deg, candidate, {}});
        EXPECT_FALSE(diagnosis.has("scalloped-edge"))
            << bits << " bits, shift " << shift << ", seed " << seed;
      }
}

TEST(Diagnosis, SomeEqualLargestValuesAreNoClamping) {
  // A symmetric picture of 72 bins with the largest value in two of them.
  std::vector<double> truth(fan().truth.size());
  for (std::size_t beam = 0; beam < PlantedFan::beams; ++beam)
    truth[beam * PlantedFan::samples + 100] =
        1 / (1 + std::abs(double(beam) - (PlantedFan::beams - 1) / 2.0));
  EXPECT_FALSE(diagnose({{fan().shape(), truth, truth, {}, fan().ranges_m}, fan().azimuths_deg, truth, {}})
                   .has("clamped"));
}

TEST(Diagnosis, AStripInTheFirstRowDeterminesNoDisplacement) {
  // All beams see the strip, but the candidate lacks the outer beams of three views and blurs the others.
  std::vector<double> truth(fan().truth.size()), candidate(truth.size());
  constexpr std::size_t beams_of_view = PlantedFan::beams / 3, lost = 3;
  for (std::size_t beam = 0; beam < PlantedFan::beams; ++beam) {
    double* const row = candidate.data() + beam * PlantedFan::samples;
    truth[beam * PlantedFan::samples] = 1;
    const std::size_t from_edge = std::min(beam % beams_of_view, beams_of_view - 1 - beam % beams_of_view);
    if (from_edge < lost) continue;
    for (const std::size_t s : {0, 1, 2}) row[s] = (from_edge == lost ? 0.2 : 0.5) * (3.0 - double(s));
  }
  const Diagnosis diagnosis =
      diagnose({{fan().shape(), truth, candidate, {}, fan().ranges_m}, fan().azimuths_deg, candidate, {}});
  for (const char* fault :
       {"beam-shift", "half-sample", "sample-shift", "range-scale", "azimuth-scale", "tangent-spacing"})
    EXPECT_FALSE(diagnosis.has(fault)) << fault;
  EXPECT_TRUE(std::ranges::any_of(diagnosis.not_found,
                                  [](const ResolvableSize& size) { return std::isinf(size.size); }));
  EXPECT_THAT(diagnosis_text("camera", diagnosis), testing::HasSubstr("too few echoes to find"));
}

TEST(Diagnosis, MirroredBeamsEvenInTheTangentUnderSpeckleAreNotAnotherOpening) {
  Mistakes mistakes;
  mistakes.mirror = true;
  mistakes.tangent_views = 1;
  mistakes.speckle = 0.6;
  const Diagnosis diagnosis = diagnosis_of(fan().picture(mistakes, 1, 600, 7));
  EXPECT_TRUE(diagnosis.has("mirror"));
  EXPECT_TRUE(diagnosis.has("tangent-spacing")) << testing::PrintToString(names(diagnosis));
  EXPECT_FALSE(diagnosis.has("azimuth-scale")) << testing::PrintToString(names(diagnosis));
}

TEST(Diagnosis, ASilentCandidateOrReferenceIsNoProblem) {
  const std::vector<double> silent(fan().truth.size());
  EXPECT_THAT(names(diagnosis_of(silent)), testing::ElementsAre("silent"));
  const DiagnosisInput none{
      {fan().shape(), silent, fan().truth, {}, fan().ranges_m}, fan().azimuths_deg, silent, {}};
  EXPECT_THAT(names(diagnose(none)), testing::IsEmpty());
}

TEST(Diagnosis, TwoBeamsAreSwapped) {
  // A sidescan: pings of two beams, each with its own profile that changes along the track.
  constexpr std::size_t pings = 40, samples = 120;
  std::vector<double> truth, swapped;
  std::vector<double> ranges;
  for (std::size_t s = 0; s < samples; ++s) ranges.push_back(5 + 0.1 * double(s));
  const auto profile = [&](std::size_t ping, int side) {
    std::vector<double> energy(samples);
    for (std::size_t s = 20; s < samples; ++s)
      energy[s] = (1.2 + std::sin(0.3 * double(s) + side * 2 + 0.2 * double(ping))) / ranges[s];
    return energy;
  };
  for (std::size_t ping = 0; ping < pings; ++ping)
    for (const int side : {0, 1}) {
      const auto right = profile(ping, side), wrong = profile(ping, 1 - side);
      truth.insert(truth.end(), right.begin(), right.end());
      swapped.insert(swapped.end(), wrong.begin(), wrong.end());
    }
  const std::vector<double> azimuths{-90, 90};
  EXPECT_THAT(names(diagnose({{{pings, 2, samples}, truth, swapped, {}, ranges}, azimuths, swapped, {}})),
              testing::ElementsAre("swapped-ports"));
  EXPECT_THAT(names(diagnose({{{pings, 2, samples}, truth, truth, {}, ranges}, azimuths, truth, {}})),
              testing::IsEmpty());
}

}  // namespace
}  // namespace tubefoot
