// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/echo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "engine/echo/contributions.hpp"
#include "engine/echo/pattern_integral.hpp"
#include "engine/echo/scattering_cut.hpp"
#include "engine/echo/texture_cells.hpp"
#include "engine/law/radial_law.hpp"
#include "geometry/integrals/range_cut.hpp"
#include "geometry/work/steps.hpp"

namespace tubefoot {
namespace {

/// The rows of an echo, and what a facet and a tube look up.
class Rows {
 public:
  Rows(Echo& echo, std::span<const std::uint32_t> beam_of_tube, const EchoLaw& law)
      : echo_(echo), beam_of_tube_(beam_of_tube), law_(law) {}

  std::span<double> of_tube(std::uint32_t tube) {
    if (tube >= beam_of_tube_.size())
      throw std::invalid_argument(
          fmt::format("the history has tube {}, but only {} tubes have a beam", tube, beam_of_tube_.size()));
    const std::uint32_t beam = beam_of_tube_[tube];
    if (beam >= std::uint32_t(echo_.beams))
      throw std::invalid_argument(fmt::format("tube {} belongs to beam {} of {}", tube, beam, echo_.beams));
    return std::span(echo_.energy).subspan(std::size_t(beam) * echo_.samples, echo_.samples);
  }

  /// Lambert's mu, times the facet's factor.
  double mu(FacetId facet) const {
    if (facet >= law_.material.size() || law_.material[facet] >= law_.material_mu.size())
      throw std::invalid_argument(fmt::format("facet {} has no material with a Lambert parameter", facet));
    return law_.material_mu[law_.material[facet]] * factor(facet);
  }
  /// The facet's own factor, of any law.
  double factor(FacetId facet) const {
    if (law_.facet_factor.empty()) return 1;
    if (facet >= law_.facet_factor.size())
      throw std::invalid_argument(fmt::format("facet {} has no factor, others have", facet));
    return law_.facet_factor[facet];
  }
  /// Null: Lambert's, by mu().
  const ScatteringLaw* scattering(FacetId facet) const {
    mu(facet);  // refuses a facet without a material
    return law_.law_of(facet);
  }

  const ReflectivityField* texture(FacetId facet) const {
    mu(facet);  // refuses a facet without material
    if (!law_.facet_map.empty() && facet >= law_.facet_map.size())
      throw std::invalid_argument(fmt::format("facet {} has no true place, others have", facet));
    return law_.texture(facet);
  }

  /// The micro-texture at a place relative to the apex.
  double texture_at(FacetId facet, glm::dvec3 place_m) const {
    const ReflectivityField* field = texture(facet);
    return field == nullptr ? 1 : field->factor(law_.true_place(facet, place_m));
  }

