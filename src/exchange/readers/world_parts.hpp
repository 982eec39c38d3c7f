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
#include "exchange/readers/xml_input.hpp"

namespace tubefoot {

/// What the readers of worlds gather, and what they share: files that worlds name, elements of our own,
/// materials, names.
class WorldParts {
 public:
  WorldParts(const XmlInput& xml, const std::filesystem::path& world, ExchangeFormat format,
             const std::vector<std::filesystem::path>& model_path);

  const XmlInput& xml() const { return xml_; }
  const EngineAxes& axes() const { return axes_; }

  /// "WORLD:12:3: what", told and gone on from.
  void notice(pugi::xml_node node, const std::string& what);
  /// Elements that are passed over, counted by what they are called.
  void pass_over(pugi::xml_node node) { ++passed_over_[name_in(node)]; }

  /// A mesh file, by path or URI; none, and told, where it is not to be had.
  std::optional<std::size_t> mesh(pugi::xml_node node, const std::string& uri);
  /// One made here.
  std::size_t mesh(const std::string& stem, ComponentMesh mesh);

  /// <tubefoot:scene>: title, water, materials.
  void read_own_scene(pugi::xml_node parent);
  /// The material of that name; of a name that was not met yet, with a level that is assumed and told.
  std::string material(const std::string& name);

  /// `placed`: of the object's own axes in the world, both theirs. Negative scales go into the mesh.
  void add_object(pugi::xml_node node, ImportedObject object, const Placement& placed);
  /// <tubefoot:sonar> in `sensor`, whose pose is in `frame` (theirs, a body's); false where there is none.
  bool add_own_sonar(pugi::xml_node sensor, const Placement& frame, const Axes& of_frame);
  /// `placed`: theirs, of the sonar's own frame. Told and left out where no scene can have it.
  void add_sensor(pugi::xml_node node, ImportedSensor sensor, const Placement& placed,
                  bool looks_down = false);

  /// Throws InputError where there is no geometry.
  ImportedScene finish();

 private:
  std::optional<std::filesystem::path> found(pugi::xml_node node, const std::string& uri);
  std::size_t mirrored(std::size_t mesh, glm::dvec3 sign);
  std::string unique(const std::string& name);
  void keep(pugi::xml_node node, ImportedSensor sensor);

  const XmlInput& xml_;
  const EngineAxes& axes_;
  std::filesystem::path world_, folder_;
  std::vector<std::filesystem::path> model_path_;
  ImportedScene scene_;
  std::map<std::string, int> passed_over_;
  std::map<std::filesystem::path, std::optional<std::size_t>> read_;
  std::map<std::pair<std::size_t, std::array<bool, 3>>, std::size_t> mirrored_;
  std::map<std::string, int> names_, sensor_names_, stems_;
  std::set<std::string> materials_, assumed_;
  std::size_t not_told_ = 0;
};

/// Two triangles in the plane z = 0, about its middle.
ComponentMesh plane_mesh(double width, double length);

/// Each format's walk through its elements.
void read_sdf(WorldParts& parts);
void read_stonefish(WorldParts& parts);

}  // namespace tubefoot
