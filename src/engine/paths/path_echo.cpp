// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/path_echo.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "engine/certified/bistatic_reference.hpp"
#include "engine/certified/certified_arrival.hpp"
#include "engine/certified/reference.hpp"
#include "engine/paths/enclosed_images.hpp"
#include "engine/paths/image_pairs.hpp"
#include "engine/paths/patch_paths.hpp"
#include "engine/rays/shared_hits.hpp"
#include "engine/visibility/part_label.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/steps.hpp"
#include "geometry/tubes/window_tubes.hpp"

// Computes single scatterings between pairs of images (by footprints or by rays) and the arrivals of
// unscattered paths. With a reference, each energy has a bound. Source: docs/notes/multiple-paths.md,
// "One scattering and none".

namespace tubefoot {
namespace {

/// Images of both apexes, and the echoes between them.
class PathTracer {
 public:
  PathTracer(const FacetMesh& mesh, double unit_m, const KnownImages& images, const TubeSet& receive,
             const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
             const PathSettings& settings)
      : mesh_(mesh),
        unit_m_(unit_m),
        finder_(images.finder),
        transmit_(images.sent),
        receive_(images.received),
        beams_(beams),
        samples_(samples),
        model_(model),
        settings_(settings),
        least_(settings.least()),
        beta_(absorption_per_m(model.absorption_db_per_m)),
        true_apex_(images.sent.front().windows.apex),
        true_receive_(receive),
        one_place_(images.sent.data() == images.received.data()),
        refracted_(images.refracted) {
    echo_.by_order.resize(std::size_t(settings.order) + 1);
    for (Echo& echo : echo_.by_order) {
      echo.beams = beams.count;
      echo.samples = samples.count;
      echo.energy.assign(std::size_t(beams.count) * std::size_t(samples.count), 0);
    }
    echo_.images = transmit_.size() - 1 + (one_place_ ? 0 : receive_.size() - 1);
    if (!settings.reference_tolerance) return;
    for (const Echo& echo : echo_.by_order) echo_.bound_by_order.emplace_back(echo.energy.size(), 0.0);
    if (refracted_ == nullptr) return;
    seabed_model_ = model;
    seabed_model_.material = refracted_->seabed().material;
    enclosed_.emplace(*refracted_, seabed_model_, settings.mirrors.reflection,
                      std::initializer_list<std::span<const Image>>{
                          images.sent, one_place_ ? std::span<const Image>() : images.received});
  }

  PathEcho trace() {
    scatter();
    if (settings_.scatterings > 1)
      add_scattered_paths({mesh_, unit_m_, finder_, beams_, samples_, model_, settings_, true_apex_,
                           true_receive_.reach, refracted_},
                          transmit_, receive_, echo_);
    return arrivals();
  }

  PathEcho arrivals() {
    for (const Image& image : settings_.arrivals ? transmit_ : std::span<const Image>())
      if (image.mirrors > 0 || (settings_.direct && !one_place_))
        enclosed_ ? arrive_enclosed(image) : arrive(image);
    if (enclosed_) add_unknown();
    return std::move(echo_);
  }

 private:
  /// Result of one task: non-empty bins of an order.
  struct Part {
    struct Bin {
      std::size_t order, bin;
      double energy, bound;
    };
    std::vector<Bin> bins;
    std::size_t pieces = 0, hits = 0;
    double misfit_m = 0;
  };

  /// Adds the single scatterings of all pairs of images. A monostatic sonar shares the common visibility of
  /// a pair between both directions.
  void scatter() {
    if (settings_.order < 2) return;
    const std::vector<ImagePair> pairs = pairs_of_images(transmit_, receive_, one_place_, settings_.order,
                                                         least_, 100 * settings_.most_images);
    if (settings_.sampled) return sample(pairs);
    std::vector<Part> parts(pairs.size());
    Steps steps("pairs of images", pairs.size());
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t k) {
      steps.done();
      const Image &sent = transmit_[pairs[k].sent], &received = receive_[pairs[k].received];
      const bool itself = &sent == &received;
      const std::size_t order = sent.mirrors + received.mirrors + 1;
      if (refracted_) {
        add_refracted(parts[k], order, sent, received);
        if (one_place_ && !itself) add_refracted(parts[k], order, received, sent);
        return;
      }
      const SharedDetails details{.corner_rests = settings_.reference_tolerance && !settings_.rounds_corners};
      SharedFootprints shared =
          itself ? shared_with_itself(mesh_, sent.look(), unit_m_, details)
                 : FootprintSharer(mesh_, sent.look(), received.look(), unit_m_, details).all();
      if (shared.pieces.empty()) return;
      const std::size_t pieces = shared.pieces.size();
      if (one_place_ && !itself)
        add(parts[k], order,
            scattered(received, sent, {received.windows, sent.windows, unit_m_, exchanged(shared)}), pieces);
      add(parts[k], order,
          scattered(sent, received, {sent.windows, received.windows, unit_m_, std::move(shared)}), pieces);
    });
    for (const Part& part : parts) take(part);
  }