 private:
  Echo& echo_;
  std::span<const std::uint32_t> beam_of_tube_;
  const EchoLaw& law_;
};

void check(const BeamPatterns& patterns, std::size_t tubes, int beams) {
  bool fits = patterns.receive.size() == std::size_t(beams) && patterns.fan_of_tube.size() == tubes &&
              patterns.beams_of_tube.size() == tubes;
  for (const std::uint32_t fan : patterns.fan_of_tube) fits = fits && fan < patterns.transmit.size();
  fits = fits && (patterns.fringes.empty() || patterns.fringes.size() == patterns.transmit.size());
  for (const TransmitPattern& fan : patterns.transmit) fits = fits && !fan.beams.empty();
  for (const auto& [first, end] : patterns.beams_of_tube)
    fits = fits && first <= end && end <= std::uint32_t(beams);
  if (!fits) throw std::invalid_argument("the beam patterns belong to other beams or other tubes");
}

/// All but those of facets with micro-texture; false if there are some.
bool add_even_footprints(const FootprintSet& set, const RangeSamples& samples, const EchoLaw& law,
                         const FootprintTaker& taker, Rows& rows, Echo& echo) {
  const RadialIntegral radial = lambert_radial_integral(samples, law.absorption_db_per_m);
  RangeCutter cutter(radial);
  ScatteringCutter scattering_cutter(samples, law.absorption_db_per_m);
  PlanarPolygon polygon;
  bool all = true;
  for (const Footprint& footprint : set.footprints) {
    stop_if_wanted();
    const std::span<double> row = rows.of_tube(footprint.tube);
    if (rows.texture(footprint.facet) != nullptr) {
      all = false;
      continue;
    }
    const FacetPlane plane{footprint.plane_normal, footprint.plane_distance_m};
    const PlaneFrame frame(plane);
    const double factor = rows.mu(footprint.facet) * plane.distance_m * plane.distance_m;
    const ScatteringLaw* scattering = rows.scattering(footprint.facet);
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece piece = set.pieces[footprint.first_piece + p];
      polygon.assign(std::span(set.corners_m).subspan(piece.first, piece.count), plane, frame);
      if (scattering != nullptr)
        scattering_cutter.add(polygon, *scattering, row, rows.factor(footprint.facet));
      else
        cutter.add(polygon, factor, row);
    }
    if (taker) taker(footprint, echo.energy);
  }
  return all;
}

/// Beams that hear what is in their own tubes, all of it alike.
BeamPatterns ideal_beams(std::span<const std::uint32_t> beam_of_tube, int beams) {
  BeamPatterns patterns;
  patterns.transmit.resize(1);
  patterns.receive.resize(std::size_t(beams));
  patterns.fan_of_tube.assign(beam_of_tube.size(), 0);
  for (const std::uint32_t beam : beam_of_tube) patterns.beams_of_tube.emplace_back(beam, beam + 1);
  return patterns;
}

/// `only_textured`: those of facets with micro-texture.
void add_weighed_footprints(const FootprintSet& set, const RangeSamples& samples, const EchoLaw& law,
                            const BeamPatterns& patterns, bool only_textured, const FootprintTaker& taker,
                            Rows& rows, Echo& echo) {
  const std::vector<double> borders = sample_borders_m(samples);
  PatternIntegrator integrator(borders, two_way_absorption_per_m(law.absorption_db_per_m), patterns,
                               law.pattern_tolerance);
  TextureCells cells;
  PlanarPolygon polygon;
  Steps steps("footprints", set.footprints.size());
  for (const Footprint& footprint : set.footprints) {
    steps.done();
    const ReflectivityField* texture = rows.texture(footprint.facet);
    if (only_textured && texture == nullptr) continue;
    const FacetPlane plane{footprint.plane_normal, footprint.plane_distance_m};
    const PlaneFrame frame(plane);
    const double factor = rows.mu(footprint.facet) * plane.distance_m * plane.distance_m;
    const ScatteringLaw* scattering = rows.scattering(footprint.facet);
    rows.of_tube(footprint.tube);  // refuses a tube that has no beam
    for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
      const Piece piece = set.pieces[footprint.first_piece + p];
      polygon.assign(std::span(set.corners_m).subspan(piece.first, piece.count), plane, frame);
      const double lambert_or_one = scattering != nullptr ? rows.factor(footprint.facet) : factor;
      if (texture == nullptr) {
        integrator.add(polygon, plane, frame, footprint.tube, lambert_or_one, echo.energy, scattering);
        continue;
      }
      const LyingPlane lies = law.lying(footprint.facet, plane, frame);
      cells.cut(polygon, lies, texture->cells(), [&](const PlanarPolygon& part) {
        stop_if_wanted();
        integrator.add(part, plane, frame, footprint.tube, lambert_or_one, echo.energy, scattering,
                       {texture, lies});
      });
    }
    if (!taker) continue;
    integrator.settle(echo.energy);
    taker(footprint, echo.energy);
  }
  integrator.finish(echo.energy);
}

