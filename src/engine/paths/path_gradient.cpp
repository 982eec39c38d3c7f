// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/path_gradient.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "engine/gradient/checked_arguments.hpp"
#include "engine/paths/image_adjoint.hpp"
#include "engine/paths/image_motion.hpp"
#include "engine/paths/image_pairs.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/tubes/window_tubes.hpp"

// Differentiates single scatterings between pairs of images as those between two apexes
// (engine/gradient/bistatic_gradient.hpp), and arrivals by the length of their paths.

namespace tubefoot {
namespace {

/// Arguments of path_derivatives() and path_gradient().
struct DifferentiatedScene {
  const FacetMesh& mesh;
  double unit_m;
  const TubeSet &transmit, &receive;
  const ReceiveBeams& beams;
  const RangeSamples& samples;
  const EchoModel& model;
  const PathSettings& settings;
  const std::function<bool(std::size_t)>& is_wanted;
};

/// Images of both ends, and the paths between them.
class NamedPaths {
 public:
  NamedPaths(const DifferentiatedScene& scene, const SceneTree& tree, const VisibilityOptions& options)
      : scene_(scene),
        finder_(scene.mesh, tree, with_names(options), scene.settings.mirrors, scene.settings.least(),
                scene.settings.most_images),
        one_place_(scene.transmit == scene.receive),
        sent_(finder_.images_of(scene.transmit, scene.settings.order, {{scene.receive.apex}})) {
    if (!one_place_) received_ = finder_.images_of(scene.receive, scene.settings.order - 1);
  }

  const DifferentiatedScene& scene() const { return scene_; }
  std::span<const Image> sent() const { return sent_; }
  std::span<const Image> received() const { return one_place_ ? sent_ : received_; }

  /// Returns the pairs whose scattering is wanted. A pair of a monostatic sonar occurs in both directions.
  std::vector<ImagePair> pairs() const {
    std::vector<ImagePair> all;
    const PathSettings& settings = scene_.settings;
    if (settings.order < 2) return all;
    for (const ImagePair& pair : pairs_of_images(sent(), received(), one_place_, settings.order,
                                                 settings.least(), 100 * settings.most_images)) {
      if (!scene_.is_wanted(sent_[pair.sent].mirrors + received()[pair.received].mirrors + 1)) continue;
      all.push_back(pair);
      if (one_place_ && pair.sent != pair.received) all.push_back({pair.received, pair.sent});
    }
    return all;
  }

  /// Names of edges refer to the whole mesh (named_in()).
  BistaticHistory history(const ImagePair& pair) const {
    const Image &sent = sent_[pair.sent], &received = this->received()[pair.received];
    BistaticHistory history{sent.windows, received.windows, scene_.unit_m, shared_by(sent, received)};
    for (SharedEdge& edge : history.shared.edges) {
      const Image& own = edge.of_receiver ? received : sent;
      edge.from = named_in(scene_.mesh, own, edge.from);
      edge.to = named_in(scene_.mesh, own, edge.to);
    }
    return history;
  }
  PairModel model(const ImagePair& pair) const {
    return PairModel(sent_[pair.sent], received()[pair.received], scene_.transmit.apex, scene_.unit_m,
                     scene_.model, scene_.beams, nullptr);
  }

  /// Calls `use` with each wanted arrival, and with its image and window.
  void for_each_arrival(
      const std::function<void(const ArrivedEnergy&, std::size_t, std::uint32_t)>& use) const {
    if (!scene_.settings.arrivals) return;
    const PathEcho echo =
        unscattered_echo(scene_.mesh, scene_.unit_m, {finder_, sent(), received()}, scene_.receive,
                         scene_.beams, scene_.samples, scene_.model, scene_.settings);
    for (const ArrivedEnergy& arrived : echo.arrived) {
      if (!scene_.is_wanted(arrived.order)) continue;
      const auto [number, window] = window_of(arrived);
      use(arrived, number, window);
    }
  }

 private:
  static VisibilityOptions with_names(VisibilityOptions options) {
    options.corner_names = true;
    return options;
  }

  /// Walls of both ends may lie in one plane. An edge there is that of the receiver, because walls between
  /// tubes of a transmitter do not divide the beams.
  SharedFootprints shared_by(const Image& sent, const Image& received) const {
    if (&sent == &received) return shared_with_itself(scene_.mesh, sent.look(), scene_.unit_m, {true});
    return exchanged(FootprintSharer(scene_.mesh, received.look(), sent.look(), scene_.unit_m, {true}).all());
  }

