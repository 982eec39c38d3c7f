// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the files of the benchmark suite: the same seed gives the same bytes, the contents are complete,
// and invalid requests are rejected.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "files/file_hash.hpp"
#include "sensors/recordings/echo_reader.hpp"
#include "suite/draw.hpp"
#include "suite/packed.hpp"
#include "suite/solids.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Bytes of all files below a folder, by name, except for files with the name or version of a run.
std::map<std::string, std::string> contents(const fs::path& folder, const std::string& below = {}) {
  std::map<std::string, std::string> all;
  for (const std::string& name : names_below(folder / below))
    if (fs::is_regular_file(folder / below / name) && name != ".tubefoot-files")
      all[name] = bytes_of(folder / below / name);
  return all;
}

TEST(Draw, PublishesOrDrawsFromItsValues) {
  Draw debug({}, "a");
  EXPECT_EQ(debug.among(7, 0, 1, 0.25), 7);
  EXPECT_EQ(debug.order({2, 0, 1}), (std::vector<std::size_t>{2, 0, 1}));
  std::set<double> met;
  Draw draw("word", "a");
  for (int k = 0; k < 200; ++k) met.insert(draw.among(7, 0, 1, 0.25));
  EXPECT_EQ(met, (std::set<double>{0, 0.25, 0.5, 0.75, 1}));
  std::set<std::vector<std::size_t>> orders;
  for (int k = 0; k < 200; ++k) orders.insert(draw.order({0, 1, 2}));
  EXPECT_EQ(orders.size(), 6u);
  double sum = 0;
  for (int k = 0; k < 1000; ++k) sum += debug.number();
  EXPECT_NEAR(sum / 1000, 0.5, 0.05);
}

TEST(Draw, IsOfItsWordAndScene) {
  const auto first = [](const std::string& word, const std::string& scene) {
    return Draw(word, scene).number();
  };
  EXPECT_EQ(first("word", "a"), first("word", "a"));
  EXPECT_NE(first("word", "a"), first("word", "b"));
  EXPECT_NE(first("word", "a"), first("ward", "a"));
  EXPECT_NE(first("word a", "b"), first("word", "a b"));  // two words are never merged
  EXPECT_NE(first("", "a"), Draw({}, "a").number());
}

TEST(Solids, AreClosedOutwardAndExactInBothForms) {
  for (Solid solid :
       {box("box", "m", {1, 2, 3}, {0.3, 0.7, 0.1}, 20), sphere("sphere", "m", {-1, 0, 2}, 0.75, 8, 12)}) {
    snap(solid);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    for (const auto& [a, b, c] : solid.facets) {
      for (const auto& edge : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) ++edges[edge];
      const glm::dvec3 &p = solid.vertices_m[a], &q = solid.vertices_m[b], &r = solid.vertices_m[c];
      volume +=
          (p.x * (q.y * r.z - q.z * r.y) + p.y * (q.z * r.x - q.x * r.z) + p.z * (q.x * r.y - q.y * r.x)) / 6;
    }
    for (const auto& [edge, times] : edges) {
      EXPECT_EQ(times, 1);
      EXPECT_TRUE(edges.contains({edge.second, edge.first})) << solid.name;
    }
    EXPECT_GT(volume, solid.name == "box" ? 0.02 : 1.4);
    const TestFolder folder;
    const Mesh mesh = mesh_in(folder.write("a.obj", obj_text(solid)));
    const std::string stl = stl_bytes(solid);
    ASSERT_EQ(stl.size(), 84 + 50 * solid.facets.size());
    ASSERT_EQ(mesh.facets.size(), solid.facets.size());
    for (std::size_t f = 0; f < solid.facets.size(); ++f)
      for (std::size_t corner = 0; corner < 3; ++corner)
        for (int axis = 0; axis < 3; ++axis) {
          const double x = solid.vertices_m[solid.facets[f][corner]][axis];
          EXPECT_EQ(x * 1024, std::round(x * 1024));
          EXPECT_EQ(mesh.vertices[mesh.facets[f][corner]][static_cast<std::size_t>(axis)], x);
          float in_stl = 0;
          std::memcpy(&in_stl,
                      stl.data() + 84 + 50 * f + 12 * (corner + 1) + 4 * static_cast<std::size_t>(axis), 4);
          EXPECT_EQ(static_cast<double>(in_stl), x);
        }
  }
}

