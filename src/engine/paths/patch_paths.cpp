// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/patch_paths.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "engine/paths/patch_echo.hpp"
#include "engine/paths/patches.hpp"
#include "engine/scattering/density.hpp"
#include "engine/water/apparent_map.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/steps.hpp"

// Computes multiple scattering generation by generation. A patch scatters from its centroid to the receivers
// and to the patches of the next generation, with its own exact visibility. Source:
// docs/notes/multiple-paths.md, "Several scatterings".

namespace tubefoot {
namespace {

/// Limit of the delays of one generation.
constexpr double most_delays = 2e8;
/// Number of sources that are computed concurrently. Their results are added in the order of the sources.
constexpr std::size_t batch = 64;

/// Energy after a path of length `way_m`. `strength` is scattered along the normal, in J/sr.
struct Delayed {
  double way_m = 0, strength = 0;
};

/// Patch as a source of the next scattering.
struct Source {
  int interactions = 0;  ///< number of interactions on the path, including the one at this patch
  std::uint32_t fan = 0;
  FacetId facet = 0;
  GridPoint at;
  glm::dvec3 normal{0};
  double strength = 0;  ///< sum over all delays
  std::vector<Delayed> signal;
};

/// Contribution of a source to a patch of the next generation.
struct Link {
  int interactions = 0;
  RadiosityPatch patch;
  GridPoint seen_from;
  double way_m = 0, gain = 0;
};

struct Bin {
  std::size_t order, bin;
  double energy;
};

/// Result of one source.
struct Sent {
  std::vector<Bin> bins;
  std::vector<Link> links;
  std::size_t pieces = 0;
  SurfaceCounts seen;
};

/// Patches of the next generation while the current one insonifies them. There is one patch per facet, side
/// of the facet, cube, fan and number of interactions. Delays are stored in steps of one range sample of the
/// total path length. Each delay is split between the two nearest steps so that the mean is preserved.
class Generation {
 public:
  Generation(const PathScene& scene) : scene_(scene) {
    last_m_ = 2 * (scene.samples.first_m + scene.samples.step_m * scene.samples.count);
  }

  void take(const Source& source, const Link& link) {
    const glm::dvec3 centre = scene_.from_apex(link.seen_from) + link.patch.lies_m;
    Lit* lit = nullptr;
    for (const Delayed& delayed : source.signal) {
      const double way = delayed.way_m + link.way_m, strength = delayed.strength * link.gain;
      if (!(way < last_m_ && strength > 0)) continue;
      if (lit == nullptr) lit = &lit_at(source.fan, link);
      lit->strength += strength;
      lit->centre += strength * centre;
      const double place = way / scene_.samples.step_m, bin = std::floor(place), part = place - bin;
      lit->add(std::size_t(bin), (1 - part) * strength, held_);
      if (part > 0) lit->add(std::size_t(bin) + 1, part * strength, held_);
    }
    if (held_ > most_delays)
      throw std::length_error(
          fmt::format("patches of {:.3g} m for second scattering have more than {:.2g} delays: use larger "
                      "patches, or longer range bins",
                      scene_.settings.patch_m, most_delays));
  }

  std::vector<Source> sources() const {
    std::vector<Source> all;
    for (const auto& [key, lit] : lit_) {
      Source source;
      source.interactions = int(key[0]);
      source.fan = std::uint32_t(key[1]);
      source.facet = FacetId(key[2]);
      source.normal = lit.normal;
      source.strength = lit.strength;
      source.at = in_front(scene_.mesh, source.facet, lit.seen_from,
                           (lit.centre / lit.strength - scene_.from_apex(lit.seen_from)) / scene_.unit_m,
                           lit.normal, scene_.least_lift());
      for (std::size_t k = 0; k < lit.signal.size(); ++k)
        if (lit.signal[k] > 0)
          source.signal.push_back({double(lit.first + k) * scene_.samples.step_m, lit.signal[k]});
      all.push_back(std::move(source));
    }
    return all;
  }

 private:
  struct Lit {
    GridPoint seen_from;
    glm::dvec3 normal{0}, centre{0};  // centre: sum weighted by strength
    double strength = 0;
    std::size_t first = 0;
    std::vector<double> signal;
    void add(std::size_t bin, double energy, double& held) {
      const std::size_t before = signal.size();
      if (signal.empty()) first = bin;
      if (bin < first) {
        signal.insert(signal.begin(), first - bin, 0.0);
        first = bin;
      }
      if (bin >= first + signal.size()) signal.resize(bin - first + 1, 0);
      signal[bin - first] += energy;
      held += double(signal.size() - before);
    }
  };
  using Key = std::array<std::int64_t, 7>;

