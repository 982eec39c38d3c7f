// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/scene_description.hpp"
#include "scene/file/toml_reader.hpp"

// The sections of a scene file: every key with its rule, and the conditions between the keys of one table.
namespace tubefoot {

const TomlField<SceneDescription>& title_field();
const TomlSection<GeoreferenceDescription>& georeference_section();
const TomlSection<WaterDescription>& water_section();
/// Returns the section with the keys of [water] that determine the sound speed.
const TomlSection<WaterDescription>& assumed_water_section();
const TomlSection<SeaSurfaceDescription>& sea_surface_section();
const TomlSection<PathsDescription>& paths_section();
const TomlSection<MaterialDescription>& material_section();
const TomlSection<ReflectivityDescription>& reflectivity_section();  // within a material
const TomlSection<ReliefDescription>& relief_section();
const TomlSection<TerrainDescription>& terrain_section();
const TomlSection<MaterialMapDescription>& material_map_section();
/// Returns the key of [[terrain]] that holds a material map.
TomlField<TerrainDescription> material_map_field();
/// Throws InputError at the first name in the map that is not a material.
void check_materials(const MaterialMapDescription& map, const std::vector<std::string>& materials);
const TomlSection<ObjectDescription>& object_section();
const TomlSection<WaterTargetDescription>& target_section();
const TomlSection<TargetPopulationDescription>& target_population_section();
const TomlSection<TrajectoryDescription>& trajectory_section();
/// Returns the section with the keys of the given kinds.
TomlSection<SensorDescription> sensor_section(const SensorSections& kinds);
const TomlSection<AssumedMountingDescription>& assumed_mounting_section();
/// Returns the key of [[sensors]] that holds the assumed mounting.
TomlField<SensorDescription> assumed_mounting_field();
const TomlSection<ProcessingDescription>& processing_section();
const TomlSection<RefinementDescription>& refinement_section();
const TomlSection<ScatterersDescription>& scatterers_section();
const TomlSection<RunDescription>& run_section();

}  // namespace tubefoot
