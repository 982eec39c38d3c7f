// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/fresnel_borders.hpp"

#include <vector>

#include "engine/echo/fresnel_cells.hpp"
#include "run/label_parts.hpp"

// Weights the energies of a transmission near its shadow borders. Cells with factors are integrated as
// facets, so that scattering models, textures, beam patterns and labels apply to them.

namespace tubefoot {
namespace {

/// Returns the properties of cells as those of facets, for echo models and labels.
FacetMesh mesh_of_cells(const FacetMesh& mesh, const FresnelCells& cells) {
  FacetMesh own;
  own.facets.resize(cells.facet.size());
  for (const FacetId facet : cells.facet) {
    own.material.push_back(mesh.material[facet]);
    own.component.push_back(mesh.component[facet]);
  }
  return own;
}

}  // namespace

bool has_fresnel_borders(const Sensor& sensor) { return sensor.description().shadow == "fresnel"; }

void add_fresnel_borders(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const History& history = traced(transmission, sums);
  const TransmissionSurface& surface_mesh = transmission.surface_mesh();
  const std::size_t terrains = transmission.scene().description.terrains.size();
  const FresnelSurface surface{surface_mesh.mesh(), surface_mesh.tree(), transmission.request().visibility,
                               [&](std::uint16_t component) { return component < terrains; }};
  sums.as_echo([&] {
    const std::vector<ShadowEdge> edges = shadow_edges(surface.mesh, history);
    if (edges.empty()) return;
    for (const std::size_t s : plan.sensors) {
      if (sums.chosen(s).pings == 0) continue;
      const double wavelength_m = transmission.survey().sensors[s].sound_speed_m_s /
                                  (1000 * transmission.sensor(s).frequency_khz(transmission.number()));
      const FresnelCells cells = fresnel_cells(surface, history, edges, wavelength_m);
      if (cells.facet.empty()) continue;
      const FacetMesh mesh = mesh_of_cells(surface.mesh, cells);
      SensorModel model(transmission, surface_mesh, s);
      model.model.material = mesh.material;
      model.model.path.facet_factor = cells.factor;
      sums.with_echo(transmission, cells.history, s, model.model,
                     [&](const Echo& echo) { sums.add(transmission, s, 1, echo.energy, echo.nonzero); });
      add_labels(transmission, s, model.model, mesh, cells.history, sums);
    }
  });
}

}  // namespace tubefoot
