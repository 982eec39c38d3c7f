// SPDX-License-Identifier: GPL-3.0-or-later
// Benchmark of speed and memory. It writes medians of interleaved repetitions in one run to figures.json
// next to the program.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "allocations.hpp"
#include "chart_figures.hpp"
#include "coverage_figures.hpp"
#include "didson_figures.hpp"
#include "engine/echo/echo.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "envelope.hpp"
#include "fresnel_figures.hpp"
#include "geometry/footprints/footprint_builder.hpp"
#include "gradient_figures.hpp"
#include "motion_figures.hpp"
#include "moving_figures.hpp"
#include "multibeam_figures.hpp"
#include "pure_embree.hpp"
#include "refraction_figures.hpp"
#include "relief_figures.hpp"
#include "run/console/exhausted.hpp"
#include "scaling_figures.hpp"
#include "survey_figures.hpp"
#include "terrain.hpp"
#include "timing.hpp"
#include "water_figures.hpp"

namespace {

using namespace tubefoot;

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Runs all works in turn, `repeats` times, and returns the median time of each.
std::vector<double> interleaved(int repeats, const std::vector<std::function<void()>>& works) {
  std::vector<std::vector<double>> times(works.size());
  for (int r = -1; r < repeats; ++r)  // the first round warms up
    for (std::size_t w = 0; w < works.size(); ++w) {
      const double t = milliseconds(works[w]);
      if (r >= 0) times[w].push_back(t);
    }
  std::vector<double> medians;
  for (const auto& t : times) medians.push_back(median(t));
  return medians;
}

/// Computes a whole sector from candidates to finished pieces, with a tree built before.
struct View {
  explicit View(FacetMesh m, int columns = 1) : View(std::move(m), benchmark_sector(columns)) {}
  View(FacetMesh m, TubeSet t) : mesh(std::move(m)), tree(mesh), tubes(std::move(t)) {}
  void look(Arithmetic arithmetic, double tolerance = 0) {
    VisibilityOptions options;
    options.arithmetic = arithmetic;
    options.tolerance = tolerance;
    pieces = 0;
    for (const TubeRun run : runs_of(tubes))
      see_run(mesh, tree, tubes, run, options, scratch, seen,
              [this](std::uint32_t) { pieces += seen.pieces.size(); });
  }
  FacetMesh mesh;
  SceneTree tree;
  TubeSet tubes;
  VisibilityScratch scratch;
  TubeVisibility seen;
  std::size_t pieces = 0;
};

struct FootprintMemory {
  double bytes = 0, allocations = 0;  ///< per footprint
};

/// Measures the bytes of the footprints of a ping, and the number of allocations when the ping is repeated
/// into the same buffers.
FootprintMemory footprint_memory(View& view) {
  FootprintSet set;
  const auto ping = [&] {
    set.footprints.clear();
    set.pieces.clear();
    set.corners_m.clear();
    set.occluders.clear();
    for (std::uint32_t tube = 0; tube < view.tubes.tubes.size(); ++tube) {
      see(view.mesh, view.tree, view.tubes, tube, {}, view.scratch, view.seen);
      append_footprints(view.mesh, view.tubes, tube, view.seen, std::ldexp(1.0, -terrain_grid_exponent), set);
    }
  };
  for (int warm_up = 0; warm_up < 3; ++warm_up) ping();
  constexpr int pings = 5;
  const std::uint64_t before = allocations();
  for (int k = 0; k < pings; ++k) ping();
  const std::uint64_t requested = allocations() - before;
  const auto bytes = [](const auto& v) { return static_cast<double>(v.size() * sizeof(v[0])); };
  const auto footprints = static_cast<double>(set.footprints.size());
  return {
      (bytes(set.footprints) + bytes(set.pieces) + bytes(set.corners_m) + bytes(set.occluders)) / footprints,
      static_cast<double>(requested) / (pings * footprints)};
}

}  // namespace