TEST(Suite, OfOneSeedIsTheSameToTheByte) {
  const TestFolder folder;
  const std::string some = "range-law,near-plane,two-scatterings";
  const auto first = contents(packed(folder, "a", {"--seed", "today", "--scenes", some, "--threads", "1"}));
  const auto second = contents(packed(folder, "b", {"--seed", "today", "--scenes", some, "--threads", "2"}));
  EXPECT_GT(first.size(), 30u);
  EXPECT_EQ(first, second);
}

TEST(Suite, OfAnotherSeedHasOtherScenes) {
  const TestFolder folder;
  const fs::path one = packed(folder, "a", {"--seed", "today", "--without-answers"}),
                 other = packed(folder, "b", {"--seed", "tomorrow", "--without-answers"}),
                 debug = packed(folder, "c", {"--without-answers"});
  std::size_t scenes = 0;
  for (const fs::directory_entry& scene : fs::directory_iterator(one / "scenes")) {
    const std::string name = "scenes/" + scene.path().filename().string();
    // Some scenes differ only in their meshes, or only in their files.
    EXPECT_NE(contents(one, name), contents(other, name)) << name;
    EXPECT_NE(contents(one, name), contents(debug, name)) << name;
    ++scenes;
  }
  EXPECT_EQ(scenes, 28u);
  EXPECT_FALSE(fs::exists(one / "answers"));
}

TEST(Suite, HandsOutTheSameScenesWithoutAnswers) {
  const TestFolder folder;
  const fs::path whole = packed(folder, "a", {"--seed", "a secret", "--scenes", "thin-wall,grazing"}),
                 handed =
                     packed(folder, "b",
                            {"--seed", "a secret", "--scenes", "grazing,thin-wall", "--without-answers"});
  fs::rename(whole / "answers", folder / "kept");
  EXPECT_EQ(json_in(folder / "kept/seed.json")["seed"], "a secret");
  for (const auto& [name, bytes] : contents(handed))
    EXPECT_EQ(bytes.find("a secret"), std::string::npos) << name;
  EXPECT_EQ(contents(whole), contents(handed));
  EXPECT_EQ(shell("cd '" + handed.string() + "' && sha256sum -c SHA256SUMS", folder / "said"), 0)
      << bytes_of(folder / "said");
  EXPECT_EQ(shell("cd '" + (folder / "kept").string() + "' && sha256sum -c SHA256SUMS", folder / "said"), 0);
  std::set<std::string> summed;
  std::istringstream sums(bytes_of(handed / "SHA256SUMS"));
  for (std::string digest, name; sums >> digest >> name;) summed.insert(name);
  for (const auto& [name, bytes] : contents(handed)) {
    const bool own = name == "SHA256SUMS";
    EXPECT_EQ(summed.contains(name), !own) << name;
  }
}

TEST(Suite, HoldsAnswersInThreeFormsAndTheirBounds) {
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "side-lobes"});
  const Json scene = json_in(suite / "scenes/side-lobes/scene.json"),
             answer = json_in(suite / "answers/side-lobes/answer.json");
  const Array energy = array_in(suite / "answers/side-lobes/energy.npy"),
              bound = array_in(suite / "answers/side-lobes/bound.npy");
  EXPECT_EQ(scene["shape"], (std::vector<std::size_t>{energy.pings, energy.beams, energy.samples}));
  EXPECT_EQ(bound.values.size(), energy.values.size());
  EXPECT_NEAR(energy.sum(), answer["energy_j"].get<double>(), 1e-12 * energy.sum());
  EXPECT_TRUE(answer["certified"].get<bool>());
  for (std::size_t k = 0; k < energy.values.size(); ++k)
    EXPECT_LE(bound.values[k], 1e-6 * std::max(energy.values[k], answer["strongest_j"].get<double>() * 1e-6));
  const Outcome same = run_program({"compare", (suite / "answers/side-lobes/echoes.nc").string(),
                                    (suite / "answers/side-lobes/echoes.nc").string(), "--within", "0"});
  EXPECT_EQ(same.exit_code, 0) << same.err;
}

