// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "engine/scattering/layered_reflectivity.hpp"
#include "engine/scattering/pattern_levels.hpp"
#include "run/paths.hpp"
#include "run/stored_pings.hpp"

// This file computes the labels of energies. Each owner (object and material) has an echo model in which all
// other owners scatter nothing. Mean height and mean range use a weight as a further factor of the
// reflectivity texture (docs/output-files.md).

namespace tubefoot {
namespace {

/// A factor that is a function of position and as smooth as a range. All weights have the same bound on
/// their complex growth. Quadratures therefore use the same nodes for each of them, and their means are
/// consistent.
class Weight : public ReflectivityField {
 public:
  explicit Weight(double scale_m) : scale_m_(scale_m) {}
  double factor(glm::dvec3) const override { return 1; }
  double largest() const override { return 1; }
  double finest_m() const override { return std::numeric_limits<double>::infinity(); }
  std::span<const CellPlanes> cells() const override { return {}; }
  double change(double away_m) const override { return away_m / scale_m_; }

 protected:
  const double scale_m_;
};

class HeightWeight : public Weight {
 public:
  HeightWeight(double lowest_m, double scale_m) : Weight(scale_m), lowest_m_(lowest_m) {}
  double factor(glm::dvec3 place_m) const override { return (place_m.z - lowest_m_) / (2 * scale_m_); }

 private:
  const double lowest_m_;
};

/// The mean of the ranges from both ends.
class RangeWeight : public Weight {
 public:
  RangeWeight(glm::dvec3 tx_m, glm::dvec3 rx_m, double scale_m) : Weight(scale_m), tx_m_(tx_m), rx_m_(rx_m) {}
  double factor(glm::dvec3 place_m) const override {
    return (glm::distance(place_m, tx_m_) + glm::distance(place_m, rx_m_)) / (2 * scale_m_);
  }

 private:
  const glm::dvec3 tx_m_, rx_m_;
};

bool is_uniform(const BeamPatterns& patterns) {
  const auto uniform = [](const Directivity& one) { return one.kind == Directivity::Kind::uniform; };
  return std::ranges::all_of(patterns.receive, uniform) &&
         std::ranges::all_of(patterns.transmit, [&](const TransmitPattern& sent) {
           return sent.beams.size() == 1 && uniform(sent.beams.front());
         });
}

const Scene& whole_scene(const Survey& survey) {
  return survey.loaded_scene->whole ? survey.loaded_scene->whole->scene : survey.scene;
}

}  // namespace

LabelChannels::LabelChannels(const Survey& survey, const RunRequest& request)
    : scene_mesh_(&survey.scene.mesh) {
  const Scene& scene = whole_scene(survey);
  const std::size_t materials = scene.description.materials.size();
  number_.assign(scene.report.components.size(), std::vector<std::int32_t>(materials, -1));
  const FacetMesh& mesh = scene.mesh;
  for (FacetId f = 0; f < mesh.facets.size(); ++f) number_.at(mesh.component[f]).at(mesh.material[f]) = 0;
  for (std::size_t k = 0; k < scene.tiled.size(); ++k) {  // for tiles that are not loaded yet
    const TiledTerrain& terrain = scene.tiled[k];
    if (!terrain.tiles) continue;
    if (terrain.map) std::ranges::fill(number_.at(k), 0);
    number_.at(k).at(terrain.material) = 0;
  }
  for (std::size_t object = 0; object < number_.size(); ++object)
    for (std::size_t material = 0; material < materials; ++material) {
      if (number_[object][material] < 0) continue;
      number_[object][material] = static_cast<std::int32_t>(owners_.size());
      owners_.push_back({static_cast<std::uint16_t>(object), static_cast<std::uint16_t>(material)});
    }
  has_unscattered_ = std::ranges::any_of(survey.sensors, [&](const SensorPings& pings) {
    return path_settings(survey.scene, pings.sensor->frequency_khz()).has_value();
  });
  if (std::ranges::any_of(survey.sensors, [](const SensorPings& p) { return p.sensor->has_patterns(); }))
    label_level_db_ = request.label_level_db;
}

std::uint16_t LabelChannels::owner(std::uint16_t object, std::uint16_t material) const {
  const std::int32_t number = number_.at(object).at(material);
  if (number < 0)
    throw std::logic_error(
        fmt::format("no facet of the scene belongs to object {} and has material {}", object, material));
  return static_cast<std::uint16_t>(number);
}

std::vector<std::uint16_t> LabelChannels::owners_of(const FacetMesh& mesh) const {
  std::vector<std::uint16_t> owners(mesh.facets.size());
  for (FacetId f = 0; f < mesh.facets.size(); ++f) owners[f] = owner(mesh.component[f], mesh.material[f]);
  return owners;
}

std::span<const std::uint16_t> LabelChannels::owners_of_loaded_scene() const {
  std::call_once(loaded_scene_owned_, [&] { owners_of_loaded_scene_ = owners_of(*scene_mesh_); });
  return owners_of_loaded_scene_;
}

const FacetMesh& LabelChannels::owned_scene_mesh() const {
  std::call_once(mesh_owned_, [&] {
    owned_ = *scene_mesh_;
    const std::span<const std::uint16_t> owners = owners_of_loaded_scene();
    owned_.material.assign(owners.begin(), owners.end());
  });
  return owned_;
}

LabelModels::LabelModels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
                         const FacetMesh& mesh)
    : transmission_(transmission), labels_(*transmission.labels()), sensor_(sensor), model_(model) {
  if (&mesh == &labels_.scene_mesh()) {
    owners_ = labels_.owners_of_loaded_scene();
  } else {
    own_ = labels_.owners_of(mesh);
    owners_ = own_;
  }
  make_tables();
}