  Lit& lit_at(std::uint32_t fan, const Link& link) {
    const auto& v = scene_.mesh.facets[link.patch.facet];
    const glm::dvec3 a = scene_.from_apex(scene_.mesh.vertices[v[0]]);
    const glm::dvec3 front = glm::cross(scene_.from_apex(scene_.mesh.vertices[v[1]]) - a,
                                        scene_.from_apex(scene_.mesh.vertices[v[2]]) - a);
    const auto& cube = link.patch.cube;
    Lit& lit = lit_[Key{link.interactions, fan, link.patch.facet, glm::dot(front, link.patch.normal) > 0,
                        cube[0], cube[1], cube[2]}];
    if (lit.signal.empty()) {
      lit.seen_from = link.seen_from;
      lit.normal = link.patch.normal;
    }
    return lit;
  }

  const PathScene& scene_;
  double last_m_ = 0, held_ = 0;
  std::map<Key, Lit> lit_;
};

class PatchPaths {
 public:
  PatchPaths(const PathScene& scene, std::span<const ImageReceiver> received, PathEcho& echo)
      : scene_(scene),
        received_(received),
        echo_(echo),
        before_(scene.settings.before != nullptr ? *scene.settings.before : scene.model),
        least_(scene.settings.least()),
        beta_(absorption_per_m(scene.model.absorption_db_per_m)),
        workers_([&] {
          return Worker{
              PatchEcho(scene.model, scene.beams, scene.settings.patch_m, scene.settings.least_received),
              {},
              {}};
        }) {
    before_.material = scene.model.material;
    if (scene.refracted == nullptr) return;
    const PathWater& water = scene.refracted->water();
    double lowest_m = std::numeric_limits<double>::infinity();
    for (const GridPoint& vertex : scene.mesh.vertices)
      lowest_m = std::min(lowest_m, water.grid.to_metres(vertex).z);
    column_ = continued_below(water.column, water.surface_height_m - lowest_m, scene.reach * scene.unit_m);
    EigenrayOptions rays = water.rays;
    rays.deepest_turn_m = std::numeric_limits<double>::infinity();
    water_.emplace(PathWater{column_, water.surface_height_m, rays, water.reference_speed_m_s,
                             water.apparent_map, water.limits, water.grid});
  }

  void follow(std::span<const Image> sent) {
    std::vector<Source> sources;
    for (const Image& image : sent) {
      stop_if_wanted();
      light(image, sources);
    }
    double whole = 0;
    for (const Source& source : sources) whole += source.strength;
    for (int scatterings = 2; !sources.empty(); ++scatterings) {
      keep_strongest(sources, least_ * whole);
      const bool again = scatterings < scene_.settings.scatterings;
      Generation next(scene_);
      Steps steps("patches", sources.size());
      for (std::size_t first = 0; first < sources.size(); first += batch) {
        const std::size_t count = std::min(batch, sources.size() - first);
        std::vector<Sent> sends(count);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
          send(sources[first + k], again, sends[k]);
          steps.done();
        });
        for (std::size_t k = 0; k < count; ++k) {
          for (const Bin& bin : sends[k].bins) echo_.by_order[bin.order].energy[bin.bin] += bin.energy;
          for (const Link& link : sends[k].links) {
            stop_if_wanted();
            next.take(sources[first + k], link);
          }
          echo_.shared_pieces += sends[k].pieces;
          echo_.seen_by_patches.add(sends[k].seen);
        }
      }
      echo_.patches += sources.size();
      sources = next.sources();
    }
  }

 private:
  struct Worker {
    PatchEcho gather;
    SparseEnergy direct, delayed;
  };

  glm::dvec3 from_apex(GridPoint p) const { return scene_.from_apex(p); }

  /// Energy in J/sr that a patch scatters along its normal per J that arrives (mu with Lambert's law).
  double scattered_by(GridPoint from, const RadiosityPatch& patch) const {
    const double range = glm::length(patch.from_apex_m), sine = patch.sine;
    if (!(sine > 0)) return 0;
    const ScatteringModel* scattering = before_.model_of(patch.facet);
    double gain = scattering == nullptr ? before_.material_mu[before_.material[patch.facet]] : 1;
    gain *= scattering_lobe(scattering, sine) / sine * std::exp(-beta_ * range) * patch.absorbed;
    if (const ReflectivityField* texture = before_.texture(patch.facet))
      gain *= texture->factor(scene_.model.path.tx.apex_m + from_apex(from) + patch.lies_m);
    return gain;
  }

