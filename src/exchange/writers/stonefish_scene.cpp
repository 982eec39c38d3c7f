// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a scene as a Stonefish scenario: static bodies with meshes and materials, and the sonars fls, msis
// and sss. The restitution of a material sets its scattering factor.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exchange/obj_mesh.hpp"
#include "exchange/stonefish_beams.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "exchange/writers/stonefish_sonar.hpp"
#include "exchange/writers/xml_words.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

const EngineAxes& stonefish_axes() { return axes_of(ExchangeFormat::stonefish); }

void set_place(pugi::xml_node node, const Placement& theirs) {
  set(node, "xyz", numbers_text(theirs.position_m));
  set(node, "rpy", rpy_text(theirs));
}

void add_mesh(pugi::xml_node parent, const char* what, const std::string& mesh) {
  const pugi::xml_node node = add(parent, what);
  set(set(add(node, "mesh"), "filename", mesh), "scale", 1.0);
  set_place(add(node, "origin"), {});
}

/// Returns the restitution, which Stonefish uses as the scattering factor of a body. The strongest material
/// has 1.
double restitution_of(const ExchangedScene& scene, const ExchangedMaterial& material) {
  double strongest_db = material.lambert_db;
  for (const ExchangedMaterial& other : scene.materials)
    strongest_db = std::max(strongest_db, other.lambert_db);
  return std::pow(10, (material.lambert_db - strongest_db) / 10);
}

void add_environment(pugi::xml_node root) {
  const pugi::xml_node environment = add(root, "environment");
  set(set(add(environment, "ned"), "latitude", 0.0), "longitude", 0.0);
  const pugi::xml_node ocean = add(environment, "ocean");
  set(set(add(ocean, "water"), "density", 1031.0), "jerlov", 0.2);
  set(add(ocean, "waves"), "height", 0.0);
  set(set(add(add(environment, "atmosphere"), "sun"), "azimuth", 20.0), "elevation", 50.0);
}

void add_materials(pugi::xml_node root, const ExchangedScene& scene) {
  const pugi::xml_node materials = add(root, "materials"), looks = add(root, "looks");
  for (const ExchangedMaterial& material : scene.materials) {
    const pugi::xml_node node = set(add(materials, "material"), "name", material.name);
    set(set(node, "density", 2500.0), "restitution", restitution_of(scene, material));
    set(node, "tubefoot:lambert_db", material.lambert_db);
    set(set(set(add(looks, "look"), "name", material.name), "gray", grey_of(material)), "roughness", 0.9);
  }
  const pugi::xml_node table = add(materials, "friction_table");
  for (std::size_t a = 0; a < scene.materials.size(); ++a)
    for (std::size_t b = a; b < scene.materials.size(); ++b) {
      const pugi::xml_node pair = set(add(table, "friction"), "material1", scene.materials[a].name);
      set(set(set(pair, "material2", scene.materials[b].name), "static", 0.5), "dynamic", 0.4);
    }
}

void add_stonefish_piece(pugi::xml_node root, const ExchangedScene& scene, const ExchangedPiece& piece,
                         const std::string& mesh) {
  const std::string& material = scene.materials[piece.material].name;
  const pugi::xml_node body = set(add(root, "static"), "name", piece.file_stem);
  set(body, "type", std::string("model"));
  add_mesh(body, "physical", mesh);
  add_mesh(body, "visual", mesh);
  set(add(body, "material"), "name", material);
  set(add(body, "look"), "name", material);
  set_place(add(body, "world_transform"), {});
}

void add_stonefish_sonar(pugi::xml_node root, const ExchangedSonar& sonar) {
  using Shape = ExchangedSonar::Shape;
  const pugi::xml_node sensor = set(add(root, "sensor"), "name", sonar.name);
  set(sensor, "type",
      std::string(sonar.shape == Shape::fan       ? "fls"
                  : sonar.shape == Shape::turning ? "msis"
                                                  : "sss"));
  const EngineRanges ranges = stonefish_ranges(sonar);
  if (const std::string words = ranges_words(sonar, ranges); !words.empty())
    add_comment(sensor,
                fmt::format("range_min is also the near clipping plane. Therefore the exported sonar has {}.",
                            words));
  const pugi::xml_node specs = add(sensor, "specs"), settings = add(sensor, "settings");
  Placement placement = sonar.placement;
  if (sonar.shape == Shape::fan) {
    const StonefishFan fan = stonefish_fan(sonar);
    placement = fan.placement;
    set(set(specs, "beams", fan.beams), "bins", ranges.samples);
    set(set(specs, "horizontal_fov", fan.width_deg), "vertical_fov", sonar.vertical_deg);
  } else if (sonar.shape == Shape::turning) {
    set(set(specs, "step", sonar.step_deg), "bins", ranges.samples);
    set(set(specs, "horizontal_beam_width", sonar.horizontal_deg), "vertical_beam_width", sonar.vertical_deg);
  } else {
    constexpr double lines = 400;  // of the waterfall
    set(set(specs, "bins", 2.0 * ranges.samples), "lines", lines);
    set(set(specs, "horizontal_beam_width", sonar.along_track_deg), "vertical_beam_width",
        sonar.vertical_deg);
    set(specs, "vertical_tilt", sonar.depression_deg);
  }
  // The default, uint8, has only 256 levels.
  set(specs, "output_format", std::string("float32"));
  set(set(settings, "range_min", ranges.range_min_m), "range_max", ranges.range_max_m);
  if (sonar.shape == Shape::turning)
    set(set(settings, "rotation_min", -sonar.scan_deg / 2), "rotation_max", sonar.scan_deg / 2);
  set(settings, "gain", 1.0);
  set(set(add(sensor, "noise"), "multiplicative", 0.0), "additive", 0.0);
  set(add(sensor, "display"), "colormap", std::string("hot"));
  set_place(add(sensor, "world_transform"),
            to_theirs(placement, stonefish_axes().world, stonefish_axes().sonar));
  add_own_sonar(sensor, sonar, to_theirs(sonar.own, stonefish_axes().world, stonefish_axes().sonar));
}

