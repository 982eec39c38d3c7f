// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/path_gradient.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "engine/gradient/checked_arguments.hpp"
#include "engine/paths/image_motion.hpp"
#include "engine/paths/image_pairs.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/stop.hpp"
#include "geometry/tubes/window_tubes.hpp"

// Differentiates single scatterings between pairs of images as those between two apexes
// (engine/gradient/bistatic_gradient.hpp), and arrivals by the length of their paths.

namespace tubefoot {
namespace {

/// Images of both ends, and the derivatives of the energies between them.
class PathDifferentiator {
 public:
  PathDifferentiator(const FacetMesh& mesh, double unit_m, const ImageFinder& finder,
                     std::span<const Image> sent, std::span<const Image> received, bool one_place,
                     const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                     const PathSettings& settings, std::span<const EchoParameter> parameters,
                     const std::function<bool(std::size_t)>& is_wanted)
      : mesh_(mesh),
        unit_m_(unit_m),
        finder_(finder),
        sent_(sent),
        received_(received),
        one_place_(one_place),
        beams_(beams),
        samples_(samples),
        model_(model),
        settings_(settings),
        parameters_(parameters),
        is_wanted_(is_wanted),
        true_apex_(sent.front().windows.apex),
        tx_(mesh, unit_m, true_apex_, sent, parameters),
        rx_(mesh, unit_m, true_apex_, received, parameters),
        sum_(parameters.size(), std::vector<double>(bins())) {}

  std::vector<std::vector<double>> differentiate() {
    scatter();
    if (settings_.arrivals) arrive();
    return std::move(sum_);
  }

 private:
  std::size_t bins() const { return std::size_t(beams_.count) * std::size_t(samples_.count); }

  /// Result of one pair: parameter, bin and derivative.
  struct OfBin {
    std::size_t parameter, bin;
    double derivative;
  };

  void scatter() {
    if (settings_.order < 2) return;
    const std::vector<ImagePair> pairs = pairs_of_images(sent_, received_, one_place_, settings_.order,
                                                         settings_.least(), 100 * settings_.most_images);
    std::vector<std::vector<OfBin>> parts(pairs.size());
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t k) {
      stop_if_wanted();
      const Image &sent = sent_[pairs[k].sent], &received = received_[pairs[k].received];
      if (is_wanted_(sent.mirrors + received.mirrors + 1)) add(pairs[k], parts[k]);
    });
    for (const std::vector<OfBin>& part : parts)
      for (const OfBin& of : part) sum_[of.parameter][of.bin] += of.derivative;
  }

  /// Adds a pair of a monostatic sonar in both directions.
  void add(const ImagePair& pair, std::vector<OfBin>& part) const {
    std::vector<std::vector<double>> all(parameters_.size());
    add(pair.sent, pair.received, all);
    if (one_place_ && pair.sent != pair.received) add(pair.received, pair.sent, all);
    for (std::size_t n = 0; n < all.size(); ++n)
      for (std::size_t bin = 0; bin < all[n].size(); ++bin)
        if (all[n][bin] != 0) part.push_back({n, bin, all[n][bin]});
  }

  /// Walls of both ends may lie in one plane. An edge there is that of the receiver, because walls between
  /// tubes of a transmitter do not divide the beams.
  SharedFootprints shared_by(const Image& sent, const Image& received) const {
    if (&sent == &received) return shared_with_itself(mesh_, sent.look(), unit_m_, true);
    return exchanged(FootprintSharer(mesh_, received.look(), sent.look(), unit_m_, true).all());
  }

  void add(std::size_t sent_number, std::size_t received_number,
           std::vector<std::vector<double>>& all) const {
    const Image &sent = sent_[sent_number], &received = received_[received_number];
    BistaticHistory history{sent.windows, received.windows, unit_m_, shared_by(sent, received)};
    if (history.shared.pieces.empty()) return;
    for (SharedEdge& edge : history.shared.edges) {
      const Image& own = edge.of_receiver ? received : sent;
      edge.from = named_in(mesh_, own, edge.from);
      edge.to = named_in(mesh_, own, edge.to);
    }
    const PairModel own(sent, received, true_apex_, unit_m_, model_, beams_, nullptr);
    MovingImage tx(tx_, sent_number), rx(rx_, received_number);
    for (std::vector<double>& of : all) of.resize(bins());
    add_echo_derivatives(mesh_, history, own.beams, samples_, own.model, parameters_, tx, rx, all);
  }

