// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the output rules of all commands that write. They never overwrite an input or a foreign file. They
// find unusable paths before any computation, and do not harm a run in progress.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "fixtures/world/long_run.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

/// Shell words before the program, in its own file system view and process namespace.
std::vector<std::string> apart(const std::string& commands) {
  std::vector<std::string> words{"/usr/bin/unshare", "--mount", "--pid", "--fork"};
  if (geteuid() != 0) words.emplace_back("--map-root-user");
  for (const char* word : {"/bin/sh", "-c"}) words.emplace_back(word);
  words.push_back(commands + " exec \"$0\" \"$@\"");
  return words;
}

bool can_be_apart() {
  Surroundings surroundings;
  surroundings.before = apart("mount -t tmpfs none /mnt &&");
  return run_program({"presets"}, surroundings).exit_code == 0;
}

struct AtomicOutput : testing::Test {
  TestFolder folder;
  const fs::path scene = folder / "scene.toml", results = folder / "results";
  AtomicOutput() {
    folder.write("scene.toml", replaced(small_scene, "beams = 4", "beams = 2\nsamples = 64"));
    folder.write("thing.obj", tetrahedron);
  }
  std::string at(const std::string& name) const { return (folder / name).string(); }
  Outcome run(const fs::path& output, const Surroundings& surroundings = {},
              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", scene.string(), "-o", output.string(), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, surroundings);
  }
  Outcome footprints(const fs::path& output, const Surroundings& surroundings = {}) const {
    return run_program({"footprints", scene.string(), "--sensor", "camera", "--quiet", "-o", output.string()},
                       surroundings);
  }
  /// Expects the exit code of a wrong command line and a message that contains `why`, before any file was
  /// made.
  void expect_refused(const Outcome& outcome, const std::string& why, const std::set<std::string>& before) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(why));
    EXPECT_EQ(names_below(folder.path()), before);
  }
  static Surroundings shell(const std::string& commands) {
    Surroundings surroundings;
    surroundings.before = {"/bin/sh", "-c", commands + " exec \"$0\" \"$@\""};
    return surroundings;
  }
  static Surroundings apart_after(const std::string& commands) {
    Surroundings surroundings;
    surroundings.before = apart(commands);
    return surroundings;
  }
};

TEST_F(AtomicOutput, NoCommandWritesOverAnInput) {
  const std::string s = scene.string();
  ASSERT_EQ(run(results).exit_code, 0);
  for (const char* ending : {".csv", ".gpkg", ".png", ".html", ".json", ".ply", ".txt"})
    for (const char* input : {"thing.obj", "scene.toml"})
      fs::create_symlink(at(input), at(std::string(input) + ending));
  std::vector<std::vector<std::string>> commands{
      {"footprints", s, "--sensor", "camera", "-o", at("thing.obj")},
      {"footprints", s, "--sensor", "camera", "-o", at("results/../thing.obj")},
      {"chart", s, "-o", folder.path().string()},
      {"export", s, "--to", "obj", "-o", folder.path().string()},
      {"run", s, "-o", folder.path().string()},
      {"run", s, "-o", at("thing.obj")},
      {"view", at("results"), "-o", at("results/stats.json")},
      {"view", at("results"), "-o", at("results/echoes.nc")}};
  for (const std::string input : {"thing.obj", "scene.toml"}) {
    for (const char* ending : {".csv", ".gpkg", ".txt", ".ply"})
      commands.push_back({"footprints", s, "--sensor", "camera", "-o", at(input + ending)});
    commands.push_back(
        {"footprints", s, "--sensor", "camera", "-o", at("new.csv"), "--rationals", at(input)});
    commands.push_back({"coverage", s, "-o", at(input + ".csv")});
    commands.push_back({"coverage", s, "-o", at("new.csv"), "--picture", at(input + ".png")});
    commands.push_back({"check", s, "--png", at(input + ".png")});
    commands.push_back({"view", s, "-o", at(input)});
    commands.push_back({"view", at("results"), "-o", at(input + ".html")});
    commands.push_back({"advise", s, "--tolerance", "1dB", "--json", at(input)});
    commands.push_back({"refine", s, "-o", at(input)});
    commands.push_back({"refine", s, "-o", at(input + ".ply")});
  }
  const auto before = names_below(folder.path());
  const std::string scene_bytes = bytes_of(scene), statistics = bytes_of(results / "stats.json");
  for (const std::vector<std::string>& words : commands) {
    SCOPED_TRACE(testing::PrintToString(words));
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, AnyOf(HasSubstr("is an input"), HasSubstr("which tubefoot did not write"),
                                   HasSubstr("is not a folder")));
    ASSERT_EQ(bytes_of(folder / "thing.obj"), tetrahedron);
    ASSERT_EQ(bytes_of(scene), scene_bytes);
    ASSERT_EQ(bytes_of(results / "stats.json"), statistics);
    ASSERT_EQ(names_below(folder.path()), before);
  }
}

