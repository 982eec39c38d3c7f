// SPDX-License-Identifier: GPL-3.0-or-later
// Collects the parts of a scene that other engines can represent: facets by component and material, and
// sonars at one ping. Lists the properties that no exchange format can represent.
#include "exchange/exchanged_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "exchange/sonar_keys.hpp"
#include "files/usage_error.hpp"
#include "run/survey.hpp"
#include "scene/tiled_scene.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

/// Returns plain_stem(), made unique by a number.
std::string stem_of(const std::string& name, std::set<std::string>& taken) {
  const std::string stem = plain_stem(name, "piece");
  std::string unique = stem;
  for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}_{}", stem, k);
  return unique;
}

std::vector<ExchangedPiece> pieces_of(const Scene& scene, const FacetMesh& mesh) {
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::vector<FacetId>> facets;
  std::map<std::uint16_t, std::set<std::uint16_t>> materials;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    facets[{mesh.component[f], mesh.material[f]}].push_back(f);
    materials[mesh.component[f]].insert(mesh.material[f]);
  }
  std::vector<ExchangedPiece> pieces;
  std::set<std::string> stems, names;
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(mesh.vertices.size(), none);
  for (const auto& [key, ids] : facets) {
    const auto [component, material] = key;
    ExchangedPiece piece;
    piece.name = scene.report.components.at(component).name;
    if (materials[component].size() > 1) piece.name += " of " + scene.description.materials.at(material).name;
    const std::string name = piece.name;
    for (int k = 2; !names.insert(piece.name).second; ++k) piece.name = fmt::format("{} {}", name, k);
    piece.file_stem = stem_of(piece.name, stems);
    piece.material = material;
    piece.triangles.reserve(ids.size());
    std::vector<VertexId> used;
    for (const FacetId f : ids) {
      std::array<std::uint32_t, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId vertex = mesh.facets[f][k];
        if (place[vertex] == none) {
          place[vertex] = static_cast<std::uint32_t>(used.size());
          used.push_back(vertex);
          piece.points_m.push_back(scene.grid.to_metres(mesh.vertices[vertex]));
        }
        triangle[k] = place[vertex];
      }
      piece.triangles.push_back(triangle);
    }
    for (const VertexId vertex : used) place[vertex] = none;
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// Returns the pieces of a scene that is loaded completely, with its moving objects at a time.
std::vector<ExchangedPiece> pieces_at(const Scene& scene, double time_s) {
  if (scene.moving.empty()) return pieces_of(scene, scene.mesh);
  FacetMesh moved = scene.mesh;
  place_moving(scene, time_s, moved);
  return pieces_of(scene, moved);
}

ExchangedSonar sonar_of(const Survey& survey, std::size_t index, std::size_t ping) {
  const SensorPings& pings = survey.sensors[index];
  const Sensor& sensor = *pings.sensor;
  ExchangedSonar sonar = sonar_words(sensor);
  sonar.sound_speed_m_s = pings.sound_speed_m_s;
  sonar.absorption_db_per_km = 1000 * absorption_db_per_m(survey.scene, sensor);
  const Trajectory& track = survey.scene.trajectories.at(survey.scene.sensor_trajectory.at(index));
  sonar.carrier = placement_of(track.at(pings.times_s[ping]));
  sonar.own = placement_of(pings.poses[ping]);
  sonar.placement = sonar.own;
  if (sonar.looks_down) sonar.placement.turn = sonar.own.turn * looking_down;
  return sonar;
}

void note_materials(const Survey& survey, std::vector<std::string>& out) {
  for (const MaterialDescription& material : survey.scene.description.materials) {
    std::string words;
    const auto add = [&](const std::string& what) { words += (words.empty() ? "" : ", ") + what; };
    if (material.model != "lambert") add(fmt::format("its scattering model '{}'", material.model));
    if (!material.reflectivity.empty()) add("its reflectivity texture");
    if (!material.relief.empty() && survey.loaded_scene->relief.parent.empty())
      add("its relief, which does not consist of facets ('tubefoot refine' and mode = \"offline\" convert it "
          "to facets)");
    if (material.specular_loss_db) add("its specular reflection");
    if (material.smooth) add("its smoothness");
    if (!words.empty())
      out.push_back(fmt::format("material '{}': {}; the exported material follows Lambert's law with {} dB",
                                material.name, words, material.lambert_db));
  }
}

void note_sensors(const Survey& survey, const std::vector<std::size_t>& chosen,
                  std::vector<std::string>& out) {
  for (const std::size_t k : chosen) {
    const Sensor& sensor = *survey.sensors[k].sensor;
    const std::string& name = sensor.description().name;
    if (sensor.has_patterns())
      out.push_back(fmt::format(
          "sensor '{}': its beam patterns; the exported beams are sectors without side lobes", name));
    if (sensor.has_receiver_pair())
      out.push_back(fmt::format("sensor '{}': its second receiver and the phase differences", name));
    if (sensor.receiver_moves())
      out.push_back(fmt::format("sensor '{}': its motion during a ping", name));
    else if (sensor.has_separate_receiver())
      out.push_back(fmt::format(
          "sensor '{}': its separate receiver; the exported sonar receives where it transmits", name));
    if (!sensor.transmit_sectors().empty())
      out.push_back(
          fmt::format("sensor '{}': the frequencies, pulses and absorptions of its transmit sectors", name));
    if (sensor.firings() > 1)
      out.push_back(fmt::format(
          "sensor '{}': the positions of its {} transmissions per ping; all are at the position of the first",
          name, sensor.firings()));
    if (!survey.sensors[k].poses.empty() && survey.sensors[k].times_s.size() > 1)
      out.push_back(fmt::format("sensor '{}': its other pings ({} in all); choose another one with --pings K",
                                name, survey.sensors[k].times_s.size()));
  }
}

