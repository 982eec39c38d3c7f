// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the complete example and the messages in docs/scenes.md. Docs.SceneKeys compares docs/scene-keys.md
// with the program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "fixtures/world/read_scenes.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

std::string documentation() {
  std::ifstream in(std::filesystem::path(TUBEFOOT_SOURCE_DIR) / "docs" / "scenes.md");
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(SceneFileDocs, CompleteExampleIsAScene) {
  const std::string text = documentation(), fence = "```toml\n";
  ASSERT_NE(text.find(fence), std::string::npos);
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
