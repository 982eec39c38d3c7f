// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/visibility.hpp"

// One solver per arithmetic, each in a translation unit of its own: heavy number types stay out of the
// others.
namespace tubefoot {

class TubeSolver {
 public:
  virtual ~TubeSolver() = default;
  /// `hidden`: facets that are known to be hidden by candidates; only the search for open water looks at
  /// them.
  virtual void run(const FacetMesh& mesh, GridPoint apex, const std::vector<FacetId>& candidates,
                   const std::vector<FacetId>& hidden, const VisibilityOptions& options,
                   TubeVisibility& out) = 0;
};

std::unique_ptr<TubeSolver> make_fixed_solver();
std::unique_ptr<TubeSolver> make_filtered_solver();
std::unique_ptr<TubeSolver> make_rational_solver();
std::unique_ptr<TubeSolver> make_double_solver();

}  // namespace tubefoot
