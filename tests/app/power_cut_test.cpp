// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a power failure at any moment. After each call that changes a name or flushes data, the test builds
// the contents of the disk by the harshest rules. The disk then contains the earlier state or the whole
// result, and no ping of the reported checkpoint is lost.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "fixtures/world/long_run.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Files and their bytes by path. Folders end in a slash.
using Tree = std::map<std::string, std::string>;

Tree tree_of(const fs::path& folder) {
  Tree tree;
  for (const std::string& name : names_below(folder))
    if (fs::is_directory(folder / name))
      tree[name + "/"];
    else
      tree[name] = bytes_of(folder / name);
  return tree;
}

/// Returns the part of the tree below one folder.
Tree below(const Tree& tree, const std::string& folder) {
  Tree part;
  for (const auto& [name, bytes] : tree)
    if (name.starts_with(folder) && name != folder) part[name.substr(folder.size())] = bytes;
  return part;
}

/// State of unflushed names on the disk: no change, all changes (a journal has them, but the bytes of the
/// files are late), only removed names, or only new names.
enum class Names { as_synced, as_changed, removed, added };

/// The calls of a program (power_cuts.c), and the contents of the disk after a power failure at one of
/// them. A file has the bytes of its last flush, or none without a flush.
class PowerCuts {
 public:
  PowerCuts(const fs::path& log, const Tree& before) {
    std::ifstream lines(log / "log");
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string what, id;
      words >> what >> id;
      if (what == "call") {
        moments_.emplace_back().call = id;
      } else if (what == "bytes") {
        std::string copy;
        words >> copy;
        moments_.back().bytes = {id, bytes_of(log / copy)};
      } else if (what == "names") {
        moments_.back().names = id;
      } else {
        Entry entry;
        std::string name;
        words >> entry.id >> entry.type;
        std::getline(words >> std::ws, name);
        if (root_.empty()) root_ = id;
        moments_.back().folders[id][name] = entry;
      }
    }
    synced_ = moments_.at(0).folders;
    learn(root_, "", before);
  }

  std::size_t moments() const { return moments_.size(); }
  const std::string& call() const { return moments_[at_].call; }
  /// Continues with the next moment.
  bool next() {
    if (++at_ >= moments_.size()) return false;
    const Moment& now = moments_[at_];
    if (!now.bytes.first.empty()) bytes_[now.bytes.first] = now.bytes.second;
    if (!now.names.empty()) {
      const auto found = now.folders.find(now.names);
      synced_[now.names] = found == now.folders.end() ? Folder() : found->second;
    }
    return true;
  }
  Tree disk(Names names) const {
    Tree tree;
    add(root_, "", names, tree);
    return tree;
  }

 private:
  struct Entry {
    std::string id;
    char type = 0;
    bool operator==(const Entry&) const = default;
  };
  using Folder = std::map<std::string, Entry>;
  struct Moment {
    std::string call, names;
    std::pair<std::string, std::string> bytes;
    std::map<std::string, Folder> folders;
  };

  /// Records the bytes of the state before.
  void learn(const std::string& folder, const std::string& path, const Tree& before) {
    for (const auto& [name, entry] : synced_[folder])
      if (entry.type == 'd')
        learn(entry.id, path + name + "/", before);
      else
        bytes_[entry.id] = before.at(path + name);
  }
  Folder entries(const std::string& folder, Names names) const {
    const auto of = [&folder](const std::map<std::string, Folder>& all) {
      const auto found = all.find(folder);
      return found == all.end() ? Folder() : found->second;
    };
    const Folder synced = of(synced_), changed = of(moments_[at_].folders);
    if (names == Names::as_synced) return synced;
    if (names == Names::as_changed) return changed;
    Folder mixed;
    if (names == Names::added) {
      mixed = changed;
      mixed.insert(synced.begin(), synced.end());
    } else {
      for (const auto& [name, entry] : synced)
        if (changed.contains(name)) mixed[name] = entry;
    }
    return mixed;
  }
  void add(const std::string& folder, const std::string& path, Names names, Tree& tree) const {
    for (const auto& [name, entry] : entries(folder, names)) {
      if (entry.type == 'd') {
        tree[path + name + "/"];
        add(entry.id, path + name + "/", names, tree);
      } else {
        const auto found = bytes_.find(entry.id);
        tree[path + name] = found == bytes_.end() ? "" : found->second;
      }
    }
  }

  std::vector<Moment> moments_;
  std::string root_;
  std::map<std::string, Folder> synced_;
  std::map<std::string, std::string> bytes_;
  std::size_t at_ = 0;
};

