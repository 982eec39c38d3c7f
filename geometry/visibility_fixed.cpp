// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic_fixed.hpp"
#include "geometry/visibility_solver.hpp"
#include "geometry/visibility_state.hpp"

namespace tubefoot {
namespace {

class FixedSolver final : public TubeSolver {
 public:
  void run(const FacetMesh& mesh, GridPoint apex, const std::vector<FacetId>& candidates,
           const std::vector<FacetId>& hidden, const VisibilityOptions& options,
           TubeVisibility& out) override {
    solver_.run(FixedArithmetic{}, mesh, apex, candidates, hidden, options, out);
  }

 private:
  VisibilitySolver<FixedArithmetic> solver_;
};

}  // namespace

std::unique_ptr<TubeSolver> make_fixed_solver() { return std::make_unique<FixedSolver>(); }

}  // namespace tubefoot