/// The energy is the value of the enclosure that is nearest to the ordinary energy, and the bound covers the
/// enclosure. Version 2 has the midpoints.
TEST(Suite, EnergiesAreTheOrdinaryOnesInTheirEnclosures) {
  const TestFolder folder;
  for (const std::string name : {"layered-water", "grazing"}) {
    const fs::path now = packed(folder, name, {"--scenes", name}),
                   before = packed(folder, name + "-2", {"--scenes", name, "--version", "2"});
    const std::string answer = "answers/" + name;
    const Array energy = array_in(now / answer / "energy.npy"), bound = array_in(now / answer / "bound.npy"),
                middle = array_in(before / answer / "energy.npy"),
                half = array_in(before / answer / "bound.npy");
    const Outcome outcome =
        run_program({"run", (now / "scenes" / name / "scene.toml").string(), "-o",
                     (folder / ("run-" + name)).string(), "--quiet", "--pictures", "none"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const SensorEchoes ordinary = read_echo_file(folder / ("run-" + name) / "echoes.nc").sensors.at(0);
    for (std::size_t k = 0; k < energy.values.size(); ++k) {
      const double low = middle.values[k] - half.values[k], high = middle.values[k] + half.values[k];
      ASSERT_DOUBLE_EQ(energy.values[k], std::clamp(ordinary.energy[k], low, high)) << name << ", " << k;
      ASSERT_GE(energy.values[k] + bound.values[k], high * (1 - 1e-14)) << name << ", " << k;
      ASSERT_LE(energy.values[k] - bound.values[k], low * (1 + 1e-14)) << name << ", " << k;
    }
    const SensorEchoes stored = read_echo_file(now / answer / "echoes.nc").sensors.at(0);
    EXPECT_EQ(stored.energy, energy.values);
    EXPECT_EQ(stored.energy_bound, bound.values);
  }
}

TEST(Suite, RefusesWhatItCannotBe) {
  const TestFolder folder;
  const auto said = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"suite", "-o", (folder / "out").string()});
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_FALSE(fs::exists(folder / "out"));
    return outcome.err;
  };
  EXPECT_THAT(said({"--scenes", "range-lore"}),
              testing::HasSubstr("no scene 'range-lore': did you mean 'range-law'?"));
  EXPECT_THAT(said({"--scenes", "grazing,"}), testing::HasSubstr("no scene ''"));
  EXPECT_THAT(said({"--version", "2", "--scenes", "half-sample"}),
              testing::HasSubstr("no scene 'half-sample'"));
  EXPECT_THAT(said({"--version", "1"}), testing::HasSubstr("expected 2 or 3"));
  EXPECT_THAT(said({"--version", "4"}), testing::HasSubstr("expected 2 or 3"));
  EXPECT_THAT(said({"--seed", ""}), testing::HasSubstr("must have 1 to 200 characters"));
  EXPECT_THAT(said({"--seed", std::string(201, 'x')}), testing::HasSubstr("not 201"));
  fs::create_directory(folder / "there");
  folder.write("there/file.txt", "mine");
  const Outcome outcome = run_program({"suite", "-o", (folder / "there").string(), "--scenes", "grazing"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("already exists"));
  EXPECT_EQ(bytes_of(folder / "there/file.txt"), "mine");
}

TEST(Suite, LeavesNothingWhereTheDiskIsFull) {
  const TestFolder folder;
  Surroundings full;
  full.largest_file_bytes = 20000;  // less than an answer
  const Outcome outcome =
      run_program({"suite", "-o", (folder / "out").string(), "--scenes", "grazing"}, full);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::HasSubstr("cannot write"));
  EXPECT_TRUE(names_below(folder.path()).empty());
}

// Runs the readers in README.md of the suite, and checks its description of scenes.
TEST(SuiteReadme, ReadersRun) {
  const std::string python = python_with_netcdf4();
  if (python.empty()) GTEST_SKIP() << "no Python with netCDF4 and NumPy (Debian: python3-netcdf4)";
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "grazing"});
  const std::string page = bytes_of(suite / "README.md");
  const auto block = [&](const std::string& language) {
    const std::size_t begin = page.find("```" + language + "\n") + language.size() + 4;
    return page.substr(begin, page.find("```", begin) - begin);
  };
  const double energy_j = json_in(suite / "answers/grazing/answer.json")["energy_j"].get<double>();
  const fs::path script = folder.write("read.py", block("python")),
                 source = folder.write("read.c", block("c"));
  EXPECT_LE(std::ranges::count(block("python"), '\n'), 20);
  EXPECT_LE(std::ranges::count(block("c"), '\n'), 24);
  ASSERT_EQ(shell(python + " '" + script.string() + "' '" + suite.string() + "' grazing", folder / "said"), 0)
      << bytes_of(folder / "said");
  EXPECT_NEAR(std::stod(bytes_of(folder / "said")), energy_j, 1e-8 * energy_j);
  const std::string program = (folder / "read").string();
  ASSERT_EQ(
      shell("cc -std=c99 -Wall -Wextra -Werror -pedantic -o '" + program + "' '" + source.string() + "'",
            folder / "said"),
      0)
      << bytes_of(folder / "said");
  const std::string answer = (suite / "answers/grazing/energy.npy").string();
  ASSERT_EQ(shell("'" + program + "' '" + answer + "'", folder / "said"), 0);
  EXPECT_NEAR(std::stod(bytes_of(folder / "said")), energy_j, 1e-8 * energy_j);
  EXPECT_THAT(bytes_of(folder / "said"), testing::HasSubstr("in 1 pings, 32 beams, 128 samples"));
  const std::string bytes = bytes_of(answer);
  for (const std::size_t length : {std::size_t{0}, std::size_t{5}, std::size_t{70}, bytes.size() - 1}) {
    const fs::path cut = folder.write("cut.npy", bytes.substr(0, length));
    EXPECT_EQ(shell("'" + program + "' '" + cut.string() + "'", folder / "said"), 1) << length;
  }
}

