// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "geometry/facet_cone.hpp"
#include "geometry/height_sheets.hpp"
#include "geometry/visibility_state.hpp"

namespace tubefoot {
namespace {

constexpr std::array<std::pair<Arithmetic, std::string_view>, 4> arithmetic_names{
    {{Arithmetic::fixed, "fixed"},
     {Arithmetic::filtered, "filtered"},
     {Arithmetic::rational, "rational"},
     {Arithmetic::plain_double, "double"}}};

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
  throw std::invalid_argument("no such arithmetic");
}

}  // namespace

struct VisibilityScratch::State {
  std::array<std::unique_ptr<TubeSolver>, arithmetic_names.size()> solvers;
  std::vector<FacetId> candidates, hidden;
  HeightSheets::View sheets;
};

VisibilityScratch::VisibilityScratch() : state_(std::make_unique<State>()) {}
VisibilityScratch::~VisibilityScratch() = default;
VisibilityScratch::VisibilityScratch(VisibilityScratch&&) noexcept = default;

Arithmetic arithmetic_from_name(std::string_view name) {
  for (const auto& [arithmetic, text] : arithmetic_names)
    if (text == name) return arithmetic;
  throw std::invalid_argument("no arithmetic named '" + std::string(name) +
                              "': fixed, filtered, rational or double");
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

void see(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, std::uint32_t tube,
         const VisibilityOptions& options, VisibilityScratch& scratch, TubeVisibility& out) {
  out.clear();
  for (const std::uint32_t ray : tubes.tubes.at(tube)) out.rays.push_back(tubes.rays[ray]);
  std::array<SceneTree::HalfSpace, 4> walls;
  for (int k = 0; k < 4; ++k) {
    const Vec64 n = cross(out.rays[k], out.rays[(k + 1) % 4]);
    walls[k] = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
  }
  VisibilityScratch::State& state = scratch.state();
  state.candidates.clear();
  tree.query(tubes.apex, walls, tubes.reach, state.candidates);
  state.hidden.clear();
  if (const HeightSheets* sheets = tree.sheets()) {
    sheets->look(mesh, tree, tubes.apex, {out.rays[0], out.rays[1], out.rays[2], out.rays[3]}, walls,
                 state.sheets);
    std::erase_if(state.candidates, [&](FacetId facet) {
      const bool hidden = sheets->surely_hidden(mesh, facet, tubes.apex, state.sheets);
      if (hidden) state.hidden.push_back(facet);
      return hidden;
    });
  }
  // The tree's order is the standard library's business; ours must not depend on it.
  std::sort(state.candidates.begin(), state.candidates.end());
  if (options.open_water) std::sort(state.hidden.begin(), state.hidden.end());
  auto& solver = state.solvers[static_cast<std::size_t>(options.arithmetic)];
  if (!solver) solver = make_solver(options.arithmetic);
  solver->run(mesh, tubes.apex, state.candidates, state.hidden, options, out);
}

}  // namespace tubefoot