int main(int, char** argv) {
  configure_heap();
  nlohmann::ordered_json figures;
  const auto figure = [&](const std::string& name, double value) {
    figures[name] = value;
    fmt::print("{:<40} {:.4g}\n", name, value);
    std::fflush(stdout);
  };
  survey_figures(figure);
  coverage_figures(figure);
  relief_figures(figure);
  scaling_figures(figure);
  // Gives the correct topology on this terrain; validation/performance.md.
  constexpr double tuned_tolerance = 1e-14;
  {
    View sector(benchmark_terrain(200)), beams(benchmark_terrain(200), 96);
    const auto t =
        interleaved(15, {[&] { sector.look(Arithmetic::fixed); }, [&] { sector.look(Arithmetic::filtered); },
                         [&] { sector.look(Arithmetic::plain_double, tuned_tolerance); },
                         [&] { beams.look(Arithmetic::fixed); }});
    figure("visibility_ms_n200_fixed", t[0]);
    figure("fixed_over_double", t[0] / t[2]);
    figure("filtered_over_double", t[1] / t[2]);
    figure("visibility_ms_n200_fixed_96_beams", t[3]);
    const WorldGrid grid(terrain_grid_exponent, glm::dvec3(0));
    const RayScene rays(sector.mesh, grid);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const PureEmbree pure(sector.mesh, sector.tubes, grid.unit_m(), 1000);
    const std::vector<double> mu{0.001};
    const std::vector<std::uint32_t> one_beam{0};
    const auto rays_of = [&](const std::function<void(const History&)>& take) {
      History history;
      history.tubes = sector.tubes;
      history.grid_unit_m = grid.unit_m();
      trace_rays(rays, history, {RaySampling::stratified, 1000000}, {}, [&] { take(history); });
    };
    const auto m = interleaved(
        9, {[&] { rays_of([](const History&) {}); }, [&] { pure.trace(); },
            [&] {
              rays_of([&](const History& history) {
                integrate_echo(history, {1, one_beam}, {1, 20.0 / 512, 512}, {mu, sector.mesh.material, 0.1});
              });
            }});
    figure("embree_million_rays_ms", m[0]);
    figure("pure_embree_million_rays_ms", m[1]);
    figure("embree_million_rays_with_echo_ms", m[2]);
    const auto bytes = [](const auto& v) { return static_cast<double>(v.capacity() * sizeof(v[0])); };
    const FacetMesh& mesh = sector.mesh;
    figure("bytes_per_facet", (bytes(mesh.vertices) + bytes(mesh.facets) + bytes(mesh.material) +
                               bytes(mesh.component) + static_cast<double>(sector.tree.bytes())) /
                                  static_cast<double>(mesh.facets.size()));
    const FootprintMemory memory = footprint_memory(beams);
    figure("bytes_per_footprint", memory.bytes);
    figure("allocations_per_footprint_steady", memory.allocations);
  }
  // About 270 facets: few large ones, or many small ones.
  figure("envelope_over_fixed", envelope_over_fixed(benchmark_terrain(20), benchmark_sector(1), 0));
  figure("envelope_over_fixed_beam", envelope_over_fixed(benchmark_terrain(200), benchmark_sector(150), 75));
  {
    View small(benchmark_terrain(200)), middle(benchmark_terrain(400)), large(benchmark_terrain(800));
    const auto t =
        interleaved(5, {[&] { small.look(Arithmetic::fixed); }, [&] { middle.look(Arithmetic::fixed); },
                        [&] { large.look(Arithmetic::fixed); }});
    figure("visibility_ms_n400_fixed", t[1]);
    figure("visibility_ms_n800_fixed", t[2]);
    figure("growth_per_fourfold", std::sqrt(t[2] / t[0]));
  }
  {
    View bare(benchmark_terrain(200)), buried(benchmark_terrain(200, 9));
    const auto t =
        interleaved(7, {[&] { bare.look(Arithmetic::fixed); }, [&] { buried.look(Arithmetic::fixed); }});
    figure("hidden_tenfold", t[1] / t[0]);
  }
  {
    View half(benchmark_interlaced_strips(400), interlaced_strips_tube()),
        whole(benchmark_interlaced_strips(800), interlaced_strips_tube());
    const auto t =
        interleaved(5, {[&] { half.look(Arithmetic::fixed); }, [&] { whole.look(Arithmetic::fixed); }});
    figure("weave_ms_n800", t[1]);
    figure("weave_growth", t[1] / t[0]);
    figure("weave_growth_of_pieces", static_cast<double>(whole.pieces) / static_cast<double>(half.pieces));
  }
  {
    const FacetMesh mesh = benchmark_terrain(200);
    const SceneTree tree(mesh);
    const TubeEngine engine(mesh, tree, std::ldexp(1.0, -terrain_grid_exponent), {});
    const auto survey = [&](std::size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      tbb::parallel_for(0, 16, [&](int) { engine.trace(benchmark_sector(1)); });
    };
    const auto t = interleaved(5, {[&] { survey(1); }, [&] { survey(2); }});
    figure("two_thread_speedup", t[0] / t[1]);
  }
  multibeam_figures(figure);
  refraction_figures(figure);
  didson_figures(figure);
  gradient_figures(figure);
  motion_figures(figure);
  moving_figures(figure);
  water_figures(figure);
  fresnel_figures(figure);
  chart_figures(figure);
  const std::filesystem::path file = std::filesystem::path(argv[0]).parent_path() / "figures.json";
  std::ofstream out(file);
  out << figures.dump(2) << "\n";
  out.close();
  if (!out) {
    fmt::print(stderr, "cannot write {}\n", file.string());
    return 1;
  }
  fmt::print("wrote {}\n", file.string());
  return 0;
}
