// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the steps of output models with their formulas, and their bounds with all true values within the
// input bounds.
#include "compare/output_models/output_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "compare/output_models/output_model_file.hpp"
#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;

BoundedPicture two_by_three() {
  return {{1, 2, 3}, {1, 2, 3, 0, 4, 8}, {0.1, 0, 0.5, 0.2, 0, 1}, {1, 2, 2, 3, 3, 4}, {}, {}};
}

BoundedPicture after(const OutputModelStep& step, BoundedPicture picture = two_by_three()) {
  apply(step, picture);
  return picture;
}

TEST(OutputModelSteps, GainAmplitudeAndClampMapBothEnds) {
  EXPECT_THAT(after({{}, GainStep{10}}).value, ElementsAre(10, 20, 30, 0, 40, 80));
  EXPECT_THAT(after({{}, GainStep{10}}).bound, Pointwise(DoubleNear(1e-12), {1.0, 0.0, 5.0, 2.0, 0.0, 10.0}));
  const auto roots = after({{}, AmplitudeStep{}});
  EXPECT_DOUBLE_EQ(roots.value[2], std::sqrt(3));
  EXPECT_DOUBLE_EQ(roots.bound[2], std::sqrt(3) - std::sqrt(2.5)) << "the wider half";
  EXPECT_DOUBLE_EQ(roots.bound[3], std::sqrt(0.2));
  EXPECT_THAT(after({{}, ClampStep{0.5, 3.2}}).value, ElementsAre(1, 2, 3, 0.5, 3.2, 3.2));
  EXPECT_THAT(after({{}, ClampStep{0.5, 3.2}}).bound,
              Pointwise(DoubleNear(1e-12), {0.1, 0.0, 0.5, 0.0, 0.0, 0.0}));
}

TEST(OutputModelSteps, RangeLawIsOfTheMiddleAndBoundHoldsTheEnds) {
  const auto law = after({{}, RangeLawStep{2, 0}});
  EXPECT_DOUBLE_EQ(law.value[1], 2 * 6.25);
  EXPECT_DOUBLE_EQ(law.bound[1], 2 * 9 - 2 * 6.25);
  EXPECT_DOUBLE_EQ(after({{}, RangeLawStep{0, 1000}}).value[1], 2 * std::pow(10, 0.5))
      << "2 x 2.5 m of 1 dB a metre";
}

TEST(OutputModelSteps, QuantisationIsNearestAndItsBoundAWholeStepWhereTheTruthMayCross) {
  const auto steps = after({{}, QuantiseStep{2, 3}});
  EXPECT_THAT(steps.value, ElementsAre(1, 2, 3, 0, 3, 3));
  EXPECT_DOUBLE_EQ(steps.bound[0], 0);
  EXPECT_DOUBLE_EQ(steps.bound[2], 0) << "2.5 rounds to 3";
}

TEST(OutputModelSteps, NormalisationBySumAndLargest) {
  EXPECT_THAT(after({{}, NormaliseStep{"largest", "image"}}).value,
              Pointwise(DoubleEq(), {0.125, 0.25, 0.375, 0.0, 0.5, 1.0}));
  EXPECT_THAT(after({{}, NormaliseStep{"sum", "row"}}).value,
              Pointwise(DoubleEq(), {1.0, 2 / 6.0, 3 / 11.0, 0.0, 4 / 6.0, 8 / 11.0}));
  EXPECT_THAT(after({{}, NormaliseStep{"largest", "beam"}}).value,
              Pointwise(DoubleEq(), {1 / 3.0, 2 / 3.0, 1.0, 0.0, 0.5, 1.0}));
}