/// Finds the sample that holds a slant range.
class SampleFinder {
 public:
  explicit SampleFinder(const RangeSamples& samples)
      : borders_(sample_borders_m(samples)),
        samples_per_m_(samples.count / (borders_.back() - borders_.front())) {}
  const std::vector<double>& borders() const { return borders_; }
  bool holds(double range_m) const { return range_m >= borders_.front() && range_m < borders_.back(); }
  /// Of a range that the samples hold. The borders decide, not the division: footprints are cut at the same
  /// numbers.
  std::size_t at(double range_m) const {
    auto k = std::min(std::size_t((range_m - borders_.front()) * samples_per_m_), borders_.size() - 2);
    while (range_m < borders_[k]) --k;
    while (range_m >= borders_[k + 1]) ++k;
    return k;
  }

 private:
  std::vector<double> borders_;
  double samples_per_m_;
};

/// Puts energy that comes from one direction, evenly from slant ranges near to far (or all from one), into
/// the rows of the beams that hear the tube. The direction, a unit vector, is asked for only where there are
/// patterns. The receivers of a staff have ranges of their own; visibility and loss are the transmitter's.
class Sharer {
 public:
  Sharer(std::span<const std::uint32_t> beam_of_tube, const RangeSamples& samples, const EchoLaw& law,
         Echo& echo)
      : beam_of_tube_(beam_of_tube), finder_(samples), law_(law), echo_(echo) {}

  const SampleFinder& finder() const { return finder_; }

  template <class Direction>
  void add(std::uint32_t tube, double energy, double range_m, double near_m, double far_m,
           const Direction& direction) {
    const auto samples = std::size_t(echo_.samples);
    if (law_.patterns == nullptr) {
      double* row = echo_.energy.data() + beam_of_tube_[tube] * samples;
      in_samples(near_m, far_m, 0, 0, [&](std::size_t k, double part) { row[k] += part * energy; });
      return;
    }
    const BeamPatterns& patterns = *law_.patterns;
    const glm::dvec3 d = direction();
    const std::uint32_t fan = patterns.fan_of_tube[tube];
    const double sent = energy * patterns.transmit[fan].gain(d);
    const auto [first, end] = patterns.beams_of_tube[tube];
    const std::size_t channel = samples * std::size_t(echo_.beams);
    for (std::uint32_t beam = first; beam < end; ++beam) {
      const double heard = sent * patterns.receive[beam].gain(d);
      double* row = echo_.energy.data() + beam * samples;
      if (patterns.fringes.empty()) {
        in_samples(near_m, far_m, 0, 0, [&](std::size_t k, double part) { row[k] += part * heard; });
        continue;
      }
      const Fringe& fringe = patterns.fringes[fan];
      const double cosine = glm::dot(d, fringe.axis);
      // Half a path is longer than the range from the transmitter by half of the difference.
      const double upper = (fringe.range_from(1, range_m, cosine) - range_m) / 2,
                   lower = (fringe.range_from(-1, range_m, cosine) - range_m) / 2;
      const std::complex<double> cross = heard * fringe.product(range_m, cosine);
      in_samples(near_m, far_m, upper, upper, [&](std::size_t k, double part) { row[k] += part * heard; });
      in_samples(near_m, far_m, lower, lower,
                 [&](std::size_t k, double part) { row[channel + k] += part * heard; });
      in_samples(near_m, far_m, std::min(upper, lower), std::max(upper, lower),
                 [&](std::size_t k, double part) {
                   row[2 * channel + k] += part * cross.real();
                   row[3 * channel + k] += part * cross.imag();
                 });
    }
  }

