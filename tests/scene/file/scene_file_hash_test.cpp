// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "files/file_hash.hpp"
#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

std::string sha256(std::string_view text) {
  Sha256 hash;
  hash.update(text);
  return hash.hex_digest();
}

// FIPS 180-4 known answers (NIST, "Examples with intermediate values", SHA-256).
TEST(Sha256, GivesTheKnownAnswersOfFips180) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmn"
                   "hijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu"),
            "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
  EXPECT_EQ(sha256(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, DoesNotDependOnHowTheBytesAreCut) {
  for (const std::size_t length : {1u, 55u, 56u, 63u, 64u, 65u, 119u, 120u, 128u, 200u}) {
    std::string text;
    for (std::size_t i = 0; i < length; ++i) text += static_cast<char>(i * 37 + length);
    for (std::size_t cut = 0; cut <= length; ++cut) {
      Sha256 hash;
      hash.update(std::string_view(text).substr(0, cut));
      hash.update(std::string_view(text).substr(cut));
      ASSERT_EQ(hash.hex_digest(), sha256(text)) << length << " bytes cut at " << cut;
    }
  }
}

TEST(SceneHash, IsThatOfTheTextAndTheNamedFilesInTheirOrder) {
  const TestFolder folder;
  const std::string wreck = "o wreck\n", track(3000000, 't');
  folder.write("wreck.obj", wreck);
  folder.write("track.csv", track);
  // The order in the file differs from that of the structs: the trajectory comes first.
  std::string scene =
      replaced(smallest_scene, "kind = \"fixed\"", "kind = \"waypoints\"\nfile = \"track.csv\"");
  scene += "[[objects]]\nfile = \"wreck.obj\"\nshape = \"mesh\"\nname = \"wreck\"\n";
  EXPECT_EQ(read_scene(folder, scene).sha256,
            sha256(scene + sha256(track) + "  track.csv\n" + sha256(wreck) + "  wreck.obj\n"));
}

TEST(SceneHash, BytesThatMoveFromOneFileToTheNextAreSeen) {
  const TestFolder folder;
  const std::string scene =
      std::string(smallest_scene) +
      "[[objects]]\nname = \"a\"\nshape = \"mesh\"\nfile = \"a.obj\"\n[[objects]]\nname = \"b\"\nshape = "
      "\"mesh\"\nfile = \"b.obj\"\n";
  folder.write("a.obj", "v 0 0 0\n");
  folder.write("b.obj", "v 0 0 1\nv 0 0 2\n");
  const std::string before = read_scene(folder, scene).sha256;
  folder.write("a.obj", "v 0 0 0\nv 0 0 1\n");
  folder.write("b.obj", "v 0 0 2\n");
  EXPECT_NE(read_scene(folder, scene).sha256, before);
}

TEST(SceneHash, ChangesWithAnyByteOfANamedFile) {
  const TestFolder folder;
  folder.write("wreck.obj", "v 0 0 0\n");
  const std::string scene =
      std::string(smallest_scene) + "[[objects]]\nname = \"wreck\"\nshape = \"mesh\"\nfile = \"wreck.obj\"\n";
  const std::string before = read_scene(folder, scene).sha256;
  EXPECT_EQ(read_scene(folder, scene).sha256, before);
  folder.write("wreck.obj", "v 0 0 1\n");
  EXPECT_NE(read_scene(folder, scene).sha256, before);
}

}  // namespace
}  // namespace tubefoot