void note_fan(const ExchangedSonar& sonar, std::vector<std::string>& notes) {
  const StonefishFan fan = stonefish_fan(sonar);
  notes.push_back(fmt::format(
      "sonar '{}': an FLS has equidistant beams in views of at most 20 degrees, here {} views; the beams "
      "of the scene are {}",
      sonar.name, stonefish_views(fan.width_deg), sonar.even ? "equiangular" : "listed in README.txt"));
  if (fan.added)
    notes.push_back(fmt::format(
        "sonar '{}': Stonefish rounds an odd number of beams up without widening the fan. The exported "
        "fan has {} beams in {} degrees, and is turned by half a beam: remove the last column of the "
        "picture",
        sonar.name, fan.beams, fan.width_deg));
  if (stonefish_beam_angles_deg(fan.beams, fan.width_deg).empty())
    notes.push_back(fmt::format(
        "sonar '{}': Stonefish cannot divide {} beams into {} views, so its picture is not valid: choose "
        "a multiple of {} beams",
        sonar.name, fan.beams, stonefish_views(fan.width_deg), stonefish_views(fan.width_deg)));
  if (sonar.looks_down) notes.push_back(fmt::format("sonar '{}' becomes an FLS that looks down", sonar.name));
}

std::vector<std::string> stonefish_notes(const ExchangedScene& scene) {
  using Shape = ExchangedSonar::Shape;
  std::vector<std::string> notes{
      "the restitution of a body is the factor of its echo: exported restitutions are proportional to mu "
      "of Lambert's law, and that of the strongest material is 1",
      "Stonefish averages the samples of each bin and blurs the image. Row 0 is the farthest bin (see "
      "docs/engine-validation.md)",
      "give this folder as the data path, because mesh names are relative to it"};
  for (const ExchangedSonar& sonar : scene.sonars) {
    if (sonar.shape == Shape::fan) note_fan(sonar, notes);
    if (sonar.shape == Shape::two_sides)
      notes.push_back(fmt::format("sonar '{}': an SSS has both sides in one row of {} bins", sonar.name,
                                  2 * stonefish_ranges(sonar).samples));
    if (sonar.shape == Shape::two_sides && (sonar.depression_deg < 0 || sonar.along_track_deg > 90))
      notes.push_back(
          fmt::format("sonar '{}': an SSS cannot look above the horizontal, and its beams cannot be wider "
                      "than 90 degrees along the track",
                      sonar.name));
    if (const std::string words = ranges_words(sonar, stonefish_ranges(sonar)); !words.empty())
      notes.push_back(fmt::format(
          "sonar '{}': the minimum range of Stonefish is also its near clipping plane, in front of which "
          "nothing casts a shadow. The exported sonar therefore has {}",
          sonar.name, words));
  }
  return notes;
}

}  // namespace

WrittenScene write_stonefish_scene(const ExchangedScene& scene, const std::filesystem::path& folder) {
  const std::vector<std::string> meshes = write_piece_meshes(ExchangeFormat::stonefish, scene, folder);
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  set(declaration, "version", std::string("1.0"));
  add_comment(document, axes_words(ExchangeFormat::stonefish));
  const pugi::xml_node root = add(document, "scenario");
  set(root, "xmlns:tubefoot", std::string(own_namespace));
  add_own_scene(root, scene);
  add_environment(root);
  add_materials(root, scene);
  for (std::size_t k = 0; k < scene.pieces.size(); ++k)
    add_stonefish_piece(root, scene, scene.pieces[k], meshes[k]);
  for (const ExchangedSonar& sonar : scene.sonars) add_stonefish_sonar(root, sonar);
  write_xml(document, folder / "scene.scn");
  WrittenScene written{{"scene.scn"}, stonefish_notes(scene)};
  written.files.insert(written.files.end(), meshes.begin(), meshes.end());
  add_stonefish_reference(scene, meshes, folder, written);
  return written;
}

}  // namespace tubefoot
