// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that result bytes do not depend on the instruction sets of the processor. It runs shortened shipped
// scenes with all instruction sets, and with some that the C library is told to ignore.
#include <gtest/gtest.h>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr const char* no_avx2_or_fma = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F";

Surroundings with_less() {
  Surroundings surroundings;
  surroundings.before = {"/usr/bin/env", no_avx2_or_fma};
  return surroundings;
}

struct Case {
  const char* name;
  const char* scene;  ///< below scenes
  std::vector<std::pair<std::string, std::string>> edits;
  std::vector<std::string> options;
};

struct AnyProcessor : testing::Test {
  TestFolder folder;

  /// Returns whether the C library itself computes sines differently in the two cases.
  static bool decides_in_the_c_library() {
    Surroundings all, less = with_less();
    all.program = less.program = TUBEFOOT_LIBRARY_PATHS;
    const Outcome of_all = run_program({}, all), of_less = run_program({}, less);
    EXPECT_EQ(of_all.exit_code, 0);
    EXPECT_EQ(of_less.exit_code, 0);
    return of_all.out != of_less.out;
  }
  void expect_same_bytes(const fs::path& scene, const std::vector<std::string>& options) const {
    const fs::path all = folder / "all", less = folder / "less";
    const auto words = [&](const fs::path& output) {
      std::vector<std::string> list{"run", scene.string(), "--quiet", "-o", output.string()};
      list.insert(list.end(), options.begin(), options.end());
      return list;
    };
    const Outcome of_all = run_program(words(all)), of_less = run_program(words(less), with_less());
    ASSERT_EQ(of_all.exit_code, 0) << of_all.err;
    ASSERT_EQ(of_less.exit_code, 0) << of_less.err;
    ASSERT_EQ(names_below(all), names_below(less));
    for (const std::string& name : names_below(all))
      if (name != "stats.json") {
        EXPECT_TRUE(bytes_of(all / name) == bytes_of(less / name)) << name;
      }
  }
};

struct Processor : AnyProcessor, testing::WithParamInterface<Case> {};

TEST_P(Processor, DoesNotDecideTheBytesOf) {
  if (!decides_in_the_c_library())
    GTEST_SKIP()
        << "this processor has no AVX2 and FMA, or this C library no such switch: nothing to tell apart";
  const fs::path shipped = fs::path(TUBEFOOT_SOURCE_DIR) / "scenes" / GetParam().scene;
  fs::copy(shipped.parent_path(), folder / "scene");
  const fs::path scene = folder / "scene" / shipped.filename().string();
  std::string text = bytes_of(scene);
  for (const auto& [from, to] : GetParam().edits) text = replaced(text, from, to);
  folder.write("scene/" + shipped.filename().string(), text);
  expect_same_bytes(scene, GetParam().options);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Processor,
    testing::Values(Case{"Multibeam", "multibeam/scene.toml", {{"pings = 200", "pings = 6"}}, {}},
                    Case{"MultibeamByRays",
                         "multibeam/scene.toml",
                         {{"pings = 200", "pings = 6"}},
                         {"--engine", "ray", "--rays", "2000"}},
                    Case{"Sidescan", "survey/scene.toml", {{"pings = 500", "pings = 20"}}, {}},
                    Case{"Echosounder", "echosounder/scene.toml", {{"pings = 200", "pings = 6"}}, {}},
                    Case{"Interferometric", "interferometric/scene.toml", {{"pings = 100", "pings = 4"}}, {}},
                    Case{"CameraWithSideLobes",
                         "crosstalk/scene.toml",
                         {{"chord_error_m = 0.0005", "chord_error_m = 0.01"}},
                         {}},
                    Case{"Refraction", "refraction/scene.toml", {{"pings = 8", "pings = 2"}}, {}},
                    Case{"Textures",
                         "textures/wellhead.toml",
                         {{"cell_m = 0.02", "cell_m = 0.06"}, {"\ntolerance = 0.02", "\ntolerance = 0.1"}},
                         {}},
                    Case{"Paths",
                         "paths/bowl.toml",
                         {{"patch_m = 0.25", "patch_m = 0.5"},
                          {"window_length_m = 5", "window_length_m = 5\nbeams = 8\nhorizontal_deg = 3"}},
                         {}}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(AnyProcessor, MakesTheBytesOfAReference) {
  folder.write("thing.obj", tetrahedron);
  expect_same_bytes(folder.write("scene.toml", small_scene), {"--reference"});
}

}  // namespace
}  // namespace tubefoot
