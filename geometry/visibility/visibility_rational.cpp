// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/arithmetic_rational.hpp"
#include "geometry/visibility/visibility_solver.hpp"
#include "geometry/visibility/visibility_state.hpp"

namespace tubefoot {
namespace {

class RationalSolver final : public TubeSolver {
 public:
  void begin(const FacetMesh& mesh, GridPoint apex, CandidateFacets& candidate_facets) override {
    solver_.begin(mesh, apex, candidate_facets);
  }
  void run(const VisibilityOptions& options, const TubesInPyramid& tubes,
           std::span<TubeVisibility> out) override {
    solver_.run(RationalArithmetic{}, options, tubes, out);
  }

 private:
  VisibilitySolver<RationalArithmetic> solver_;
};

}  // namespace

std::unique_ptr<TubeSolver> make_rational_solver() { return std::make_unique<RationalSolver>(); }

}  // namespace tubefoot