 private:
  /// Calls take(sample, part) with the parts of [near, far] that, moved by either of two shifts, lie in the
  /// same sample.
  template <class Take>
  void in_samples(double near_m, double far_m, double least, double most, const Take& take) const {
    const std::vector<double>& borders = finder_.borders();
    if (!(far_m > near_m)) {
      if (!finder_.holds(near_m + least) || !finder_.holds(near_m + most)) return;
      const std::size_t k = finder_.at(near_m + least);
      if (k == finder_.at(near_m + most)) take(k, 1);
      return;
    }
    if (!(far_m + most > borders.front() && near_m + least < borders.back())) return;
    for (std::size_t k = near_m + least <= borders.front() ? 0 : finder_.at(near_m + least);
         k + 1 < borders.size() && borders[k] - least < far_m; ++k) {
      const double part = std::min(far_m, borders[k + 1] - most) - std::max(near_m, borders[k] - least);
      if (part > 0) take(k, part / (far_m - near_m));
    }
  }

  std::span<const std::uint32_t> beam_of_tube_;
  SampleFinder finder_;
  const EchoLaw& law_;
  Echo& echo_;
};

void add_whole_footprints(const FootprintSet& set, const RangeSamples& samples, const EchoLaw& law,
                          Binning binning, std::span<const std::uint32_t> beam_of_tube,
                          const FootprintTaker& taker, Rows& rows, Echo& echo) {
  const double beta = two_way_absorption_per_m(law.absorption_db_per_m);
  Sharer sharer(beam_of_tube, samples, law, echo);
  for (const Footprint& footprint : set.footprints) {
    stop_if_wanted();
    const double range = glm::length(footprint.centroid_m);
    const double near = footprint.slant_range_min_m, far = footprint.slant_range_max_m;
    if (!(range > 0 && footprint.area_m2 > 0)) continue;
    rows.of_tube(footprint.tube);  // refuses a tube that has no beam
    const double sine = std::sin(footprint.grazing_angle_rad), r2 = range * range;
    const ScatteringLaw* scattering = rows.scattering(footprint.facet);
    const double cross_section =
        scattering != nullptr ? rows.factor(footprint.facet) *
                                    scattering->cross_section(sine, std::cos(footprint.grazing_angle_rad))
                              : rows.mu(footprint.facet) * sine * sine;
    const double energy = cross_section * rows.texture_at(footprint.facet, footprint.centroid_m) *
                          footprint.area_m2 / (r2 * r2) * std::exp(-beta * range);
    const bool at_once = binning == Binning::centroid || !(far > near);
    sharer.add(footprint.tube, energy, range, at_once ? range : near, at_once ? range : far,
               [&] { return footprint.centroid_m / range; });
    if (taker) taker(footprint, echo.energy);
  }
}

/// A hit stands for the area solid_angle r^2 / sin(grazing), so it returns sigma / sin(grazing) solid_angle /
/// r^2; Lambert's sigma is mu sin^2(grazing).
void add_hits(const std::vector<RayHit>& hits, const RangeSamples& samples, const EchoLaw& law,
              std::span<const std::uint32_t> beam_of_tube, Rows& rows, Echo& echo) {
  const double beta = two_way_absorption_per_m(law.absorption_db_per_m);
  Sharer sharer(beam_of_tube, samples, law, echo);
  const bool staffs = law.patterns != nullptr && !law.patterns->fringes.empty();
  for (const RayHit& hit : hits) {
    const double r = hit.slant_range_m;
    rows.of_tube(hit.tube);  // refuses a tube that has no beam
    rows.mu(hit.facet);      // refuses a facet without material
    if (!(r > 0 && (staffs || sharer.finder().holds(r)))) continue;
    double per_sine = rows.mu(hit.facet) * hit.sine_grazing;
    if (const ScatteringLaw* scattering = rows.scattering(hit.facet)) {
      const double sine = hit.sine_grazing, cosine = std::sqrt(std::max((1 - sine) * (1 + sine), 0.0));
      if (!(sine > 0)) continue;
      per_sine = rows.factor(hit.facet) * scattering->cross_section(sine, cosine) / sine;
    }
    per_sine *= rows.texture_at(hit.facet, r * glm::normalize(glm::dvec3(hit.direction)));
    const double spread = per_sine * hit.solid_angle_sr / (r * r);
    sharer.add(hit.tube, beta > 0 ? spread * std::exp(-beta * r) : spread, r, r, r,
               [&] { return glm::normalize(glm::dvec3(hit.direction)); });
  }
}

}  // namespace