  /// Image prepared for the ray engine.
  struct RayImage {
    RayImage(const Image& image, const FacetMesh& mesh, const SampledPaths& sampled) : finder(image.windows) {
      if (image.mesh != &mesh) own.emplace(*image.mesh, sampled.grid);
      end.emplace(SampledEnd{own ? *own : *sampled.scene, image.windows, finder, image.origin});
    }
    /// For refracting water, where an image sees its apparent positions of `count` facets.
    void place(std::size_t count) {
      apparent.received.assign(count, ApparentFacets::none);
      for (FacetId facet = 0; facet < end->origin.size(); ++facet)
        apparent.received[end->origin[facet]] = facet;
    }
    RayImage(const RayImage&) = delete;
    RayImage& operator=(const RayImage&) = delete;
    std::optional<RayScene> own;
    TubeFinder finder;
    std::optional<SampledEnd> end;
    ApparentFacets apparent;
  };
  using RayImages = std::vector<std::unique_ptr<const RayImage>>;

  RayImages made_ready(std::span<const Image> images, const std::vector<char>& wanted) const {
    RayImages ready(images.size());
    tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
      if (!wanted[i]) return;
      auto image = std::make_unique<RayImage>(images[i], mesh_, *settings_.sampled);
      if (refracted_) image->place(refracted_->seabed().facets.size());
      ready[i] = std::move(image);
    });
    return ready;
  }

  /// Adds the same pairs by rays. Each image of the transmitter sends its own rays.
  void sample(std::span<const ImagePair> pairs) {
    std::vector<std::vector<std::size_t>> received_by(transmit_.size());
    std::vector<char> sends(transmit_.size()), receives(receive_.size());
    const auto join = [&](std::size_t i, std::size_t j) {
      received_by[i].push_back(j);
      sends[i] = receives[j] = 1;
    };
    for (const ImagePair& pair : pairs) {
      join(pair.sent, pair.received);
      if (one_place_ && pair.sent != pair.received) join(pair.received, pair.sent);
    }
    if (one_place_)
      for (std::size_t i = 0; i < sends.size(); ++i) sends[i] = receives[i] = char(sends[i] | receives[i]);
    const RayImages senders = made_ready(transmit_, sends),
                    others = one_place_ ? RayImages() : made_ready(receive_, receives);
    const RayImages& image_receivers = one_place_ ? senders : others;
    std::vector<Part> parts(transmit_.size());
    tbb::parallel_for(std::size_t{0}, transmit_.size(), [&](std::size_t i) {
      if (received_by[i].empty()) return;
      const Image& sent = transmit_[i];
      History history;
      history.tubes = transmit_[0].windows;
      history.grid_unit_m = unit_m_;
      RaySettings rays = settings_.sampled->rays;
      rays.seed = label_of_part(rays.seed, i + 1);  // independent samples per image
      const RaysOnwards onwards{sent.windows.apex, glm::transpose(sent.leg.to_true), senders[i]->finder};
      trace_rays(
          senders[i]->end->scene, history, rays, settings_.sampled->beam_of_tube,
          [&] {
            for (const std::size_t j : received_by[i]) {
              const Image& received = receive_[j];
              BistaticHistory shared = shared_hits(history, *senders[i]->end, *image_receivers[j]->end,
                                                   refracted_ ? refracted_->seabed() : mesh_,
                                                   refracted_ ? &image_receivers[j]->apparent : nullptr);
              if (shared.hits.empty()) continue;
              if (refracted_) pair_facets(parts[i], sent, received, shared);
              parts[i].hits += shared.hits.size();
              add(parts[i], sent.mirrors + received.mirrors + 1, scattered(sent, received, std::move(shared)),
                  0);
            }
          },
          sent.mirrors > 0 ? &onwards : nullptr, &settings_.sampled->guide);
    });
    for (const Part& part : parts) take(part);
  }

  /// The ends have different apparent seabeds. The common visibility is given on the apparent seabed of the
  /// transmitter's image.
  void add_refracted(Part& part, std::size_t order, const Image& sent, const Image& received) const {
    BistaticHistory history{sent.windows, received.windows, unit_m_,
                            FootprintSharer(sent.look(), received.look(), unit_m_).all()};
    if (history.shared.pieces.empty()) return;
    pair_facets(part, sent, received, history);
    add(part, order, scattered(sent, received, history), history.shared.pieces.size());
  }

  void pair_facets(Part& part, const Image& sent, const Image& received, BistaticHistory& history) const {
    history.bistatic =
        bistatic_facets(history.shared, refracted_->seabed(), refracted_->end_of(sent),
                        refracted_->end_of(received), refracted_->grid(), model_.absorption_db_per_m);
    const glm::dvec3 beside_m = refracted_->beside_m(received);
    for (std::size_t k = 0; k < history.bistatic.size(); ++k) {
      part.misfit_m = std::max(part.misfit_m, history.bistatic[k].misfit_m);
      if (beside_m != glm::dvec3(0) && !history.bistatic[k].move_receiver(beside_m))
        history.shared.facets[k].piece_count = 0;
    }
  }

  /// Without a reference all bounds are 0.
  static void add(Part& part, std::size_t order, const CertifiedEcho& found, std::size_t pieces) {
    const std::vector<double>& energy = found.echo.energy;
    for (std::size_t bin = 0; bin < energy.size(); ++bin) {
      const double bound = found.bound.empty() ? 0 : found.bound[bin];
      if (energy[bin] != 0 || bound != 0) part.bins.push_back({order, bin, energy[bin], bound});
    }
    part.pieces += pieces;
  }

  void take(const Part& part) {
    for (const Part::Bin& bin : part.bins) take(bin);
    echo_.shared_pieces += part.pieces;
    echo_.largest_misfit_m = std::max(echo_.largest_misfit_m, part.misfit_m);
    echo_.hits += part.hits;
  }
  void take(const Part::Bin& bin) {
    double& energy = echo_.by_order[bin.order].energy[bin.bin];
    energy += bin.energy;
    if (echo_.bound_by_order.empty()) return;
    constexpr double rounding = 0x1p-52;  // rounding of both sums
    double& bound = echo_.bound_by_order[bin.order][bin.bin];
    bound = (bound + bin.bound) * (1 + rounding) + energy * rounding;
  }

  CertifiedEcho scattered(const Image& sent, const Image& received, const BistaticHistory& history) const {
    const PairModel pair(sent, received, true_apex_, unit_m_, model_, beams_,
                         refracted_ ? &refracted_->seabed() : nullptr);
    CertifiedEcho found;
    found.echo = integrate_echo(history, pair.beams, samples_, pair.model, settings_.binning);
    const auto tolerance = settings_.reference_tolerance;
    if (tolerance && enclosed_) {
      VisibilityOptions options = refracted_->options();
      options.open_water = false;
      found = certify_refracted_echo(
                  enclosed_->seabed_between(sent, received),
                  {sent.windows, received.windows, {enclosed_->off_rad(sent), enclosed_->off_rad(received)}},
                  options, pair.beams, samples_, pair.model, found.echo, *tolerance)
                  .certified;
    } else if (tolerance) {
      found = certify_echo(mesh_, history, pair.beams, samples_, pair.model, found.echo, *tolerance);
    }
    return found;
  }

  /// Adds the arrivals from an image at the true receiver, along a straight line or along rays in refracting
  /// water. Two chains have the same image only if their windows adjoin (two mirrors at a right angle). Each
  /// source therefore counts once.
  void arrive(const Image& image) {
    const GridPoint from = image.windows.apex;
    if (refracted_) {
      const WorldGrid& grid = refracted_->grid();
      for (const MirroredRay& ray : refracted_->rays_to(image, true_receive_.apex)) {
        const GridPoint back = grid.snap(grid.to_metres(from) - 2 * ray.half_path_m * ray.arrives) - from;
        arrive(image,
               {ray.seen_at - from, back, ray.sent, ray.arrives, ray.half_path_m, ray.kept, ray.tube_area_m2},
               {from, ray.sent.z, ray.unfolded_height_m}, [] { return true; });
      }
      return;
    }
    const GridPoint to = true_receive_.apex;
    const GridPoint along = to - from;
    if (along == GridPoint{}) return;
    const glm::dvec3 path_m = displacement_m(from, to, unit_m_);
    const double length = glm::length(path_m);
    const glm::dvec3 direction = path_m / length;
    arrive(image,
           {along, from - to, direction, direction, length / 2, std::exp(-beta_ * length), length * length},
           {from, 0, 0}, [&] { return reaches(image, to); });
  }

  /// Path from an image to the receiver.
  struct ArrivingRay {
    GridPoint along, back;           ///< vectors from the image along the path, and from the receiver back
    glm::dvec3 sent{0}, arrives{0};  ///< unit vectors at the image, in the frame of the image, and at the
                                     ///< receiver
    double half_path_m;
    double kept, tube_area_m2;  ///< energy factor of absorption; area at the receiver per steradian
  };
  /// Identifies an arrival: apex of the image, and the ray in unfolded water.
  using Source = std::tuple<GridPoint, double, double>;

  template <class InView>
  void arrive(const Image& image, const ArrivingRay& arrival, const Source& source,
              const InView& is_in_view) {
    std::optional<bool> seen;
    for (std::uint32_t window = 0; window < image.own_tube.size(); ++window) {
      stop_if_wanted();
      const std::uint32_t fan = fan_of(beams_.fan_of_transmit_tube, image.own_tube[window]);
      if (arrived_.contains({source, fan}) || !holds(image.windows, window, arrival.along, window_border_rad))
        continue;
      if (!seen) seen = is_in_view();
      if (!*seen) return;
      for (std::uint32_t tube = 0; tube < true_receive_.tubes.size(); ++tube) {
        if (!beams_.fan_of_receive_tube.empty() && beams_.fan_of_receive_tube[tube] != fan) continue;
        if (!holds(true_receive_, tube, arrival.back)) continue;
        hear(image, tube, arrival);
        arrived_.insert({source, fan});
        break;
      }
    }
  }

  void hear(const Image& image, std::uint32_t receive_tube, const ArrivingRay& arrival) {
    if (settings_.reference_tolerance) return hear_certified(image, receive_tube);
    const double sample = std::floor((arrival.half_path_m - samples_.first_m) / samples_.step_m);
    if (!(sample >= 0 && sample < samples_.count)) return;
    const double passes = image.leg.loss.at(arrival.sent);
    if (!(passes > least_)) return;
    const double energy = passes * arrival.kept / arrival.tube_area_m2;
    const auto add = [&](std::uint32_t beam, double weight) {
      const std::size_t bin = std::size_t(beam) * std::size_t(samples_.count) + std::size_t(sample);
      echo_.by_order[image.mirrors].energy[bin] += weight * energy;
      echo_.arrived.push_back({image.windows.apex, GridPoint{} - arrival.back, image.mirror_path,
                               image.mirrors, bin, weight * energy});
    };
    ++echo_.arrivals;
    if (model_.patterns == nullptr) return add(beams_.of_tube[receive_tube], 1);
    const BeamPatterns& patterns = *model_.patterns;
    const auto [first, end] = patterns.beams_of_tube[receive_tube];
    const double sent =
        patterns.transmit[patterns.fan_of_tube[receive_tube]].gain(image.leg.to_true * arrival.sent);
    for (std::uint32_t beam = first; beam < end; ++beam)
      add(beam, sent * patterns.receive[beam].gain(-arrival.arrives));
  }

  std::pair<std::uint32_t, std::uint32_t> beams_of(std::uint32_t receive_tube) const {
    if (model_.patterns != nullptr) return model_.patterns->beams_of_tube[receive_tube];
    return {beams_.of_tube[receive_tube], beams_.of_tube[receive_tube] + 1};
  }
  /// Sets the patterns of the beams that receive a tube. Returns these beams.
  std::pair<std::uint32_t, std::uint32_t> weigh(Arrival& arrival, std::uint32_t receive_tube) const {
    const auto [first, end] = beams_of(receive_tube);
    if (model_.patterns != nullptr) {
      arrival.transmit = &model_.patterns->transmit[model_.patterns->fan_of_tube[receive_tube]];
      arrival.receive = std::span(model_.patterns->receive).subspan(first, end - first);
    }
    return {first, end};
  }
  static std::uint32_t fan_of(std::span<const std::uint32_t> fans, std::uint32_t tube) {
    return fans.empty() ? 0 : fans[tube];
  }

  /// Adds an arrival with bounds in refracting water, along the only ray, if the uniqueness of this ray is
  /// proven.
  void arrive_enclosed(const Image& image) {
    const EnclosedImages::Ray found = enclosed_->ray_to(image, true_receive_.apex);
    if (!found.may_be_seen || found.passes == false) return;
    if (!found.enclosed) {
      for (std::uint32_t beam = 0; beam < std::uint32_t(beams_.count); ++beam)
        nothing_known(image.mirrors, beam, found.soonest_m / 2);
      return;
    }
    const MirroredRay& ray = *found.ray;
    const WorldGrid& grid = refracted_->grid();
    const GridPoint from = image.windows.apex, along = ray.seen_at - from,
                    back = grid.snap(grid.to_metres(from) - 2 * ray.half_path_m * ray.arrives) - from;
    // Both directions are rounded to the grid.
    const double rounded_rad = 1e-8 + 2 * unit_m_ / ray.half_path_m;
    std::set<std::uint32_t> fans;
    for (std::uint32_t window = 0; window < image.own_tube.size(); ++window)
      if (holds(image.windows, window, along, enclosed_->off_rad(image) + rounded_rad))
        fans.insert(fan_of(beams_.fan_of_transmit_tube, image.own_tube[window]));
    for (const std::uint32_t fan : fans) {
      const std::pair source(Source(from, ray.sent.z, ray.unfolded_height_m), fan);
      if (arrived_.contains(source)) continue;
      bool sure = found.passes == true &&
                  !enclosed_->is_near_border(image, beams_.fan_of_transmit_tube, fan, ray.sent);
      // Tubes that may receive the ray. Tubes with the same beams are one entry.
      std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> tubes;
      bool in_one = false;
      for (std::uint32_t tube = 0; tube < true_receive_.tubes.size(); ++tube) {
        if (!beams_.fan_of_receive_tube.empty() && beams_.fan_of_receive_tube[tube] != fan) continue;
        if (!holds(true_receive_, tube, back, rounded_rad)) continue;
        tubes.emplace(beams_of(tube), tube);
        in_one = in_one || holds(true_receive_, tube, back);
      }
      sure = sure && in_one && tubes.size() == 1;
      if (tubes.empty()) continue;
      arrived_.insert(source);
      for (const auto& [beams, tube] : tubes) hear_enclosed(image, tube, found, sure);
    }
  }

  void hear_enclosed(const Image& image, std::uint32_t receive_tube, const EnclosedImages::Ray& found,
                     bool sure) {
    if (!(image.leg.loss.at(found.ray->sent) > least_)) return;
    Arrival arrival;
    arrival.leg = &image.leg;
    const auto [first, end] = weigh(arrival, receive_tube);
    if (first == end) return;
    bool received = false;
    certify_arrival(
        *found.enclosed, arrival, sure, samples_,
        [&, first = first](std::size_t beam, std::size_t sample, double energy, double bound) {
          received = true;
          take({image.mirrors, (first + beam) * std::size_t(samples_.count) + sample, energy, bound});
        });
    if (received) ++echo_.arrivals;
  }

  void nothing_known(std::size_t order, std::uint32_t beam, double from_m) {
    for (int sample = 0; sample < samples_.count; ++sample)
      if (samples_.first_m + (sample + 1) * samples_.step_m >= from_m)
        take({order, std::size_t(beam) * std::size_t(samples_.count) + std::size_t(sample), 0,
              std::numeric_limits<double>::infinity()});
  }

  /// Nothing is known of mirrors that facets without a proven ray may hide, or that consist of such facets.
  void add_unknown() {
    for (const EnclosedImages::Unknown& unknown : enclosed_->unknown())
      for (std::size_t order = unknown.mirrors + 1; order < echo_.by_order.size(); ++order)
        for (std::uint32_t beam = 0; beam < std::uint32_t(beams_.count); ++beam)
          nothing_known(order, beam, unknown.from_m / 2);
  }

  void hear_certified(const Image& image, std::uint32_t receive_tube) {
    Arrival arrival{true_receive_.apex - image.windows.apex, unit_m_, model_.absorption_db_per_m, &image.leg};
    const glm::dvec3 path_m = displacement_m(image.windows.apex, true_receive_.apex, unit_m_);
    if (!(image.leg.loss.at(path_m / glm::length(path_m)) > least_)) return;
    const auto [first, end] = weigh(arrival, receive_tube);
    if (first == end) return;
    bool received = false;
    certify_arrival(arrival, samples_,
                    [&, first = first](std::size_t beam, std::size_t sample, double energy, double bound) {
                      received = true;
                      const std::size_t bin = (first + beam) * std::size_t(samples_.count) + sample;
                      take({image.mirrors, bin, energy, bound});
                      echo_.arrived.push_back({image.windows.apex, arrival.displacement, image.mirror_path,
                                               image.mirrors, bin, energy, bound});
                    });
    if (received) ++echo_.arrivals;
  }

  const FacetMesh& mesh_;
  double unit_m_;
  const ImageFinder& finder_;
  std::span<const Image> transmit_, receive_;
  const ReceiveBeams& beams_;
  const RangeSamples& samples_;
  const EchoModel& model_;
  const PathSettings& settings_;
  double least_, beta_;
  GridPoint true_apex_;
  const TubeSet& true_receive_;
  bool one_place_;
  RefractedImages* refracted_;  // finder of the images, in refracting water
  EchoModel seabed_model_;      // with a reference: model with the materials of the finder's seabed
  std::optional<EnclosedImages> enclosed_;
  std::set<std::pair<Source, std::uint32_t>> arrived_;  // sources with their fans
  PathEcho echo_;
};

}  // namespace