TEST(OutputModelSteps, BlurIsSeparableAndLosesNothingInside) {
  BoundedPicture point{{1, 7, 9}, std::vector<double>(63), std::vector<double>(63), {}, {}, {}};
  point.value[3 * 9 + 4] = 1;
  point.bound[3 * 9 + 4] = 0.5;
  const auto blurred = after({{}, BlurStep{1, 2, 5}}, point);
  double sum = 0;
  for (std::size_t k = 0; k < 63; ++k) {
    sum += blurred.value[k];
    EXPECT_NEAR(blurred.bound[k], blurred.value[k] / 2, 1e-15);
  }
  EXPECT_NEAR(sum, 1, 1e-14);
  EXPECT_NEAR(blurred.value[2 * 9 + 4] / blurred.value[3 * 9 + 4], std::exp(-0.5), 1e-14);
  EXPECT_NEAR(blurred.value[3 * 9 + 5] / blurred.value[3 * 9 + 4], std::exp(-0.125), 1e-14);
  EXPECT_EQ(blurred.value[0 * 9 + 4], 0) << "5 x 5 and no more";
}

TEST(OutputModelSteps, MeanAndCountAreOfSolidAngles) {
  BoundedPicture picture = two_by_three();
  EXPECT_THROW(apply({{}, MeanStep{}}, picture), InputError);
  picture.solid_angle_sr = {0.5, 1, 0, 1, 2, 4};
  picture.solid_angle_bound_sr = {0, 0.5, 0, 0, 0, 0};
  const auto mean = after({{}, MeanStep{}}, picture);
  EXPECT_THAT(mean.value, ElementsAre(2, 2, 0, 0, 2, 2));
  EXPECT_DOUBLE_EQ(mean.bound[1], 2) << "2 / 0.5 - 2";
  EXPECT_EQ(mean.bound[2], INFINITY) << "echo without a solid angle: nothing is certain";
  EXPECT_THAT(after({{}, CountStep{10}}, picture).value, ElementsAre(5, 10, 0, 10, 20, 40));
  EXPECT_THAT(after({{}, CountStep{10}}, picture).bound,
              Pointwise(DoubleNear(1e-12), {0.0, 5.0, 0.0, 0.0, 0.0, 0.0}));
}

TEST(OutputModelSteps, AMeanLeavesSliversEmptyIfRequested) {
  // Five beams, two samples. The medians of the rows are 2 and 2, the second of the four beams with energy.
  BoundedPicture picture{{1, 5, 2}, {8, 1, 9, 2, 6, 3, 2, 0, 4, 5}, std::vector<double>(10), {}, {}, {}};
  picture.solid_angle_sr = {4, 0.5, 3, 2, 2, 1.25, 0.9, 0, 1, 4};
  picture.solid_angle_bound_sr.assign(10, 0);
  const auto mean = after({{}, MeanStep{0.5}}, picture);
  EXPECT_THAT(mean.value, ElementsAre(2, 0, 3, 1, 3, 2.4, 0, 0, 4, 1.25)) << "less than a half of 2";
  EXPECT_EQ(mean.bound[6], 0) << "certainly";
  EXPECT_THAT(after({{}, MeanStep{}}, picture).value[1], 2) << "if asked";
  picture.solid_angle_bound_sr[6] = 0.2;  // its value may be 1.1, and the median may grow accordingly
  EXPECT_DOUBLE_EQ(after({{}, MeanStep{0.5}}, picture).bound[6], 2 / 0.7) << "or the whole mean";
  picture.solid_angle_sr[6] = 1.05;
  EXPECT_DOUBLE_EQ(after({{}, MeanStep{0.5}}, picture).bound[6], 2 / 1.05) << "or nothing";
}

