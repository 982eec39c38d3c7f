// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/arithmetic_double.hpp"
#include "geometry/visibility/visibility_solver.hpp"
#include "geometry/visibility/visibility_state.hpp"

namespace tubefoot {
namespace {

class DoubleSolver final : public TubeSolver {
 public:
  void begin(const FacetMesh& mesh, GridPoint apex, CandidateFacets& candidate_facets) override {
    solver_.begin(mesh, apex, candidate_facets);
  }
  void run(const VisibilityOptions& options, const TubesInPyramid& tubes,
           std::span<TubeVisibility> out) override {
    solver_.run(DoubleArithmetic{options.tolerance}, options, tubes, out);
  }

 private:
  VisibilitySolver<DoubleArithmetic> solver_;
};

}  // namespace

std::unique_ptr<TubeSolver> make_double_solver() { return std::make_unique<DoubleSolver>(); }

}  // namespace tubefoot