  /// Adds the sources of the first generation, the patches that an image of the transmitter sees. Their
  /// delays are exact.
  void light(const Image& image, std::vector<Source>& sources) const {
    const int interactions = int(image.mirrors) + 1;
    if (interactions >= scene_.settings.order) return;
    std::vector<std::uint32_t> fan_of_window;
    if (!scene_.beams.fan_of_transmit_tube.empty())
      for (const std::uint32_t tube : image.own_tube)
        fan_of_window.push_back(scene_.beams.fan_of_transmit_tube[tube]);
    const GridPoint apex = image.windows.apex;
    for (const RadiosityPatch& patch : patches_of(scene_.mesh, apex, scene_.seen_by(image), scene_.unit_m,
                                                  scene_.settings.patch_m, fan_of_window)) {
      const double range = glm::length(patch.from_apex_m);
      if (range / 2 >= scene_.samples.first_m + scene_.samples.step_m * scene_.samples.count) continue;
      const glm::dvec3 direction = patch.from_apex_m / range;
      Source source;
      source.interactions = interactions;
      source.fan = fan_of_window.empty() ? 0 : fan_of_window[patch.tube];
      source.facet = patch.facet;
      source.normal = patch.normal;
      // The received energy is that of the exact solid angle, so a patch receives no more than the
      // transmitter sends there.
      source.strength = scattered_by(apex, patch) * patch.solid_angle_sr * image.leg.loss.at(direction);
      if (scene_.model.patterns != nullptr)
        source.strength *= scene_.model.patterns->transmit[source.fan].gain(image.leg.to_true * direction);
      source.at = in_front(scene_.mesh, patch.facet, apex, patch.lies_m / scene_.unit_m, patch.normal,
                           scene_.least_lift());
      source.signal.push_back({range, source.strength});
      sources.push_back(std::move(source));
    }
  }

  /// Removes the weakest sources that together scatter no more than `allowed`.
  static void keep_strongest(std::vector<Source>& sources, double allowed) {
    std::vector<std::size_t> by_strength(sources.size());
    std::iota(by_strength.begin(), by_strength.end(), std::size_t{0});
    std::stable_sort(by_strength.begin(), by_strength.end(),
                     [&](std::size_t a, std::size_t b) { return sources[a].strength < sources[b].strength; });
    std::vector<bool> kept(sources.size(), true);
    double dropped = 0;
    for (const std::size_t k : by_strength) {
      dropped += sources[k].strength;
      if (dropped > allowed) break;
      kept[k] = false;
    }
    std::size_t count = 0;
    for (std::size_t k = 0; k < sources.size(); ++k)
      if (kept[k] && count++ != k) sources[count - 1] = std::move(sources[k]);
    sources.resize(count);
  }

  void send(const Source& source, bool again, Sent& sent) {
    const int most_mirrors = scene_.settings.order - source.interactions - 1;
    TubeSet tubes = front_tubes(source.at, source.normal, scene_.reach);
    std::optional<RefractedImages> refracted;
    if (water_) {
      // above the water surface
      if (!(water_->grid.to_metres(source.at).z < water_->surface_height_m)) return;
      refracted.emplace(*scene_.refracted, *water_, std::move(tubes), most_mirrors + 1,
                        SurfaceApex{source.normal, scene_.settings.patch_m});
    }
    const std::vector<Image> images =
        refracted ? refracted->images_of(0) : scene_.finder.images_of(std::move(tubes), most_mirrors);
    std::vector<VisibleSurface> seabeds;
    for (const Image& image : images)
      seabeds.push_back(scene_.seen_by(image, refracted ? &*refracted : nullptr));
    if (refracted) sent.seen = refracted->counts(seabeds);
    const ScatteringModel* scattering = before_.model_of(source.facet);
    for (std::size_t k = 0; k < images.size(); ++k) {
      stop_if_wanted();
      const Image& image = images[k];
      const int interactions = source.interactions + int(image.mirrors) + 1;
      const VisibleSurface& seen = seabeds[k];
      const PatchEcho::Point point{from_apex(image.windows.apex), image.leg.loss,
                                   glm::transpose(image.leg.to_true) * source.normal, scattering, source.fan};
      for (const ImageReceiver& received : received_) {
        const int order = interactions + int(received.receives.image().mirrors);
        if (order <= scene_.settings.order && image.largest * received.receives.largest() > least_)
          hear(source, seen, point, received, std::size_t(order), sent);
      }
      if (!again || interactions >= scene_.settings.order) continue;
      for (const RadiosityPatch& patch : patches_of(scene_.mesh, image.windows.apex, seen, scene_.unit_m,
                                                    scene_.settings.patch_m, {}, point.axis)) {
        const double range = glm::length(patch.from_apex_m);
        const glm::dvec3 direction = patch.from_apex_m / range;
        const double sine = glm::dot(direction, point.axis);
        if (!(sine > 0)) continue;
        // The received energy is that of the exact projected solid angle. With Lambert's law the total is pi
        // times the strength along the normal. The receiving patches therefore get no more than the source
        // scatters, however near they are.
        const double gain = scattered_by(image.windows.apex, patch) * image.leg.loss.at(direction) *
                            scattering_lobe(scattering, sine) / sine * patch.projected_sr;
        if (gain > 0) sent.links.push_back({interactions, patch, image.windows.apex, range, gain});
      }
    }
  }

