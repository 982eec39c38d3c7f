// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/fresnel_borders.hpp"

#include <fmt/format.h>

#include <vector>

#include "engine/echo/fresnel_cells.hpp"
#include "files/input_error.hpp"
#include "run/label_parts.hpp"

// Weights the energies of a transmission near its shadow borders. Cells with factors are integrated as
// facets, so that scattering models, textures, beam patterns and labels apply to them.

namespace tubefoot {
namespace {

FresnelSurface fresnel_surface_of(const Transmission& transmission) {
  const TransmissionSurface& surface_mesh = transmission.surface_mesh();
  return {surface_mesh.mesh(), surface_mesh.tree(), transmission.request().visibility,
          transmission.scene().grid.unit_m(),
          [terrains = transmission.scene().description.terrains.size()](std::uint16_t component) {
            return component < terrains;
          }};
}

double fresnel_wavelength_m(const Transmission& transmission, std::size_t sensor) {
  return transmission.survey().sensors[sensor].sound_speed_m_s /
         (1000 * transmission.sensor(sensor).frequency_khz(transmission.number()));
}

/// Adds the echo of cells and its labels. `history`: that of the cells.
template <class CellHistory>
void add_cells(const Transmission& transmission, std::size_t s, const FresnelCellList& cells,
               const CellHistory& history, PingSums& sums) {
  const FacetMesh& mesh = transmission.surface_mesh().mesh();
  FacetMesh own;  // the properties of cells as those of facets
  own.facets.resize(cells.facet.size());
  for (const FacetId facet : cells.facet) {
    own.material.push_back(mesh.material[facet]);
    own.component.push_back(mesh.component[facet]);
  }
  SensorModel model(transmission, transmission.surface_mesh(), s);
  model.model.material = own.material;
  model.model.path.facet_factor = cells.factor;
  sums.with_echo(transmission, history, s, model.model,
                 [&](const Echo& echo) { sums.add(transmission, s, 1, echo.energy, echo.nonzero); });
  add_labels(transmission, s, model.model, own, history, sums);
}

/// Adds the cells of one transmission to the echo of a sensor, and limits their number.
class CellSums {
 public:
  CellSums(const Transmission& transmission, std::size_t sensor, PingSums& sums)
      : transmission_(transmission), sensor_(sensor), sums_(sums) {}

  template <class Cells>
  FresnelBlocks<Cells> blocks() {
    return {[this](const Cells& block) {
      count_ += block.facet.size();
      if (count_ > most_fresnel_cells) {
        const SensorDescription& sensor = transmission_.survey().sensors[sensor_].sensor->description();
        throw InputError(
            sensor.place,
            fmt::format("sensor '{}' has more than {} cells near shadow borders in one transmission: use "
                        "shadow = \"sharp\", coarser terrain or fewer objects",
                        sensor.name, most_fresnel_cells));
      }
      add_cells(transmission_, sensor_, block, block.history, sums_);
    }};
  }

 private:
  const Transmission& transmission_;
  std::size_t sensor_;
  PingSums& sums_;
  std::size_t count_ = 0;
};

}  // namespace

bool has_fresnel_borders(const Sensor& sensor) { return sensor.description().shadow == "fresnel"; }

void add_fresnel_borders(const EchoContribution& plan, const Transmission& transmission, PingSums& sums) {
  const History& history = traced(transmission, sums);
  sums.as_echo([&] {
    const FresnelSurface surface = fresnel_surface_of(transmission);
    const std::vector<ShadowEdge> edges = shadow_edges(surface.mesh, history);
    for (const std::size_t s : plan.sensors) {
      if (sums.chosen(s).pings == 0) continue;
      CellSums cells(transmission, s, sums);
      fresnel_cells(surface, history, edges, fresnel_wavelength_m(transmission, s),
                    cells.blocks<FresnelCells>());
    }
  });
}

void add_fresnel_pair_borders(const EchoContribution& plan, const Transmission& transmission,
                              PingSums& sums) {
  const FresnelSurface surface = fresnel_surface_of(transmission);
  for (const std::size_t s : plan.sensors) {
    if (sums.chosen(s).pings == 0) continue;
    sums.as_echo([&] {
      CellSums cells(transmission, s, sums);
      fresnel_pair_cells(surface, transmission.tubes(), transmission.receive_tubes(transmission.first()),
                         fresnel_wavelength_m(transmission, s), cells.blocks<FresnelPairCells>());
    });
  }
}

}  // namespace tubefoot