  std::pair<std::size_t, std::uint32_t> window_of(const ArrivedEnergy& arrived) const {
    for (std::size_t number = 0; number < sent_.size(); ++number) {
      const TubeSet& windows = sent_[number].windows;
      if (sent_[number].mirrors != arrived.order || windows.apex != arrived.from) continue;
      for (std::uint32_t window = 0; window < windows.tubes.size(); ++window)
        if (holds(windows, window, arrived.displacement, window_border_rad)) return {number, window};
    }
    throw std::logic_error("an arrival has no window");
  }

  DifferentiatedScene scene_;
  ImageFinder finder_;
  bool one_place_;
  std::vector<Image> sent_, received_;
};

/// The logarithm of the energy of an arrival, and its derivatives. The bin is constant.
struct ArrivalSlopes {
  double by_absorption, by_roughness = 0;
  glm::dvec3 by_path{0};  ///< by the vector from the image to the receiver
  std::vector<glm::dvec3> by_rough_normal{};

  ArrivalSlopes(glm::dvec3 path_m, const MirrorLoss& loss, double beta_per_m) {
    const double length = glm::length(path_m);
    const glm::dvec3 along = path_m / length;
    by_absorption = -per_db * length;
    by_path = -(beta_per_m + 2 / length) * along;
    for (const glm::dvec3& normal : loss.rough_normals) {
      const double sine = glm::dot(along, normal), by_sine = -2 * loss.roughness * sine;
      by_path += by_sine / length * (normal - sine * along);
      by_rough_normal.push_back(by_sine * along);
      by_roughness -= loss.roughness * sine * sine;
    }
  }
};

/// Forward mode.
class PathDifferentiator {
 public:
  PathDifferentiator(const NamedPaths& paths, std::span<const EchoParameter> parameters)
      : paths_(paths),
        scene_(paths.scene()),
        parameters_(parameters),
        tx_(scene_.mesh, scene_.unit_m, scene_.transmit.apex, paths.sent(), parameters),
        rx_(scene_.mesh, scene_.unit_m, scene_.transmit.apex, paths.received(), parameters),
        sum_(parameters.size(), std::vector<double>(bins())) {}

  std::vector<std::vector<double>> differentiate() {
    scatter();
    paths_.for_each_arrival([&](const ArrivedEnergy& arrived, std::size_t image, std::uint32_t window) {
      add(arrived, image, window);
    });
    return std::move(sum_);
  }

 private:
  std::size_t bins() const { return std::size_t(scene_.beams.count) * std::size_t(scene_.samples.count); }

  /// Result of one pair.
  struct OfBin {
    std::size_t parameter, bin;
    double derivative;
  };

  void scatter() {
    const std::vector<ImagePair> pairs = paths_.pairs();
    std::vector<std::vector<OfBin>> parts(pairs.size());
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t k) {
      stop_if_wanted();
      add(pairs[k], parts[k]);
    });
    for (const std::vector<OfBin>& part : parts)
      for (const OfBin& of : part) sum_[of.parameter][of.bin] += of.derivative;
  }

  void add(const ImagePair& pair, std::vector<OfBin>& part) const {
    const BistaticHistory history = paths_.history(pair);
    if (history.shared.pieces.empty()) return;
    const PairModel own = paths_.model(pair);
    MovingImage tx(tx_, pair.sent), rx(rx_, pair.received);
    std::vector<std::vector<double>> all(parameters_.size(), std::vector<double>(bins()));
    add_echo_derivatives(scene_.mesh, history, own.beams, scene_.samples, own.model, parameters_, tx, rx,
                         all);
    for (std::size_t n = 0; n < all.size(); ++n)
      for (std::size_t bin = 0; bin < all[n].size(); ++bin)
        if (all[n][bin] != 0) part.push_back({n, bin, all[n][bin]});
  }

  void add(const ArrivedEnergy& arrived, std::size_t image, std::uint32_t window) {
    const ArrivalSlopes slopes(rx_.place(0) - tx_.place(image), paths_.sent()[image].leg.loss,
                               absorption_per_m(scene_.model.absorption_db_per_m));
    for (std::size_t n = 0; n < parameters_.size(); ++n) {
      double relative = slopes.by_absorption * parameters_[n].by_absorption +
                        slopes.by_roughness * parameters_[n].by_roughness +
                        glm::dot(slopes.by_path, rx_.of_image(0, 0, n) - tx_.of_image(image, window, n));
      for (std::size_t k = 0; k < slopes.by_rough_normal.size(); ++k)
        relative += glm::dot(slopes.by_rough_normal[k], tx_.of_rough_normal(image, window, n, k));
      sum_[n][arrived.bin] += arrived.energy_j * relative;
    }
  }

