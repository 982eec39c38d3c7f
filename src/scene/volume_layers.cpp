// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/volume_layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "files/csv_file.hpp"

namespace tubefoot {
namespace {

/// Strengths below this value mean that the water does not scatter.
constexpr double least_strength_db = -300, lowest_table_value_db = -999;
/// Each layer adds a border to each tube.
constexpr std::size_t most_layers = 1000;

double coefficient_per_m(double strength_db) {
  return strength_db < least_strength_db ? 0 : std::pow(10, strength_db / 10);
}

struct Layer {
  double depth_m, s_v_per_m;
};

std::vector<Layer> read_layers(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 2> columns = {"depth_m", "volume_scattering_db"};
  std::vector<Layer> layers;
  double deepest_m = 0;
  read_csv(file, columns, [&](const CsvRow& row) {
    const double depth = row.values[0], strength = row.values[1];
    if (!(std::abs(depth) <= 12000))
      throw InputError(row.places[0], fmt::format("depth_m is {}, expected -12000 to 12000", depth));
    if (!layers.empty() && !(depth > deepest_m))
      throw InputError(row.places[0], fmt::format("depth_m must increase: {} follows {}", depth, deepest_m));
    if (!(strength >= lowest_table_value_db && strength <= 0))
      throw InputError(row.places[1],
                       fmt::format("volume_scattering_db is {}, expected {:g} to 0 (dB re 1 m^-1): values "
                                   "below {:g} mean that the layer does not scatter",
                                   strength, lowest_table_value_db, least_strength_db));
    // Rows of equal strength are one layer.
    if (layers.empty() || layers.back().s_v_per_m != coefficient_per_m(strength))
      layers.push_back({depth, coefficient_per_m(strength)});
    deepest_m = depth;
    if (layers.size() > most_layers)
      throw InputError(
          row.places[0],
          fmt::format("the table has more than {} layers of volume scattering: use fewer rows", most_layers));
  });
  if (layers.empty())
    throw InputError({file.string(), 0, 0}, "has a header but no rows, expected at least one depth");
  return layers;
}

}  // namespace

VolumeScattering load_volume_scattering(const WaterDescription& water, double surface_height_m,
                                        bool ends_at_surface) {
  VolumeScattering volume{{},
                          {water.volume_scattering_db ? coefficient_per_m(*water.volume_scattering_db) : 0}};
  if (water.volume_scattering_file) {
    const std::vector<Layer> layers = read_layers(*water.volume_scattering_file);
    volume.s_v_per_m.clear();
    for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
      volume.s_v_per_m.push_back(layer->s_v_per_m);
      volume.borders_m.push_back(surface_height_m - layer->depth_m);
    }
    volume.s_v_per_m.push_back(0);
  }
  if (!ends_at_surface || !volume.any()) return volume;
  // Nothing scatters above the surface.
  const auto above = std::ranges::lower_bound(volume.borders_m, surface_height_m);
  const auto kept = std::size_t(above - volume.borders_m.begin());
  volume.borders_m.resize(kept);
  volume.s_v_per_m.resize(kept + 1);
  volume.borders_m.push_back(surface_height_m);
  volume.s_v_per_m.push_back(0);
  return volume;
}

std::optional<std::string> short_layers_warning(const WaterDescription& water, const VolumeScattering& volume,
                                                double surface_height_m, double lowest_m) {
  if (!water.volume_scattering_file || volume.borders_m.empty() || !(volume.borders_m.front() > lowest_m) ||
      volume.s_v_per_m.front() == 0)
    return std::nullopt;
  return fmt::format(
      "{}: the table of volume scattering ends at a depth of {:.6g} m, but the scene reaches down to {:.6g} "
      "m: "
      "the last layer continues below its row; add a row with the depth of its end",
      water.volume_scattering_file->string(), surface_height_m - volume.borders_m.front(),
      surface_height_m - lowest_m);
}

}  // namespace tubefoot
