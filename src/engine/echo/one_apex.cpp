// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "engine/echo/hit_lanes.hpp"
#include "engine/echo/pattern_integral.hpp"
#include "engine/echo/quadratures.hpp"
#include "engine/echo/sample_finder.hpp"
#include "engine/echo/scattering_cut.hpp"
#include "engine/echo/texture_cells.hpp"
#include "engine/scattering/density.hpp"
#include "engine/scattering/radial_model.hpp"
#include "geometry/integrals/range_cut.hpp"
#include "geometry/steps/steps.hpp"

// Integrates monostatic echoes: footprints without patterns by closed forms in range, with patterns by
// PatternIntegrator, and hits of rays (quadratures.hpp).

namespace tubefoot {
namespace {

constexpr std::uint32_t no_tube = std::numeric_limits<std::uint32_t>::max();

/// Beams that receive all of their own tubes with the gain 1.
BeamPatterns ideal_beams(const ReceiveBeams& beams) {
  BeamPatterns patterns;
  patterns.transmit.resize(1);
  patterns.receive.resize(std::size_t(beams.count));
  patterns.fan_of_tube.assign(beams.of_tube.size(), 0);
  for (const std::uint32_t beam : beams.of_tube) patterns.beams_of_tube.emplace_back(beam, beam + 1);
  return patterns;
}

/// Sums per bin for many hits in few bins. Each bin has four sums, one per lane modulo four. An addition
/// would otherwise wait for the previous one if neighbouring hits belong to one bin. The four sums are added
/// in a fixed order at the end. With many bins there is one sum per bin, the energy itself.
class LaneSums {
 public:
  LaneSums(std::span<const HitBlock> hits, std::vector<double>& energy) {
    constexpr std::size_t few = 1 << 13;  // four times this number of sums fit in a cache
    const std::size_t bins = energy.size();
    if (bins > few || HitBlock::size * hits.size() < 8 * bins) {
      sum_.fill(energy.data());
      return;
    }
    own_.resize(sum_.size() * bins);
    for (std::size_t k = 0; k < sum_.size(); ++k) sum_[k] = own_.data() + k * bins;
  }
  void add(std::size_t lane, std::size_t bin, double energy) const { sum_[lane % 4][bin] += energy; }
  void finish(std::vector<double>& energy) const {
    if (own_.empty()) return;
    for (std::size_t bin = 0; bin < energy.size(); ++bin)
      energy[bin] += (sum_[0][bin] + sum_[1][bin]) + (sum_[2][bin] + sum_[3][bin]);
  }

 private:
  std::vector<double> own_;
  std::array<double*, 4> sum_{};
};

/// Energies of all bins with the inputs of the sum.
class OneApex {
 public:
  OneApex(const CommonVisibility& visibility, const ReceiveBeams& beams, const RangeSamples& samples,
          const EchoModel& model, const Quadrature& how, const Sink<double>& sink, std::vector<double> buffer)
      : visibility_(visibility),
        beams_(beams),
        samples_(samples),
        model_(model),
        how_(how),
        sink_(sink),
        finder_(samples),
        beta_(absorption_per_m(model.absorption_db_per_m)),
        energy_(std::move(buffer)) {
    const std::size_t rows =
        std::size_t(model.patterns != nullptr ? model.patterns->channels() : 1) * std::size_t(beams.count);
    energy_.resize(rows * std::size_t(samples.count));
    nonzero_.resize(rows);
    if (model.patterns == nullptr) return;
    for (const ReceiverBaseline& baseline : model.patterns->baselines)
      spread_m_ = std::max(spread_m_, baseline.baseline_m);
  }

  Echo integrate() {
    bool by_samples = visibility_.hits().empty();  // whether nonzero_ covers all energies
    if (visibility_.first() == visibility_.end()) {
      // No footprints, so no preparation.
    } else if (how_.binning != Binning::exact) {
      whole();
      by_samples = false;
    } else if (model_.patterns != nullptr) {
      weighed(*model_.patterns, false);
      by_samples = false;
    } else if (!even()) {
      weighed(ideal_beams(beams_), true);
      by_samples = false;
    }
    hits();
    if (!by_samples) nonzero_.clear();
    return {beams_.count, samples_.count, std::move(energy_), std::move(nonzero_)};
  }

 private:
  std::uint32_t beam_of(std::uint32_t tube) const {
    if (tube >= beams_.of_tube.size())
      throw std::invalid_argument(
          fmt::format("the history has tube {}, but only {} tubes have a beam", tube, beams_.of_tube.size()));
    const std::uint32_t beam = beams_.of_tube[tube];
    if (beam >= std::uint32_t(beams_.count))
      throw std::invalid_argument(
          fmt::format("tube {} belongs to beam {}, but there are {} beams", tube, beam, beams_.count));
    return beam;
  }
  std::uint32_t tube_of(std::size_t number) const { return visibility_.footprint(number)->tube; }

