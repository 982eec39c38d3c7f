// SPDX-License-Identifier: GPL-3.0-or-later
// Tests echoes in reused memory, and the record of their non-zero samples.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "engine/echo/echo.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "fixtures/geometry/grid_scenes.hpp"

namespace tubefoot {
namespace {

constexpr double unit = 0x1p-20;
const std::vector<double> buffer_material_mu{0.002};
const RangeSamples samples{2, 0.0625, 300};
const std::vector<std::uint32_t> beams{0, 1, 2, 3, 4, 5};

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}
bool all_zero(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return value == 0; });
}

class EchoBuffer : public testing::Test {
 protected:
  EchoBuffer() : mesh(rough()), tree(mesh) {}
  static FacetMesh rough() {
    test::Random random(20266);
    return test::rough_terrain(random, 10, 20000000, -3000000, 500000);
  }
  History history(GridPoint apex) const {
    return TubeEngine(mesh, tree, unit, {}).trace(test::forward_tubes(apex, 6, 1, 50, 30, 20));
  }
  EchoModel model() const { return {buffer_material_mu, mesh.material, 0.1}; }
  FacetMesh mesh;
  SceneTree tree;
};

TEST_F(EchoBuffer, HasTheSameEnergiesInUsedMemory) {
  std::vector<double> buffer;
  for (int k = 0; k < 6; ++k) {
    const History seen = history({0, 300000 * k, 200000 * k});
    // The number of range bins may change: the rest of the memory is zero again.
    const RangeSamples own{2, 0.0625 / (1 + k % 3), 300 * (1 + k % 3)};
    const Echo expected = integrate_echo(seen, {6, beams}, own, model());
    ASSERT_FALSE(all_zero(expected.energy));
    Echo made = integrate_echo(seen, {6, beams}, own, model(), {}, std::move(buffer));
    EXPECT_TRUE(same(made.energy, expected.energy)) << k;
    EXPECT_EQ(made.beams, 6);
    EXPECT_EQ(made.samples, own.count);
    buffer = cleared_buffer(std::move(made));
    EXPECT_TRUE(all_zero(buffer)) << k;
  }
}

TEST_F(EchoBuffer, IsZeroOutsideOfItsSpans) {
  const History seen = history({0, 0, 0});
  const Echo made = integrate_echo(seen, {6, beams}, samples, model(), {}, {});
  ASSERT_EQ(made.nonzero.size(), 6u);
  for (std::size_t row = 0; row < 6; ++row) {
    const auto [first, end] = made.nonzero[row];
    ASSERT_LT(first, end);
    ASSERT_LE(end, 300u);
    EXPECT_GT(first, 0u) << "a near sample in which nothing is";
    for (std::size_t k = 0; k < 300; ++k)
      if (k < first || k >= end) {
        EXPECT_EQ(made.energy[row * 300 + k], 0) << row << ", " << k;
      }
    EXPECT_NE(made.energy[row * 300 + first], 0) << "no sample to spare here";
  }
}

TEST_F(EchoBuffer, HasNoSpansWhereAllMayBeNonzero) {
  const History seen = history({0, 0, 0});
  for (const Binning binning : {Binning::spread, Binning::centroid}) {
    Echo made = integrate_echo(seen, {6, beams}, samples, model(), binning, {});
    EXPECT_TRUE(made.nonzero.empty());
    EXPECT_FALSE(all_zero(made.energy));
    EXPECT_TRUE(all_zero(cleared_buffer(std::move(made))));
  }
  History hit;
  hit.tubes = seen.tubes;
  hit.grid_unit_m = seen.grid_unit_m;
  hit.hits.push_back(
      {.facet = 0, .tube = 2, .slant_range_m = 9, .sine_grazing = 0.4, .solid_angle_sr = 0.01});
  Echo made = integrate_echo(hit, {6, beams}, samples, model(), {}, {});
  EXPECT_TRUE(made.nonzero.empty());
  EXPECT_FALSE(all_zero(made.energy));
  EXPECT_TRUE(all_zero(cleared_buffer(std::move(made))));
}

}  // namespace
}  // namespace tubefoot
