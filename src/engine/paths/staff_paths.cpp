// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/staff_paths.hpp"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <map>

#include "engine/paths/image_pairs.hpp"
#include "engine/paths/patch_paths.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

/// Where a chain of mirrors puts a grid point, from `to`. Images of apexes are rounded to the grid at every
/// mirror; phases ask for more.
glm::dvec3 image_m(GridPoint place, std::span<const MirrorPlane> chain, GridPoint to, double unit_m) {
  glm::dvec3 beside{0};  // from the grid point to the true one, grid units
  for (const MirrorPlane& plane : chain) {
    const GridPoint next = plane.image(place);
    const glm::dvec3 normal = plane.unit_normal(),
                     whole(double(plane.normal.x), double(plane.normal.y), double(plane.normal.z));
    const double before = double(plane.side(place)) / glm::length(whole) + glm::dot(normal, beside);
    beside += way_m(next, place, 1) - 2 * before * normal;
    place = next;
  }
  return way_m(to, place, unit_m) + beside * unit_m;
}

/// Images of the transmitter and of both receivers, and what passes between them.
class StaffTracer {
 public:
  StaffTracer(const FacetMesh& mesh, const SceneTree& tree, double unit_m, const VisibilityOptions& options,
              const TubeSet& transmit, const TubeSet& receive, const Fringe& staff,
              const RangeSamples& samples, const EchoLaw& law, const PathSettings& settings)
      : mesh_(mesh),
        unit_m_(unit_m),
        staff_(staff),
        samples_(samples),
        law_(law),
        settings_(settings),
        apex_(transmit.apex),
        middle_(receive.apex),
        ends_{moved_along(receive, staff, 1, unit_m), moved_along(receive, staff, -1, unit_m)},
        only_beam_(receive.tubes.size(), 0),
        finder_(mesh, tree, options, settings.mirrors, settings.least(), settings.most_images),
        sent_(finder_.images_of(transmit, settings.order, {{ends_[0].apex, ends_[1].apex}})) {
    for (std::size_t end = 0; end < 2; ++end) heard_[end] = finder_.images_of(ends_[end], settings.order - 1);
    for (std::size_t k = 0; k < heard_[1].size(); ++k) by_chain_[heard_[1][k].chain].push_back(k);
    const auto count = std::size_t(samples.count);
    echo_.by_order.assign(std::size_t(settings.order) + 1,
                          {std::vector<double>(count), std::vector<double>(count), std::vector<double>(count),
                           std::vector<double>(count)});
    echo_.images = sent_.size() + heard_[0].size() + heard_[1].size() - 3;
  }

  StaffPathEcho trace() {
    std::array<std::vector<ArrivedEnergy>, 2> arrived;
    PathSettings once = settings_;
    once.scatterings = 1;
    for (std::size_t end = 0; end < 2; ++end) {
      PathEcho one = path_echo(mesh_, unit_m_, finder_, sent_, heard_[end], ends_[end], {1, only_beam_},
                               samples_, law_, once);
      for (std::size_t order = 0; order < one.by_order.size(); ++order)
        (end == 0 ? echo_.by_order[order].upper_j : echo_.by_order[order].lower_j) =
            std::move(one.by_order[order].energy);
      echo_.shared_pieces += one.shared_pieces;
      echo_.arrivals += one.arrivals;
      arrived[end] = std::move(one.arrived);
    }
    multiply_scattered();
    multiply_arrivals(arrived);
    if (settings_.scatterings > 1) add_scattered();
    return std::move(echo_);
  }

 private:
  void add(std::size_t order, std::size_t sample, Complex product) {
    echo_.by_order[order].cross_real_j[sample] += product.real();
    echo_.by_order[order].cross_imag_j[sample] += product.imag();
  }

  glm::dvec3 axis_of(const Image& receiver) const {
    return glm::transpose(receiver.leg.to_true) * staff_.axis;
  }

  /// The lower receiver's images in the same mirrors as one of the upper one's.
  std::span<const std::size_t> lower_of(const Image& upper) const {
    const auto found = by_chain_.find(upper.chain);
    return found == by_chain_.end() ? std::span<const std::size_t>() : found->second;
  }

