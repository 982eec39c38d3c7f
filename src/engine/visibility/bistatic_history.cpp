// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/visibility/bistatic_history.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <utility>

#include "engine/surface/facet_flattening.hpp"
#include "engine/visibility/looks.hpp"
#include "engine/water/apparent_map.hpp"
#include "geometry/steps/steps.hpp"
#include "geometry/visibility/contradictions.hpp"

namespace tubefoot {
std::vector<TubeVisibility> look(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                                 const VisibilityOptions& options) {
  struct Buffers {
    VisibilityScratch visibility;
    TubeVisibility seen;
  };
  std::vector<TubeVisibility> all(tubes.tubes.size());
  tbb::enumerable_thread_specific<Buffers> threads;
  Steps steps("tubes", all.size());
  // Tubes of a run would have other pieces, and the published answers of the suite other last digits.
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(all.size()), [&](std::uint32_t tube) {
    auto& [scratch, seen] = threads.local();
    see(mesh, tree, tubes, tube, options, scratch, seen);
    all[tube] = seen;  // a copy is no larger than its contents
    if (options.arithmetic == Arithmetic::plain_double) leave_out_contradictions(mesh, tubes.apex, all[tube]);
    steps.done();
  });
  return all;
}

BistaticHistory trace_bistatic(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               bool corner_rests) {
  BistaticHistory history{std::move(transmit), std::move(receive), grid_unit_m, {}};
  const auto sent = look(mesh, tree, history.transmit, options),
             received = look(mesh, tree, history.receive, options);
  history.shared = shared_by_all(FootprintSharer(mesh, {history.transmit, sent}, {history.receive, received},
                                                 grid_unit_m, {options.corner_names, corner_rests}));
  return history;
}

BistaticHistory trace_bistatic(const ApparentPair& pair, const WorldGrid& grid,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               const ApparentMap& transmit_water, const ApparentMap& receive_water,
                               double reference_absorption_db_per_m) {
  BistaticHistory history{std::move(transmit), std::move(receive), grid.unit_m(), {}};
  const FacetMesh &sent_to = pair.transmit.refined.mesh, &received_from = pair.receive.refined.mesh;
  const SceneTree sent_tree(sent_to, SceneTree::HeightFieldSearch::ignored),
      received_tree(received_from, SceneTree::HeightFieldSearch::ignored);
  const auto sent = look(sent_to, sent_tree, history.transmit, options),
             received = look(received_from, received_tree, history.receive, options);
  history.shared = shared_by_all(
      FootprintSharer({history.transmit, sent, &sent_to, pair.transmit_origin},
                      {history.receive, received, &received_from, pair.receive_origin}, grid.unit_m()));
  history.bistatic = bistatic_facets(history.shared, pair, grid, transmit_water, receive_water,
                                     reference_absorption_db_per_m);
  return history;
}

}  // namespace tubefoot
