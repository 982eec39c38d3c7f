// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/relief/wave_surface.hpp"
#include "engine/scattering/scattering_model.hpp"
#include "scene/description/scene_component.hpp"
#include "scene/description/scene_description.hpp"

// Facets, waves and scattering of the sea surface of a scene ([sea_surface] with `size_m`).
namespace tubefoot {

/// Name of the component and of its material.
inline constexpr std::string_view sea_surface_name = "sea surface";
/// The value of MaterialDescription::model for the material of the sea surface. Scene files cannot state it.
inline constexpr std::string_view sea_surface_model = "sea-surface";

/// Returns whether an object of a loaded scene's description stands for the facets of the sea surface. It is
/// the last one.
bool is_sea_surface(const SceneDescription& scene, std::size_t object);

/// Returns the description with an object for the facets of the sea surface, and with the roughness of its
/// mirror. Unless the scene names a material, it also gets a material. Throws InputError for a component or a
/// material of the same name, for a mirror as the material, and for too many facets. Throws it also for a
/// sound speed profile that begins at another height.
SceneDescription with_sea_surface(SceneDescription scene);

/// The facets of the sea surface.
struct SeaSurfaceWaves {
  std::shared_ptr<const WaveLattice> heights;  ///< by vertex of the object's mesh
  double bound_m = 0;                          ///< no height above or below the mean is larger
  double standard_deviation_m = 0;             ///< of the heights of the facets
};
/// Makes the waves of a description with facets of the sea surface. Adds warnings about waves that the cells
/// do not show.
SeaSurfaceWaves sea_surface_waves(const SceneDescription& scene, std::vector<std::string>& warnings);

/// Returns the scattering model of the sea surface, without the slopes of the waves that its facets show.
/// Adds warnings about frequencies and wind speeds outside of the range of the model.
ScatteringModel sea_surface_scattering(const SceneDescription& scene, std::vector<std::string>& warnings);

}  // namespace tubefoot
