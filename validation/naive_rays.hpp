// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "validation/case.hpp"
#include "validation/kernel_run.hpp"

namespace tubefoot::atlas {

/// Embree in the simplest use by a ray engine: absolute float coordinates in metres, rays that start at the
/// apex, first hit only. (src/engine/rays/ray_engine subtracts the origin of the grid and ignores facets
/// whose plane contains the apex.)
class NaiveRays {
 public:
  enum class Flags { usual, robust };
  /// Throws std::runtime_error if Embree fails.
  NaiveRays(const Case& scene, Flags flags);
  ~NaiveRays();
  NaiveRays(const NaiveRays&) = delete;
  NaiveRays& operator=(const NaiveRays&) = delete;

  /// Returns the facet that was hit, or nothing_there. `direction` need not be a unit vector.
  FacetId first_hit(glm::dvec3 direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns one uniform point in each cell of an n x n grid over the unit square, from a seed.
std::vector<glm::dvec2> stratified(std::uint32_t n, std::uint64_t seed);

/// Error of sampling for every method: the error of the exact result evaluated at the sample points.
struct Sampling {
  std::uint32_t n = 0;             ///< n x n rays per tube
  double mean = 0, deviation = 0;  ///< of the error, over several draws
};
Sampling sampling_error(const CommonVisibility& truth, std::uint32_t n);

struct RayResult {
  double error = 0;  ///< as error_of, from the numbers of hits
  std::size_t rays = 0,
              wrong = 0;  ///< number of rays, and of those whose facet differs from the exact result
};
RayResult shoot(const Case& scene, const CommonVisibility& truth, NaiveRays::Flags flags, std::uint32_t n);

/// Returns whether rays fail beyond their sampling noise. Either the error exceeds the mean sampling error by
/// more than 5 deviations, or more than 25 rays are wrong. The number 25 is 5 times its standard deviation,
/// which is its root.
bool fails(const RayResult& result, const Sampling& sampling);

}  // namespace tubefoot::atlas
