// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/surfaces/relief.hpp"

#include <stdexcept>
#include <utility>

#include "engine/relief/relief_sum.hpp"
#include "engine/relief/spectral_relief.hpp"
#include "scene/surfaces/relief_map.hpp"

namespace tubefoot {
namespace {

using Field = std::shared_ptr<const ElevationField>;

bool alike(const ReliefDescription& a, const ReliefDescription& b) {
  return a.tile_m == b.tile_m && a.resolution_m == b.resolution_m && a.seed == b.seed && a.kind == b.kind;
}

class Reliefs {
 public:
  Reliefs(const LocalFrame& frame, std::vector<std::string>& warnings) : frame_(frame), warnings_(warnings) {}

  Field get(const ReliefDescription& relief) {
    for (const auto& [made, field] : made_)
      if (alike(*made, relief)) return field;
    return made_.emplace_back(&relief, make(relief)).second;
  }

 private:
  Field make(const ReliefDescription& relief) {
    const ReliefTile tile{relief.tile_m, relief.resolution_m, relief.seed};
    try {
      if (const auto* fractal = std::get_if<FractalReliefDescription>(&relief.kind)) {
        FractalRelief surface{tile, fractal->hurst ? *fractal->hurst : *fractal->spectral_exponent / 2 - 1,
                              fractal->rms_height_m};
        if (fractal->spectral_strength_cm4) surface.spectral_strength_cm4 = *fractal->spectral_strength_cm4;
        return make_surface(surface);
      }
      if (const auto* map = std::get_if<MapReliefDescription>(&relief.kind))
        return read_relief_map(*map, frame_, warnings_);
      const auto& ripples = std::get<RippleReliefDescription>(relief.kind);
      return make_surface(RippleRelief{tile, ripples.wavelength_m, ripples.direction_deg, ripples.hurst,
                                       ripples.rms_height_m});
    } catch (const std::invalid_argument& error) {
      throw InputError(relief.place, error.what());
    } catch (const InputError& error) {  // error in the map: both places are reported
      throw InputError(relief.place, error.what());
    }
  }

  const LocalFrame& frame_;
  std::vector<std::string>& warnings_;
  std::vector<std::pair<const ReliefDescription*, Field>> made_;
};

}  // namespace

std::vector<std::shared_ptr<const ElevationField>> load_relief(
    const std::vector<MaterialDescription>& materials, const LocalFrame& frame,
    std::vector<std::string>& warnings) {
  Reliefs reliefs(frame, warnings);
  std::vector<Field> fields;
  for (const MaterialDescription& material : materials) {
    std::vector<Field> parts;
    for (const ReliefDescription& relief : material.relief) parts.push_back(reliefs.get(relief));
    if (parts.size() > 1)
      fields.push_back(std::make_shared<ReliefSum>(std::move(parts)));
    else
      fields.push_back(parts.empty() ? nullptr : std::move(parts.front()));
  }
  return fields;
}

}  // namespace tubefoot