  void hear(const Source& source, const VisibleSurface& seen, const PatchEcho::Point& point,
            const ImageReceiver& received, std::size_t order, Sent& sent) {
    Worker& worker = workers_.local();
    const RangeSamples& samples = scene_.samples;
    RangeSamples last_legs = samples;
    if (source.signal.size() == 1) {
      const Delayed& only = source.signal.front();
      last_legs.first_m -= only.way_m / 2;
      sent.pieces +=
          worker.gather.add(seen, point, received, scene_.model.path.tx.apex_m, last_legs, 0, worker.direct);
      worker.direct.drain([&](std::size_t bin, double energy) {
        sent.bins.push_back({order, bin, energy * only.strength});
      });
      return;
    }
    // Computes the response of the last two legs once, in half samples, and adds it once per delay. Delays
    // are whole samples of the total path, which are half samples of the half path.
    last_legs.step_m = samples.step_m / 2;
    const double soonest = source.signal.front().way_m / 2;
    last_legs.first_m = std::max(samples.first_m - source.signal.back().way_m / 2, 0.0);
    last_legs.count = int(std::ceil(
        (samples.first_m + samples.step_m * samples.count - soonest - last_legs.first_m) / last_legs.step_m));
    if (last_legs.count <= 0) return;
    sent.pieces += worker.gather.add(seen, point, received, scene_.model.path.tx.apex_m, last_legs,
                                     samples.step_m, worker.direct);
    const double step = samples.step_m;
    worker.direct.drain([&](std::size_t bin, double energy) {
      const std::size_t beam = bin / std::size_t(last_legs.count);
      const double from =
          last_legs.first_m + double(bin % std::size_t(last_legs.count)) * last_legs.step_m - samples.first_m;
      stop_if_wanted();
      for (const Delayed& delayed : source.signal) {
        const double place = (from + delayed.way_m / 2) / step, sample = std::floor(place);
        const double over = std::max(place - sample - 0.5, 0.0) * 2;  // fraction in the next sample
        const auto add = [&](double k, double part) {
          if (part > 0 && k >= 0 && k < samples.count)
            worker.delayed.add(beam * std::size_t(samples.count) + std::size_t(k),
                               part * energy * delayed.strength);
        };
        add(sample, 1 - over);
        add(sample + 1, over);
      }
    });
    worker.delayed.drain([&](std::size_t bin, double energy) { sent.bins.push_back({order, bin, energy}); });
  }

  const PathScene& scene_;
  std::span<const ImageReceiver> received_;
  PathEcho& echo_;
  EchoModel before_;  // model of all scatterings except the last
  double least_, beta_;
  WaterColumn column_;
  std::optional<PathWater> water_;  // water as seen from patches, if refracting
  tbb::enumerable_thread_specific<Worker> workers_;
};

}  // namespace

glm::dvec3 PathScene::from_apex(GridPoint p) const { return displacement_m(apex, p, unit_m); }

ReceiverViews PathScene::received_by(const Image& image) const {
  return {image, from_apex(image.windows.apex), seen_by(image)};
}

VisibleSurface PathScene::seen_by(const Image& image, const RefractedImages* by) const {
  if (refracted != nullptr) return (by != nullptr ? by : refracted)->seen_by(image);
  return {shared_with_itself(mesh, image.look(), unit_m)};
}

void add_scattered_paths(const PathScene& scene, std::span<const Image> sent,
                         std::span<const ImageReceiver> received, PathEcho& echo) {
  if (scene.refracted == nullptr) return PatchPaths(scene, received, echo).follow(sent);
  const FacetMesh& base = scene.refracted->base();
  EchoModel model = scene.model;
  model.material = base.material;
  const PathScene cut{base,  scene.unit_m,   scene.finder, scene.beams, scene.samples,
                      model, scene.settings, scene.apex,   scene.reach, scene.refracted};
  PatchPaths(cut, received, echo).follow(sent);
}

void add_scattered_paths(const PathScene& scene, std::span<const Image> sent, std::span<const Image> received,
                         PathEcho& echo) {
  std::vector<ImageReceiver> image_receivers;
  for (const Image& image : received)
    if (!image.seen.empty()) image_receivers.push_back({scene.received_by(image)});
  add_scattered_paths(scene, sent, image_receivers, echo);
}

}  // namespace tubefoot