  /// Passes to the sink the energies that a footprint has just added, and resets them.
  void told(std::size_t number) {
    if (!how_.by_owner) return;
    const std::uint32_t tube = tube_of(number);
    const auto [first, end] = finder_.between(near_m_ - spread_m_, far_m_ + spread_m_);
    std::pair<std::uint32_t, std::uint32_t> received{beams_.of_tube[tube], beams_.of_tube[tube] + 1};
    if (model_.patterns != nullptr) received = model_.patterns->beams_of_tube[tube];
    const auto samples = std::size_t(samples_.count);
    for (std::size_t channel = 0; channel < energy_.size(); channel += std::size_t(beams_.count) * samples)
      for (std::uint32_t beam = received.first; beam < received.second; ++beam) {
        const std::size_t row = channel + beam * samples;
        for (std::size_t k = first; k < end; ++k)
          if (const double energy = std::exchange(energy_[row + k], 0); energy != 0)
            sink_({std::uint32_t(row / samples), std::uint32_t(k), energy, std::uint32_t(number), tube});
      }
  }
  void add_nonzero(std::size_t row, SampleSpan samples) {
    if (samples.first >= samples.end) return;
    SampleSpan& span = nonzero_[row];
    span = span.first >= span.end
               ? samples
               : SampleSpan{std::min(span.first, samples.first), std::max(span.end, samples.end)};
  }
  void begin_footprint() {
    near_m_ = finder_.borders().back();
    far_m_ = 0;
  }
  void assign(const SeenFacet& facet, std::size_t number, std::uint32_t piece, const PlaneFrame& frame) {
    polygon_.assign(visibility_.part(number, facet.first_piece + piece).corners_m, facet.plane, frame);
    if (!how_.by_owner || polygon_.offsets.empty()) return;
    near_m_ = std::min(near_m_, nearest_point(polygon_).range);
    far_m_ = std::max(far_m_, farthest_range(polygon_));
  }

  /// Adds all footprints except those with a reflectivity texture. Returns false if there are such
  /// footprints.
  bool even() {
    const std::shared_ptr<const RadialIntegral> radial =
        lambert_radial_integral(samples_, model_.absorption_db_per_m);
    RangeCutter cutter(*radial);
    std::optional<ScatteringCutter> scattering_cutter;
    bool all = true;
    for (std::size_t number = visibility_.first(); number < visibility_.end(); ++number) {
      stop_if_wanted();
      const SeenFacet facet = visibility_[number];
      const std::uint32_t beam = beam_of(tube_of(number));
      const std::span<double> row =
          std::span(energy_).subspan(beam * std::size_t(samples_.count), std::size_t(samples_.count));
      const SurfaceProperties seabed = model_.seabed(facet.facet);
      if (seabed.texture != nullptr) {
        all = false;
        continue;
      }
      if (is_silent(seabed)) continue;
      const PlaneFrame frame(facet.plane);
      const double factor = seabed.mu * facet.plane.distance_m * facet.plane.distance_m;
      begin_footprint();
      for (std::uint32_t p = 0; p < facet.piece_count; ++p) {
        assign(facet, number, p, frame);
        if (seabed.scattering != nullptr) {
          if (!scattering_cutter) scattering_cutter.emplace(samples_, model_.absorption_db_per_m);
          add_nonzero(beam, scattering_cutter->add(polygon_, *seabed.scattering, row, seabed.factor));
        } else {
          add_nonzero(beam, cutter.add(polygon_, factor, row));
        }
      }
      told(number);
    }
    return all;
  }

