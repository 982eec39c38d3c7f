// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/visibility/candidate_facets.hpp"
#include "geometry/visibility/visibility.hpp"

// One solver per arithmetic, each in a translation unit of its own: heavy number types stay out of the
// others.
namespace tubefoot {

class TubeSolver {
 public:
  virtual ~TubeSolver() = default;
  /// A new gathering, for the runs that follow; it must outlive them.
  virtual void begin(const FacetMesh& mesh, GridPoint apex, const CandidateFacets& candidate_facets) = 0;
  /// One tube of those gathered for: out.rays holds its rays.
  virtual void run(const VisibilityOptions& options, TubeVisibility& out) = 0;
};

std::unique_ptr<TubeSolver> make_fixed_solver();
std::unique_ptr<TubeSolver> make_filtered_solver();
std::unique_ptr<TubeSolver> make_rational_solver();
std::unique_ptr<TubeSolver> make_double_solver();

}  // namespace tubefoot