struct PowerCut : LongRun {
  TestFolder logs;
  PowerCut() : LongRun(40) {}
  Outcome run(const std::vector<std::string>& words, Surroundings surroundings = {},
              bool watched = false) const {
    if (watched) {
      for (const auto& entry : fs::directory_iterator(logs.path())) fs::remove(entry);
      surroundings.before = {"/usr/bin/env", "LD_PRELOAD=" TUBEFOOT_POWER_CUTS,
                             "TUBEFOOT_POWER_BELOW=" + folder.path().string(),
                             "TUBEFOOT_POWER_LOG=" + logs.path().string()};
    }
    return run_program(words, surroundings);
  }
  std::vector<std::string> run_words(const fs::path& in, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{
        "run", (in / "scene.toml").string(), "-o", (in / "results").string(), "--quiet", "--threads", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Returns the files of a result folder except stats.json, which contains the seconds and must only
  /// exist.
  static Tree result(Tree tree) {
    const std::string statistics = tree.contains("stats.json") ? tree["stats.json"] : "";
    tree["stats.json"] = statistics.starts_with("{") && statistics.ends_with("}\n") ? "whole" : "not whole";
    return tree;
  }
  static std::size_t pings_in(const Tree& disk, const TestFolder& scratch) {
    const auto found = disk.find("results.partial");
    if (found == disk.end()) return 0;
    return pings_kept(scratch.write("kept", found->second));
  }
  static std::set<std::string> names_in(const Tree& disk) {
    std::set<std::string> names;
    for (const auto& [name, bytes] : disk) names.insert(fmt::format("{} ({} bytes)", name, bytes.size()));
    return names;
  }
  static std::set<std::string> top_names(const fs::path& in) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(in)) names.insert(entry.path().filename().string());
    return names;
  }
  PowerCuts cuts_at_end(const Tree& before) const {
    PowerCuts cuts(logs.path(), before);
    for (std::size_t k = 1; k < cuts.moments(); ++k) cuts.next();
    return cuts;
  }
  static void lay_out(const Tree& disk, const fs::path& in) {
    for (const auto& [name, bytes] : disk)
      if (name.ends_with("/"))
        fs::create_directories(in / name);
      else
        std::ofstream(in / name, std::ios::binary) << bytes;
  }
};

constexpr Names all_names[] = {Names::as_synced, Names::as_changed, Names::removed, Names::added};

// A resumed run replaces an earlier result. At each moment the disk has the earlier result and the pings,
// or the new result. The contents are always enough to continue.
TEST_F(PowerCut, AtAnyMomentLeavesTheEarlierResultOrTheWholeNewOne) {
  ASSERT_EQ(run(run_words(folder.path())).exit_code, 0);
  const Tree whole = result(tree_of(results));
  write_scene(40, "An earlier one");
  ASSERT_EQ(run(run_words(folder.path())).exit_code, 0);
  const Tree earlier = result(tree_of(results));
  ASSERT_NE(earlier, whole);
  write_scene(40);
  run(run_words(folder.path()), stopped_at(5, SIGKILL));
  if (!fs::exists(partial)) GTEST_SKIP() << "the run was over before it was killed";
  const std::size_t kept = summary_of(partial).done;
  const Tree before = tree_of(folder.path());
  ASSERT_EQ(run(run_words(folder.path(), {"--resume"}), {}, true).exit_code, 0);
  ASSERT_EQ(result(tree_of(results)), whole);

  PowerCuts cuts(logs.path(), before);
  const TestFolder scratch;
  std::set<Tree> disks;
  std::size_t tried = 0;
  while (cuts.next())
    for (const Names names : all_names) {
      ++tried;
      const Tree disk = cuts.disk(names), found = result(below(disk, "results/"));
      ASSERT_TRUE(found == whole || found == earlier)
          << "after " << cuts.call() << ": " << testing::PrintToString(names_in(disk));
      if (found != whole) {
        ASSERT_GE(pings_in(disk, scratch), kept) << "after " << cuts.call();
      }
      disks.insert(disk);
    }
  for (const Names names : all_names)
    EXPECT_EQ(result(below(cuts_at_end(before).disk(names), "results/")), whole);
  EXPECT_GT(tried, 100u);
  // Tests every disk state if TUBEFOOT_EVERY_CALL is set, else about a dozen.
  const std::size_t stride = std::getenv("TUBEFOOT_EVERY_CALL") != nullptr ? 1 : disks.size() / 12 + 1;
  std::size_t number = 0;
  for (const Tree& disk : disks) {
    if (number++ % stride != 0) continue;
    const TestFolder there;
    lay_out(disk, there.path());
    const Outcome again = run(run_words(there.path(), {"--resume"}));
    ASSERT_EQ(again.exit_code, 0) << again.err << testing::PrintToString(names_in(disk));
    ASSERT_EQ(result(tree_of(there / "results")), whole);
    EXPECT_EQ(top_names(there.path()), (std::set<std::string>{"results", "scene.toml", "thing.obj"}));
  }
  std::cout << tried << " power cuts, " << disks.size() << " different disks\n";
}