  /// `only_textured`: only footprints of facets with a reflectivity texture.
  void weighed(const BeamPatterns& patterns, bool only_textured) {
    PatternIntegrator integrator(finder_.borders(), beta_, patterns, model_.pattern_tolerance);
    TextureCells cells;
    Steps steps("footprints", visibility_.end() - visibility_.first());
    for (std::size_t number = visibility_.first(); number < visibility_.end(); ++number) {
      steps.done();
      const SeenFacet facet = visibility_[number];
      const SurfaceProperties seabed = model_.seabed(facet.facet);
      if ((only_textured && seabed.texture == nullptr) || is_silent(seabed)) continue;
      const std::uint32_t tube = tube_of(number);
      const PlaneFrame frame(facet.plane);
      const double lambert_or_one = seabed.scattering != nullptr
                                        ? seabed.factor
                                        : seabed.mu * facet.plane.distance_m * facet.plane.distance_m;
      beam_of(tube);  // throws for a tube without a beam
      begin_footprint();
      for (std::uint32_t p = 0; p < facet.piece_count; ++p) {
        assign(facet, number, p, frame);
        if (seabed.texture == nullptr) {
          integrator.add(polygon_, facet.plane, frame, tube, lambert_or_one, energy_, seabed.scattering);
          continue;
        }
        const LyingPlane lies = model_.path.tx.lying(facet.facet, facet.plane, frame);
        cells.cut(polygon_, lies, seabed.texture, [&](const PlanarPolygon& part) {
          stop_if_wanted();
          integrator.add(part, facet.plane, frame, tube, lambert_or_one, energy_, seabed.scattering,
                         {seabed.texture, lies});
        });
      }
      if (!how_.by_owner) continue;
      integrator.settle(energy_);
      told(number);
    }
    integrator.finish(energy_);
  }

  /// Texture factor at a place relative to the apex.
  double texture_at(const SurfaceProperties& seabed, FacetId facet, glm::dvec3 place_m) const {
    return seabed.texture == nullptr ? 1 : seabed.texture->factor(model_.path.tx.true_place(facet, place_m));
  }

  void whole() {
    for (std::size_t number = visibility_.first(); number < visibility_.end(); ++number) {
      stop_if_wanted();
      const Footprint& footprint = *visibility_.footprint(number);
      const double range = glm::length(footprint.centroid_m);
      if (!(range > 0 && footprint.area_m2 > 0)) continue;
      beam_of(footprint.tube);  // throws for a tube without a beam
      const SurfaceProperties seabed = model_.seabed(footprint.facet);
      const double energy = density(seabed.cross_section(std::sin(footprint.grazing_angle_rad),
                                                         std::cos(footprint.grazing_angle_rad)),
                                    TwoWayRange<double>::of(range), beta_) *
                            texture_at(seabed, footprint.facet, footprint.centroid_m) * footprint.area_m2;
      const double near = footprint.slant_range_min_m, far = footprint.slant_range_max_m;
      const bool at_once = how_.binning == Binning::centroid || !(far > near);
      share(footprint.tube, energy, range, at_once ? range : near, at_once ? range : far,
            [&] { return footprint.centroid_m / range; });
      near_m_ = std::min(near, range);  // the centroid of a footprint with a hole may be nearer
      far_m_ = std::max(far, range);
      told(number);
    }
  }