/// Chains of all steps keep each true value within its bounds.
TEST(OutputModelBounds, HoldEveryTruthThroughAnyChain) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(0, 1);
  const std::vector<OutputModelStep> steps{{{}, RangeLawStep{1.5, 300}},
                                           {{}, AmplitudeStep{}},
                                           {{}, DecibelStep{-30, 10}},
                                           {{}, BlurStep{0.8, 1.2, 5}},
                                           {{}, NormaliseStep{"sum", "row"}},
                                           {{}, NormaliseStep{"largest", "image"}},
                                           {{}, ClampStep{0.1, 0.8}},
                                           {{}, QuantiseStep{4, 1}},
                                           {{}, GainStep{3}},
                                           {{}, MeanStep{}},
                                           {{}, MeanStep{0.6}}};
  for (int trial = 0; trial < 300; ++trial) {
    BoundedPicture middle{{1, 4, 6}, {}, {}, {}, {}, {}}, truth = middle;
    for (int s = 0; s < 6; ++s)
      middle.slant_range_bounds_m.insert(middle.slant_range_bounds_m.end(), {2.0 + s, 3.0 + s});
    for (int k = 0; k < 24; ++k) {
      const double value = part(random) < 0.3 ? 0 : part(random),
                   bound = part(random) < 0.5 ? 0 : 0.1 * part(random);
      middle.value.push_back(value);
      middle.bound.push_back(bound);
      truth.value.push_back(std::max(0.0, value + bound * (2 * part(random) - 1)));
      const double omega = 0.5 + part(random), omega_bound = 0.05 * part(random);
      middle.solid_angle_sr.push_back(omega);
      middle.solid_angle_bound_sr.push_back(omega_bound);
      truth.solid_angle_sr.push_back(omega + omega_bound * (2 * part(random) - 1));
    }
    truth.slant_range_bounds_m = middle.slant_range_bounds_m;
    for (int length = 0; length < 4; ++length) {
      const OutputModelStep& step = steps[random() % steps.size()];
      apply(step, middle);
      apply(step, truth);
      for (std::size_t k = 0; k < 24; ++k)
        ASSERT_LE(std::abs(truth.value[k] - middle.value[k]), middle.bound[k] * (1 + 1e-9) + 1e-9)
            << "trial " << trial << ", step " << step.kind.index() << ", bin " << k;
    }
  }
}

struct OutputModelFile : testing::Test {
  TestFolder folder;
  std::string refusal(const std::string& text) {
    try {
      read_output_model(folder.write("recipe.toml", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }
};

TEST_F(OutputModelFile, IsAChainInItsOrder) {
  const OutputModel output_model = read_output_model(folder.write("r.toml", R"(title = "an engine"
[[steps]]
step = "range-law"
exponent = 2
[[steps]]
step = "blur"
[[steps]]
step = "quantise"
bits = 8
)"));
  ASSERT_EQ(output_model.steps.size(), 3u);
  EXPECT_EQ(std::get<RangeLawStep>(output_model.steps[0].kind).exponent, 2);
  EXPECT_EQ(std::get<BlurStep>(output_model.steps[1].kind).size, 5);
  EXPECT_EQ(std::get<QuantiseStep>(output_model.steps[2].kind).bits, 8);
}

TEST_F(OutputModelFile, WhatIsWrongIsSaidAtItsLine) {
  EXPECT_THAT(refusal("[[steps]]\nstep = \"blurr\"\n"), HasSubstr("recipe.toml:2:"));
  EXPECT_THAT(refusal("[[steps]]\nstep = \"blur\"\nbits = 8\n"), HasSubstr("recipe.toml:3:"));
  EXPECT_THAT(refusal("[[steps]]\nstep = \"blur\"\nsize = 4\n"), HasSubstr("must be odd"));
  EXPECT_THAT(refusal("[[steps]]\nstep = \"clamp\"\nlow = 2\n"), HasSubstr("'high' must be above 'low'"));
  EXPECT_THAT(refusal("[[steps]]\nstep = \"gain\"\nfactor = 0\n"), HasSubstr("factor"));
  EXPECT_THAT(refusal("title = \"nothing\"\n"), HasSubstr("has no [[steps]]"));
  EXPECT_THAT(refusal("[[step]]\n"), HasSubstr("steps"));
  EXPECT_THAT(refusal("[[steps]\n"), HasSubstr("not valid TOML"));
}

}  // namespace
}  // namespace tubefoot
