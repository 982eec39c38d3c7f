// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/visibility.hpp"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "geometry/visibility/visibility_state.hpp"

// Runs the visibility algorithm for a tube or for a run of neighbouring tubes, with the selected arithmetic.
// The tubes of a run are computed in one pyramid; a run too wide for a pyramid is divided in halves.

namespace tubefoot {
namespace {

constexpr std::array<std::pair<Arithmetic, std::string_view>, 4> arithmetic_names{
    {{Arithmetic::fixed, "fixed"},
     {Arithmetic::filtered, "filtered"},
     {Arithmetic::rational, "rational"},
     {Arithmetic::plain_double, "double"}}};

/// Number of tubes of a run. Longer runs share more work, and shorter ones occupy more processors. The values
/// follow from measurements (validation/performance.md).
constexpr std::size_t fewest_tubes_a_run = 8, most_tubes_a_run = 32, runs_of_a_set = 32;

bool share_a_wall(const Tube& a, const Tube& b) {
  return std::count_if(a.begin(), a.end(),
                       [&](std::uint32_t ray) { return std::find(b.begin(), b.end(), ray) != b.end(); }) == 2;
}

/// Whether the middle of one tube lies within the other, up to rounding, as in beams wider than their
/// spacing.
bool overlap(const TubeSet& set, std::uint32_t a, std::uint32_t b) {
  glm::dvec3 middle{0};
  for (const GridPoint& ray : rays_of(set, b)) middle += glm::normalize(as_double(ray));
  const std::array<GridPoint, 4> rays = rays_of(set, a);
  for (std::size_t k = 0; k < 4; ++k)
    if (glm::dot(glm::cross(as_double(rays[k]), as_double(rays[(k + 1) % 4])), middle) < 0) return false;
  return true;
}

std::unique_ptr<TubeSolver> make_solver(Arithmetic arithmetic) {
  switch (arithmetic) {
    case Arithmetic::fixed:
      return make_fixed_solver();
    case Arithmetic::filtered:
      return make_filtered_solver();
    case Arithmetic::rational:
      return make_rational_solver();
    case Arithmetic::plain_double:
      return make_double_solver();
  }
  throw std::invalid_argument("unknown arithmetic");
}

}  // namespace

struct VisibilityScratch::State {
  std::array<std::unique_ptr<TubeSolver>, arithmetic_names.size()> solvers;
  CandidateFacets candidate_facets;
  std::vector<std::array<GridPoint, 4>> rays;  ///< of the tubes of the current run
  std::vector<TubeVisibility> seen;            ///< of the tubes of the current run
};

VisibilityScratch::VisibilityScratch() : state_(std::make_unique<State>()) {}
VisibilityScratch::~VisibilityScratch() = default;
VisibilityScratch::VisibilityScratch(VisibilityScratch&&) noexcept = default;

Arithmetic arithmetic_from_name(std::string_view name) {
  for (const auto& [arithmetic, text] : arithmetic_names)
    if (text == name) return arithmetic;
  throw std::invalid_argument("unknown arithmetic '" + std::string(name) +
                              "': choose fixed, filtered, rational or double");
}

std::string_view name_of(Arithmetic arithmetic) {
  for (const auto& [a, text] : arithmetic_names)
    if (a == arithmetic) return text;
  return "?";
}

void TubeVisibility::clear() {
  corners.clear();
  pieces.clear();
  open.clear();
  occluders.clear();
  rays.clear();
  candidates = 0;
}

namespace {

TubeSolver& solver_of(VisibilityScratch::State& state, Arithmetic arithmetic) {
  auto& solver = state.solvers[static_cast<std::size_t>(arithmetic)];
  if (!solver) solver = make_solver(arithmetic);
  return *solver;
}

}  // namespace

void see(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, std::uint32_t tube,
         const VisibilityOptions& options, VisibilityScratch& scratch, TubeVisibility& out) {
  see_run(mesh, tree, tubes, {tube, tube + 1}, options, scratch, out, [](std::uint32_t) {});
}

std::vector<TubeRun> runs_of(const TubeSet& tubes) {
  std::vector<TubeRun> runs;
  const std::size_t most =
      std::clamp(tubes.tubes.size() / runs_of_a_set, fewest_tubes_a_run, most_tubes_a_run);
  for (std::uint32_t tube = 0; tube < tubes.tubes.size(); ++tube) {
    if (!runs.empty() && tube - runs.back().first < most &&
        (share_a_wall(tubes.tubes[tube - 1], tubes.tubes[tube]) || overlap(tubes, tube - 1, tube)))
      runs.back().end = tube + 1;
    else
      runs.push_back({tube, tube + 1});
  }
  return runs;
}

void see_run(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, TubeRun run,
             const VisibilityOptions& options, VisibilityScratch& scratch, TubeVisibility& out,
             const std::function<void(std::uint32_t)>& take) {
  VisibilityScratch::State& state = scratch.state();
  const bool is_single = run.end - run.first == 1;
  std::optional<std::array<GridPoint, 4>> pyramid;
  if (is_single)
    pyramid = rays_of(tubes, run.first);
  else
    pyramid = enclosing_pyramid(tubes, run.first, run.end);
  if (!pyramid) {
    const std::uint32_t middle = run.first + (run.end - run.first) / 2;
    see_run(mesh, tree, tubes, {run.first, middle}, options, scratch, out, take);
    see_run(mesh, tree, tubes, {middle, run.end}, options, scratch, out, take);
    return;
  }
  state.candidate_facets.gather(mesh, tree, tubes.apex, tubes.reach, *pyramid, !options.open_water);
  TubeSolver& solver = solver_of(state, options.arithmetic);
  solver.begin(mesh, tubes.apex, state.candidate_facets);
  state.rays.clear();
  for (std::uint32_t tube = run.first; tube < run.end; ++tube) state.rays.push_back(rays_of(tubes, tube));
  if (is_single) {
    solver.run(options, {*pyramid, state.rays}, std::span(&out, 1));
    take(run.first);
    return;
  }
  const std::size_t count = run.end - run.first;
  if (state.seen.size() < count) state.seen.resize(count);
  solver.run(options, {*pyramid, state.rays}, std::span(state.seen).first(count));
  for (std::size_t k = 0; k < count; ++k) {
    std::swap(out, state.seen[k]);
    take(run.first + static_cast<std::uint32_t>(k));
    std::swap(out, state.seen[k]);
  }
}

}  // namespace tubefoot
