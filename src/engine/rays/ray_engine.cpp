// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_engine.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>

#include "engine/rays/adaptive_rays.hpp"
#include "engine/rays/ray_guide.hpp"
#include "engine/rays/ray_tracing.hpp"
#include "geometry/steps/steps.hpp"

// Traces rays in parallel tasks and returns their hits in a fixed order. Rays are processed in portions that
// fit the cache. Adaptive rays are traced in two passes, first the pilots and then the others.

namespace tubefoot {
namespace {

/// Hits of chunks of rays, consecutive in one array of blocks. A chunk that starts when all earlier ones are
/// finished writes at its final position. Other chunks write to free memory. Their hits are moved as soon as
/// the earlier chunks are finished, while the hits are still in the cache.
class HitsInOrder {
 public:
  /// `stride` is the maximum number of blocks of a chunk.
  HitsInOrder(HitBlock* blocks, std::size_t stride, std::int64_t chunks)
      : blocks_(blocks), last_(blocks), stride_(stride), parts_(std::size_t(chunks)) {}

  HitBlock* begin(std::int64_t c) {
    const std::lock_guard lock(mutex_);
    return parts_[c].begin = c == next_ ? last_ : blocks_ + std::size_t(c) * stride_;
  }
  void end(std::int64_t c, HitBlock* end) {
    const std::lock_guard lock(mutex_);
    parts_[c].end = end;
    for (; next_ < std::int64_t(parts_.size()) && parts_[next_].end != nullptr; ++next_) {
      const Part& part = parts_[next_];
      last_ = part.begin == last_ ? part.end : std::move(part.begin, part.end, last_);
    }
  }
  std::size_t blocks() const { return std::size_t(last_ - blocks_); }

 private:
  struct Part {
    HitBlock *begin = nullptr, *end = nullptr;
  };
  HitBlock *blocks_, *last_;
  std::size_t stride_;
  std::int64_t next_ = 0;  // the first unfinished chunk
  std::vector<Part> parts_;
  std::mutex mutex_;
};

/// Returns the number of rays in memory at a time: about as many as have their hits in a processor's own
/// cache, or four tasks.
std::int64_t portion_of(std::int64_t task) { return std::max(std::int64_t{1} << 16, 4 * task); }

constexpr std::int64_t adaptive_task = 1 << 11, adaptive_portion = std::int64_t{1} << 16;

std::int64_t portions(std::int64_t rays, std::int64_t portion) { return (rays + portion - 1) / portion; }

/// Origin and end of the rays of a transmission or of an image of it.
struct RayRoute {
  const RayScene::State& scene;
  GridPoint apex;
  double reach_m;
  const RaysOnwards* onwards;

  RayRoute(const RayScene& rays, const History& history, const RaysOnwards* over)
      : scene(rays.state()),
        apex(over != nullptr ? over->apex : history.tubes.apex),
        reach_m(history.tubes.reach * history.grid_unit_m),
        onwards(over) {}
  template <class Source>
  void trace(Source source, HitWriter& hits) const {
    scene.trace(
        apex, reach_m, [&](RayPacket& packet) { return source.next(packet); }, hits, onwards);
  }
};

/// Traces rays [first, end), which `source(first, end)` generates, and writes the hits in their order.
/// `chunk` is the number of rays per task.
template <class Source>
void trace_all(const RayRoute& route, std::int64_t first, std::int64_t end, std::int64_t chunk, RayHits& hits,
               const Source& source) {
  const std::int64_t rays = end - first, chunks = (rays + chunk - 1) / chunk;
  const std::size_t stride = HitWriter::most_blocks(std::size_t(chunk));
  HitsInOrder in_order(hits.room_for(std::size_t(chunks) * stride), stride, chunks);
  tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t c) {
    stop_if_wanted();
    const std::int64_t begin = first + c * chunk;
    HitWriter writer(in_order.begin(c));
    route.trace(source(begin, std::min(begin + chunk, end)), writer);
    in_order.end(c, writer.end());
  });
  hits.resize(in_order.blocks());
}

/// Traces the pilots of adaptive rays and stores their hits per task.
class Pilots {
 public:
  Pilots(const RayRoute& route, const AdaptiveRays& rays, const RayGuide* guide)
      : met_(std::size_t(rays.pilots())), tasks_(std::size_t((rays.pilots() + task_rays - 1) / task_rays)) {
    tbb::parallel_for(std::size_t{0}, tasks_.size(), [&](std::size_t t) {
      stop_if_wanted();
      Task& task = tasks_[t];
      task.first = std::int64_t(t) * task_rays;
      const std::int64_t end = std::min(task.first + task_rays, rays.pilots());
      task.number.resize(std::size_t(end - task.first));
      HitBlock* const blocks = task.hits.room_for(HitWriter::most_blocks(task.number.size()));
      HitWriter writer(blocks, task.number.data());
      route.trace(AdaptiveRays::Source(rays, true, task.first, end), writer);
      task.hits.resize(std::size_t(writer.end() - blocks));
      std::size_t k = 0;
      for (const RayHit hit : task.hits)
        met_[std::size_t(task.first + task.number[k++])] = echo_of(hit, route.scene.mesh, guide);
    });
  }
  const std::vector<PilotEcho>& met() const { return met_; }