  /// A hit represents the area solid_angle r^2 / sin(grazing).
  void hits() {
    const std::vector<double> even_mu = mu_of_even_materials();
    const LaneSums sums(visibility_.hits(), energy_);
    alignas(64) HitBlock::Lanes<double> mu;
    std::uint32_t tube = no_tube;
    std::size_t row = 0;
    for (const HitBlock& block : visibility_.hits()) {
      if (even_mu.empty()) {
        for (std::size_t k = 0; k < block.count; ++k) {
          beam_of(block.tube[k]);  // throws for a tube without a beam
          hit(block[k]);
        }
        continue;
      }
      const bool even = find_mu(block, model_.material, even_mu, mu) >= 0;
      const LambertEchoes echoes = echoes_of(block, mu, beta_, finder_);
      if (block.tube[0] != tube) {
        tube = block.tube[0];
        row = beam_of(tube) * std::size_t(samples_.count);  // throws for a tube without a beam
      }
      if (even && echoes.whole) {
        for (std::size_t k = 0; k < HitBlock::size; ++k)
          sums.add(k, row + std::size_t(echoes.sample[k]), echoes.energy[k]);
        continue;
      }
      for (std::size_t k = 0; k < block.count; ++k) {
        if (block.tube[k] != tube) {
          tube = block.tube[k];
          row = beam_of(tube) * std::size_t(samples_.count);
        }
        if (mu[k] < 0)
          hit(block[k]);
        else if (echoes.sample[k] != LambertEchoes::no_sample)
          sums.add(k, row + std::size_t(echoes.sample[k]), echoes.energy[k]);
      }
    }
    sums.finish(energy_);
  }
  /// Adds a hit that lies on a surface other than uniform Lambert.
  void hit(const RayHit& hit) {
    const bool receiver_pairs = model_.patterns != nullptr && !model_.patterns->baselines.empty();
    const double r = hit.slant_range_m, sine = hit.sine_grazing;
    const SurfaceProperties seabed = model_.seabed(hit.facet);
    if (!(r > 0 && sine > 0 && (receiver_pairs || finder_.holds(r)))) return;
    const double cosine = std::sqrt(std::max((1 - sine) * (1 + sine), 0.0));
    const auto direction = [&] { return glm::normalize(glm::dvec3(hit.direction)); };
    const double texture = seabed.texture == nullptr ? 1 : texture_at(seabed, hit.facet, r * direction());
    const double energy = density(seabed.cross_section(sine, cosine), TwoWayRange<double>::of(r), beta_) *
                          texture * (hit.solid_angle_sr * (r * r) / sine);
    share(hit.tube, energy, r, r, r, direction);
  }
  /// Lambert's parameter per material if it alone determines the echo of a hit. The value is negative for
  /// other materials, and the last entry is for missing materials. Empty: there are no such materials.
  std::vector<double> mu_of_even_materials() const {
    if (model_.patterns != nullptr || !model_.path.facet_factor.empty() || !model_.path.tx.facet_map.empty())
      return {};
    std::vector<double> mu(model_.material_mu.begin(), model_.material_mu.end());
    for (std::size_t m = 0; m < mu.size(); ++m)
      if ((!model_.scattering.empty() && model_.scattering[m] != nullptr) ||
          (!model_.reflectivity.empty() && model_.reflectivity[m] != nullptr))
        mu[m] = -1;
    mu.push_back(-1);
    return mu;
  }
  /// Adds energy from one direction to the rows of the beams that receive the tube. The energy is
  /// distributed uniformly over slant ranges from near to far, or belongs to one range. The direction, a
  /// unit vector, is evaluated only with patterns. The receivers of a receiver pair have their own ranges.
  /// Visibility and loss are those of the transmitter.
  template <class Direction>
  void share(std::uint32_t tube, double energy, double range_m, double near_m, double far_m,
             const Direction& direction) {
    const auto samples = std::size_t(samples_.count);
    if (model_.patterns == nullptr) {
      double* row = energy_.data() + beams_.of_tube[tube] * samples;
      finder_.share(near_m, far_m, 0, 0, [&](std::size_t k, double part) { row[k] += part * energy; });
      return;
    }
    const BeamPatterns& patterns = *model_.patterns;
    const glm::dvec3 d = direction();
    const std::uint32_t fan = patterns.fan_of_tube[tube];
    const double sent = patterns.transmit[fan].gain(d), energy_sent = energy * sent;
    const auto [first, end] = patterns.beams_of_tube[tube];
    const std::size_t channel = samples * std::size_t(beams_.count);
    for (std::uint32_t beam = first; beam < end; ++beam) {
      const double received = patterns.receive[beam].gain(d);
      if (!patterns.receives(beam, sent * received)) continue;
      const double received_energy = energy_sent * received;
      double* row = energy_.data() + beam * samples;
      if (patterns.baselines.empty()) {
        finder_.share(near_m, far_m, 0, 0,
                      [&](std::size_t k, double part) { row[k] += part * received_energy; });
        continue;
      }
      const ReceiverBaseline& baseline = patterns.baselines[fan];
      const double cosine = glm::dot(d, baseline.axis);
      // Half path minus the range from the transmitter.
      const double upper = (baseline.range_from(1, range_m, cosine) - range_m) / 2,
                   lower = (baseline.range_from(-1, range_m, cosine) - range_m) / 2;
      const std::complex<double> cross = received_energy * baseline.product(range_m, cosine);
      finder_.share(near_m, far_m, upper, upper,
                    [&](std::size_t k, double part) { row[k] += part * received_energy; });
      finder_.share(near_m, far_m, lower, lower,
                    [&](std::size_t k, double part) { row[channel + k] += part * received_energy; });
      finder_.share(near_m, far_m, std::min(upper, lower), std::max(upper, lower),
                    [&](std::size_t k, double part) {
                      row[2 * channel + k] += part * cross.real();
                      row[3 * channel + k] += part * cross.imag();
                    });
    }
  }

  const CommonVisibility& visibility_;
  const ReceiveBeams& beams_;
  const RangeSamples& samples_;
  const EchoModel& model_;
  const Quadrature& how_;
  const Sink<double>& sink_;
  SampleFinder finder_;
  double beta_, spread_m_ = 0;
  std::vector<double> energy_;
  std::vector<SampleSpan> nonzero_;  ///< per row: samples to which even() has added energy
  PlanarPolygon polygon_;
  double near_m_ = 0, far_m_ = 0;  // of the current footprint, for attribution
};

}  // namespace

Echo integrate_one_apex(const CommonVisibility& visibility, const ReceiveBeams& beams,
                        const RangeSamples& samples, const EchoModel& model, const Quadrature& how,
                        const Sink<double>& sink, std::vector<double> buffer) {
  return OneApex(visibility, beams, samples, model, how, sink, std::move(buffer)).integrate();
}

}  // namespace tubefoot