// There is no earlier result, and the parent folders are new.
TEST_F(PowerCut, AtAnyMomentLeavesNoHalfNewResult) {
  ASSERT_EQ(run(run_words(folder.path())).exit_code, 0);
  const Tree whole = result(tree_of(results));
  fs::remove_all(results);
  const Tree before = tree_of(folder.path());
  std::vector<std::string> words = run_words(folder.path());
  words[3] = (folder / "new/and/deep").string();
  ASSERT_EQ(run(words, {}, true).exit_code, 0);
  PowerCuts cuts(logs.path(), before);
  std::size_t tried = 0;
  while (cuts.next())
    for (const Names names : all_names) {
      ++tried;
      const Tree disk = cuts.disk(names);
      if (disk.contains("new/and/deep/")) {
        ASSERT_EQ(result(below(disk, "new/and/deep/")), whole) << "after " << cuts.call();
      }
    }
  for (const Names names : all_names)
    EXPECT_EQ(result(below(cuts_at_end(before).disk(names), "new/and/deep/")), whole);
  std::cout << tried << " power cuts\n";
}

TEST_F(PowerCut, AfterAnInterruptedRunKeepsThePingsThatItToldOf) {
  write_scene(3000);
  const Tree before = tree_of(folder.path());
  const Outcome outcome = run(run_words(folder.path()), stopped_at(5, SIGINT), true);
  ASSERT_EQ(outcome.exit_code, 1) << outcome.err;
  const std::size_t told = std::stoul(outcome.err.substr(outcome.err.find("interrupted: ") + 13));
  ASSERT_GE(told, 5u);
  const TestFolder scratch;
  const PowerCuts cuts = cuts_at_end(before);
  std::set<Tree> disks;
  for (const Names names : all_names) disks.insert(cuts.disk(names));
  for (const Tree& disk : disks) {
    EXPECT_EQ(pings_in(disk, scratch), told);
    const TestFolder there;
    lay_out(disk, there.path());
    const Outcome again = run(run_words(there.path(), {"--resume"}));
    EXPECT_EQ(again.exit_code, 0) << again.err;
  }
}

TEST_F(PowerCut, AtAnyMomentLeavesTheEarlierFileOrTheWholeNewOne) {
  folder.write("scene.toml", replaced(small_scene, "beams = 4", "beams = 2\nsamples = 64"));
  ASSERT_EQ(run(run_words(folder.path())).exit_code, 0);
  fs::rename(results, folder / "compared");
  const std::string scene = (folder / "scene.toml").string(),
                    echoes = (folder / "compared/echoes.nc").string();
  std::size_t tried = 0;
  for (const auto& [name, words] : std::map<std::string, std::vector<std::string>>{
           {"f.csv", {"footprints", scene, "--sensor", "camera", "--quiet", "-o"}},
           {"f.gpkg", {"footprints", scene, "--sensor", "camera", "--quiet", "-o"}},
           {"f.nc", {"footprints", scene, "--sensor", "camera", "--quiet", "-o"}},
           {"c.csv", {"coverage", scene, "--quiet", "-o"}},
           {"v.html", {"view", scene, "--quiet", "-o"}},
           {"e.json", {"compare", echoes, echoes, "--json"}},
           {"e.png", {"compare", echoes, echoes, "--png"}}}) {
    SCOPED_TRACE(name);
    for (const bool replaces : {false, true}) {
      fs::remove(folder / name);
      if (replaces) folder.write(name, "an earlier file");
      const Tree before = tree_of(folder.path());
      std::vector<std::string> all = words;
      all.push_back((folder / name).string());
      const Outcome outcome = run(all, {}, true);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      const std::string whole = bytes_of(folder / name);
      PowerCuts cuts(logs.path(), before);
      while (cuts.next())
        for (const Names names : all_names) {
          ++tried;
          const Tree disk = cuts.disk(names);
          if (!disk.contains(name)) {
            ASSERT_FALSE(replaces) << "after " << cuts.call();
          } else {
            ASSERT_TRUE(disk.at(name) == whole || (replaces && disk.at(name) == "an earlier file"))
                << "after " << cuts.call();
          }
        }
      for (const Names names : all_names) EXPECT_TRUE(cuts_at_end(before).disk(names).at(name) == whole);
    }
  }
  std::cout << tried << " power cuts\n";
}

}  // namespace
}  // namespace tubefoot
