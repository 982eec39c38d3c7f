// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <span>
#include <tuple>

#include "app/commands.hpp"
#include "files/checked_file.hpp"
#include "files/input_error.hpp"
#include "files/outlet.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "footprints/coverage_file.hpp"
#include "footprints/coverage_looks.hpp"
#include "footprints/coverage_picture.hpp"
#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/facet_blocks.hpp"
#include "run/facet_numbering.hpp"
#include "run/settings.hpp"

namespace tubefoot {
namespace {
namespace fs = std::filesystem;

/// The pings that count.
std::vector<HeardPing> counted(const Survey& survey, const CoverageOptions& options) {
  std::vector<HeardPing> pings;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    if (options.sensor && survey.fleet->sensor_named(*options.sensor) != s) continue;
    const PingRange range = resolved(options.pings, survey.sensors[s].times_s.size());
    for (auto ping = static_cast<std::size_t>(range.first); ping <= static_cast<std::size_t>(range.last);
         ++ping)
      pings.push_back({s, ping});
  }
  return pings;
}

/// What some of the pings that count see.
std::vector<CoverageLook> look(const Shots& shots, std::span<const HeardPing> pings,
                               std::span<const std::size_t> chosen, bool quiet) {
  struct Asked {
    std::size_t listed, shot;
  };
  std::vector<Asked> asked;
  for (const std::size_t p : chosen)
    for (std::size_t shot = 0; shot < shots.survey().sensors[pings[p].sensor].sensor->shots(); ++shot)
      asked.push_back({p, shot});
  std::vector<std::vector<CoverageLook>> found(asked.size());
  Progress progress("shots", asked.size(), quiet);
  tbb::parallel_for(std::size_t{0}, asked.size(), [&](std::size_t l) {
    stop_if_wanted();
    const auto& [listed, shot] = asked[l];
    const auto& [sensor, ping] = pings[listed];
    found[l] = coverage_looks(shots.heard_by(sensor, ping, shot), sensor, static_cast<std::uint32_t>(listed));
    progress.step();
  });
  std::vector<CoverageLook> looks;
  for (auto& some : found) std::move(some.begin(), some.end(), std::back_inserter(looks));
  return looks;
}

CoveredFacet measured(const Survey& survey, const Coverage& overlay, std::span<const CoverageLook> looks,
                      FacetCoverage&& coverage) {
  const Scene& scene = survey.scene;
  const double unit_m = scene.grid.unit_m();
  const FacetId id = coverage.facet;
  CoveredFacet facet{std::move(coverage), scene.mesh.component[id], scene.mesh.material[id], 0, {}, {}};
  std::array<glm::dvec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = scene.grid.to_metres(scene.mesh.vertices[scene.mesh.facets[id][k]]);
  facet.area_m2 = glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) / 2;
  for (const glm::dvec3& corner : facet.coverage.corners)
    facet.corners_m.push_back(scene.grid.origin_m() + corner * unit_m);
  std::map<std::tuple<std::uint32_t, std::uint32_t, FacetId>, std::vector<std::size_t>> shadows;
  for (std::size_t k = 0; k < facet.coverage.cells.size(); ++k) {
    const CoverageCell& cell = facet.coverage.cells[k];
    stop_if_wanted();
    if (cell.in_sector == 0) continue;
    const FacetId occluder = overlay.occluder(facet.coverage, cell);
    shadows[{looks[cell.first_look].ping, cell.in_sector, occluder}].push_back(k);
  }
  for (auto& [key, cells] : shadows) {
    const auto [ping, in_sector, occluder] = key;
    const bool clear = occluder != no_facet;
    facet.shadows.push_back({in_sector, ping, clear ? survey.site->number_of(occluder) : no_facet,
                             clear ? scene.mesh.component[occluder] : std::uint16_t{0}, std::move(cells)});
  }
  facet.coverage.facet = survey.site->number_of(id);  // by the mesh's until here
  return facet;
}

/// Calls `add` with the facets of a block that were met, in the order of their numbers.
void cover(const Shots& shots, const FacetBlock& block, const std::vector<CoverageLook>& looks, bool quiet,
           const std::function<void(const CoveredFacet&)>& add) {
  const Survey& survey = shots.survey();
  const Coverage coverage(survey.scene.mesh, *survey.site->tree, looks);
  // A batch at a time: facets are independent of each other, files want them in their order.
  constexpr std::size_t batch = 2048;
  Progress progress("facets", coverage.facets(), quiet);
  for (std::size_t first = 0; first < coverage.facets(); first += batch) {
    const std::size_t count = std::min(batch, coverage.facets() - first);
    std::vector<CoveredFacet> facets(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      stop_if_wanted();
      progress.step();
      const FacetId number = survey.site->number_of(coverage.facet_of(first + k));
      if (number < block.first || number >= block.end) return;  // another block has all that see it
      FacetCoverage covered = coverage.facet(first + k);
      if (!covered.closes)
        throw std::logic_error(
            fmt::format("internal error: what is seen of facet {} and what is not do not add "
                        "up to it. Please report the scene",
                        number));
      if (covered.met()) facets[k] = measured(survey, coverage, looks, std::move(covered));
    });
    for (const CoveredFacet& facet : facets) {
      stop_if_wanted();
      if (!facet.coverage.cells.empty()) add(facet);
    }
  }
}

