// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/visibility/candidate_facets.hpp"
#include "geometry/visibility/visibility.hpp"

// One solver per arithmetic, each in a separate translation unit. The other units do not include the header
// files of its number types.
namespace tubefoot {

class TubeSolver {
 public:
  virtual ~TubeSolver() = default;
  /// Starts the following runs with new candidate facets, which must outlive them.
  virtual void begin(const FacetMesh& mesh, GridPoint apex, const CandidateFacets& candidate_facets) = 0;
  /// Computes one tube of those that share the candidate facets. out.rays has its rays.
  virtual void run(const VisibilityOptions& options, TubeVisibility& out) = 0;
};

std::unique_ptr<TubeSolver> make_fixed_solver();
std::unique_ptr<TubeSolver> make_filtered_solver();
std::unique_ptr<TubeSolver> make_rational_solver();
std::unique_ptr<TubeSolver> make_double_solver();

}  // namespace tubefoot
