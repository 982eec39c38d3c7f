// SPDX-License-Identifier: GPL-3.0-or-later
// Collects the parts of an imported world: meshes of files, materials, objects and sonars with unique
// names. It reports omissions and assumptions.
#include "exchange/readers/world_parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>

#include "exchange/sonar_keys.hpp"
#include "files/absolute_path.hpp"
#include "files/shown.hpp"
#include "scene/meshes/mesh_file.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr double assumed_db = -27;

/// Returns whether all lengths of a primitive are above 0.
bool has_size(const ImportedObject& object) {
  return std::ranges::none_of(object.keys, [](const auto& key) {
    const char* at = key.second.data() + (key.second.starts_with('[') ? 1 : 0);
    for (char* end = nullptr;; at = end + 1) {
      const double length = std::strtod(at, &end);
      if (end == at || !(length > 0)) return true;
      if (*end != ',') return false;
    }
  });
}

/// Throws InputError for a template, from which another program makes the world.
void refuse_template(const fs::path& world) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> programs{
      {{".xacro", "xacro"}, {".erb", "erb"}, {".em", "empy"}}};
  for (const auto& [extension, program] : programs)
    if (world.extension() == extension)
      throw InputError(
          {world.string(), 0, 0},
          fmt::format("is a template of {0}, expected a world: run {0}, and import its output", program));
}

std::string unique_in(std::map<std::string, int>& taken, const std::string& name) {
  std::string unique = name;
  int& next = taken[name];
  while (next > 0 && taken.contains(unique)) unique = fmt::format("{}_{}", name, ++next);
  if (unique == name)
    next = 1;
  else
    taken[unique] = 1;
  return unique;
}

/// Keeps the triangles whose lists of names contain the name of the part. Returns false if there are none.
bool cut_to(NamedMesh& mesh, const SubMesh& part) {
  if (part.name.empty()) return true;
  std::vector<bool> is_part(mesh.names.size());
  for (std::size_t k = 0; k < mesh.names.size(); ++k)
    is_part[k] = std::ranges::find(mesh.names[k], part.name) != mesh.names[k].end();
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    if (k < mesh.names_of.size() && is_part[mesh.names_of[k]]) kept.push_back(mesh.triangles[k]);
  if (kept.empty()) return false;
  mesh.triangles = std::move(kept);
  drop_unused_points(mesh);
  if (!part.centred) return true;
  glm::dvec3 lo = mesh.points_m.front(), hi = lo;
  for (const glm::dvec3& p : mesh.points_m) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  for (glm::dvec3& p : mesh.points_m) p -= (lo + hi) / 2.0;
  return true;
}

}  // namespace

WorldParts::WorldParts(XmlInput& xml, const fs::path& world, ExchangeFormat format,
                       const std::vector<fs::path>& model_path, std::optional<double> unit_m)
    : xml_(xml), axes_(axes_of(format)), world_(world), files_(world, model_path), unit_m_(unit_m) {
  scene_.world = world;
}

void WorldParts::notice(pugi::xml_node node, const std::string& what) {
  constexpr std::size_t most = 1000;
  if (scene_.noticed.size() < most)
    scene_.noticed.push_back(fmt::format("{}: {}", to_string(xml_.place_of(node)), what));
  else
    ++not_told_;
}

void WorldParts::visit(pugi::xml_node node) {
  constexpr std::size_t most = 2'000'000;
  if (++visited_ > most)
    xml_.fail(node, fmt::format("the world has more than {} elements with its included models: import its "
                                "models separately",
                                most));
}

fs::path WorldParts::folder_of(pugi::xml_node node) const {
  return absolute_path(xml_.file_of(node)).parent_path();
}