PathEcho path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                   const VisibilityOptions& options, const TubeSet& transmit, const TubeSet& receive,
                   const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                   const PathSettings& settings, const PathWater* water) {
  VisibilityOptions without_names = options;
  without_names.corner_names = false;
  const ImageFinder finder(mesh, tree, without_names, settings.mirrors, settings.least(),
                           settings.most_images);
  const bool one_place = transmit == receive;
  if (water != nullptr) {
    std::vector<TubeSet> ends{transmit};
    if (!one_place) ends.push_back(receive);
    PathWater own = *water;
    own.keep_last = settings.reference_tolerance.has_value();
    RefractedImages refracted(mesh, tree, options, settings.mirrors, settings.least(), settings.most_images,
                              model.absorption_db_per_m, own, std::move(ends), settings.order);
    const std::vector<Image> sent = refracted.images_of(0, {{receive.apex}}),
                             received = one_place ? std::vector<Image>{} : refracted.images_of(1);
    PathEcho echo = path_echo(mesh, grid_unit_m, {finder, sent, one_place ? sent : received, &refracted},
                              receive, beams, samples, model, settings);
    echo.surface_meshes = refracted.take_surfaces();
    return echo;
  }
  const std::vector<Image> sent = finder.images_of(transmit, settings.order, {{receive.apex}});
  if (one_place)
    return path_echo(mesh, grid_unit_m, {finder, sent, sent}, receive, beams, samples, model, settings);
  const std::vector<Image> received = finder.images_of(receive, settings.order - 1);
  return path_echo(mesh, grid_unit_m, {finder, sent, received}, receive, beams, samples, model, settings);
}

PathEcho path_echo(const FacetMesh& mesh, double grid_unit_m, const KnownImages& images,
                   const TubeSet& receive, const ReceiveBeams& beams, const RangeSamples& samples,
                   const EchoModel& model, const PathSettings& settings) {
  if (settings.reference_tolerance && settings.scatterings > 1)
    throw std::invalid_argument(
        "second scattering treats patches as points, so there is no certified bound for its echoes");
  return PathTracer(mesh, grid_unit_m, images, receive, beams, samples, model, settings).trace();
}

PathEcho unscattered_echo(const FacetMesh& mesh, double grid_unit_m, const KnownImages& images,
                          const TubeSet& receive, const ReceiveBeams& beams, const RangeSamples& samples,
                          const EchoModel& model, const PathSettings& settings) {
  return PathTracer(mesh, grid_unit_m, images, receive, beams, samples, model, settings).arrivals();
}

}  // namespace tubefoot