  const NamedPaths& paths_;
  const DifferentiatedScene& scene_;
  std::span<const EchoParameter> parameters_;
  ImageMotion tx_, rx_;
  std::vector<std::vector<double>> sum_;
};

/// Reverse mode.
EchoGradient gradient_of(const NamedPaths& paths, std::span<const double> weights,
                         std::span<const MaterialParameter> scattering) {
  const DifferentiatedScene& scene = paths.scene();
  ImageAdjoint tx(scene.mesh, scene.unit_m, scene.transmit.apex, paths.sent()),
      rx(scene.mesh, scene.unit_m, scene.transmit.apex, paths.received());
  EchoGradient gradient;
  gradient.by_material_mu.assign(scene.model.material_mu.size(), 0);
  gradient.by_scattering.assign(scattering.size(), 0);
  for (const ImagePair& pair : paths.pairs()) {
    stop_if_wanted();
    const BistaticHistory history = paths.history(pair);
    if (history.shared.pieces.empty()) continue;
    const PairModel own = paths.model(pair);
    MovingImageAdjoint sent(tx, pair.sent), received(rx, pair.received);
    add_echo_gradient(scene.mesh, history, own.beams, scene.samples, own.model, weights, scattering, sent,
                      received, gradient);
  }
  paths.for_each_arrival([&](const ArrivedEnergy& arrived, std::size_t image, std::uint32_t window) {
    const ArrivalSlopes slopes(rx.place(0) - tx.place(image), paths.sent()[image].leg.loss,
                               absorption_per_m(scene.model.absorption_db_per_m));
    const double energy = weights[arrived.bin] * arrived.energy_j;
    gradient.by_absorption += energy * slopes.by_absorption;
    gradient.by_roughness += energy * slopes.by_roughness;
    rx.add_image(0, 0, energy * slopes.by_path);
    tx.add_image(image, window, -energy * slopes.by_path);
    for (std::size_t k = 0; k < slopes.by_rough_normal.size(); ++k)
      tx.add_rough_normal(image, window, k, energy * slopes.by_rough_normal[k]);
  });
  tx.finish();
  rx.finish();
  gradient.by_vertex = tx.by_vertex();
  for (std::size_t v = 0; v < gradient.by_vertex.size(); ++v) gradient.by_vertex[v] += rx.by_vertex()[v];
  gradient.by_ray = tx.by_ray();
  gradient.by_receive_ray = rx.by_ray();
  gradient.by_receiver = rx.by_apex();
  gradient.by_apex += tx.by_local_motion() + rx.by_local_motion();
  return gradient;
}

void check_differentiable(const EchoModel& model, const PathSettings& settings) {
  if (settings.scatterings > 1) reject_gradient("patches of several scatterings are points");
  if (settings.sampled || settings.reference_tolerance)
    reject_gradient("paths by rays and references are not supported");
  if (model.patterns != nullptr) reject_gradient("beam patterns of paths over mirrors are not supported");
}

}  // namespace

std::vector<std::vector<double>> path_derivatives(const FacetMesh& mesh, const SceneTree& tree,
                                                  double grid_unit_m, const VisibilityOptions& options,
                                                  const TubeSet& transmit, const TubeSet& receive,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model, const PathSettings& settings,
                                                  std::span<const EchoParameter> parameters,
                                                  const std::function<bool(std::size_t order)>& is_wanted) {
  check_differentiable(model, settings);
  const NamedPaths paths({mesh, grid_unit_m, transmit, receive, beams, samples, model, settings, is_wanted},
                         tree, options);
  return PathDifferentiator(paths, parameters).differentiate();
}

EchoGradient path_gradient(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                           const VisibilityOptions& options, const TubeSet& transmit, const TubeSet& receive,
                           const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                           const PathSettings& settings, std::span<const double> weights,
                           std::span<const MaterialParameter> scattering,
                           const std::function<bool(std::size_t order)>& is_wanted) {
  check_differentiable(model, settings);
  check_weights(weights, beams, samples);
  const NamedPaths paths({mesh, grid_unit_m, transmit, receive, beams, samples, model, settings, is_wanted},
                         tree, options);
  return gradient_of(paths, weights, scattering);
}

}  // namespace tubefoot