pugi::xml_node WorldParts::included(pugi::xml_node node, const std::string& uri) {
  const auto left_out = [&](const std::string& why) {
    notice(node, fmt::format("<include> of '{}' is left out: {}", shown_line(trimmed(uri)), why));
    return pugi::xml_node();
  };
  try {
    const WorldFiles::Place place = files_.model(uri, folder_of(node));
    if (!place.file) return left_out(place.why);
    const pugi::xml_node root = xml_.open(*place.file);
    const fs::path file = fs::weakly_canonical(*place.file);
    if (std::ranges::find(scene_.inputs, file) == scene_.inputs.end()) scene_.inputs.push_back(file);
    return root;
  } catch (const InputError& error) {
    return left_out(error.what());
  }
}

std::optional<std::size_t> WorldParts::mesh(pugi::xml_node node, const std::string& uri,
                                            const SubMesh& part) {
  const auto left_out = [&](const std::string& why) {
    notice(node, fmt::format("'{}' is left out: {}", shown_line(trimmed(uri)), why));
  };
  const WorldFiles::Place place = files_.file(uri, folder_of(node));
  if (!place.file) {
    left_out(place.why);
    return {};
  }
  const fs::path file = fs::weakly_canonical(*place.file);
  const auto key = std::pair(file, part);
  if (const auto known = read_.find(key); known != read_.end()) return known->second;
  std::optional<std::size_t> number;
  try {
    // Gazebo and Stonefish use the coordinates of a file that states no vertical axis as they are.
    NamedMesh read = read_mesh_file(*place.file, {{}, {}, "z", unit_m_});
    for (const std::string& warning : read.warnings)
      notice(node, fmt::format("'{}': {}", shown_line(trimmed(uri)), shown_line(warning)));
    if (std::ranges::find(scene_.inputs, file) == scene_.inputs.end()) scene_.inputs.push_back(file);
    if (cut_to(read, part))
      number = mesh(file.stem().string() + (part.name.empty() ? "" : "_" + part.name), std::move(read));
    else
      left_out(fmt::format("no part of the mesh has the name '{}'", shown_line(part.name)));
  } catch (const InputError& error) {
    left_out(error.what());
  }
  read_[key] = number;
  return number;
}

std::size_t WorldParts::mesh(const std::string& stem, ComponentMesh mesh) {
  scene_.meshes.push_back({unique_in(stems_, plain_stem(stem, "unnamed")) + ".obj", std::move(mesh)});
  return scene_.meshes.size() - 1;
}

void WorldParts::read_own_scene(pugi::xml_node parent) {
  const pugi::xml_node own = parent.child("tubefoot:scene");
  if (!own) return;
  scene_.title = shown_line(own.attribute("title").value());
  if (own.attribute("sound_speed_m_s"))
    scene_.sound_speed_m_s = xml_.attribute_number(own, "sound_speed_m_s", 0);
  if (own.attribute("absorption_db_per_km"))
    scene_.absorption_db_per_km = xml_.attribute_number(own, "absorption_db_per_km", 0);
  for (const pugi::xml_node node : own.children("tubefoot:material")) {
    const std::string name = shown_line(node.attribute("name").value());
    if (name.empty()) xml_.fail(node, "the material has no name");
    if (!materials_.insert(name).second)
      xml_.fail(node, fmt::format("two materials have the name '{}'", name));
    scene_.materials.push_back({name, xml_.attribute_number(node, "lambert_db", assumed_db)});
  }
}

void WorldParts::sound_speed(pugi::xml_node node, double m_s) {
  constexpr double slowest_m_s = 1300, fastest_m_s = 1700;  // limits of a scene
  if (!(m_s >= slowest_m_s && m_s <= fastest_m_s))
    notice(node, fmt::format("its sound speed of {} m/s is left out: expected {} to {} m/s", m_s, slowest_m_s,
                             fastest_m_s));
  else if (!scene_.sound_speed_m_s)
    scene_.sound_speed_m_s = m_s;
  else if (*scene_.sound_speed_m_s != m_s)
    notice(node, fmt::format("its sound speed of {} m/s is left out, because the water of the scene has {} "
                             "m/s",
                             m_s, *scene_.sound_speed_m_s));
}