Binning binning_from_name(std::string_view name) {
  if (name == "exact") return Binning::exact;
  if (name == "spread") return Binning::spread;
  if (name == "centroid") return Binning::centroid;
  throw std::invalid_argument(fmt::format("no binning named '{}': exact, spread or centroid", name));
}

Echo integrate_echo(const History& history, std::span<const std::uint32_t> beam_of_tube, int beams,
                    const RangeSamples& samples, const EchoLaw& law, Binning binning) {
  return integrate_echo(history, beam_of_tube, beams, samples, law, binning, FootprintTaker());
}

Echo integrate_echo(const History& history, std::span<const std::uint32_t> beam_of_tube, int beams,
                    const RangeSamples& samples, const EchoLaw& law, Binning binning,
                    const FootprintTaker& taker) {
  if (beams < 0) throw std::invalid_argument(fmt::format("a receiver cannot have {} beams", beams));
  if (!(law.absorption_db_per_m >= 0 && std::isfinite(law.absorption_db_per_m)))
    throw std::invalid_argument(
        fmt::format("absorption must be finite and not negative, not {} dB/m", law.absorption_db_per_m));
  if (law.patterns != nullptr) {
    check(*law.patterns, beam_of_tube.size(), beams);
    for (const Fringe& fringe : law.patterns->fringes)
      if (!(fringe.baseline_m >= 0 && fringe.baseline_m <= samples.first_m))
        throw std::invalid_argument(
            fmt::format("a baseline of {} m needs samples from there on, not from {} m", fringe.baseline_m,
                        samples.first_m));
    if (!law.patterns->fringes.empty() && binning == Binning::exact && !history.footprints.footprints.empty())
      throw std::invalid_argument(
          "footprints of one apex cannot be cut for the two receivers of a staff (staff_echo.hpp)");
  }
  if (!law.scattering.empty() && law.scattering.size() != law.material_mu.size())
    throw std::invalid_argument(fmt::format("{} scattering laws do not fit {} materials",
                                            law.scattering.size(), law.material_mu.size()));
  if (!(law.pattern_tolerance >= 1e-12 && law.pattern_tolerance <= 0.01))
    throw std::invalid_argument(fmt::format(
        "the tolerance of beam patterns must be from 1e-12 to 0.01, not {}", law.pattern_tolerance));

  if (!law.reflectivity.empty() && law.reflectivity.size() != law.material_mu.size())
    throw std::invalid_argument(fmt::format("{} materials have a Lambert parameter, but {} a texture or none",
                                            law.material_mu.size(), law.reflectivity.size()));

  Echo echo;
  echo.beams = beams;
  echo.samples = samples.count;
  const int channels = law.patterns != nullptr ? law.patterns->channels() : 1;
  echo.energy.assign(std::size_t(channels) * beams * samples.count, 0);
  Rows rows(echo, beam_of_tube, law);
  if (binning != Binning::exact)
    add_whole_footprints(history.footprints, samples, law, binning, beam_of_tube, taker, rows, echo);
  else if (law.patterns != nullptr)
    add_weighed_footprints(history.footprints, samples, law, *law.patterns, false, taker, rows, echo);
  else if (!add_even_footprints(history.footprints, samples, law, taker, rows, echo))
    add_weighed_footprints(history.footprints, samples, law, ideal_beams(beam_of_tube, beams), true, taker,
                           rows, echo);
  add_hits(history.hits, samples, law, beam_of_tube, rows, echo);
  return echo;
}

}  // namespace tubefoot
