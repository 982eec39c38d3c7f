// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of beam patterns: one cycle of an acoustic camera over the benchmark terrain. It has 12 beams that
// transmit and receive simultaneously and receive from the whole sector, with 512 samples.
//
//     tubefoot_pattern_bench [facets a side] [tubes] [repetitions] [pattern]
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string>

#include "engine/echo/echo.hpp"
#include "engine/visibility/tube_engine.hpp"
#include "geometry/numbers/scalars.hpp"
#include "terrain.hpp"

namespace tubefoot {
namespace {

constexpr int beams = 12;

/// Beams of one cycle: every eighth of 96 beams over 29 degrees.
std::vector<Directivity> cycle(const Directivity& pattern) {
  std::vector<Directivity> made(beams, pattern);
  for (int b = 0; b < beams; ++b) made[b].centre = std::sin((-14.5 + 29.0 / 96 * (8 * b + 3.5)) * degree);
  return made;
}

std::shared_ptr<const PatternTable> table_with_floor() {
  std::vector<double> angle, level;
  for (int k = -40; k <= 40; ++k) {
    angle.push_back(0.1 * k * degree);
    level.push_back(std::max(-40.0, -12 * std::pow(0.1 * k / 0.3, 2)));
  }
  return std::make_shared<const PatternTable>(angle, level);
}

/// Returns the least processor time, which other programs disturb least.
template <class Run>
double best_ms(int repetitions, const Run& run) {
  double best = 1e300;
  for (int i = 0; i < repetitions; ++i) {
    const std::clock_t start = std::clock();
    run();
    best = std::min(best, 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

void measure_patterns(int n, int tubes, int repetitions, const std::string& only) {
  const FacetMesh mesh = benchmark_terrain(n);
  const SceneTree tree(mesh);
  AngularGrid grid;
  for (int k = 0; k <= tubes; ++k) grid.azimuth_edges_rad.push_back((29.0 * k / tubes - 14.5) * degree);
  grid.elevation_edges_rad = {-7 * degree, 7 * degree};
  const double c = std::cos(20 * degree), s = std::sin(20 * degree);
  grid.frame = glm::dmat3(glm::dvec3(0, c, -s), glm::dvec3(1, 0, 0), glm::dvec3(0, s, c));
  TubeSet set;
  set.reach = 1e12;
  append_tubes(set, grid);
  const TubeEngine engine(mesh, tree, std::ldexp(1.0, -terrain_grid_exponent), {});
  const History history = engine.trace(set);
  const std::vector<double> material_mu{0.01};
  const RangeSamples samples{3, 12.0 / 512, 512};
  const std::vector<std::uint32_t> beam_of_tube(set.tubes.size(), 0);
  fmt::print("{} facets, {} tubes, {} footprints\n", mesh.facets.size(), set.tubes.size(),
             history.footprints.footprints.size());

  EchoModel model{material_mu, mesh.material, 0.6};
  Echo plain;
  const double plain_ms = best_ms(repetitions, [&] {
    plain = integrate_echo(history, {1, beam_of_tube}, samples, model);
  });
  fmt::print("no patterns: {:.1f} ms\n", plain_ms);
  const Directivity line{Directivity::Kind::line, {1, 0, 0}, false, 0, 120},
      gaussian{Directivity::Kind::gaussian, {1, 0, 0}, false, 0, 0.3 * degree},
      tabulated{Directivity::Kind::table, {1, 0, 0}, false, 0, 0, 0, table_with_floor()};
  for (const auto& [name, pattern] :
       {std::pair("line", line), std::pair("gaussian", gaussian), std::pair("table", tabulated)}) {
    if (!only.empty() && only != name) continue;
    const BeamPatterns patterns{
        {TransmitPattern(cycle(pattern))},
        cycle(pattern),
        std::vector<std::uint32_t>(set.tubes.size(), 0),
        std::vector<std::pair<std::uint32_t, std::uint32_t>>(set.tubes.size(), {0, beams})};
    model.patterns = &patterns;
    model.pattern_tolerance = 1e-12;
    const Echo fine = integrate_echo(history, {beams, beam_of_tube}, samples, model);
    for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-11}) {
      model.pattern_tolerance = tolerance;
      Echo echo;
      const double ms = best_ms(repetitions, [&] {
        echo = integrate_echo(history, {beams, beam_of_tube}, samples, model);
      });
      double error = 0;
      for (int beam = 0; beam < beams; ++beam)
        for (int k = 0; k < samples.count; ++k)
          if (plain.at(0, k) > 0)
            error = std::max(error, std::abs(echo.at(beam, k) - fine.at(beam, k)) / plain.at(0, k));
      fmt::print("{}, tolerance {:g}: {:.1f} ms, largest error {:.1e} of the echo without patterns\n", name,
                 tolerance, ms, error);
    }
  }
}

}  // namespace
}  // namespace tubefoot

int main(int argc, char** argv) {
  const auto number = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
  tubefoot::measure_patterns(number(1, 400), number(2, 96), number(3, 3), argc > 4 ? argv[4] : "");
}
