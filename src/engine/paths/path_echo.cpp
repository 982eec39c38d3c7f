// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/paths/path_echo.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "engine/certified/certified_arrival.hpp"
#include "engine/certified/reference.hpp"
#include "engine/paths/patch_paths.hpp"
#include "geometry/search/line_of_sight.hpp"
#include "geometry/steps/steps.hpp"
#include "geometry/tubes/window_tubes.hpp"

namespace tubefoot {
namespace {

std::vector<std::uint32_t> of_windows(const Image& image, std::span<const std::uint32_t> of_tube) {
  std::vector<std::uint32_t> values;
  if (of_tube.empty()) return values;
  for (const std::uint32_t tube : image.own_tube) values.push_back(of_tube[tube]);
  return values;
}

glm::dvec3 difference_m(GridPoint a, GridPoint b, double unit_m) {
  return glm::dvec3(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z) * unit_m;
}

/// Both apexes' images, and what passes between them.
class PathTracer {
 public:
  PathTracer(const FacetMesh& mesh, const SceneTree& tree, double unit_m, const VisibilityOptions& options,
             const TubeSet& transmit, const TubeSet& receive, const ReceiveBeams& beams,
             const RangeSamples& samples, const EchoLaw& law, const PathSettings& settings)
      : mesh_(mesh),
        unit_m_(unit_m),
        beams_(beams),
        samples_(samples),
        law_(law),
        settings_(settings),
        least_(std::pow(10, -settings.cutoff_db / 10)),
        beta_(absorption_per_m(law.absorption_db_per_m)),
        true_apex_(transmit.apex),
        true_receive_(receive),
        one_place_(transmit == receive),
        finder_(mesh, tree, options, settings.mirrors, least_, settings.most_images) {
    transmit_ = finder_.images_of(transmit, settings.order, receive.apex);
    if (!one_place_) receive_ = finder_.images_of(receive, settings.order - 1);
    echo_.by_order.resize(std::size_t(settings.order) + 1);
    for (Echo& echo : echo_.by_order) {
      echo.beams = beams.count;
      echo.samples = samples.count;
      echo.energy.assign(std::size_t(beams.count) * std::size_t(samples.count), 0);
    }
    if (settings.reference_tolerance)
      for (const Echo& echo : echo_.by_order) echo_.bound_by_order.emplace_back(echo.energy.size(), 0.0);
    echo_.images = transmit_.size() + receive_.size() - (one_place_ ? 1 : 2);
  }

  PathEcho trace() {
    scatter();
    if (settings_.scatterings > 1)
      add_scattered_paths(
          {mesh_, unit_m_, finder_, beams_, samples_, law_, settings_, true_apex_, true_receive_.reach},
          transmit_, receivers(), echo_);
    for (const Image& image : transmit_)
      if (image.mirrors > 0 || (settings_.direct && !one_place_)) arrive(image);
    return std::move(echo_);
  }

 private:
  /// What one task found: bins of an order that are not empty.
  struct Part {
    struct Bin {
      std::size_t order, bin;
      double energy, bound;
    };
    std::vector<Bin> bins;
    std::size_t pieces = 0;
  };

  const std::vector<Image>& receivers() const { return one_place_ ? transmit_ : receive_; }

  /// Facets of the whole mesh, each once.
  static std::vector<FacetId> facets_seen(const Image& image) {
    std::vector<FacetId> facets;
    for (const TubeVisibility& seen : image.seen)
      for (const NamedPiece& piece : seen.pieces)
        facets.push_back(image.origin.empty() ? piece.facet : image.origin[piece.facet]);
    std::sort(facets.begin(), facets.end());
    facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
    return facets;
  }

  /// Which image sees which facet, sorted.
  static std::vector<std::pair<FacetId, std::size_t>> who_sees(const std::vector<Image>& images) {
    std::vector<std::pair<FacetId, std::size_t>> who;
    for (std::size_t i = 0; i < images.size(); ++i)
      for (const FacetId facet : facets_seen(images[i])) who.emplace_back(facet, i);
    std::sort(who.begin(), who.end());
    return who;
  }