  /// Passes the hits on in portions. The weight of each pilot becomes that of one ray of its cell.
  template <class Take>
  void hand_over(const AdaptiveRays& rays, RayHits& hits, const Take& take) {
    constexpr std::size_t tasks_a_portion = adaptive_portion / task_rays;
    for (std::size_t first = 0; first < tasks_.size(); first += tasks_a_portion) {
      hits.resize(0);
      for (std::size_t t = first; t < std::min(first + tasks_a_portion, tasks_.size()); ++t) {
        Task& task = tasks_[t];
        std::size_t k = 0;
        for (HitBlock& block : task.hits.blocks())
          for (std::size_t lane = 0; lane < block.count; ++lane)
            block.solid_angle_sr[lane] /= double(rays.rays_in(task.first + task.number[k++]));
        hits.append(task.hits.blocks());
        task = {};
      }
      take();
    }
  }

 private:
  static constexpr std::int64_t task_rays = adaptive_task;
  struct Task {
    std::int64_t first = 0;
    RayHits hits;
    std::vector<std::uint32_t> number;  // number of the ray of each hit
  };
  static PilotEcho echo_of(const RayHit& hit, const FacetMesh& mesh, const RayGuide* guide) {
    const double r = hit.slant_range_m;
    double strength = hit.sine_grazing / (r * r), half_path = r;
    if (guide != nullptr) {
      if (hit.facet < mesh.material.size() && mesh.material[hit.facet] < guide->material_strength.size())
        strength *= guide->material_strength[mesh.material[hit.facet]];
      if (guide->receiver_m != glm::dvec3(0))
        half_path = (r + glm::length(r * glm::dvec3(hit.direction) - guide->receiver_m)) / 2;
      strength *= std::exp(-2 * guide->absorption_per_m * half_path);
    }
    return {float(half_path), float(strength)};
  }

  std::vector<PilotEcho> met_;
  std::vector<Task> tasks_;
};

void trace_adaptive(const RayScene& scene, History& history, const RaySettings& settings,
                    std::span<const std::uint32_t> beam_of_tube, const std::function<void()>& take,
                    const RaysOnwards* onwards, const RayGuide* guide) {
  constexpr std::int64_t portion = adaptive_portion;
  AdaptiveRays rays(history.tubes, settings, beam_of_tube, guide);
  const RayRoute route(scene, history, onwards);
  Steps steps("portions of rays",
              std::size_t(portions(rays.pilots(), portion) + portions(rays.others(), portion)));
  {
    Pilots pilots(route, rays, guide);
    rays.deal(pilots.met());
    pilots.hand_over(rays, history.hits, [&] {
      take();
      steps.done();
    });
  }
  for (std::int64_t first = 0; first < rays.others(); first += portion) {
    trace_all(
        route, first, std::min(first + portion, rays.others()), adaptive_task, history.hits,
        [&](std::int64_t begin, std::int64_t end) { return AdaptiveRays::Source(rays, false, begin, end); });
    take();
    steps.done();
  }
}

}  // namespace

void trace_rays(const RayScene& scene, const RayPlan& plan, std::int64_t first, std::int64_t end,
                History& history, const RaysOnwards* onwards) {
  trace_all(RayRoute(scene, history, onwards), first, end, plan.rays_at_a_time(), history.hits,
            [&](std::int64_t begin, std::int64_t until) { return RaySource(plan, begin, until); });
}

void trace_rays(const RayScene& scene, History& history, const RaySettings& settings,
                std::span<const std::uint32_t> beam_of_tube, const std::function<void()>& take,
                const RaysOnwards* onwards, const RayGuide* guide) {
  if (settings.sampling == RaySampling::adaptive)
    return trace_adaptive(scene, history, settings, beam_of_tube, take, onwards, guide);
  const RayPlan plan(history.tubes, settings, beam_of_tube);
  const std::int64_t portion = portion_of(plan.rays_at_a_time());
  Steps steps("portions of rays", std::size_t(portions(plan.rays(), portion)));
  for (std::int64_t first = 0; first < plan.rays(); first += portion) {
    trace_rays(scene, plan, first, std::min(first + portion, plan.rays()), history, onwards);
    take();
    steps.done();
  }
}

History trace_rays(const RayScene& scene, TubeSet tubes, double grid_unit_m, const RaySettings& settings,
                   std::span<const std::uint32_t> beam_of_tube, const RayGuide* guide) {
  History history;
  history.tubes = std::move(tubes);
  history.grid_unit_m = grid_unit_m;
  if (settings.sampling == RaySampling::adaptive) {
    RayHits all;
    trace_adaptive(
        scene, history, settings, beam_of_tube, [&] { all.append(history.hits.blocks()); }, nullptr, guide);
    history.hits = std::move(all);
    return history;
  }
  const RayPlan plan(history.tubes, settings, beam_of_tube);
  trace_rays(scene, plan, 0, plan.rays(), history);
  return history;
}

}  // namespace tubefoot