/// Areas of all facets that were met, m^2.
struct Totals {
  std::size_t facets = 0, closed = 0, seen_whole = 0, never_seen = 0;
  double area = 0, seen = 0, shadow = 0;
  std::map<std::uint32_t, double> by_pings;

  void add(const CoveredFacet& facet) {
    ++facets;
    closed += facet.coverage.closes;
    seen_whole += facet.coverage.seen.exact == "1";
    never_seen += facet.coverage.seen.exact == "0";
    area += facet.area_m2;
    seen += facet.area_m2 * facet.coverage.seen.share;
    shadow += facet.area_m2 * facet.coverage.shadow.share;
    for (const AreaShare& part : facet.coverage.by_pings) by_pings[part.pings] += facet.area_m2 * part.share;
  }
  void print(std::size_t scene_facets, std::size_t pings) const {
    const auto line = [&](const char* what, double m2) {
      tell("{:<15}{:.6g} m2 ({:.2f} %)\n", what, m2, area > 0 ? 100 * m2 / area : 0.0);
    };
    tell("pings          {}\n", pings);
    tell("facets         {} in a sector, of {}: {} seen whole, {} not at all\n", facets, scene_facets,
         seen_whole, never_seen);
    tell("closes         {} facets of {}\n", closed, facets);
    tell("area           {:.6g} m2\n", area);
    line("seen", seen);
    line("never seen", by_pings.count(0) ? by_pings.at(0) : 0.0);
    line("  in a shadow", shadow);
    constexpr std::size_t most_lines = 12;
    std::size_t lines = 0;
    double more = 0;
    for (const auto& [times, m2] : by_pings) {
      if (times == 0) continue;
      if (++lines <= most_lines)
        line(fmt::format("  by {}", times).c_str(), m2);
      else
        more += m2;
    }
    if (lines > most_lines) line("  by more", more);
  }
};

}  // namespace

int coverage_command(const CoverageOptions& options) {
  const std::string ending = options.output.extension().string();
  const bool package = ending == ".gpkg", table = ending == ".csv", folder = !package && !table;
  if (folder && !ending.empty() && !fs::is_directory(options.output))
    throw UsageError(fmt::format("'{}': the ending chooses the format: .gpkg, .csv, or none for a folder",
                                 options.output.string()));
  if (options.picture && options.picture->extension() != ".png")
    throw UsageError(fmt::format("'{}': the picture is a .png", options.picture->string()));
  SceneDescription description = described(options);
  if (options.order) {
    description.paths.order = *options.order;
    description.paths.only_order.reset();
  }
  const Inputs inputs = inputs_of(description);
  std::optional<OutputFolder> staged;
  std::optional<OutputFile> file, picture_file;
  if (options.picture) picture_file.emplace(*options.picture, inputs);
  if (folder)
    staged.emplace(options.output, inputs);
  else
    file.emplace(options.output, inputs);
  const ThreadLimit limit(description.run.threads);
  const auto survey = open_survey(description);
  const Scene& scene = survey->scene;
  print_warnings(scene.report.warnings, options.quiet);
  const Shots shots(*survey, request_of(description.run));
  require_able(*survey, shots.request(), Feature::coverage,
               options.sensor ? std::optional(survey->fleet->sensor_named(*options.sensor)) : std::nullopt);

  const std::vector<HeardPing> pings = counted(*survey, options);
  std::vector<CountedPing> names;
  for (const auto& [sensor, ping] : pings)
    names.push_back({survey->sensors[sensor].sensor->description().name, ping});

  std::optional<CoverageFile> layers;
  if (!table) layers.emplace(scene);
  CoverageTables tables(scene);
  std::optional<CoveragePicture> picture;
  if (folder || options.picture) picture.emplace(*survey);
  Totals totals;
  const auto add = [&](const CoveredFacet& facet) {
    totals.add(facet);
    if (!package) tables.add(facet);
    if (layers) layers->add(facet, names);
    if (picture) picture->add(facet);
  };
  for (const FacetBlock& block : facet_blocks(shots, pings)) {
    const Shots around(survey->site->is_tiled() ? survey_with_tiles(*survey, block.tiles) : *survey,
                       shots.request());
    cover(around, block, look(around, pings, block.pings, options.quiet), options.quiet, add);
  }
  const std::string title =
      fmt::format("{}: {}, {} ping{}", description.title.empty() ? "coverage" : shown_line(description.title),
                  options.sensor.value_or("all sensors"), pings.size(), pings.size() == 1 ? "" : "s");
  if (picture_file) {
    picture->write(picture_file->path(), title);
    picture_file->commit();
  }
  if (folder) {
    layers->write(staged->staging() / "coverage.gpkg");
    write_file(staged->staging() / "facets.csv", tables.facets());
    write_file(staged->staging() / "depths.csv", tables.depths());
    if (totals.facets > 0) picture->write(staged->staging() / "coverage.png", title);
    staged->commit();
  } else {
    if (package)
      layers->write(file->path());
    else
      write_file(file->path(), tables.facets());
    file->commit();
  }
  totals.print(survey->site->is_tiled() ? survey->site->numbering().facets() : scene.mesh.facets.size(),
               pings.size());
  tell("wrote {}\n", options.output.string());
  return 0;
}

}  // namespace tubefoot