  /// All pairs of images between which something is scattered. What two images share is found once, also
  /// where both ends swap their parts.
  void scatter() {
    if (settings_.order < 2) return;
    struct Pair {
      std::size_t transmit, receive;
    };
    std::vector<Pair> pairs;
    const auto who = who_sees(receivers());
    std::vector<std::size_t> same, last(receivers().size(), transmit_.size());
    for (std::size_t i = 0; i < transmit_.size(); ++i) {
      stop_if_wanted();
      same.clear();
      for (const FacetId facet : facets_seen(transmit_[i]))
        for (auto at = std::lower_bound(who.begin(), who.end(), std::pair(facet, one_place_ ? i : 0));
             at != who.end() && at->first == facet; ++at)
          if (std::exchange(last[at->second], i) != i) same.push_back(at->second);
      std::sort(same.begin(), same.end());
      for (const std::size_t j : same) {
        const std::uint32_t mirrors = transmit_[i].mirrors + receivers()[j].mirrors;
        if (mirrors > 0 && int(mirrors) < settings_.order &&
            transmit_[i].largest * receivers()[j].largest > least_)
          pairs.push_back({i, j});
      }
      if (pairs.size() / 100 > settings_.most_images)
        throw std::length_error(
            fmt::format("more than {} pairs of images that see the same facets: make mirrors of many small "
                        "facets coarser, "
                        "follow fewer orders or cut off sooner",
                        100 * settings_.most_images));
    }
    std::vector<Part> parts(pairs.size());
    Steps steps("pairs of images", pairs.size());
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t k) {
      steps.done();
      const Image &sent = transmit_[pairs[k].transmit], &heard = receivers()[pairs[k].receive];
      const bool itself = &sent == &heard;
      SharedFootprints shared = itself ? shared_with_itself(mesh_, sent.look(), unit_m_)
                                       : FootprintSharer(mesh_, sent.look(), heard.look(), unit_m_).all();
      if (shared.pieces.empty()) return;
      const std::size_t order = sent.mirrors + heard.mirrors + 1;
      if (one_place_ && !itself)
        add(parts[k], order, scattered(heard, sent, exchanged(shared)), shared.pieces.size());
      const std::size_t pieces = shared.pieces.size();
      add(parts[k], order, scattered(sent, heard, std::move(shared)), pieces);
    });
    for (const Part& part : parts) take(part);
  }