  /// What is scattered once.
  void multiply_scattered() {
    struct Triple {
      const Image *sent, *upper, *lower;
    };
    std::vector<Triple> all;
    for (const ImagePair& pair : pairs_of_images(sent_, heard_[0], false, settings_.order, settings_.least(),
                                                 100 * settings_.most_images))
      for (const std::size_t k : lower_of(heard_[0][pair.heard]))
        if (sent_[pair.sent].largest * heard_[1][k].largest > settings_.least())
          all.push_back({&sent_[pair.sent], &heard_[0][pair.heard], &heard_[1][k]});
    struct Bin {
      std::size_t sample;
      Complex product;
    };
    std::vector<std::vector<Bin>> found(all.size());
    Steps steps("pairs of images", all.size());
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t k) {
      const auto& [sent, upper, lower] = all[k];
      const StaffEcho echo = product_of(*sent, *upper, *lower);
      for (std::size_t sample = 0; sample < echo.cross_real_j.size(); ++sample)
        if (const Complex product{echo.cross_real_j[sample], echo.cross_imag_j[sample]}; product != 0.0)
          found[k].push_back({sample, product});
      steps.done();
    });
    for (std::size_t k = 0; k < all.size(); ++k)
      for (const Bin& bin : found[k])
        add(all[k].sent->mirrors + all[k].upper->mirrors + 1, bin.sample, bin.product);
  }

  StaffEcho product_of(const Image& sent, const Image& upper, const Image& lower) const {
    StaffHistory history;
    history.middle_m = image_m(middle_, upper.chain, sent.windows.apex, unit_m_);
    history.by_upper = FootprintSharer(mesh_, sent.look(), upper.look(), unit_m_).all();
    if (history.by_upper.pieces.empty()) return {};
    history.by_lower = FootprintSharer(mesh_, sent.look(), lower.look(), unit_m_).all();
    EchoLaw by_upper = law_;
    by_upper.path.out = sent.leg;
    by_upper.path.out.apex_m = law_.path.out.apex_m + way_m(apex_, sent.windows.apex, unit_m_);
    EchoLaw by_lower = by_upper;
    by_upper.path.home = upper.leg;
    by_lower.path.home = lower.leg;
    const BeamPatterns patterns = as_images_have(*law_.patterns, by_upper.path);
    by_upper.patterns = by_lower.patterns = &patterns;
    const Fringe staff{axis_of(upper), staff_.baseline_m, staff_.wavenumber_rad_m};
    return integrate_staff_products(history, staff, 0, 0, samples_, by_upper, by_lower);
  }

  /// What comes to both receivers straight from the same image of the transmitter.
  void multiply_arrivals(const std::array<std::vector<ArrivedEnergy>, 2>& arrived) {
    for (const ArrivedEnergy& upper : arrived[0])
      for (const ArrivedEnergy& lower : arrived[1]) {
        if (!(upper.from == lower.from) || upper.order != lower.order || upper.bin != lower.bin) continue;
        const glm::dvec3 way = way_m(upper.from, middle_, unit_m_),
                         half = staff_.baseline_m / 2 * staff_.axis;
        const double further = 4 * glm::dot(way, half) / (glm::length(way + half) + glm::length(way - half));
        add(upper.order, upper.bin,
            std::polar(std::sqrt(upper.energy_j * lower.energy_j), staff_.wavenumber_rad_m * further));
      }
  }

  /// What is scattered more than once: rows of the upper and of the lower receiver's energies, and of both
  /// parts of the product.
  void add_scattered() {
    const ReceiveBeams beams{1, only_beam_};
    const PathScene scene{mesh_, unit_m_, finder_, beams, samples_, law_, settings_, apex_, ends_[0].reach};
    std::vector<Listener> listeners;
    for (std::uint32_t end = 0; end < 2; ++end)
      for (const Image& image : heard_[end]) listeners.push_back({scene.heard_by(image), {}, end});
    for (const Image& upper : heard_[0])
      for (const std::size_t k : lower_of(upper))
        listeners.push_back({scene.heard_by(upper), scene.heard_by(heard_[1][k]), 2,
                             image_m(middle_, upper.chain, apex_, unit_m_),
                             staff_.baseline_m * axis_of(upper), staff_.wavenumber_rad_m});
    const auto count = std::size_t(samples_.count);
    PathEcho rows;
    rows.by_order.resize(echo_.by_order.size());
    for (Echo& echo : rows.by_order) echo.energy.assign(4 * count, 0);
    add_scattered_paths(scene, sent_, listeners, rows);
    for (std::size_t order = 0; order < rows.by_order.size(); ++order) {
      StaffEcho& to = echo_.by_order[order];
      const std::vector<double>& energy = rows.by_order[order].energy;
      for (std::size_t k = 0; k < count; ++k) {
        to.upper_j[k] += energy[k];
        to.lower_j[k] += energy[count + k];
        add(order, k, {energy[2 * count + k], energy[3 * count + k]});
      }
    }
    echo_.patches += rows.patches;
    echo_.shared_pieces += rows.shared_pieces;
  }

  const FacetMesh& mesh_;
  double unit_m_;
  const Fringe& staff_;
  const RangeSamples& samples_;
  const EchoLaw& law_;
  const PathSettings& settings_;
  GridPoint apex_, middle_;      // true ones, of the transmitter and of the staff
  std::array<TubeSet, 2> ends_;  // upper, lower
  std::vector<std::uint32_t> only_beam_;
  ImageFinder finder_;
  std::vector<Image> sent_;
  std::array<std::vector<Image>, 2> heard_;
  std::map<std::vector<MirrorPlane>, std::vector<std::size_t>> by_chain_;  // of the lower receiver's images
  StaffPathEcho echo_;
};

}  // namespace

StaffPathEcho staff_path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                              const VisibilityOptions& options, const TubeSet& transmit,
                              const TubeSet& receive, const Fringe& staff, const RangeSamples& samples,
                              const EchoLaw& law, const PathSettings& settings) {
  return StaffTracer(mesh, tree, grid_unit_m, options, transmit, receive, staff, samples, law, settings)
      .trace();
}

BeamPatterns patterns_of_fan(const BeamPatterns& patterns, std::uint32_t fan, std::size_t tubes) {
  BeamPatterns own;
  own.transmit = {patterns.transmit[fan]};
  own.receive = {patterns.receive[fan]};
  own.fan_of_tube.assign(tubes, 0);
  own.beams_of_tube.assign(tubes, {0, 1});
  return own;
}

}  // namespace tubefoot
