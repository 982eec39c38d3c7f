// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/receiver_pair_paths.hpp"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "engine/certified/certified_arrival.hpp"
#include "engine/certified/receiver_pair_reference.hpp"
#include "engine/paths/image_pairs.hpp"
#include "engine/paths/patch_paths.hpp"
#include "engine/scattering/pair_density.hpp"
#include "geometry/numbers/grid_vector.hpp"
#include "geometry/steps/steps.hpp"

// Computes energies and mean products of a receiver pair per order. A product combines the two receivers'
// images over the same mirrors, with the phase of the path difference. Source: docs/notes/multiple-paths.md,
// "Receiver pairs".

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

/// Position of the image of a grid point in a chain of mirrors, from `to`. Images of apexes are rounded to
/// the grid at every mirror, which is too coarse for phases.
glm::dvec3 image_m(GridPoint place, std::span<const MirrorPlane> chain, GridPoint to, double unit_m) {
  glm::dvec3 beside{0};  // from the rounded image to the exact one, grid units
  for (const MirrorPlane& plane : chain) {
    const GridPoint next = plane.image(place);
    const glm::dvec3 normal = plane.unit_normal(),
                     whole(double(plane.normal.x), double(plane.normal.y), double(plane.normal.z));
    const double before = double(plane.side(place)) / glm::length(whole) + glm::dot(normal, beside);
    beside += displacement(next, place) - 2 * before * normal;
    place = next;
  }
  return displacement_m(to, place, unit_m) + beside * unit_m;
}

/// Receiver pair with the baseline scaled for the apparent seabed from its middle. Phases depend on the
/// sound speed at the receivers, ranges on the reference speed.
ReceiverBaseline apparent_receiver_pair(const ReceiverPairEnds& ends, const PathWater& water) {
  ReceiverBaseline receiver_pair = ends.receiver_pair;
  const double depth_m = water.surface_height_m - water.grid.to_metres(ends.receive.apex).z;
  receiver_pair.baseline_m *= water.reference_speed_m_s / water.column.profile.at(depth_m);
  return receiver_pair;
}

/// Images of the transmitter and of both receivers, and the echoes between them.
class ReceiverPairTracer {
 public:
  ReceiverPairTracer(const FacetMesh& mesh, const SceneTree& tree, double unit_m,
                     const VisibilityOptions& options, const ReceiverPairEnds& ends,
                     const RangeSamples& samples, const EchoModel& model, const PathSettings& settings,
                     const PathWater* water)
      : mesh_(mesh),
        unit_m_(unit_m),
        receiver_pair_(water != nullptr ? apparent_receiver_pair(ends, *water) : ends.receiver_pair),
        samples_(samples),
        model_(model),
        settings_(settings),
        apex_(ends.transmit.apex),
        middle_(ends.receive.apex),
        ends_{moved_along(ends.receive, ends.receiver_pair, 1, unit_m),
              moved_along(ends.receive, ends.receiver_pair, -1, unit_m)},
        only_beam_(ends.receive.tubes.size(), 0),
        finder_(mesh, tree, options, settings.mirrors, settings.least(), settings.most_images) {
    const std::array<GridPoint, 2> received_at{ends_[0].apex, ends_[1].apex};
    if (water == nullptr) {
      sent_ = finder_.images_of(ends.transmit, settings.order, received_at);
      for (std::size_t end = 0; end < 2; ++end)
        received_[end] = finder_.images_of(ends_[end], settings.order - 1);
    } else {
      std::vector<TubeSet> places{ends.transmit};
      if (ends.receive != ends.transmit) places.push_back(ends.receive);
      const std::size_t middle = places.size() - 1;
      refracted_.emplace(mesh, tree, options, settings.mirrors, settings.least(), settings.most_images,
                         model.absorption_db_per_m, *water, std::move(places), settings.order);
      sent_ = refracted_->images_of(0, received_at);
      for (std::size_t end = 0; end < 2; ++end) {
        const TubeSet beside = moved_along(ends.receive, receiver_pair_, end == 0 ? 1 : -1, unit_m);
        received_[end] = refracted_->images_of(middle, {}, &beside);
      }
    }
    for (std::size_t k = 0; k < received_[1].size(); ++k) by_chain_[chain_of(received_[1][k])].push_back(k);
    const std::vector<double> none(std::size_t(samples.count));
    echo_.by_order.assign(std::size_t(settings.order) + 1, {none, none, none, none});
    if (settings.reference_tolerance) echo_.bound_by_order = echo_.by_order;
    echo_.images = sent_.size() + received_[0].size() + received_[1].size() - 3;
  }