  /// Without bounds all are 0.
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
  }
  void take(const Part::Bin& bin) {
    double& energy = echo_.by_order[bin.order].energy[bin.bin];
    energy += bin.energy;
    if (echo_.bound_by_order.empty()) return;
    constexpr double rounding = 0x1p-52;  // of both sums
    double& bound = echo_.bound_by_order[bin.order][bin.bin];
    bound = (bound + bin.bound) * (1 + rounding) + energy * rounding;
  }

  CertifiedEcho scattered(const Image& sent, const Image& heard, SharedFootprints shared) const {
    const BistaticHistory history{sent.windows, heard.windows, unit_m_, std::move(shared)};
    const std::vector<std::uint32_t> beam = of_windows(heard, beams_.of_tube),
                                     from = of_windows(sent, beams_.fan_of_transmit_tube),
                                     to = of_windows(heard, beams_.fan_of_receive_tube);
    EchoLaw law = law_;
    law.path.home = heard.leg;
    law.path.out = sent.leg;
    law.path.out.apex_m = law_.path.out.apex_m + difference_m(sent.windows.apex, true_apex_, unit_m_);
    BeamPatterns patterns;
    if (law_.patterns != nullptr) {
      patterns = *law_.patterns;
      patterns.fan_of_tube = of_windows(heard, law_.patterns->fan_of_tube);
      patterns.beams_of_tube.clear();
      for (const std::uint32_t tube : heard.own_tube)
        patterns.beams_of_tube.push_back(law_.patterns->beams_of_tube[tube]);
      law.patterns = &patterns;
    }
    const ReceiveBeams beams{beams_.count, beam, from, to};
    CertifiedEcho found;
    found.echo = integrate_echo(history, beams, samples_, law);
    if (const auto tolerance = settings_.reference_tolerance)
      found = certify_echo(mesh_, history, beams, samples_, law, found.echo, *tolerance);
    return found;
  }

  /// Rounded images miss the edge where two mirrors meet by no more than this many grid units.
  static constexpr double edge_units = 4;

  /// How much of the line from an image lies before its last mirror, or so near to it that a mirror which
  /// adjoins it must not hide what passes their common edge.
  static double part_to_mirror(const Image& image, GridPoint to) {
    if (!image.last) return 0;
    const double behind = -static_cast<double>(image.last->side(image.windows.apex)),
                 before = static_cast<double>(image.last->side(to)),
                 units = edge_units *
                         glm::length(glm::dvec3(double(image.last->normal.x), double(image.last->normal.y),
                                                double(image.last->normal.z)));
    return (behind + units) / (behind + before);
  }

  /// What comes straight from an image to the true receiver. Two chains have the same image only where their
  /// windows adjoin (two mirrors at a right angle), so a place is heard once.
  void arrive(const Image& image) {
    const GridPoint from = image.windows.apex, to = true_receive_.apex;
    const GridPoint along = to - from, back = from - to;
    if (along == GridPoint{} || (image.last && image.last->side(to) <= 0)) return;
    std::optional<bool> seen;
    for (std::uint32_t window = 0; window < image.own_tube.size(); ++window) {
      stop_if_wanted();
      const std::uint32_t fan =
          beams_.fan_of_transmit_tube.empty() ? 0 : beams_.fan_of_transmit_tube[image.own_tube[window]];
      if (arrived_.contains({from, fan}) || !holds(image.windows, window, along, window_border_rad)) continue;
      if (!seen) seen = in_sight(*image.mesh, *image.tree, from, to, part_to_mirror(image, to));
      if (!*seen) return;
      for (std::uint32_t tube = 0; tube < true_receive_.tubes.size(); ++tube) {
        if (!beams_.fan_of_receive_tube.empty() && beams_.fan_of_receive_tube[tube] != fan) continue;
        if (!holds(true_receive_, tube, back)) continue;
        hear(image, tube, difference_m(to, from, unit_m_));
        arrived_.insert({from, fan});
        break;
      }
    }
  }

  void hear(const Image& image, std::uint32_t receive_tube, glm::dvec3 path_m) {
    if (settings_.reference_tolerance) return hear_certified(image, receive_tube);
    const double length = glm::length(path_m);
    const double sample = std::floor((length / 2 - samples_.first_m) / samples_.step_m);
    if (!(sample >= 0 && sample < samples_.count)) return;
    const glm::dvec3 direction = path_m / length;
    const double passes = image.leg.loss.at(direction);
    if (!(passes > least_)) return;
    const double energy = passes * std::exp(-beta_ * length) / (length * length);
    const auto add = [&](std::uint32_t beam, double weight) {
      echo_.by_order[image.mirrors]
          .energy[std::size_t(beam) * std::size_t(samples_.count) + std::size_t(sample)] += weight * energy;
    };
    ++echo_.arrivals;
    if (law_.patterns == nullptr) return add(beams_.of_tube[receive_tube], 1);
    const BeamPatterns& patterns = *law_.patterns;
    const auto [first, end] = patterns.beams_of_tube[receive_tube];
    const double sent =
        patterns.transmit[patterns.fan_of_tube[receive_tube]].gain(image.leg.to_true * direction);
    for (std::uint32_t beam = first; beam < end; ++beam)
      add(beam, sent * patterns.receive[beam].gain(-direction));
  }

  void hear_certified(const Image& image, std::uint32_t receive_tube) {
    Arrival arrival{true_receive_.apex - image.windows.apex, unit_m_, law_.absorption_db_per_m, &image.leg};
    const double length = glm::length(difference_m(true_receive_.apex, image.windows.apex, unit_m_));
    if (!(image.leg.loss.at(difference_m(true_receive_.apex, image.windows.apex, unit_m_) / length) > least_))
      return;
    std::uint32_t first = beams_.of_tube[receive_tube];
    if (law_.patterns != nullptr) {
      const BeamPatterns& patterns = *law_.patterns;
      const auto [begin, end] = patterns.beams_of_tube[receive_tube];
      if (begin == end) return;
      first = begin;
      arrival.transmit = &patterns.transmit[patterns.fan_of_tube[receive_tube]];
      arrival.receive = std::span(patterns.receive).subspan(begin, end - begin);
    }
    bool heard = false;
    certify_arrival(
        arrival, samples_, [&](std::size_t beam, std::size_t sample, double energy, double bound) {
          heard = true;
          take({image.mirrors, (first + beam) * std::size_t(samples_.count) + sample, energy, bound});
        });
    if (heard) ++echo_.arrivals;
  }

  const FacetMesh& mesh_;
  double unit_m_;
  const ReceiveBeams& beams_;
  const RangeSamples& samples_;
  const EchoLaw& law_;
  const PathSettings& settings_;
  double least_, beta_;
  GridPoint true_apex_;
  const TubeSet& true_receive_;
  bool one_place_;
  ImageFinder finder_;
  std::vector<Image> transmit_, receive_;
  std::set<std::pair<GridPoint, std::uint32_t>> arrived_;  // images' apexes and fans
  PathEcho echo_;
};

}  // namespace

PathEcho path_echo(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                   const VisibilityOptions& options, const TubeSet& transmit, const TubeSet& receive,
                   const ReceiveBeams& beams, const RangeSamples& samples, const EchoLaw& law,
                   const PathSettings& settings) {
  if (settings.reference_tolerance && settings.scatterings > 1)
    throw std::invalid_argument("patches that scatter on are points: what they return has no proven bound");
  return PathTracer(mesh, tree, grid_unit_m, options, transmit, receive, beams, samples, law, settings)
      .trace();
}

}  // namespace tubefoot