LabelModels::LabelModels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
                         std::vector<std::uint16_t> owners)
    : transmission_(transmission),
      labels_(*transmission.labels()),
      sensor_(sensor),
      model_(model),
      own_(std::move(owners)),
      owners_(own_) {
  make_tables();
}

void LabelModels::make_tables() {
  const RangeSamples& samples = transmission_.sensor(sensor_).samples();
  const glm::dvec3 tx_m = model_.path.tx.apex_m;
  // No position on a path is farther from either end than the path is long.
  scale_m_ = 2 * (samples.first_m + samples.count * samples.step_m);
  lowest_m_ = tx_m.z - scale_m_;
  glm::dvec3 rx_m = tx_m;
  if (transmission_.has_separate_receiver()) {
    const WorldGrid& grid = transmission_.scene().grid;
    rx_m = grid.to_metres(grid.snap(transmission_.receiver_pose().position_m));
  }
  for (const LabelChannels::Owner& owner : labels_.owners()) {
    mu_.push_back(model_.material_mu[owner.material]);
    if (!model_.scattering.empty()) scattering_.push_back(model_.scattering[owner.material]);
    plain_.push_back(model_.reflectivity.empty() ? nullptr : model_.reflectivity[owner.material]);
  }
  no_mu_.assign(mu_.size(), 0);
  no_scattering_.assign(scattering_.size(), nullptr);
  level_ = weighed_by(std::make_shared<Weight>(scale_m_));
  height_ = weighed_by(std::make_shared<HeightWeight>(lowest_m_, scale_m_));
  range_ = weighed_by(std::make_shared<RangeWeight>(tx_m, rx_m, scale_m_));
}

LabelModels::Textures LabelModels::weighed_by(const std::shared_ptr<const ReflectivityField>& weight) const {
  Textures textures;
  for (const auto& texture : plain_)
    textures.push_back(
        texture == nullptr ? weight : std::make_shared<const LayeredReflectivity>(Textures{texture, weight}));
  return textures;
}

EchoModel LabelModels::whole() const {
  EchoModel model = model_;
  model.material = owners_;
  model.material_mu = mu_;
  model.scattering = scattering_;
  model.reflectivity = plain_;
  return model;
}

