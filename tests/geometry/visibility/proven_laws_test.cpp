// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string>

#include "prove/laws.hpp"

// Checks a hundred thousand tubes of tests/prove, a share for each kind of scene. `make prove` checks a
// hundred times as many. TUBEFOOT_SEED in the environment sets another seed.
namespace tubefoot::prove {
namespace {

// Sanitizers make rationals about fifty times slower.
#ifdef TUBEFOOT_SANITIZED
constexpr std::uint64_t one_scene_in = 32;
#else
constexpr std::uint64_t one_scene_in = 1;
#endif
constexpr std::uint64_t tubes_wanted = 100'000 / one_scene_in;
constexpr std::uint64_t kinds = generator_names.size();
constexpr std::uint64_t scenes_per_kind = tubes_wanted / (kinds * tubes_per_scene) + 1;

std::uint64_t seed() {
  const char* text = std::getenv("TUBEFOOT_SEED");
  return text ? std::strtoull(text, nullptr, 10) : 20260801;
}

class ProvenLaws : public testing::TestWithParam<std::uint64_t> {};

// Laws C1, V2, A1, A2, A3, A4, A5, A6, A8, V3, V4, V6, V7 and V8.
TEST_P(ProvenLaws, HoldOnEveryTube) {
  Prover prover;
  Ledger ledger;
  for (std::uint64_t k = 0; k < scenes_per_kind; ++k) prover.check(seed(), GetParam() + k * kinds, ledger);

  for (std::size_t l = 0; l < law_names.size(); ++l) {
    const Ledger::Entry entry = ledger.total(static_cast<Law>(l));
    EXPECT_EQ(entry.failures, 0u) << law_names[l] << ": " << entry.failures << " of " << entry.tubes
                                  << " tubes; the first with tubefoot_prove --seed " << seed() << " --scene "
                                  << entry.first_failure << ", or TUBEFOOT_SEED=" << seed();
    // The test checks each law in turn, expensive laws less often.
    EXPECT_GE(entry.tubes, scenes_per_kind * tubes_per_scene / 16) << law_names[l];
    RecordProperty(std::string("tubes: ") + std::string(law_names[l]), static_cast<int>(entry.tubes));
  }
  const std::uint64_t tubes = ledger.total(Law::closure).tubes;
  EXPECT_GE(tubes * kinds, tubes_wanted) << "all kinds together are to be " << tubes_wanted;
  EXPECT_GE(ledger.tubes_with_facets[GetParam()], tubes / 2)
      << "tubes that see nothing but water prove little";
}

// A scene in which a facet hid itself: the plane of a narrow tube was not perpendicular to its axis.
TEST(ProvenScenes, HoldEveryLaw) {
  Prover prover;
  Ledger ledger;
  prover.check(1, 9246, ledger, true);
  for (std::size_t l = 0; l < law_names.size(); ++l)
    EXPECT_EQ(ledger.total(static_cast<Law>(l)).failures, 0u) << law_names[l];
}

INSTANTIATE_TEST_SUITE_P(On, ProvenLaws, testing::Range<std::uint64_t>(0, kinds), [](const auto& kind) {
  std::string name(generator_names[kind.param]);
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
});

int turning(GridPoint a, GridPoint b, GridPoint c) {
  __extension__ using Int128 = __int128;
  const Int128 det = (Int128(a.y) * b.z - Int128(a.z) * b.y) * c.x +
                     (Int128(a.z) * b.x - Int128(a.x) * b.z) * c.y +
                     (Int128(a.x) * b.y - Int128(a.y) * b.x) * c.z;
  return (det > 0) - (det < 0);
}

TEST(SmallScenes, AreWhatTheKernelAsksFor) {
  constexpr std::int64_t end = std::int64_t{1} << WorldGrid::coordinate_bits;
  std::int64_t largest = 0;
  for (std::uint64_t k = 0; k < 200 * kinds; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << seed() << ", scene " << k);
    const SmallScene scene = make_scene(seed(), k);
    ASSERT_EQ(scene.tubes.tubes.size(), tubes_per_scene);
    ASSERT_FALSE(scene.mesh.facets.empty());
    for (const GridPoint& p : scene.mesh.vertices)
      for (const std::int64_t d :
           {std::int64_t(p.x) - scene.tubes.apex.x, std::int64_t(p.y) - scene.tubes.apex.y,
            std::int64_t(p.z) - scene.tubes.apex.z}) {
        ASSERT_LE(std::abs(d), end);
        largest = std::max(largest, std::abs(d));
      }
    for (const GridPoint& ray : scene.tubes.rays)
      for (const std::int64_t d : {ray.x, ray.y, ray.z}) ASSERT_LE(std::abs(d), end);
    for (const Tube& tube : scene.tubes.tubes)
      for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t other = 2; other < 4; ++other)
          ASSERT_GT(turning(scene.tubes.rays[tube[r]], scene.tubes.rays[tube[(r + 1) % 4]],
                            scene.tubes.rays[tube[(r + other) % 4]]),
                    0);
    for (const auto& facet : scene.mesh.facets)
      for (const VertexId v : facet) ASSERT_LT(v, scene.mesh.vertices.size());
  }
  EXPECT_EQ(largest, end) << "no scene goes to the end of the range";
}

}  // namespace
}  // namespace tubefoot::prove
