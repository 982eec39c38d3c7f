// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/arithmetic_filtered.hpp"
#include "geometry/visibility/visibility_solver.hpp"
#include "geometry/visibility/visibility_state.hpp"

namespace tubefoot {
namespace {

class FilteredSolver final : public TubeSolver {
 public:
  void begin(const FacetMesh& mesh, GridPoint apex, CandidateFacets& candidate_facets) override {
    solver_.begin(mesh, apex, candidate_facets);
  }
  void run(const VisibilityOptions& options, const TubesInPyramid& tubes,
           std::span<TubeVisibility> out) override {
    const FilteredArithmetic::Guard guard;
    solver_.run(FilteredArithmetic{}, options, tubes, out);
  }

 private:
  VisibilitySolver<FilteredArithmetic> solver_;
};

}  // namespace

std::unique_ptr<TubeSolver> make_filtered_solver() { return std::make_unique<FilteredSolver>(); }

}  // namespace tubefoot
