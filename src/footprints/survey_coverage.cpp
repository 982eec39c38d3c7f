// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the coverage of a survey (docs/notes/coverage.md). It overlays the visible polygons of all
// transmissions on each facet of the scene, block by block, and measures the cells of the overlay.

#include "footprints/survey_coverage.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <iterator>
#include <tuple>

#include "files/shown.hpp"
#include "footprints/coverage_looks.hpp"
#include "geometry/steps/stop.hpp"
#include "run/facet_numbering.hpp"
#include "run/settings.hpp"

namespace tubefoot {
namespace {

/// Returns the visible polygons of some of the counted pings.
std::vector<CoverageLook> look(const Transmissions& transmissions, std::span<const ReceivedPing> pings,
                               std::span<const std::size_t> chosen, bool quiet) {
  struct Requested {
    std::size_t listed, transmission;
  };
  std::vector<Requested> requested;
  for (const std::size_t p : chosen)
    for (std::size_t transmission = 0;
         transmission < transmissions.survey().sensors[pings[p].sensor].sensor->transmissions();
         ++transmission)
      requested.push_back({p, transmission});
  std::vector<std::vector<CoverageLook>> found(requested.size());
  Progress progress("transmissions", requested.size(), quiet);
  tbb::parallel_for(std::size_t{0}, requested.size(), [&](std::size_t l) {
    stop_if_wanted();
    const auto& [listed, transmission] = requested[l];
    const auto& [sensor, ping] = pings[listed];
    found[l] = coverage_looks(transmissions.received_by(sensor, ping, transmission), sensor,
                              static_cast<std::uint32_t>(listed));
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
  CoveredFacet facet{std::move(coverage), scene.mesh.component[id], scene.mesh.material[id], 0, {}, {}, {}};
  std::array<glm::dvec3, 3>& p = facet.vertices_m;
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
    facet.shadows.push_back({in_sector, ping, clear ? survey.loaded_scene->number_of(occluder) : no_facet,
                             clear ? scene.mesh.component[occluder] : std::uint16_t{0}, std::move(cells)});
  }
  facet.coverage.corners = {};  // corners_m has them
  facet.coverage.facet =
      survey.loaded_scene->number_of(id);  // until here it was the facet's number in the mesh
  return facet;
}

/// Calls `add` with the facets of a block that lie in a sector, in the order of facet numbers.
void cover_block(const Transmissions& transmissions, const FacetBlock& block,
                 const std::vector<CoverageLook>& looks, bool quiet,
                 const std::function<void(const CoveredFacet&)>& add) {
  const Survey& survey = transmissions.survey();
  const Coverage coverage(survey.scene.mesh, *survey.loaded_scene->tree, looks);
  // Facets are processed in batches. They are independent of each other, but files need them in order.
  constexpr std::size_t batch = 2048;
  Progress progress("facets", coverage.facets(), quiet);
  for (std::size_t first = 0; first < coverage.facets(); first += batch) {
    const std::size_t count = std::min(batch, coverage.facets() - first);
    std::vector<CoveredFacet> facets(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      stop_if_wanted();
      progress.step();
      const FacetId number = survey.loaded_scene->number_of(coverage.facet_of(first + k));
      if (number < block.first || number >= block.end)
        return;  // another block has all looks that see this facet
      FacetCoverage covered = coverage.facet(first + k);
      if (!covered.closes)
        throw std::logic_error(
            fmt::format("internal error: the visible and hidden parts of facet {} do not add up to the "
                        "facet. Please report the scene",
                        number));
      if (covered.met()) facets[k] = measured(survey, coverage, looks, std::move(covered));
    });
    for (const CoveredFacet& facet : facets) {
      stop_if_wanted();
      if (!facet.coverage.cells.empty()) add(facet);
    }
  }
}

}  // namespace

std::vector<ReceivedPing> counted_pings(const Survey& survey, const std::optional<std::string>& sensor,
                                        const std::string& pings) {
  std::vector<ReceivedPing> counted;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    if (sensor && survey.sensor_set->sensor_named(*sensor) != s) continue;
    const PingRange range = resolved(pings, survey.sensors[s].times_s.size());
    for (auto ping = static_cast<std::size_t>(range.first); ping <= static_cast<std::size_t>(range.last);
         ++ping)
      counted.push_back({s, ping});
  }
  return counted;
}

std::vector<CountedPing> names_of(const Survey& survey, std::span<const ReceivedPing> pings) {
  std::vector<CountedPing> names;
  for (const auto& [sensor, ping] : pings)
    names.push_back({survey.sensors[sensor].sensor->description().name, ping});
  return names;
}

void cover(const Survey& survey, const RunRequest& request, std::span<const ReceivedPing> pings, bool quiet,
           const std::function<void(const CoveredFacet&)>& add) {
  const Transmissions transmissions(survey, request);
  for (const FacetBlock& block : facet_blocks(transmissions, pings)) {
    const Transmissions around(
        survey.loaded_scene->is_tiled() ? survey_with_tiles(survey, block.tiles) : survey, request);
    cover_block(around, block, look(around, pings, block.pings, quiet), quiet, add);
  }
}

void CoverageTotals::add(const CoveredFacet& facet) {
  ++facets;
  closed += facet.coverage.closes;
  seen_whole += facet.coverage.seen.exact == "1";
  never_seen += facet.coverage.seen.exact == "0";
  area += facet.area_m2;
  seen += facet.area_m2 * facet.coverage.seen.share;
  shadow += facet.area_m2 * facet.coverage.shadow.share;
  for (const AreaShare& part : facet.coverage.by_pings) by_pings[part.pings] += facet.area_m2 * part.share;
}

std::string coverage_title(const Survey& survey, const std::optional<std::string>& sensor,
                           std::size_t pings) {
  const std::string& title = survey.scene.description.title;
  return fmt::format("{}: {}, {} ping{}", title.empty() ? "coverage" : shown_line(title),
                     sensor.value_or("all sensors"), pings, pings == 1 ? "" : "s");
}

}  // namespace tubefoot
