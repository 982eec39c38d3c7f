// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/readers/scene_readers.hpp"
#include "exchange/readers/world_files.hpp"
#include "exchange/readers/xml_input.hpp"

namespace tubefoot {

/// The part of a mesh that a world uses.
struct SubMesh {
  std::string name;      ///< of a mesh, a group, an object or a node; empty: the whole mesh
  bool centred = false;  ///< moves the centre of the box around the part to the origin
  auto operator<=>(const SubMesh&) const = default;
};

/// Collects the parts of a world for the readers of all formats: named files, elements of the tubefoot
/// namespace, materials and names.
class WorldParts {
 public:
  WorldParts(XmlInput& xml, const std::filesystem::path& world, ExchangeFormat format,
             const std::vector<std::filesystem::path>& model_path, std::optional<double> unit_m);

  const XmlInput& xml() const { return xml_; }
  const EngineAxes& axes() const { return axes_; }

  /// Adds the remark "WORLD:12:3: what". Reading continues.
  void notice(pugi::xml_node node, const std::string& what);
  /// Counts an ignored element by its name.
  void pass_over(pugi::xml_node node) { ++passed_over_[name_in(node)]; }
  /// Counts an element that has no effect on the echoes of a scene at rest.
  void without_effect(pugi::xml_node node) { ++without_effect_[name_in(node)]; }
  /// Counts an element that a reader visits. Throws InputError if there are too many, because models can
  /// include each other repeatedly.
  void visit(pugi::xml_node node);

  /// Counts an included model that is read or left out.
  void count_include(bool read) { ++(read ? included_ : not_included_); }

  /// Returns the root element of the SDF file of a model, by path or URI. Reports a missing or invalid file
  /// and returns nothing.
  pugi::xml_node included(pugi::xml_node node, const std::string& uri);
  /// Reads a mesh file, by path or URI. Reports a missing file and returns nothing.
  std::optional<std::size_t> mesh(pugi::xml_node node, const std::string& uri, const SubMesh& part = {});
  /// Adds a mesh that the reader made.
  std::size_t mesh(const std::string& stem, ComponentMesh mesh);

  /// Reads <tubefoot:scene>: title, water, materials.
  void read_own_scene(pugi::xml_node parent);
  /// Sets the sound speed of the water if the world does not state one yet. Reports a different one.
  void sound_speed(pugi::xml_node node, double m_s);
  /// Returns the material of that name. A new material gets an assumed level, which is reported.
  std::string material(const std::string& name);

  /// Adds an object. `placed`: axes of the object in the world, both in the convention of the engine.
  /// Negative scales are applied to the mesh.
  void add_object(pugi::xml_node node, ImportedObject object, const Placement& placed);
  /// Reads <tubefoot:sonar> in `sensor`, whose pose is in `frame` (axes of a body of the engine). Returns
  /// false if there is none.
  bool add_own_sonar(pugi::xml_node sensor, const Placement& frame, const Axes& of_frame);
  /// Adds a sensor. `placed`: frame of the sonar, in the axes of the engine. Reports and omits a sensor
  /// that no scene can contain.
  void add_sensor(pugi::xml_node node, ImportedSensor sensor, const Placement& placed,
                  bool looks_down = false);

  /// Throws InputError if there is no geometry.
  ImportedScene finish();

 private:
  std::filesystem::path folder_of(pugi::xml_node node) const;
  std::size_t mirrored(std::size_t mesh, glm::dvec3 sign);
  std::string unique(const std::string& name);
  void keep(pugi::xml_node node, ImportedSensor sensor);

  XmlInput& xml_;
  const EngineAxes& axes_;
  std::filesystem::path world_;
  WorldFiles files_;
  std::optional<double> unit_m_;
  ImportedScene scene_;
  std::map<std::string, int> passed_over_, without_effect_;
  std::map<std::pair<std::filesystem::path, SubMesh>, std::optional<std::size_t>> read_;
  std::map<std::pair<std::size_t, std::array<bool, 3>>, std::size_t> mirrored_;
  std::map<std::string, int> names_, sensor_names_, stems_;
  std::set<std::string> materials_, assumed_;
  std::size_t not_told_ = 0, visited_ = 0, included_ = 0, not_included_ = 0;
};

/// Returns two triangles in the plane z = 0, centred on the origin.
ComponentMesh plane_mesh(double width, double length);

/// Readers of the elements of each format.
void read_sdf(WorldParts& parts);
void read_stonefish(WorldParts& parts);

}  // namespace tubefoot
