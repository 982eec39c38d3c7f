// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/echo/sink.hpp"
#include "engine/scattering/echo_model.hpp"
#include "engine/scattering/range_samples.hpp"
#include "engine/visibility/common_visibility.hpp"

namespace tubefoot {

/// How a footprint's energy gets into range samples.
enum class Binning {
  exact,     ///< cut at the samples' borders, integrated over each part
  spread,    ///< the law at the centroid, evenly over the footprint's interval of slant range (or half path)
  centroid,  ///< the law at the centroid, all in the sample that holds the centroid's slant range
};

/// Name as in scene files; throws std::invalid_argument.
Binning binning_from_name(std::string_view name);
std::string_view name_of(Binning binning);

/// Which beams receive what.
struct ReceiveBeams {
  int count = 0;
  std::span<const std::uint32_t> of_tube;  ///< the beam that a tube of the receive leg belongs to
  /// Fans of the tubes of two apexes: a receiver receives the transmissions of its own fan only. Both empty:
  /// one fan.
  std::span<const std::uint32_t> fan_of_transmit_tube{}, fan_of_receive_tube{};

  bool in_one_fan(std::uint32_t transmit_tube, std::uint32_t receive_tube) const {
    return fan_of_transmit_tube.empty() ||
           fan_of_transmit_tube[transmit_tube] == fan_of_receive_tube[receive_tube];
  }
};

/// Relative error that paths between two apexes keep if they are not told otherwise.
constexpr double bistatic_tolerance = 1e-10;

/// How energies are integrated.
struct Quadrature {
  Quadrature(Binning by = Binning::exact, double tolerance = bistatic_tolerance)  // NOLINT: a binning is one
      : binning(by), path_tolerance(tolerance) {}

  Binning binning;        ///< of footprints
  double path_tolerance;  ///< relative error between two apexes
  bool by_owner = false;  ///< parts are reported with whose they are (Part::seen, tx_tube)
};

/// Energy [J] per beam and range sample of one ping, beam-major: energy[beam * samples + sample]. With
/// baselines (BeamPatterns) that is what the upper receiver receives, and three more such blocks follow.
struct Echo {
  int beams = 0;
  int samples = 0;
  std::vector<double> energy;
  double at(int beam, int sample) const { return energy[std::size_t(beam) * samples + sample]; }
};

/// Integrates what a path returns of all that it sees into range samples of beams, and hands it to `sink`
/// (rows of channels follow each other: beam = channel * beams.count + beam). Sample k covers half paths,
/// (out + home) / 2, from first + k step on. density.hpp has what an area element returns; that is weighed by
/// texture at its place, by the transmit pattern in the direction from the apex of the transmit leg, by the
/// receive pattern in that from the apex of the receive leg, and by what mirrors on either way take
/// (law.path).
///
/// One apex: footprints are cut at the samples' borders, arcs on the facet, and integrated, range in closed
/// form, with patterns or texture by polar moments (pattern_integral.hpp); or they are binned as
/// `how.binning` says, which reads what measure() filled, the law and the texture taken at the centroid. A
/// ray's hit falls into the sample that holds its range. With patterns a beam receives the tubes that
/// `law.patterns->beams_of_tube` says.
///
/// Two apexes: cells between ellipses (path_cut.hpp), Lambert's law being mu sin(out) sin(home) and another
/// sqrt(sigma(out) sigma(home)). `law.patterns` is about the tubes of the receive leg (its fans are used as
/// theirs). The error of each energy is at most about how.path_tolerance times what it would be with
/// patterns of 1; tabulated patterns, whose second derivative jumps, keep it only to about 1e-6, tabulated
/// laws, whose first does, to about 1e-5. Other binnings take what a tube of the one and a tube of the other
/// share of a facet at its centroid; a hit falls into the sample that holds half of its path. With paired
/// facets, ranges are travel times by the reference speed, patterns are taken in the directions in which rays
/// leave and arrive, and each facet has bistatic_factor().
///
/// Throws std::invalid_argument for what does not fit.
void integrate(const CommonVisibility& visibility, const ReceiveBeams& beams, const RangeSamples& samples,
               const EchoModel& model, const Quadrature& how, const Sink<double>& sink);

/// All of it, added up.
Echo integrate_echo(const CommonVisibility& visibility, const ReceiveBeams& beams,
                    const RangeSamples& samples, const EchoModel& model, Quadrature how = {});

/// What one seen facet adds to one range sample of one beam.
struct Contribution {
  std::uint32_t footprint = 0;  ///< number in the Sight
  std::uint32_t beam = 0, sample = 0;
  double energy_j = 0;
};

/// Which footprints made which samples: the terms that integrate_echo() adds up, with the same arguments,
/// ordered by footprint, beam and sample. For each beam and sample they sum to the echo's energy but for
/// rounding (with beam patterns: rounding of their peak).
///
/// With patterns every footprint is received by every beam of its fan. `least_share` leaves out what is less
/// than this times the energy of its beam and sample in `echo` (which integrate_echo() made), but never a
/// footprint's largest contribution; 0 keeps everything that is not zero. Throws as integrate_echo().
std::vector<Contribution> contributions(const CommonVisibility& visibility, const ReceiveBeams& beams,
                                        const RangeSamples& samples, const EchoModel& model,
                                        const Quadrature& how, const Echo& echo, double least_share = 0);

/// What each footprint adds to an echo, over all range samples, in the order of the footprints. Joule per
/// J/sr sent at 1 m, as Echo.
struct FootprintEnergies {
  std::vector<double> all_beams;  ///< in all beams that receive it: these sum to the sum of the echo
  /// In the beam that its tube belongs to. Without patterns no other beam receives it.
  std::vector<double> own_beam;
};

/// The energies that integrate() puts into its bins, by footprint instead. `footprints`: the Sight's, number
/// by number (of two apexes: path_footprints.hpp). A footprint's own beam is `beam_of_footprint_tube`'s of
/// its tube. With baselines: what the transmitter's own place would receive.
FootprintEnergies footprint_energies(const FootprintSet& footprints, const CommonVisibility& visibility,
                                     std::span<const std::uint32_t> beam_of_footprint_tube,
                                     const ReceiveBeams& beams, const RangeSamples& samples,
                                     const EchoModel& model, const Quadrature& how = {});

}  // namespace tubefoot
