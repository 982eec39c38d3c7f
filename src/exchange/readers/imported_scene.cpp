// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "exchange/obj_mesh.hpp"
#include "exchange/readers/scene_readers.hpp"
#include "exchange/readers/sonar_places.hpp"
#include "files/checked_file.hpp"
#include "files/shown.hpp"
#include "scene/scene.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {

std::string scene_text(const ImportedScene& scene) {
  std::string text =
      "# Made by 'tubefoot import-scene'. Axes: x east, y north, z up; docs/exchange-formats.md\n";
  if (!scene.title.empty()) text += fmt::format("title = {}\n", toml_quoted(scene.title));
  if (scene.sound_speed_m_s || scene.absorption_db_per_km) text += "\n[water]\n";
  if (scene.sound_speed_m_s) text += fmt::format("sound_speed_m_s = {}\n", *scene.sound_speed_m_s);
  if (scene.absorption_db_per_km)
    text += fmt::format("absorption_db_per_km = {}\n", *scene.absorption_db_per_km);
  for (const ExchangedMaterial& material : scene.materials)
    text += fmt::format("\n[[materials]]\nname = {}\nlambert_db = {}\n", toml_quoted(material.name),
                        material.lambert_db);
  for (const ImportedObject& object : scene.objects) {
    text += fmt::format("\n[[objects]]\nname = {}\nshape = \"{}\"\nmaterial = {}\n", toml_quoted(object.name),
                        object.shape, toml_quoted(object.material));
    if (object.mesh)
      text += fmt::format("file = {}\n", toml_quoted(scene.meshes[*object.mesh].file.string()));
    for (const auto& [key, value] : object.keys) text += fmt::format("{} = {}\n", key, value);
    text += place_keys(object.placed);
    if (object.scale != std::array<double, 3>{1, 1, 1})
      text += fmt::format("scale = [{}, {}, {}]\n", object.scale[0], object.scale[1], object.scale[2]);
  }
  std::vector<ImportedSensor> sensors = scene.sensors;
  if (sensors.empty()) sensors.push_back(example_sonar());
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    text += fmt::format("\n[[trajectories]]\nname = \"of sonar {}\"\nkind = \"fixed\"\n{}", k,
                        place_keys(sensors[k].own));
    text += fmt::format("\n[[sensors]]\nname = {}\ntrajectory = \"of sonar {}\"\n",
                        toml_quoted(sensors[k].name), k);
    for (const auto& [key, value] : sensors[k].keys) text += fmt::format("{} = {}\n", key, value);
  }
  return text;
}

void write_imported_scene(ImportedScene& scene, const std::filesystem::path& folder) {
  for (const ImportedMesh& mesh : scene.meshes) {
    ObjMesh obj(
        folder / mesh.file,
        "Made by 'tubefoot import-scene'. Units: metres. Axes: those of the mesh in the imported world.");
    obj.object(mesh.file.stem().string(), {}, mesh.mesh.points_m, mesh.mesh.triangles);
    obj.close();
  }
  const auto write = [&] {
    const std::string text = scene_text(scene);
    write_file(folder / "scene.toml", std::string_view(text));
    return read_scene_file(folder / "scene.toml");
  };
  try {
    if (place_sonars(scene, load_scene(write()))) write();
  } catch (const InputError& error) {
    // The temporary folder is deleted; its name would mean nothing to the user.
    std::string why = error.what();
    const std::string in_folder = folder.string() + "/";
    for (std::size_t at = why.find(in_folder); at != why.npos; at = why.find(in_folder, at))
      why.erase(at, in_folder.size());
    throw InputError({scene.world.string(), 0, 0},
                     "the readable parts of the world do not form a scene: " + why);
  }
}

}  // namespace tubefoot