// The list in a result folder does not make an input a file of tubefoot.
TEST_F(AtomicOutput, NoResultFolderThatHoldsAnInputIsReplaced) {
  ASSERT_EQ(run(results).exit_code, 0);
  folder.write("results/thing.obj", tetrahedron);
  std::ofstream(results / ".tubefoot-files", std::ios::app) << "thing.obj\n";
  folder.write("scene.toml", replaced(bytes_of(scene), "thing.obj", "results/thing.obj"));
  expect_refused(run(results), "is an input or contains one", names_below(folder.path()));
}

TEST_F(AtomicOutput, FilesOfOthersStayAsTheyAre) {
  folder.write("victim", "mine");
  for (const std::string name : {"f.csv", "v.html", "results"}) {
    folder.write(".partial-" + name, "mine, too");
    fs::create_symlink(at("victim"), at("." + name + ".partial-1"));
  }
  fs::create_symlink(at("victim"), at(".partial-w.html"));
  EXPECT_EQ(footprints(at("f.csv")).exit_code, 0);
  for (const char* page : {"v.html", "w.html"})
    EXPECT_EQ(run_program({"view", scene.string(), "--quiet", "-o", at(page)}).exit_code, 0);
  EXPECT_EQ(run(results).exit_code, 0);
  EXPECT_EQ(bytes_of(folder / "victim"), "mine");
  for (const std::string name : {"f.csv", "v.html", "results"})
    EXPECT_EQ(bytes_of(folder / (".partial-" + name)), "mine, too");
}

// A foreign or malicious file has the name of the checkpoint of a run.
TEST_F(AtomicOutput, PingsAreKeptInNoFileButTheRunsOwn) {
  folder.write("victim", "");
  const std::vector<std::pair<std::string, std::function<void(const fs::path&)>>> plants{
      {"is a symbolic link", [&](const fs::path& p) { fs::create_symlink(at("victim"), p); }},
      {"is a symbolic link", [&](const fs::path& p) { fs::create_symlink(at("nowhere"), p); }},
      {"second hard link", [&](const fs::path& p) { fs::create_hard_link(at("victim"), p); }},
      {"is not a checkpoint", [&](const fs::path& p) { ASSERT_EQ(mkfifo(p.c_str(), 0666), 0); }},
      {"cannot open the checkpoint", [&](const fs::path& p) { fs::create_directory(p); }},
      {"is not a checkpoint", [&](const fs::path&) { folder.write("results.partial", "mine"); }}};
  for (const auto& [why, plant] : plants) {
    SCOPED_TRACE(why);
    plant(folder / "results.partial");
    const auto before = names_below(folder.path());
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--resume"}})
      expect_refused(run(results, {}, more), why, before);
    EXPECT_EQ(bytes_of(folder / "victim"), "");
    fs::remove(folder / "results.partial");
  }
}

TEST_F(AtomicOutput, PingsAreKeptInNoFileOfSomebodyElse) {
  if (geteuid() != 0 || !nobody_can_run_program()) GTEST_SKIP() << "needs two users";
  fs::permissions(folder.path(), fs::perms(01777));
  folder.write("results.partial", "");
  fs::permissions(folder / "results.partial", fs::perms(0666));
  Surroundings nobody;
  nobody.as_nobody = true;
  expect_refused(run(results, nobody), "belongs to another user", names_below(folder.path()));
}

