// SPDX-License-Identifier: GPL-3.0-or-later
// Tests mesh files in the program: the report of `check`, and the files that it opens when mesh files name
// others.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/model_samples.hpp"
#include "fixtures/program.hpp"
#include "fixtures/watched_run.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

std::string scene_with_mesh(const std::string& file, const std::string& more = "") {
  return "[[materials]]\nname = \"sand\"\n[[materials]]\nname = \"steel\"\n[[objects]]\nname = "
         "\"thing\"\nmaterial = "
         "\"sand\"\nshape = \"mesh\"\nfile = \"" +
         file + "\"\n" + more +
         "[trajectory]\nkind = \"fixed\"\nposition_m = [0, -9, 1]\n[[sensors]]\nname = \"sonar\"\nkind = "
         "\"imaging\"\nbeams = 4\n";
}

Outcome check(const TestFolder& folder, const std::string& scene) {
  return run_program({"check", folder.write("scene.toml", scene).string()});
}

TEST(MeshRun, AUShapedPrismHasItsAreaInCheck) {
  // 0.5 m thick: two legs of 0.5 m x 2.3 m on a bar of 2.5 m x 0.5 m.
  const TestFolder folder;
  folder.write(
      "u.obj",
      "v 0 0 0\nv 2.5 0 0\nv 2.5 2.8 0\nv 2 2.8 0\nv 2 0.5 0\nv 0.5 0.5 0\nv 0.5 2.8 0\nv 0 2.8 0\n"
      "v 0 0 0.5\nv 2.5 0 0.5\nv 2.5 2.8 0.5\nv 2 2.8 0.5\nv 2 0.5 0.5\nv 0.5 0.5 0.5\nv 0.5 2.8 0.5\nv 0 "
      "2.8 0.5\nf 8 7 6 5 4 3 2 1\nf 9 10 11 12 13 14 15 16\nf 1 2 10 9\nf 2 3 11 10\nf 3 4 12 11\nf 4 5 "
      "13 12\nf 5 6 14 13\nf 6 7 15 14\nf 7 8 16 15\nf 8 1 9 16\n");
  const double caps = 2 * (2.5 * 2.8 - 1.5 * 2.3), around = 2 * (2.5 + 2.8) + 2 * 2.3;
  const Outcome outcome = check(folder, scene_with_mesh("u.obj"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ContainsRegex(fmt::format("sand +28 +{:.6g}\n", caps + around * 0.5)));
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST(MeshRun, CheckCountsWhatIsLeftOutAndListsNames) {
  const TestFolder folder;
  folder.write(
      "m.obj",
      "v 0 0 0\nv 1 0 0\nv 0 1 1\nv 1 1 1\nusemtl hull\nf 1 2 3\nf 2 4 3\nusemtl rope\nf 1 4\ng keel\nf 1 2 "
      "4\n");
  const Outcome outcome = check(folder, scene_with_mesh("m.obj", "[objects.materials]\nhull = \"steel\"\n"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("m.obj: 1 faces have fewer than three corners and are left out"));
  EXPECT_THAT(outcome.out,
              AllOf(ContainsRegex("names in thing +facets +material"), ContainsRegex("hull +2 +steel"),
                    ContainsRegex("rope +1 +sand"), ContainsRegex("\nsteel +2 ")));
}

TEST(MeshRun, OfAModelItsBuffersAreOpenedAndNothingElse) {
  const TestFolder folder;
  const CalledHost host;
  folder.write("numbers.bin", gltf_numbers());
  folder.write("skin.png", "no picture");
  folder.write("m.gltf", gltf_model(R"(,"uri":"numbers.bin")",
                                    R"("images":[{"uri":"skin.png"},{"uri":")" + host.address() +
                                        R"(/skin.png"}],"textures":[{"source":0},{"source":1}],)"));
  std::string collada = collada_model();
  collada.insert(collada.find("<library_effects>"),
                 "<library_images><image id=\"i\"><init_from>skin.png</init_from></image><image "
                 "id=\"j\"><init_from>" +
                     host.address() + "/a.png</init_from></image></library_images>");
  folder.write("m.dae", collada);
  folder.write("m.mtl", "newmtl hull\nmap_Kd skin.png\n");
  folder.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl hull\nf 1 2 3\n");
  const auto opened = [&](const std::string& file) {
    const std::string scene = folder.write("scene.toml", scene_with_mesh(file)).string();
    const WatchedRun run = run_watched({"check", "--confined", scene});
    EXPECT_EQ(run.outcome.exit_code, 0) << run.outcome.err;
    std::set<std::string> names;
    for (const std::string& name : run.opened.read)
      names.insert(std::filesystem::path(name).filename().string());
    return names;
  };
  EXPECT_THAT(opened("m.gltf"), UnorderedElementsAre("scene.toml", "m.gltf", "numbers.bin"));
  EXPECT_THAT(opened("m.dae"), UnorderedElementsAre("scene.toml", "m.dae"));
  EXPECT_THAT(opened("m.obj"), UnorderedElementsAre("scene.toml", "m.obj"));
  EXPECT_FALSE(host.was_called());
}

TEST(MeshRun, AModelWithoutAxesIsRefusedWithTheWayOut) {
  const TestFolder folder;
  folder.write("m.3ds", studio_model());
  const Outcome refused = check(folder, scene_with_mesh("m.3ds"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("scene.toml:5:1: "), HasSubstr("m.3ds: does not define its vertical axis"),
                    HasSubstr("'up'"), HasSubstr("'unit_m'")));
  const Outcome taken = check(folder, scene_with_mesh("m.3ds", "up = \"z\"\nunit_m = 0.5\n"));
  EXPECT_EQ(taken.exit_code, 0) << taken.err;
  EXPECT_THAT(taken.out, ContainsRegex("sand +2 +0.5\n"));
}

}  // namespace
}  // namespace tubefoot
