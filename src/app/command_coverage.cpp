// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "app/commands.hpp"
#include "footprints/coverage_output.hpp"
#include "footprints/survey_coverage.hpp"
#include "run/abilities.hpp"
#include "run/console/say.hpp"
#include "run/facet_numbering.hpp"
#include "run/settings.hpp"

namespace tubefoot {
namespace {

void print(const CoverageTotals& totals, std::size_t scene_facets, std::size_t pings) {
  const auto line = [&](const char* what, double m2) {
    tell("{:<15}{:.6g} m2 ({:.2f} %)\n", what, m2, totals.area > 0 ? 100 * m2 / totals.area : 0.0);
  };
  tell("pings          {}\n", pings);
  tell("facets         {} in a sector, of {} in the scene: {} fully visible, {} hidden\n", totals.facets,
       scene_facets, totals.seen_whole, totals.never_seen);
  tell("closure        {} of {} facets\n", totals.closed, totals.facets);
  tell("area           {:.6g} m2\n", totals.area);
  line("visible", totals.seen);
  line("never visible", totals.by_pings.count(0) ? totals.by_pings.at(0) : 0.0);
  line("  in a shadow", totals.shadow);
  constexpr std::size_t most_lines = 12;
  std::size_t lines = 0;
  double more = 0;
  for (const auto& [times, m2] : totals.by_pings) {
    if (times == 0) continue;
    if (++lines <= most_lines)
      line(fmt::format("  in {} ping{}", times, times == 1 ? "" : "s").c_str(), m2);
    else
      more += m2;
  }
  if (lines > most_lines) line("  more pings", more);
}

}  // namespace

int coverage_command(const CoverageOptions& options) {
  SceneDescription description = described(options);
  if (options.order) {
    description.paths.order = *options.order;
    description.paths.only_order.reset();
  }
  CoverageOutput output(options.output, options.picture, inputs_of(description));
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  const Scene& scene = survey->scene;
  print_warnings(scene.report.warnings, options.quiet);
  const RunRequest request = request_of(description.run);
  require_able(
      *survey, request, Feature::coverage,
      options.sensor ? std::optional(survey->sensor_set->sensor_named(*options.sensor)) : std::nullopt);

  const std::vector<ReceivedPing> pings = counted_pings(*survey, options.sensor, options.pings);
  output.begin(*survey, names_of(*survey, pings));
  CoverageTotals totals;
  cover(*survey, request, pings, options.quiet, [&](const CoveredFacet& facet) {
    totals.add(facet);
    output.add(facet);
  });
  output.finish(coverage_title(*survey, options.sensor, pings.size()));
  print(totals,
        survey->loaded_scene->is_tiled() ? survey->loaded_scene->numbering().facets()
                                         : scene.mesh.facets.size(),
        pings.size());
  tell("wrote {}\n", options.output.string());
  return 0;
}

}  // namespace tubefoot