std::string WorldParts::material(const std::string& name) {
  const std::string known = name.empty() ? "unknown" : shown_line(name);
  if (materials_.insert(known).second) {
    constexpr std::size_t most = 60'000;  // limit of a scene
    if (scene_.materials.size() >= most) xml_.fail(xml_.root(), "has more materials than a scene can hold");
    scene_.materials.push_back({known, assumed_db});
    assumed_.insert(known);
  }
  return known;
}

std::string WorldParts::unique(const std::string& name) {
  return unique_in(names_, name.empty() ? "object" : shown_line(name));
}

std::size_t WorldParts::mirrored(std::size_t of, glm::dvec3 sign) {
  const auto key = std::pair(of, std::array{sign.x < 0, sign.y < 0, sign.z < 0});
  if (const auto known = mirrored_.find(key); known != mirrored_.end()) return known->second;
  ImportedMesh copy = scene_.meshes[of];
  for (glm::dvec3& p : copy.mesh.points_m) p *= sign;
  if (sign.x * sign.y * sign.z < 0)
    for (auto& triangle : copy.mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mirrored_[key] = mesh(copy.file.stem().string() + "_mirrored", std::move(copy.mesh));
}

void WorldParts::add_object(pugi::xml_node node, ImportedObject object, const Placement& placed) {
  constexpr std::size_t most = 100'000;
  if (scene_.objects.size() >= most)
    xml_.fail(node, fmt::format("the world has more than {} objects: import its models separately", most));
  object.name = unique(object.name);
  if (object.shape != "mesh" && !has_size(object))
    return notice(node, fmt::format("'{}' is left out: all of its lengths must be above 0", object.name));
  object.placed = {axes_.world.to_ours(placed.position_m),
                   glm::transpose(axes_.world.matrix()) * placed.turn};
  glm::dvec3 sign(1);
  for (int k = 0; k < 3; ++k) {
    double& scale = object.scale[static_cast<std::size_t>(k)];
    if (scale == 0) return notice(node, fmt::format("'{}' is left out: its scale is 0", object.name));
    if (scale < 0) sign[k] = -1;
    scale = std::abs(scale);
  }
  if (object.mesh && sign != glm::dvec3(1)) object.mesh = mirrored(*object.mesh, sign);
  scene_.objects.push_back(std::move(object));
}

bool WorldParts::add_own_sonar(pugi::xml_node sensor, const Placement& frame, const Axes& of_frame) {
  if (sensor.child("tubefoot:part_of")) return true;
  const pugi::xml_node own = sensor.child("tubefoot:sonar");
  if (!own) return false;
  const std::vector<double> pose =
      xml_.numbers(own, own.attribute("pose").value(), 6, "pose of <tubefoot:sonar>");
  ImportedSensor read;
  read.name = shown_line(own.attribute("name").value());
  for (const pugi::xml_attribute attribute : own.attributes()) {
    const std::string_view key = attribute.name();
    if (key == "pose" || key == "name") continue;
    const std::string value = toml_value(attribute.value());
    if (!is_key(key) || value.empty())
      xml_.fail(own, fmt::format(
                         "{}=\"{}\" is not a sonar key with a number, several numbers or a word as its value",
                         shown_line(key), shown_line(std::string_view(attribute.value()).substr(0, 100))));
    read.keys.emplace_back(key, value);
  }
  const Placement theirs =
      frame * Placement{{pose[0], pose[1], pose[2]}, turn_of({pose[3], pose[4], pose[5]})};
  read.own = to_ours(theirs, axes_.world, of_frame);
  keep(own, std::move(read));
  return true;
}

void WorldParts::add_sensor(pugi::xml_node node, ImportedSensor sensor, const Placement& placed,
                            bool looks_down) {
  sensor.own = to_ours(placed, axes_.world, axes_.sonar);
  if (looks_down) sensor.own.turn = sensor.own.turn * glm::transpose(looking_down);
  keep(node, std::move(sensor));
}

void WorldParts::keep(pugi::xml_node node, ImportedSensor sensor) {
  constexpr std::size_t most = 1000;
  if (scene_.sensors.size() >= most)
    return notice(node, fmt::format("the sonar is left out: a scene holds at most {} sonars", most));
  // The name becomes part of file names.
  const std::string plain = plain_stem(sensor.name, "unnamed");
  if (plain != sensor.name) notice(node, fmt::format("sonar '{}' is renamed to '{}'", sensor.name, plain));
  sensor.name = unique_in(sensor_names_, plain);
  ImportedScene alone;
  alone.materials.push_back({"any", assumed_db});
  alone.sensors.push_back(sensor);
  try {
    read_scene_text(scene_text(alone) + "\n[[terrain]]\nkind = \"flat\"\nwidth_m = 1\nlength_m = 1\n",
                    world_);
  } catch (const InputError& error) {
    std::string why = error.what();
    if (const std::size_t place = why.find(": "); place != std::string::npos) why = why.substr(place + 2);
    return notice(node, fmt::format("sonar '{}' is left out: {}", sensor.name, why));
  }
  scene_.sensors.push_back(std::move(sensor));
}

ImportedScene WorldParts::finish() {
  if (scene_.objects.empty())
    throw InputError({world_.string(), 0, 0},
                     scene_.noticed.empty()
                         ? "has no geometry: expected a mesh, box, sphere, cylinder, cone or plane"
                         : fmt::format("has no geometry that tubefoot reads ({} of {} <include> read); the "
                                       "first part that is left out: {}",
                                       included_, included_ + not_included_, scene_.noticed.front()));
  if (not_told_ > 0) scene_.noticed.push_back(fmt::format("there are {} more notes", not_told_));
  if (included_ + not_included_ > 0)
    scene_.noticed.push_back(fmt::format("read {} of {} <include>", included_, included_ + not_included_));
  for (const std::string& name : assumed_)
    scene_.noticed.push_back(
        fmt::format("material '{}' has no scattering strength in the world; lambert_db = {} is assumed: "
                    "change it in scene.toml",
                    name, assumed_db));
  for (const auto& [name, count] : passed_over_)
    scene_.noticed.push_back(fmt::format("left out: {} x <{}>", count, name));
  std::vector<std::string> unneeded;
  for (const auto& [name, count] : without_effect_) unneeded.push_back(fmt::format("{} x <{}>", count, name));
  if (!unneeded.empty())
    scene_.noticed.push_back(
        fmt::format("without effect on the echoes of a scene at rest: {}", fmt::join(unneeded, ", ")));
  if (!scene_.sound_speed_m_s)
    scene_.noticed.push_back("the world does not describe the water: scene.toml uses defaults");
  return std::move(scene_);
}

ComponentMesh plane_mesh(double width, double length) {
  ComponentMesh mesh;
  for (const double y : {-0.5, 0.5})
    for (const double x : {-0.5, 0.5}) mesh.points_m.emplace_back(x * width, y * length, 0);
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
  return mesh;
}

ImportedScene read_world(const fs::path& world, const std::vector<fs::path>& model_path,
                         std::optional<double> unit_m) {
  refuse_template(world);
  XmlInput xml(world);
  const std::string root = xml.root().name();
  if (root != "sdf" && root != "scenario")
    throw InputError(
        xml.place_of(xml.root()),
        fmt::format("begins with <{}>: expected <sdf> (Gazebo) or <scenario> (Stonefish){}",
                    name_in(xml.root()),
                    root == "robot" ? "; 'gz sdf -p FILE' converts a robot in URDF to SDF" : ""));
  const bool stonefish = root == "scenario";
  WorldParts parts(xml, world, stonefish ? ExchangeFormat::stonefish : ExchangeFormat::sdf, model_path,
                   unit_m);
  (stonefish ? read_stonefish : read_sdf)(parts);
  return parts.finish();
}

}  // namespace tubefoot
