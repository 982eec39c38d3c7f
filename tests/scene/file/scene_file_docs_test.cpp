// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <tuple>
#include <vector>

#include "fixtures/world/read_scenes.hpp"
#include "scene/file/scene_file_keys.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

std::string documentation() {
  std::ifstream in(std::filesystem::path(TUBEFOOT_SOURCE_DIR) / "docs" / "scene-file.md");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Section, kind, key, type, unit, default, range.
using Row =
    std::tuple<std::string, std::string, std::string, std::string, std::string, std::string, std::string>;

std::string or_dash(const std::string& cell) { return cell.empty() ? "-" : cell; }

/// The text between the first two backquotes.
std::string in_back_quotes(const std::string& text) {
  const std::size_t begin = text.find('`');
  return begin == std::string::npos ? "" : text.substr(begin + 1, text.find('`', begin + 1) - begin - 1);
}

std::vector<Row> documented_rows() {
  std::vector<Row> rows;
  std::string section, kind;
  std::istringstream lines(documentation());
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) section = in_back_quotes(line), kind.clear();
    if (line.starts_with("### ")) kind = in_back_quotes(line);
    if (!line.starts_with("| `")) continue;
    std::vector<std::string> cells;
    for (std::size_t at = 2, end; (end = line.find(" |", at)) != std::string::npos; at = end + 3) {
      cells.push_back(line.substr(at, end - at));
    }
    if (cells.size() != 6) {
      ADD_FAILURE() << "six cells wanted: " << line;
      continue;
    }
    EXPECT_GT(cells[5].size(), 4u) << "no meaning: " << line;
    rows.emplace_back(section, kind, in_back_quotes(cells[0]), cells[1], cells[2], cells[3], cells[4]);
  }
  return rows;
}

TEST(SceneFileDocs, TablesSayWhatTheReaderDoes) {
  std::vector<Row> known;
  for (const SceneKey& key : scene_file_keys()) {
    known.emplace_back(key.section, key.kind, key.name, key.type, or_dash(key.unit),
                       or_dash(key.default_value), or_dash(key.range));
  }
  ASSERT_GT(known.size(), 80u);
  EXPECT_THAT(documented_rows(), testing::UnorderedElementsAreArray(known));
}

TEST(SceneFileDocs, CompleteExampleIsAScene) {
  const std::string text = documentation(), fence = "```toml\n";
  const std::size_t begin = text.find(fence) + fence.size();
  const TestFolder folder;
  const SceneDescription scene = read_scene(folder, text.substr(begin, text.find("```", begin) - begin));
  EXPECT_EQ(scene.title, "A sphere on sand");
  EXPECT_EQ(scene.objects.size(), 1u);
}

TEST(SceneFileDocs, QuotedMessagesAreReal) {
  const TestFolder folder;
  const std::string text = documentation();
  const std::string filler(11, '\n');
  for (const char* mistake :
       {"[[objects]]\nshape = \"box\"\nname = \"b\"\nheading_rad = 1\n",
        "[[sensors]]\nkind = \"didson\"\nname = \"s\"\nbeams = 0\n", "[[terrain]]\n\n\nkind = \"flatt\"\n"}) {
    const std::string message = scene_error(folder, filler.substr(3) + mistake);
    EXPECT_NE(text.find("\n" + message + "\n"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace tubefoot