TEST_F(AtomicOutput, FoldersThatCannotBeReplacedAreFoundBeforeTheFirstPing) {
  ASSERT_EQ(run(folder / "source").exit_code, 0);
  fs::create_directory_symlink(at("nowhere"), at("dangling"));
  fs::create_directory(folder / "mounted");
  const std::string too_long(300, 'x');
  const auto before = names_below(folder.path());
  expect_refused(run(folder / "dangling"), "is a link to a missing file", before);
  expect_refused(run(folder / "dangling/below"), "cannot write into", before);
  expect_refused(run(folder / too_long), "too long", before);
  expect_refused(run(folder / std::string(248, 'x')), "too long", before);
  if (!can_be_apart()) GTEST_SKIP() << "no file systems of a test's own here";
  const std::string mounted = "'" + at("mounted") + "'", source = "'" + at("source") + "'";
  expect_refused(run(folder / "mounted", apart_after("mount -t tmpfs none " + mounted + " &&")), "mounted",
                 before);
  expect_refused(run(folder / "mounted", apart_after("mount --bind " + source + " " + mounted + " &&")),
                 "mounted", before);
  expect_refused(run(folder / "mounted/below", apart_after("mount -t tmpfs -o ro none " + mounted + " &&")),
                 "Read-only file system", before);
  // The link leads to another file system, but its folder is on that file system as well, so that it is
  // valid.
  fs::create_directory_symlink(at("mounted/deep/there"), at("linked"));
  const Outcome outcome = run(folder / "linked", apart_after("mount -t tmpfs none " + mounted +
                                                             " && mkdir -p " + mounted + "/deep/there &&"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

// A layered file system of a container cannot move a folder of a lower layer.
TEST_F(AtomicOutput, FoldersOfALowerLayerAreFoundBeforeTheFirstPing) {
  if (!can_be_apart()) GTEST_SKIP() << "no file systems of a test's own here";
  ASSERT_EQ(run(folder / "lower/results").exit_code, 0);
  fs::create_directory(folder / "merged");
  fs::create_directory(folder / "disk");
  const auto before = names_below(folder.path());
  const Surroundings layered = apart_after(
      fmt::format("cd '{}' && mount -t tmpfs none disk && mkdir disk/upper disk/work && mount -t overlay "
                  "overlay -o redirect_dir=off,lowerdir=lower,upperdir=disk/upper,workdir=disk/work merged "
                  "|| exit 77;",
                  folder.path().string()));
  const Outcome outcome = run(folder / "merged/results", layered);
  if (outcome.exit_code == 77) GTEST_SKIP() << "no layered file systems here: " << outcome.err;
  expect_refused(outcome, "cannot be replaced", before);
  EXPECT_EQ(run(folder / "merged/new", layered).exit_code, 0);
}

TEST_F(AtomicOutput, FoldersOfOthersAreFoundBeforeTheFirstPing) {
  if (geteuid() != 0 || !nobody_can_run_program()) GTEST_SKIP() << "needs two users";
  Surroundings nobody;
  nobody.as_nobody = true;
  // A folder of another user in which only owners may move files, and an own folder that is read-only.
  fs::create_directory(folder / "shared");
  fs::permissions(folder / "shared", fs::perms(01777));
  ASSERT_EQ(run(folder / "shared/others").exit_code, 0);
  fs::permissions(folder / "shared/others", fs::perms(0777));
  ASSERT_EQ(run(folder / "shared/own", nobody).exit_code, 0);
  fs::permissions(folder / "shared/own", fs::perms(0555));
  const auto before = names_below(folder.path());
  expect_refused(run(folder / "shared/others", nobody), "cannot be replaced", before);
  expect_refused(run(folder / "shared/own", nobody), "cannot be replaced", before);
  fs::permissions(folder / "shared/own", fs::perms(0755));
}

TEST_F(AtomicOutput, FilesThatCannotBeReplacedAreFoundBeforeAnythingIsComputed) {
  fs::create_symlink(at("nowhere"), at("dangling.csv"));
  fs::create_directory(folder / "folder.csv");
  folder.write("mounted.csv", "mine");
  folder.write("there.csv", "mine");
  const auto before = names_below(folder.path());
  expect_refused(footprints(folder / "dangling.csv"), "is a link to a missing file", before);
  expect_refused(footprints(folder / "folder.csv"), "is a folder", before);
  expect_refused(footprints(folder / "missing/f.csv"), "No such file", before);
  expect_refused(footprints(folder / (std::string(300, 'x') + ".csv")), "too long", before);
  if (!can_be_apart()) GTEST_SKIP() << "no file systems of a test's own here";
  expect_refused(footprints(folder / "mounted.csv", apart_after("mount --bind '" + at("there.csv") + "' '" +
                                                                at("mounted.csv") + "' &&")),
                 "mounted", before);
  EXPECT_EQ(bytes_of(folder / "there.csv"), "mine");
  if (geteuid() != 0 || !nobody_can_run_program()) GTEST_SKIP() << "the rest needs two users";
  fs::create_directory(folder / "shared");
  fs::permissions(folder / "shared", fs::perms(01777));
  folder.write("shared/f.csv", "mine");
  Surroundings nobody;
  nobody.as_nobody = true;
  expect_refused(footprints(folder / "shared/f.csv", nobody), "cannot be replaced",
                 names_below(folder.path()));
  EXPECT_EQ(bytes_of(folder / "shared/f.csv"), "mine");
}

// Runs all commands in a folder whose name is not valid UTF-8.
TEST_F(AtomicOutput, NamesMayBeOfAnyBytes) {
  const fs::path strange = folder /
                           "stra\xdf"
                           "e";
  fs::create_directory(strange);
  fs::copy_file(scene, strange / "sc\xe4ne.toml");
  fs::copy_file(folder / "thing.obj", strange / "thing.obj");
  const std::string s = (strange / "sc\xe4ne.toml").string(), r = (strange / "results").string();
  const auto good = [&](const std::vector<std::string>& words) {
    SCOPED_TRACE(words.front());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  Surroundings impatient;
  impatient.signal = SIGKILL;
  impatient.interrupt_when = [&] { return fs::exists(strange / "results.partial"); };
  run_program({"run", s, "-o", r, "--quiet"}, impatient);
  fs::remove_all(r);
  good({"run", s, "-o", r, "--quiet", "--resume"});
  const auto statistics = nlohmann::json::parse(bytes_of(strange / "results/stats.json"));
  EXPECT_THAT(statistics.at("scene").get<std::string>(), HasSubstr("/sc\ufffdne.toml"));
  good({"view", r, "--scene", s, "--quiet", "-o", (strange / "v\xe4.html").string()});
  good({"advise", s, "--tolerance", "1dB", "--quiet", "--json", (strange / "a.json").string()});
  good({"compare", r + "/echoes.nc", r + "/echoes.nc", "--json", (strange / "c.json").string(), "--png",
        (strange / "c.png").string()});
  good({"footprints", s, "--sensor", "camera", "--quiet", "-o", (strange / "f.gpkg").string()});
  good({"footprints", s, "--sensor", "camera", "--quiet", "-o", (strange / "f.nc").string()});
  good({"coverage", s, "--quiet", "-o", (strange / "coverage").string()});
  good({"chart", s, "--quiet", "--repeats", "1", "--seconds", "0.05", "-o", (strange / "chart").string()});
}

// Process numbers of one container mean nothing in another.
TEST_F(AtomicOutput, ARunThatIsRefusedDoesNotHurtALiveOne) {
  folder.write("scene.toml", long_scene(3000));
  ASSERT_EQ(run(folder / "whole").exit_code, 0);
  for (const bool elsewhere : {false, true}) {
    SCOPED_TRACE(elsewhere ? "in another container" : "beside it");
    if (elsewhere && !can_be_apart()) GTEST_SKIP() << "no process numbers of a test's own here";
    Outcome refused;
    Surroundings met;
    met.signal = 0;
    met.interrupt_when = [&] {
      if (pings_kept(folder / "results.partial") == 0) return false;
      refused = run(results, elsewhere ? apart_after("") : Surroundings(), {"--resume"});
      return true;
    };
    const Outcome outcome = run(results, met);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    ASSERT_EQ(refused.exit_code, 2) << refused.err << "the first may have ended before the second began";
    EXPECT_THAT(refused.err, HasSubstr("another run is writing"));
    EXPECT_TRUE(bytes_of(results / "echoes.nc") == bytes_of(folder / "whole/echoes.nc"));
    fs::remove_all(results);
  }
  EXPECT_EQ(names_below(folder.path()).size(), names_below(folder / "whole").size() + 3);
}

TEST_F(AtomicOutput, WhatKilledRunsLeftIsClearedByTheNext) {
  folder.write("scene.toml", long_scene(3000));
  for (const std::string output : {"f.csv", "results"}) {
    const std::vector<std::string> words =
        output == "results"
            ? std::vector<std::string>{"run", scene.string(), "--quiet", "-o", at(output)}
            : std::vector<std::string>{"footprints", scene.string(), "--sensor", "side",    "--pings",
                                       ":",          "--quiet",      "-o",       at(output)};
    const auto staging = [&] {
      for (const auto& entry : fs::directory_iterator(folder.path()))
        if (entry.path().filename().string().starts_with("." + output)) return true;
      return false;
    };
    Surroundings killed;
    killed.signal = SIGKILL;
    killed.interrupt_when = staging;
    EXPECT_EQ(run_program(words, killed).signal, SIGKILL);
    EXPECT_TRUE(staging());
    fs::remove(folder / "results.partial");
    EXPECT_EQ(run_program(words).exit_code, 0);
    EXPECT_FALSE(staging());
  }
}

TEST_F(AtomicOutput, WhatIsNoOrdinaryFileIsWrittenAsItIs) {
  ASSERT_EQ(mkfifo(at("pipe.csv").c_str(), 0666), 0);
  ASSERT_EQ(footprints(folder / "file.csv").exit_code, 0);
  std::string received;
  std::thread reader([&] { received = bytes_of(folder / "pipe.csv"); });
  const Outcome outcome = footprints(folder / "pipe.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  close(open(at("pipe.csv").c_str(), O_WRONLY | O_NONBLOCK));  // no process waits for unwritten data
  reader.join();
  EXPECT_EQ(received, bytes_of(folder / "file.csv"));
  EXPECT_TRUE(fs::is_fifo(folder / "pipe.csv"));
  // /dev/stdout is a link to the actual output, which may be a file.
  const std::vector<std::string> words{"advise",  scene.string(), "--tolerance", "1dB",
                                       "--quiet", "--json",       "/dev/stdout"};
  EXPECT_THAT(run_program(words).out, HasSubstr("\"cheapest\""));
  const Surroundings into_file = shell("exec >> '" + at("said") + "';");
  EXPECT_EQ(run_program(words, into_file).exit_code, 0);
  EXPECT_THAT(bytes_of(folder / "said"), HasSubstr("wrote /dev/stdout"));
  EXPECT_TRUE(fs::is_symlink("/dev/stdout"));
}

TEST_F(AtomicOutput, ModesAreThoseOfTheUmask) {
  const Surroundings masked = shell("umask 027;");
  ASSERT_EQ(run(results, masked).exit_code, 0);
  ASSERT_EQ(footprints(folder / "f.csv", masked).exit_code, 0);
  ASSERT_EQ(footprints(folder / "f.gpkg", masked).exit_code, 0);
  const auto mode = [](const fs::path& p) { return static_cast<int>(fs::status(p).permissions()); };
  EXPECT_EQ(mode(results), 0750);
  for (const auto& entry : fs::directory_iterator(results)) EXPECT_EQ(mode(entry.path()), 0640) << entry;
  EXPECT_EQ(mode(folder / "f.csv"), 0640);
  EXPECT_EQ(mode(folder / "f.gpkg"), 0640);
}

TEST_F(AtomicOutput, LinksStayLinks) {
  fs::create_directory(folder / "there");
  folder.write("there/f.csv", "an earlier one");
  fs::create_directory(folder / "there/results");
  fs::create_symlink("there/f.csv", folder / "f.csv");
  fs::create_directory_symlink("there/results", results);
  EXPECT_EQ(footprints("f.csv", shell("cd '" + folder.path().string() + "';")).exit_code, 0);
  EXPECT_EQ(run("results/", shell("cd '" + folder.path().string() + "';")).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "f.csv"));
  EXPECT_TRUE(fs::is_symlink(results));
  EXPECT_THAT(bytes_of(folder / "there/f.csv"), testing::StartsWith("WKT"));
  EXPECT_TRUE(fs::exists(folder / "there/results/echoes.nc"));
}

}  // namespace
}  // namespace tubefoot