std::vector<std::string> left_out(const Survey& survey, const std::vector<std::size_t>& chosen) {
  std::vector<std::string> out;
  const SceneDescription& description = survey.scene.description;
  note_materials(survey, out);
  if (survey.scene.water->refracts())
    out.push_back("the sound speed profile; rays are straight, with the sound speed at the sonar");
  if (moving_sea_surface_of(survey.scene) != nullptr)
    out.push_back(
        "the motion and the reflections of the sea surface; its facets are those of the exported ping");
  else if (description.sea_surface)
    out.push_back("the sea surface and its reflections");
  if (description.paths.order > 1 || description.paths.scatterings > 1)
    out.push_back("paths with more than one interaction");
  if (description.georeference) out.push_back("the georeference; positions are in metres in the local frame");
  note_sensors(survey, chosen, out);
  return out;
}

}  // namespace

std::size_t ExchangedScene::triangles() const {
  std::size_t count = 0;
  for (const ExchangedPiece& piece : pieces) count += piece.triangles.size();
  return count;
}

double ExchangedScene::largest_coordinate_m() const {
  double largest = 0;
  for (const ExchangedPiece& piece : pieces)
    for (const glm::dvec3& p : piece.points_m)
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

double float_rounding_m(double coordinate_m) {
  const auto value = static_cast<float>(std::abs(coordinate_m));
  return (static_cast<double>(std::nextafter(value, std::numeric_limits<float>::infinity())) - value) / 2;
}

ExchangedScene exchanged_scene(const Survey& survey, const std::optional<std::string>& sensor,
                               std::size_t ping) {
  std::vector<std::size_t> chosen;
  if (sensor)
    chosen.push_back(survey.sensor_set->sensor_named(*sensor));
  else
    for (std::size_t k = 0; k < survey.sensors.size(); ++k) chosen.push_back(k);
  for (const std::size_t k : chosen)
    if (const std::size_t pings = survey.sensors[k].times_s.size(); ping >= pings)
      throw UsageError(fmt::format("--pings {}: sensor '{}' has pings 0 to {}: choose one of them{}", ping,
                                   survey.sensors[k].sensor->description().name, pings - 1,
                                   chosen.size() > 1 ? ", or one sensor with --sensor" : ""));
  ExchangedScene scene;
  scene.title = survey.scene.description.title;
  scene.ping = ping;
  for (const MaterialDescription& material : survey.scene.description.materials)
    scene.materials.push_back({material.name, material.lambert_db});
  scene.sound_speed_m_s = survey.scene.sound_speed_m_s;
  const double time_s =
      chosen.empty() ? survey.scene.first_ping_s : survey.sensors[chosen.front()].times_s.at(ping);
  scene.pieces = survey.scene.tiled.empty()
                     ? pieces_at(survey.scene, time_s)
                     : pieces_at(with_tiles(survey.scene, all_tiles(survey.scene)), time_s);
  for (const std::size_t k : chosen) scene.sonars.push_back(sonar_of(survey, k, ping));
  scene.left_out = left_out(survey, chosen);
  if (!survey.scene.moving.empty() && std::ranges::any_of(chosen, [&](std::size_t k) {
        return survey.sensors[k].times_s.at(ping) != time_s;
      }))
    scene.left_out.push_back(fmt::format(
        "the places of moving objects at the pings of other sensors; they are at {:.9g} s, the time "
        "of the ping of sensor '{}', unless you export one sensor with --sensor",
        time_s, scene.sonars.front().name));
  if (std::ranges::any_of(scene.sonars, [&](const ExchangedSonar& sonar) {
        return sonar.absorption_db_per_km != scene.sonars.front().absorption_db_per_km;
      }))
    scene.left_out.push_back(
        "the absorption of each sonar, which only README.txt lists; if you import the scene again, it has "
        "the default absorption, unless you export one sonar with --sensor");
  for (const ExchangedSonar& sonar : scene.sonars)
    if (sonar.narrowly_lit)
      scene.left_out.push_back(fmt::format(
          "sensor '{}': its transmit sector; the exported sonar transmits into its receive sector",
          sonar.name));
  return scene;
}

std::string plain_stem(const std::string& name, const char* otherwise) {
  std::string stem = name.substr(0, 60);
  for (char& c : stem) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    if (!plain) c = '_';
  }
  return stem.empty() ? otherwise : stem;
}

}  // namespace tubefoot
