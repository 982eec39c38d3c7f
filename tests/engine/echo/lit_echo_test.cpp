// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `LitEcho`: an echo in reused memory, with a record of the non-empty sample range.
#include "engine/echo/lit_echo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"

namespace tubefoot {
namespace {

constexpr double unit = 0x1p-20;
const std::vector<double> lit_material_mu{0.002};
const RangeSamples samples{2, 0.0625, 300};
const std::vector<std::uint32_t> beams{0, 1, 2, 3, 4, 5};

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}
bool all_zero(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return value == 0; });
}

class LitEchoes : public testing::Test {
 protected:
  LitEchoes() : mesh(rough()), tree(mesh) {}
  static FacetMesh rough() {
    test::Random random(20266);
    return test::rough_terrain(random, 10, 20000000, -3000000, 500000);
  }
  History history(GridPoint apex) const {
    return TubeEngine(mesh, tree, unit, {}).trace(test::forward_tubes(apex, 6, 1, 50, 30, 20));
  }
  EchoModel model() const { return {lit_material_mu, mesh.material, 0.1}; }
  FacetMesh mesh;
  SceneTree tree;
};

TEST_F(LitEchoes, AreTheSameInMemoryOfOthers) {
  std::vector<double> room;
  for (int k = 0; k < 6; ++k) {
    const History seen = history({0, 300000 * k, 200000 * k});
    // The number of range bins may change: the rest of the memory is zero again.
    const RangeSamples own{2, 0.0625 / (1 + k % 3), 300 * (1 + k % 3)};
    const Echo expected = integrate_echo(seen, {6, beams}, own, model());
    ASSERT_FALSE(all_zero(expected.energy));
    LitEcho made = integrate_lit_echo(seen, {6, beams}, own, model(), {}, std::move(room));
    EXPECT_TRUE(same(made.echo.energy, expected.energy)) << k;
    EXPECT_EQ(made.echo.beams, 6);
    EXPECT_EQ(made.echo.samples, own.count);
    room = cleared_room(std::move(made));
    EXPECT_TRUE(all_zero(room)) << k;
  }
}

TEST_F(LitEchoes, AreZeroOutsideOfWhatIsLit) {
  const History seen = history({0, 0, 0});
  const LitEcho made = integrate_lit_echo(seen, {6, beams}, samples, model(), {}, {});
  ASSERT_EQ(made.lit.size(), 6u);
  for (std::size_t row = 0; row < 6; ++row) {
    const auto [first, end] = made.lit[row];
    ASSERT_LT(first, end);
    ASSERT_LE(end, 300u);
    EXPECT_GT(first, 0u) << "a near sample in which nothing is";
    for (std::size_t k = 0; k < 300; ++k)
      if (k < first || k >= end) {
        EXPECT_EQ(made.echo.energy[row * 300 + k], 0) << row << ", " << k;
      }
    EXPECT_NE(made.echo.energy[row * 300 + first], 0) << "no sample to spare here";
  }
}

TEST_F(LitEchoes, SayNothingWhereAllMayBeLit) {
  const History seen = history({0, 0, 0});
  for (const Binning binning : {Binning::spread, Binning::centroid}) {
    LitEcho made = integrate_lit_echo(seen, {6, beams}, samples, model(), binning, {});
    EXPECT_TRUE(made.lit.empty());
    EXPECT_FALSE(all_zero(made.echo.energy));
    EXPECT_TRUE(all_zero(cleared_room(std::move(made))));
  }
  History hit;
  hit.tubes = seen.tubes;
  hit.grid_unit_m = seen.grid_unit_m;
  hit.hits.push_back(
      {.facet = 0, .tube = 2, .slant_range_m = 9, .sine_grazing = 0.4, .solid_angle_sr = 0.01});
  LitEcho made = integrate_lit_echo(hit, {6, beams}, samples, model(), {}, {});
  EXPECT_TRUE(made.lit.empty());
  EXPECT_FALSE(all_zero(made.echo.energy));
  EXPECT_TRUE(all_zero(cleared_room(std::move(made))));
}

}  // namespace
}  // namespace tubefoot
