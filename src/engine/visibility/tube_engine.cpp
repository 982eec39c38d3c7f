// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/visibility/tube_engine.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/visibility/bistatic_audit.hpp"
#include "engine/visibility/part_label.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "geometry/integrals/measure.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {

/// Buffers per thread. No task starts while one is in use, so nested parallel loops cannot enter it twice.
struct TubeEngine::Scratch {
  struct Buffers {
    VisibilityScratch visibility;
    TubeVisibility seen;
  };
  tbb::enumerable_thread_specific<Buffers> threads;
};

TubeEngine::TubeEngine(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                       const VisibilityOptions& options)
    : mesh_(mesh),
      tree_(tree),
      grid_unit_m_(grid_unit_m),
      options_(options),
      scratch_(std::make_unique<Scratch>()) {}

TubeEngine::~TubeEngine() = default;

History TubeEngine::trace(TubeSet tubes, std::size_t* candidates, bool measured,
                          const std::vector<bool>& wanted) const {
  const std::vector<TubeRun> runs = runs_of(tubes);
  std::vector<FootprintSet> per_run(runs.size());
  std::vector<std::size_t> looked_at(runs.size());
  Steps steps("tubes", tubes.tubes.size());
  const auto is_wanted = [&](std::uint32_t tube) { return wanted.empty() || wanted[tube]; };
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t run) {
    bool any = false;
    for (std::uint32_t tube = runs[run].first; tube < runs[run].end; ++tube) any = any || is_wanted(tube);
    if (!any) return;
    auto& [visibility, sees] = scratch_->threads.local();
    const TubeVisibility& seen = sees;  // a lambda may refer to it by this name
    see_run(mesh_, tree_, tubes, runs[run], options_, visibility, sees, [&](std::uint32_t tube) {
      if (!is_wanted(tube)) return;
      append_footprints(mesh_, tubes, tube, seen, grid_unit_m_, per_run[run], options_.corner_names);
      looked_at[run] += seen.candidates;
      steps.done();
    });
    if (measured) measure(per_run[run]);
  });
  History history;
  history.footprints = joined(per_run);
  if (candidates)
    for (const std::size_t n : looked_at) *candidates += n;
  history.tubes = std::move(tubes);
  history.grid_unit_m = grid_unit_m_;
  return history;
}

std::vector<TubeAudit> TubeEngine::audit(const TubeSet& tubes, std::uint64_t label) const {
  VisibilityOptions options = options_;
  options.open_water = true;
  std::vector<TubeAudit> audits(tubes.tubes.size());
  Steps steps("tubes", tubes.tubes.size());
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(tubes.tubes.size()),
                    [&](std::uint32_t tube) {
                      auto& [visibility, seen] = scratch_->threads.local();
                      see(mesh_, tree_, tubes, tube, options, visibility, seen);
                      audits[tube] = tubefoot::audit(mesh_, tubes, tube, seen, label_of_part(label, tube));
                      steps.done();
                    });
  return audits;
}

}  // namespace tubefoot
