// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes CSV tables: trajectories, sound-speed profiles and casts, layers of volume scattering, beam
// patterns, and scattering models. A reader may only reject a table by InputError.
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>

#include "files/shown.hpp"
#include "fuzz.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/scene_water.hpp"
#include "scene/surfaces/scattering.hpp"
#include "scene/volume_layers.hpp"
#include "scene/waypoint_file.hpp"
#include "sensors/model/pattern_file.hpp"

namespace tubefoot::fuzz {
namespace {

using Path = std::filesystem::path;

/// In a frame on Earth, over a terrain with a hole, with and without times.
void trajectory(const Path& file, std::optional<double> speed_m_s) {
  const TrackSurroundings around{LocalFrame::at_lat_lon(50, 8, 0), 0, [](std::span<const glm::dvec2> places) {
                                   std::vector<std::optional<double>> heights(places.size(), -20.0);
                                   if (places.size() > 5) heights[5].reset();
                                   return heights;
                                 }};
  const Trajectory read = read_waypoints({file, speed_m_s}, around);
  for (const double part : {0.0, 0.3, 1.0}) {
    const Pose pose = read.at(std::lerp(read.begin_s(), read.end_s(), part));
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(pose.position_m[k])) finding("a pose at no place");
    if (!(std::abs(glm::length(pose.attitude) - 1) < 1e-9)) finding("an attitude that is no rotation");
  }
}

void water(const Path& file, const char* profile, const char* formula) {
  WaterDescription description;
  description.place.file = "scene.toml";
  description.profile = profile;
  description.sound_speed_formula = formula;
  description.profile_file = file;
  const SceneWater read(description);
  for (const double depth_m : {-50.0, 0.0, 3.3, 200.0, 12000.0})
    if (!(read.profile().at(depth_m) >= 100)) finding("no sound speed");
  for (const double loss : read.column(100).absorption_db_per_m)
    if (!std::isfinite(loss)) finding("no absorption");
}

void volume_layers(const Path& file) {
  WaterDescription description;
  description.volume_scattering_file = file;
  const VolumeScattering read = load_volume_scattering(description, 3, true);
  check(read);
  if (read.s_v_per_m.back() != 0) finding("scattering above the surface");
  if (const auto warning = short_layers_warning(description, read, 3, -20)) check_message(shown(*warning));
}

void pattern(const Path& file) {
  const PatternTable read = read_pattern_file(file);
  for (double angle_rad = -3.2; angle_rad < 3.2; angle_rad += 0.1)
    if (!(std::abs(read.level_db(angle_rad)) <= 1000.001)) finding("a level out of the table's range");
}

void scattering(const Path& file) {
  SceneDescription scene;
  MaterialDescription material;
  material.place.file = "scene.toml";
  material.name = "sand";
  material.model = "table";
  material.table_file = file;
  material.unbounded = true;
  scene.materials.push_back(material);
  std::vector<std::string> warnings;
  const auto laws = load_scattering(scene, warnings);
  for (const double sine : {1e-6, 0.5, 1.0})
    if (!(laws.at(0)->cross_section(sine, std::sqrt(1 - sine * sine)) >= 0)) finding("no cross-section");
  for (const std::string& warning : warnings) check_message(shown(warning));
}

}  // namespace
}  // namespace tubefoot::fuzz

/// A byte for the kind of table, then the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  fuzz::Bytes bytes(data, size);
  const std::uint32_t kind = bytes.below(8);
  const auto file = fuzz::scratch_file("t.csv", bytes.rest());
  fuzz::may_refuse([&] {
    switch (kind) {
      case 0:
        return fuzz::trajectory(file, std::nullopt);
      case 1:
        return fuzz::water(file, "table", "mackenzie");
      case 2:
        return fuzz::water(file, "cast", "mackenzie");
      case 3:
        return fuzz::water(file, "cast", "leroy");
      case 4:
        return fuzz::pattern(file);
      case 5:
        return fuzz::scattering(file);
      case 7:
        return fuzz::volume_layers(file);
      default:
        return fuzz::trajectory(file, 1.5);
    }
  });
  return 0;
}