  ReceiverPairPathEcho trace() {
    std::array<std::vector<ArrivedEnergy>, 2> arrived;
    PathSettings once = settings_;
    once.scatterings = 1;
    for (std::size_t end = 0; end < 2; ++end) {
      PathEcho one =
          path_echo(mesh_, unit_m_, {finder_, sent_, received_[end], refracted_ ? &*refracted_ : nullptr},
                    ends_[end], {1, only_beam_}, samples_, model_, once);
      const auto row = [end](ReceiverPairEcho& echo) -> std::vector<double>& {
        return end == 0 ? echo.upper_j : echo.lower_j;
      };
      for (std::size_t order = 0; order < one.by_order.size(); ++order)
        row(echo_.by_order[order]) = std::move(one.by_order[order].energy);
      for (std::size_t order = 0; order < one.bound_by_order.size(); ++order)
        row(echo_.bound_by_order[order]) = std::move(one.bound_by_order[order]);
      echo_.shared_pieces += one.shared_pieces;
      echo_.arrivals += one.arrivals;
      echo_.largest_misfit_m = std::max(echo_.largest_misfit_m, one.largest_misfit_m);
      arrived[end] = std::move(one.arrived);
    }
    multiply_scattered();
    multiply_arrivals(arrived);
    if (settings_.scatterings > 1) add_scattered();
    if (refracted_) echo_.surface_meshes = refracted_->take_surfaces();
    return std::move(echo_);
  }

 private:
  void add(std::size_t order, std::size_t sample, Complex product) {
    echo_.by_order[order].cross_real_j[sample] += product.real();
    echo_.by_order[order].cross_imag_j[sample] += product.imag();
  }

  glm::dvec3 axis_of(const Image& receiver) const {
    return glm::transpose(receiver.leg.to_true) * receiver_pair_.axis;
  }

  /// Identifies a chain of mirrors, in isovelocity or in refracting water.
  using Chain = std::pair<std::vector<MirrorPlane>, std::size_t>;
  static Chain chain_of(const Image& image) { return {image.chain, image.mirror_path}; }

  /// Images of the lower receiver over the same mirrors as an image of the upper one.
  std::span<const std::size_t> lower_of(const Image& upper) const {
    const auto found = by_chain_.find(chain_of(upper));
    return found == by_chain_.end() ? std::span<const std::size_t>() : found->second;
  }

  /// Adds a product with its bounds, which are 0 without a reference.
  void add(std::size_t order, std::size_t sample, const Bounded& real, const Bounded& imag) {
    add(order, sample, {real.value, imag.value});
    if (echo_.bound_by_order.empty()) return;
    constexpr double rounding = 0x1p-52;  // rounding of both sums
    const auto widen = [&](double& bound, double more, double sum) {
      bound = (bound + more) * (1 + rounding) + std::abs(sum) * rounding;
    };
    ReceiverPairEcho& bounds = echo_.bound_by_order[order];
    widen(bounds.cross_real_j[sample], real.bound, echo_.by_order[order].cross_real_j[sample]);
    widen(bounds.cross_imag_j[sample], imag.bound, echo_.by_order[order].cross_imag_j[sample]);
  }