EchoModel LabelModels::silent() const {
  EchoModel model = whole();
  model.material_mu = no_mu_;
  model.scattering = no_scattering_;
  return model;
}

void LabelModels::add(PingSums& sums, const EchoBy& echo_by) const {
  EchoModel model = silent();
  model.reflectivity = level_;
  BeamPatterns near_peak;
  const bool is_limited =
      labels_.label_level_db() && model_.patterns != nullptr && !is_uniform(*model_.patterns);
  if (is_limited) {
    near_peak = *model_.patterns;
    near_peak.least =
        gains_below_peak(near_peak, *labels_.label_level_db(), transmission_.has_separate_receiver());
  }
  std::vector<double> mu = no_mu_, all;
  auto scattering = no_scattering_;
  model.material_mu = mu;
  model.scattering = scattering;
  const auto show = [&](std::size_t owner, bool seen) {
    mu[owner] = seen ? mu_[owner] : 0;
    if (!scattering.empty()) scattering[owner] = seen ? scattering_[owner] : nullptr;
  };
  for (std::size_t owner = 0; owner < mu_.size(); ++owner) {
    show(owner, true);
    const std::vector<double> energy = echo_by(model);
    if (is_limited) {
      model.patterns = &near_peak;
      sums.add_to_channel(transmission_, sensor_, "labels", labels_.near_peak(owner), echo_by(model));
      model.patterns = model_.patterns;
    } else if (labels_.label_level_db()) {
      sums.add_to_channel(transmission_, sensor_, "labels", labels_.near_peak(owner), energy);
    }
    show(owner, false);
    all.resize(energy.size(), 0);
    std::ranges::transform(all, energy, all.begin(), std::plus<>());
    sums.add_to_channel(transmission_, sensor_, "labels", owner, energy);
  }
  model.material_mu = mu_;
  model.scattering = scattering_;
  model.reflectivity = height_;
  std::vector<double> heights = echo_by(model);
  for (std::size_t k = 0; k < heights.size(); ++k)
    heights[k] = 2 * scale_m_ * heights[k] + lowest_m_ * all[k];
  sums.add_to_channel(transmission_, sensor_, "labels", labels_.height(), heights);
  model.reflectivity = range_;
  std::vector<double> ranges = echo_by(model);
  for (double& range : ranges) range *= scale_m_;
  sums.add_to_channel(transmission_, sensor_, "labels", labels_.range(), ranges);
}

LabelledSurface::LabelledSurface(const Transmission& transmission, const FacetMesh& mesh) {
  const LabelChannels& labels = *transmission.labels();
  if (&mesh == &labels.scene_mesh()) {
    loaded_scene = &labels.owned_scene_mesh();
  } else {
    own.emplace(mesh);
    own->material = labels.owners_of(mesh);
  }
  const std::vector<double>& by_material = transmission.scene().material_reflection;
  for (const LabelChannels::Owner& owner : labels.owners())
    reflection.push_back(owner.material < by_material.size() ? by_material[owner.material] : 0);
}

std::vector<LabelRecording> label_recordings_of(const Survey& survey, const RunRequest& request,
                                                const std::shared_ptr<PingStore>& store) {
  std::vector<LabelRecording> label_recordings;
  if (!request.labels) return label_recordings;
  const LabelChannels labels(survey, request);
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, request.selection);
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    if (chosen[s].pings == 0) continue;
    const Sensor& sensor = *survey.sensors[s].sensor;
    LabelRecording& one = label_recordings.emplace_back();
    for (const ComponentReport& component : survey.scene.report.components)
      one.objects.push_back(component.name);
    for (const MaterialDescription& material : survey.scene.description.materials)
      one.materials.push_back(material.name);
    one.owners = labels.owners();
    one.has_unscattered = labels.has_unscattered();
    one.label_level_db = labels.label_level_db();
    one.cells = chosen[s].beams.size() * static_cast<std::size_t>(sensor.samples().count);
    one.recorded = recorded_channel(store, s, "labels");
  }
  return label_recordings;
}

}  // namespace tubefoot
