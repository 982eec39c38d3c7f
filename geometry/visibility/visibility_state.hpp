// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "geometry/visibility/candidate_facets.hpp"
#include "geometry/visibility/visibility.hpp"

// One solver per arithmetic, each in a separate translation unit. The other units do not include the header
// files of its number types.
namespace tubefoot {

/// Tubes that are computed together, and the rays of a pyramid that contains them. The pyramid of a single
/// tube is the tube itself.
struct TubesInPyramid {
  std::array<GridPoint, 4> pyramid;
  std::span<const std::array<GridPoint, 4>> tubes;
};

class TubeSolver {
 public:
  virtual ~TubeSolver() = default;
  /// Starts the following runs with new candidate facets, which must outlive them.
  virtual void begin(const FacetMesh& mesh, GridPoint apex, CandidateFacets& candidate_facets) = 0;
  /// Computes tubes that share the candidate facets. `out` has one result per tube, which is overwritten.
  virtual void run(const VisibilityOptions& options, const TubesInPyramid& tubes,
                   std::span<TubeVisibility> out) = 0;
};

std::unique_ptr<TubeSolver> make_fixed_solver();
std::unique_ptr<TubeSolver> make_filtered_solver();
std::unique_ptr<TubeSolver> make_rational_solver();
std::unique_ptr<TubeSolver> make_double_solver();

}  // namespace tubefoot