  void arrive() {
    const PathEcho echo = unscattered_echo(mesh_, unit_m_, {finder_, sent_, received_},
                                           received_.front().windows, beams_, samples_, model_, settings_);
    for (const ArrivedEnergy& arrived : echo.arrived)
      if (is_wanted_(arrived.order)) add(arrived);
  }

  /// The bin of an arrival is constant.
  void add(const ArrivedEnergy& arrived) {
    const auto [number, window] = window_of(arrived);
    const Image& image = sent_[number];
    const MirrorLoss& loss = image.leg.loss;
    const glm::dvec3 path_m = rx_.place(0) - tx_.place(number);
    const double length = glm::length(path_m);
    const glm::dvec3 along = path_m / length;
    for (std::size_t n = 0; n < parameters_.size(); ++n) {
      const glm::dvec3 moved = rx_.of_image(0, 0, n) - tx_.of_image(number, window, n);
      const double longer = glm::dot(along, moved);
      const glm::dvec3 turned = (moved - longer * along) / length;
      double relative = -(absorption_per_m(model_.absorption_db_per_m) + 2 / length) * longer -
                        per_db * parameters_[n].by_absorption * length;
      for (std::size_t k = 0; k < loss.rough_normals.size(); ++k) {
        const double sine = glm::dot(along, loss.rough_normals[k]),
                     by_sine = glm::dot(turned, loss.rough_normals[k]) +
                               glm::dot(along, tx_.of_rough_normal(number, window, n, k));
        relative -= loss.roughness * sine * (2 * by_sine + sine * parameters_[n].by_roughness);
      }
      sum_[n][arrived.bin] += arrived.energy_j * relative;
    }
  }

  /// Returns the image and its window through which sound arrived.
  std::pair<std::size_t, std::uint32_t> window_of(const ArrivedEnergy& arrived) const {
    for (std::size_t number = 0; number < sent_.size(); ++number) {
      const TubeSet& windows = sent_[number].windows;
      if (sent_[number].mirrors != arrived.order || windows.apex != arrived.from) continue;
      for (std::uint32_t window = 0; window < windows.tubes.size(); ++window)
        if (holds(windows, window, arrived.displacement, window_border_rad)) return {number, window};
    }
    throw std::logic_error("an arrival has no window");
  }

  const FacetMesh& mesh_;
  double unit_m_;
  const ImageFinder& finder_;
  std::span<const Image> sent_, received_;
  bool one_place_;
  const ReceiveBeams& beams_;
  const RangeSamples& samples_;
  const EchoModel& model_;
  const PathSettings& settings_;
  std::span<const EchoParameter> parameters_;
  const std::function<bool(std::size_t)>& is_wanted_;
  GridPoint true_apex_;
  ImageMotion tx_, rx_;
  std::vector<std::vector<double>> sum_;
};

}  // namespace

std::vector<std::vector<double>> path_derivatives(const FacetMesh& mesh, const SceneTree& tree,
                                                  double grid_unit_m, const VisibilityOptions& options,
                                                  const TubeSet& transmit, const TubeSet& receive,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model, const PathSettings& settings,
                                                  std::span<const EchoParameter> parameters,
                                                  const std::function<bool(std::size_t order)>& is_wanted) {
  if (settings.scatterings > 1) reject_gradient("patches of several scatterings are points");
  if (settings.sampled || settings.reference_tolerance)
    reject_gradient("paths by rays and references are not supported");
  if (model.patterns != nullptr) reject_gradient("beam patterns of paths over mirrors are not supported");
  VisibilityOptions named = options;
  named.corner_names = true;
  const ImageFinder finder(mesh, tree, named, settings.mirrors, settings.least(), settings.most_images);
  const bool one_place = transmit == receive;
  const std::vector<Image> sent = finder.images_of(transmit, settings.order, {{receive.apex}}),
                           received = one_place ? std::vector<Image>()
                                                : finder.images_of(receive, settings.order - 1);
  return PathDifferentiator(mesh, grid_unit_m, finder, sent, one_place ? sent : received, one_place, beams,
                            samples, model, settings, parameters, is_wanted)
      .differentiate();
}

}  // namespace tubefoot