// An outsider's walk from a scene to a verdict, in Python and in C.
TEST(SuiteReadme, EnginesAgree) {
  const std::string python = python_with_netcdf4();
  if (python.empty()) GTEST_SKIP() << "no Python with netCDF4 and NumPy (Debian: python3-netcdf4)";
  const TestFolder folder;
  const fs::path suite = packed(folder, "a", {"--scenes", "grazing"});
  std::string page = bytes_of(suite / "README.md");
  page = page.substr(page.find("## Engines of 20 lines"));
  const auto block = [&](const std::string& language) {
    const std::size_t begin = page.find("```" + language + "\n") + language.size() + 4;
    return page.substr(begin, page.find("```", begin) - begin);
  };
  EXPECT_LE(std::ranges::count(block("python"), '\n'), 20);
  EXPECT_LE(std::ranges::count(block("c"), '\n'), 28);
  const fs::path script = folder.write("engine.py", block("python")),
                 source = folder.write("engine.c", block("c"));
  const std::string program = (folder / "engine").string(), results = (folder / "results").string();
  ASSERT_EQ(
      shell("cc -std=c99 -Wall -Wextra -Werror -pedantic -o '" + program + "' '" + source.string() + "' -lm",
            folder / "said"),
      0)
      << bytes_of(folder / "said");
  for (const std::string& engine :
       {python + " '" + script.string() + "' '" + suite.string() + "' '" + results + "'",
        "'" + program + "' '" + results + "/grazing.npy'"}) {
    fs::remove_all(results);
    fs::create_directory(results);
    ASSERT_EQ(shell(engine, folder / "said"), 0) << bytes_of(folder / "said");
    ASSERT_EQ(shell(python + " '" + (suite / "compare.py").string() + "' '" + suite.string() + "' '" +
                        results + "'",
                    folder / "said"),
              0)
        << bytes_of(folder / "said");
    EXPECT_THAT(bytes_of(folder / "said"), testing::HasSubstr("grazing           agrees"));
  }
}

TEST(SuiteReadme, ListsEveryScene) {
  for (const auto& [version, scenes] : {std::pair<std::string, std::size_t>{"2", 19}, {"3", 28}}) {
    const std::string page = bytes_of(reference_folder() / ("v" + version) / "README.md");
    const TestFolder folder;
    const fs::path suite = packed(folder, "a", {"--without-answers", "--version", version});
    EXPECT_EQ(bytes_of(suite / "README.md"), page);
    const Json about = json_in(suite / "pack.json");
    EXPECT_EQ(about["version"], version + ".0");
    EXPECT_EQ(about["scenes"].size(), scenes);
    for (const Json& name : about["scenes"]) {
      const Json scene = json_in(suite / "scenes" / name.get<std::string>() / "scene.json");
      const std::regex row("\\| `" + name.get<std::string>() + "` \\|[^|]*\\| ([^|]*) \\|");
      std::smatch found;
      ASSERT_TRUE(std::regex_search(page, found, row)) << name;
      std::string judged;
      for (const Json& measure : scene["judged_by"])
        judged += (judged.empty() ? "`" : ", `") + measure["measure"].get<std::string>() + "`";
      EXPECT_EQ(found[1].str(), judged) << name;
      for (const Json& measure : scene["judged_by"])
        EXPECT_THAT(page, testing::HasSubstr("| `" + measure["measure"].get<std::string>() + "`"));
      for (const auto& [key, value] : scene.items())
        if (version != "2" && key != "scene" && key != "tests" && key != "title") {
          EXPECT_THAT(page, testing::HasSubstr("`" + key + "`")) << name;
        }
    }
  }
}

}  // namespace
}  // namespace tubefoot
