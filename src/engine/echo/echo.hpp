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
#include "geometry/integrals/range_cut.hpp"

// Integrates the echo of visible polygons per beam and range sample. Sample k contains the half paths from
// first + k step on, half of transmit leg plus receive leg. density.hpp has the integrand. See
// docs/notes/multiple-paths.md for mirrors.

namespace tubefoot {

/// Method that distributes the energy of a footprint over range samples.
enum class Binning {
  exact,     ///< cut at the borders of samples and integrated over each part
  spread,    ///< model at the centroid, uniform over the footprint's interval of slant range (or half path)
  centroid,  ///< model at the centroid, all in the sample that contains the centroid's slant range
};

/// Binning with a name of scene files. Throws std::invalid_argument.
Binning binning_from_name(std::string_view name);
std::string_view name_of(Binning binning);

/// Assignment of tubes to beams.
struct ReceiveBeams {
  int count = 0;
  std::span<const std::uint32_t> of_tube;  ///< beam of each tube of the receive leg
  /// Fans of the tubes of both apexes. A receiver receives only transmissions of its own fan. If both are
  /// empty, there is one fan.
  std::span<const std::uint32_t> fan_of_transmit_tube{}, fan_of_receive_tube{};

  bool in_one_fan(std::uint32_t transmit_tube, std::uint32_t receive_tube) const {
    return fan_of_transmit_tube.empty() ||
           fan_of_transmit_tube[transmit_tube] == fan_of_receive_tube[receive_tube];
  }
};

/// Default relative error for bistatic paths.
constexpr double bistatic_tolerance = 1e-10;

/// Settings of the integration.
struct Quadrature {
  Quadrature(Binning by = Binning::exact, double tolerance = bistatic_tolerance)  // NOLINT: a binning is one
      : binning(by), path_tolerance(tolerance) {}

  Binning binning;        ///< binning of footprints
  double path_tolerance;  ///< relative error for bistatic paths
  bool by_owner = false;  ///< parts are reported with their facet and tube (Part::seen, tx_tube)
};

/// Received energy density in J/m² for 1 J/sr at 1 m, per beam and range sample of one ping, beam-major:
/// energy[beam * samples + sample]. With baselines (BeamPatterns) this block is that of the upper receiver,
/// and three more blocks follow.
struct Echo {
  int beams = 0;
  int samples = 0;
  std::vector<double> energy;
  /// Per row of energies: all samples outside of the span are 0. For a multibeam these are a few samples per
  /// beam. Empty: any sample may be non-zero.
  std::vector<SampleSpan> nonzero{};
  double at(int beam, int sample) const { return energy[std::size_t(beam) * samples + sample]; }
};

/// Integrates the echo of a path over all that it sees, per range sample and beam, and passes the results to
/// `sink`. The rows of channels follow each other: beam = channel * beams.count + beam. Sample k contains
/// the half paths (transmit leg + receive leg) / 2 from first + k step on. The integrand is that of
/// density.hpp times four factors. They are the texture at the place, the transmit and the receive pattern,
/// and the losses of mirrors on both legs (model.path). A pattern is evaluated in the direction from the
/// apex of its leg.
///
/// Monostatic: footprints are cut at the samples' borders, which are arcs on the facet. Ranges are
/// integrated in closed form, patterns and texture by polar moments (pattern_integral.hpp). With another
/// `how.binning`, the values of measure() are used, with the model and the texture at the centroid. The hit
/// of a ray belongs to the sample that contains its range. With patterns, `model.patterns->beams_of_tube`
/// gives the tubes that a beam receives.
///
/// Bistatic: the integral is over cells between ellipses (path_cut.hpp). Lambert's law is mu sin(incident)
/// sin(scattered), and other models are sqrt(sigma(incident) sigma(scattered)). `model.patterns` and its
/// fans refer to the tubes of the receive leg. The error of an energy is at most about how.path_tolerance
/// times the energy for patterns of 1. Tabulated patterns, whose second derivative jumps, have errors of
/// about 1e-6. Tabulated models, whose first derivative jumps, have errors of about 1e-5. Other binnings
/// evaluate the common part of two tubes on a facet at its centroid. A hit belongs to the sample that
/// contains half of its path. For bistatic facets, ranges are travel times multiplied by the reference
/// speed. Patterns are evaluated in the directions in which rays leave and arrive, and bistatic_factor()
/// multiplies each facet.
///
/// Throws std::invalid_argument for arguments that do not fit.
void integrate(const CommonVisibility& visibility, const ReceiveBeams& beams, const RangeSamples& samples,
               const EchoModel& model, const Quadrature& how, const Sink<double>& sink);

/// Sum of all contributions of integrate(). `buffer`: any number of zeros, whose memory is reused for the
/// energies. New memory costs more than the computation of most echoes.
Echo integrate_echo(const CommonVisibility& visibility, const ReceiveBeams& beams,
                    const RangeSamples& samples, const EchoModel& model, Quadrature how = {},
                    std::vector<double> buffer = {});
/// Returns the memory of an echo's energies, set to 0 again.
std::vector<double> cleared_buffer(Echo echo);

/// Contribution of one visible facet to one range sample of one beam.
struct Contribution {
  std::uint32_t footprint = 0;  ///< index in the visibility
  std::uint32_t beam = 0, sample = 0;
  double energy_j = 0;
};

/// Contributions of footprints to samples: the terms of the sum in integrate_echo() with the same arguments,
/// ordered by footprint, beam and sample. For each beam and sample their sum is the energy of the echo
/// except for rounding (with beam patterns: rounding relative to the patterns' peak).
///
/// With patterns, every beam of a fan receives every footprint of the fan. `least_share` omits contributions
/// below this fraction of the energy of their beam and sample in `echo`, which is the result of
/// integrate_echo(). The largest contribution of a footprint is always kept. 0 keeps all contributions that
/// are not zero. Throws the exceptions of integrate_echo().
std::vector<Contribution> contributions(const CommonVisibility& visibility, const ReceiveBeams& beams,
                                        const RangeSamples& samples, const EchoModel& model,
                                        const Quadrature& how, const Echo& echo, double least_share = 0);

/// Contributions of footprints to an echo, over all range samples, in the order of the footprints. In J/m²
/// for 1 J/sr at 1 m, as Echo.
struct FootprintEnergies {
  std::vector<double> all_beams;  ///< over all beams that receive the footprint; their sum is the sum of the
                                  ///< echo
  /// In the beam of the footprint's tube, the only beam that receives it without patterns.
  std::vector<double> own_beam;
};

/// Energies of integrate() per footprint instead of per bin. `footprints`: footprints of the visibility with
/// the same indices (bistatic: path_footprints.hpp). `beam_of_footprint_tube`: own beam of a footprint, by
/// its tube. With baselines: energies at the transmitter's position.
FootprintEnergies footprint_energies(const FootprintSet& footprints, const CommonVisibility& visibility,
                                     std::span<const std::uint32_t> beam_of_footprint_tube,
                                     const ReceiveBeams& beams, const RangeSamples& samples,
                                     const EchoModel& model, const Quadrature& how = {});

}  // namespace tubefoot