  /// Adds the products of single scatterings.
  void multiply_scattered() {
    struct Triple {
      const Image *sent, *upper, *lower;
    };
    std::vector<Triple> all;
    for (const ImagePair& pair : pairs_of_images(sent_, received_[0], false, settings_.order,
                                                 settings_.least(), 100 * settings_.most_images))
      for (const std::size_t k : lower_of(received_[0][pair.received]))
        if (sent_[pair.sent].largest * received_[1][k].largest > settings_.least())
          all.push_back({&sent_[pair.sent], &received_[0][pair.received], &received_[1][k]});
    struct Bin {
      std::size_t sample;
      Bounded real, imag;
    };
    std::vector<std::vector<Bin>> found(all.size());
    Steps steps("pairs of images", all.size());
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t k) {
      const auto& [sent, upper, lower] = all[k];
      const CertifiedEcho echo = product_of(*sent, *upper, *lower);
      const auto count = std::size_t(samples_.count);
      const auto bounded = [&](std::size_t bin) {
        return Bounded{echo.echo.energy[bin], echo.bound.empty() ? 0 : echo.bound[bin]};
      };
      for (std::size_t sample = 0; !echo.echo.energy.empty() && sample < count; ++sample) {
        const Bin bin{sample, bounded(2 * count + sample), bounded(3 * count + sample)};
        if (bin.real.value != 0 || bin.imag.value != 0 || bin.real.bound != 0 || bin.imag.bound != 0)
          found[k].push_back(bin);
      }
      steps.done();
    });
    for (std::size_t k = 0; k < all.size(); ++k)
      for (const Bin& bin : found[k])
        add(all[k].sent->mirrors + all[k].upper->mirrors + 1, bin.sample, bin.real, bin.imag);
  }

  /// Rows as in certify_receiver_pair_echo(). Without a reference the result has no bounds.
  CertifiedEcho product_of(const Image& sent, const Image& upper, const Image& lower) const {
    ReceiverPairHistory history;
    history.transmit.apex = sent.windows.apex;
    history.middle_m = image_m(middle_, upper.chain, sent.windows.apex, unit_m_);
    share(sent, upper, history.by_upper, history.bistatic_upper);
    if (history.by_upper.pieces.empty()) return {};
    share(sent, lower, history.by_lower, history.bistatic_lower);
    if (history.by_lower.pieces.empty()) return {};
    EchoModel by_upper = model_;
    if (refracted_) by_upper.material = refracted_->seabed().material;
    by_upper.path.tx = sent.leg;
    by_upper.path.tx.apex_m = model_.path.tx.apex_m + displacement_m(apex_, sent.windows.apex, unit_m_);
    EchoModel by_lower = by_upper;
    by_upper.path.rx = upper.leg;
    by_lower.path.rx = lower.leg;
    const BeamPatterns patterns = as_images_have(*model_.patterns, by_upper.path);
    by_upper.patterns = by_lower.patterns = &patterns;
    const ReceiverBaseline receiver_pair{axis_of(upper), receiver_pair_.baseline_m,
                                         receiver_pair_.wavenumber_rad_m};
    if (!settings_.reference_tolerance)
      return {rows_of(integrate_receiver_pair_products(history, receiver_pair, 0, 0, samples_, by_upper,
                                                       by_lower)),
              {}};
    const ReceiverPairEcho ordinary =
        integrate_receiver_pair_echo(history, receiver_pair, 0, 0, samples_, by_upper, by_lower);
    return certify_receiver_pair_products(mesh_, history, unit_m_, receiver_pair, samples_, by_upper,
                                          by_lower, ordinary, *settings_.reference_tolerance);
  }

  /// Common visibility of both ends, which in refracting water see the apparent seabed of the receiver
  /// pair's middle.
  void share(const Image& sent, const Image& received, SharedFootprints& shared,
             std::vector<BistaticFacet>& bistatic) const {
    if (!refracted_) {
      const SharedDetails details{.corner_rests = settings_.reference_tolerance && !settings_.rounds_corners};
      shared = FootprintSharer(mesh_, sent.look(), received.look(), unit_m_, details).all();
      return;
    }
    shared = FootprintSharer(sent.look(), received.look(), unit_m_).all();
    bistatic = bistatic_facets(shared, refracted_->seabed(), refracted_->end_of(sent),
                               refracted_->end_of(received), refracted_->grid(), model_.absorption_db_per_m);
  }

  /// Adds the products of unscattered arrivals at both receivers from the same image of the transmitter. In
  /// refracting water the rays with the most similar arrivals are combined.
  void multiply_arrivals(const std::array<std::vector<ArrivedEnergy>, 2>& arrived) {
    const auto apart = [](const ArrivedEnergy& a, const ArrivedEnergy& b) {
      if (!(a.from == b.from) || a.chain != b.chain || a.order != b.order)
        return std::numeric_limits<double>::infinity();
      return glm::length(displacement(a.displacement, b.displacement));
    };
    std::array<std::vector<double>, 2> nearest;
    for (std::size_t end = 0; end < 2; ++end)
      for (const ArrivedEnergy& one : arrived[end]) {
        double& least = nearest[end].emplace_back(std::numeric_limits<double>::max());
        for (const ArrivedEnergy& other : arrived[1 - end]) least = std::min(least, apart(one, other));
      }
    for (std::size_t u = 0; u < arrived[0].size(); ++u)
      for (std::size_t l = 0; l < arrived[1].size(); ++l) {
        const ArrivedEnergy &upper = arrived[0][u], &lower = arrived[1][l];
        if (upper.bin != lower.bin || apart(upper, lower) > std::min(nearest[0][u], nearest[1][l])) continue;
        if (settings_.reference_tolerance) {
          const auto [real, imag] =
              certify_arrivals_product(middle_ - upper.from, unit_m_, receiver_pair_,
                                       {upper.energy_j, upper.bound_j}, {lower.energy_j, lower.bound_j});
          add(upper.order, upper.bin, real, imag);
          continue;
        }
        // The middle of the receivers from the image, and from there to the upper receiver.
        const glm::dvec3 way = (displacement_m({}, upper.displacement, unit_m_) +
                                displacement_m({}, lower.displacement, unit_m_)) /
                               2.0,
                         half = receiver_pair_.baseline_m / 2 * receiver_pair_.axis;
        const double further =
            range_difference(glm::dot(-way, 2.0 * half), glm::length(way + half) + glm::length(way - half));
        const auto product =
            PairDensity::of(upper.energy_j, lower.energy_j, receiver_pair_.wavenumber_rad_m * further);
        add(upper.order, upper.bin, {product.real, product.imag});
      }
  }

  /// Adds multiple scattering. The four rows are the energies of the upper and of the lower receiver, and
  /// the real and the imaginary part of the product.
  void add_scattered() {
    const ReceiveBeams beams{1, only_beam_};
    const PathScene scene{mesh_,  unit_m_,   finder_, beams,          samples_,
                          model_, settings_, apex_,   ends_[0].reach, refracted_ ? &*refracted_ : nullptr};
    std::vector<ImageReceiver> image_receivers;
    for (std::uint32_t end = 0; end < 2; ++end)
      for (const Image& image : received_[end]) image_receivers.push_back({scene.received_by(image), end});
    for (std::size_t u = 0; u < received_[0].size(); ++u)
      for (const std::size_t k : lower_of(received_[0][u])) {
        const Image& upper = received_[0][u];
        ReceiverViews both(image_receivers[u].receives, image_receivers[received_[0].size() + k].receives);
        image_receivers.push_back({std::move(both), 2, image_m(middle_, upper.chain, apex_, unit_m_),
                                   receiver_pair_.baseline_m * axis_of(upper),
                                   receiver_pair_.wavenumber_rad_m});
      }
    const auto count = std::size_t(samples_.count);
    PathEcho rows;
    rows.by_order.resize(echo_.by_order.size());
    for (Echo& echo : rows.by_order) echo.energy.assign(4 * count, 0);
    add_scattered_paths(scene, sent_, image_receivers, rows);
    for (std::size_t order = 0; order < rows.by_order.size(); ++order) {
      ReceiverPairEcho& to = echo_.by_order[order];
      const std::vector<double>& energy = rows.by_order[order].energy;
      for (std::size_t k = 0; k < count; ++k) {
        to.upper_j[k] += energy[k];
        to.lower_j[k] += energy[count + k];
        add(order, k, {energy[2 * count + k], energy[3 * count + k]});
      }
    }
    echo_.patches += rows.patches;
    echo_.shared_pieces += rows.shared_pieces;
    echo_.seen_by_patches.add(rows.seen_by_patches);
  }

  const FacetMesh& mesh_;
  double unit_m_;
  const ReceiverBaseline receiver_pair_;
  const RangeSamples& samples_;
  const EchoModel& model_;
  const PathSettings& settings_;
  GridPoint apex_, middle_;      // true apexes of transmitter and receiver pair
  std::array<TubeSet, 2> ends_;  // upper, lower
  std::vector<std::uint32_t> only_beam_;
  ImageFinder finder_;
  std::optional<RefractedImages> refracted_;  // in refracting water
  std::vector<Image> sent_;
  std::array<std::vector<Image>, 2> received_;
  std::map<Chain, std::vector<std::size_t>> by_chain_;  // images of the lower receiver
  ReceiverPairPathEcho echo_;
};

}  // namespace

ReceiverPairPathEcho receiver_pair_path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                                             const VisibilityOptions& options, const ReceiverPairEnds& ends,
                                             const RangeSamples& samples, const EchoModel& model,
                                             const PathSettings& settings, const PathWater* water) {
  if (settings.reference_tolerance && settings.scatterings > 1)
    throw std::invalid_argument(
        "second scattering treats patches as points, so there is no certified bound for its echoes");
  return ReceiverPairTracer(mesh, tree, grid_unit_m, options, ends, samples, model, settings, water).trace();
}

}  // namespace tubefoot
