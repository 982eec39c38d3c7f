// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "validation/case.hpp"
#include "validation/kernel_run.hpp"

namespace tubefoot::atlas {

/// Embree as a ray engine in a hurry uses it: absolute float coordinates in metres, rays from the apex on,
/// the first hit counts. (src/engine/rays/ray_engine subtracts the grid's origin and passes through facets
/// whose plane holds the apex.)
class NaiveRays {
 public:
  enum class Flags { usual, robust };
  /// Throws std::runtime_error if Embree fails.
  NaiveRays(const Case& scene, Flags flags);
  ~NaiveRays();
  NaiveRays(const NaiveRays&) = delete;
  NaiveRays& operator=(const NaiveRays&) = delete;

  /// The facet met, or nothing_there. `direction` need not be a unit vector.
  FacetId first_hit(glm::dvec3 direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One point in each cell of an n x n grid over the unit square, uniform, from a seed.
std::vector<glm::dvec2> stratified(std::uint32_t n, std::uint64_t seed);

/// What sampling costs, whoever samples: the error of the exact answer, read off at the sample points.
struct Sampling {
  std::uint32_t n = 0;             ///< n x n rays a tube
  double mean = 0, deviation = 0;  ///< of the error, over several draws
};
Sampling sampling_error(const CommonVisibility& truth, std::uint32_t n);

struct RayResult {
  double error = 0;  ///< as error_of, from the numbers of hits
  std::size_t rays = 0,
              wrong = 0;  ///< rays, and those that met another facet than the exact answer has there
};
RayResult shoot(const Case& scene, const CommonVisibility& truth, NaiveRays::Flags flags, std::uint32_t n);

/// Whether rays fail beyond their noise: the error lies more than 5 deviations above what sampling costs, or
/// the wrong rays are more than 5 of their own standard deviations (the root of their number).
bool fails(const RayResult& result, const Sampling& sampling);

}  // namespace tubefoot::atlas
