// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "sensors/receiver/quantisation.hpp"
#include "sensors/receiver/speckle.hpp"

namespace tubefoot {

/// Source levels [dB re 1 uPa at 1 m]. Those of the DIDSON are from a secondary source. That of the SeaBat
/// 8101, at full power, is from its manual.
inline constexpr double didson_identification_source_level_db = 206, didson_detection_source_level_db = 202,
                        seabat_8101_source_level_db = 210;

/// Thermal noise of the sea in a receiver's band [dB re 1 uPa], above about 100 kHz. It is Mellen's -15 + 20
/// log f [dB re 1 uPa^2/Hz], f in kHz, plus 10 log bandwidth, less the directivity index.
double thermal_noise_level_db(double frequency_khz, double bandwidth_hz, double directivity_index_db);

/// Time-varied gain Sp log10 R + 2 alpha R + G [dB], R in metres, as in a SeaBat 8101.
struct TimeVariedGain {
  double spreading = 30;                  ///< Sp: 40 equalises a point target, 30 a seabed within a beam
  double absorption_db_per_km = 0;        ///< alpha, one way
  double gain_db = 0;                     ///< G
  double fixed_below_m = 10;              ///< the gain is constant below this range; above 0
  double least_db = -300, most_db = 300;  ///< limits of the amplifier, within these defaults

  double at(double range_m) const;
};

/// Effects of a receiver on the energies of a simulation. All effects are off by default.
struct ReceiverDescription {
  double source_level_db = didson_identification_source_level_db;  ///< dB re 1 uPa at 1 m
  std::optional<double> noise_level_db;  ///< mean noise in the band, dB re 1 uPa; none: no noise
  Speckle speckle;
  std::optional<TimeVariedGain> tvg;
  std::optional<Quantiser> quantiser{};  ///< of levels after the gain [dB re 1 uPa]
  std::uint64_t seed = 1;
  double display_gain = 1, display_offset_db = 0;  ///< displayed level = gain * level + offset
};

/// Energies are relative: in J for a source of 1 J/sr at 1 m. An energy of 1 J therefore has the source
/// level. A sample's level is that of a pulse as long as the sample, c tau / 2 = step. For another pulse add
/// 10 log10(c tau / (2 step)) to the source level.
class ReceiverChain {
 public:
  /// Throws std::invalid_argument for an invalid value.
  explicit ReceiverChain(const ReceiverDescription& description);

  /// The energies [J/m^2] of one ping, [beam][sample], as received: with speckle and noise, then the
  /// time-varied gain at the middle of the sample, then quantised. Effects that are off do not change a bit.
  /// Random numbers depend on seed, ping, beam and sample only. Throws std::invalid_argument for a negative
  /// or non-finite energy, and for incomplete beams of `samples.count` samples.
  std::vector<double> receive(std::uint32_t ping, std::span<const double> energies_j,
                              const RangeSamples& samples) const {
    return receive(ping, energies_j, gains(samples));
  }
  /// The same with precomputed gains(), which are those of all pings.
  std::vector<double> receive(std::uint32_t ping, std::span<const double> energies_j,
                              std::span<const double> gains) const;
  /// The same for the samples of one beam, from the first on. `gains` may have more elements.
  void receive_beam(std::uint32_t ping, std::uint32_t beam, std::span<const double> energies_j,
                    std::span<const double> gains, std::span<double> received_j) const;
  /// The same for the lower receiver of a pair: mean energies of both, and absolute mean products of their
  /// signals.
  void receive_lower_beam(std::uint32_t ping, std::uint32_t beam, std::span<const double> upper_j,
                          std::span<const double> lower_j, std::span<const double> product_j,
                          std::span<const double> gains, std::span<double> received_j) const;
  /// Time-varied gain by sample, as a factor of energies; 1 without gain.
  std::vector<double> gains(const RangeSamples& samples) const;

  /// Displayed echo level SL + 10 log10(E) [dB re 1 uPa], with display gain and offset applied. Without
  /// energy it is minus infinity.
  double level_db(double energy_j) const;
  /// Root-mean-square pressure [uPa] of an energy, without display gain and offset.
  double amplitude_upa(double energy_j) const { return std::sqrt(energy_j) * source_upa_; }
  /// Mean energy of the noise [J/m^2]; 0 without noise.
  double noise_j() const { return noise_j_; }
  const std::optional<Quantiser>& quantiser() const { return description_.quantiser; }

 private:
  /// The energy after the gain and, with a quantiser, of the code of its level; 0 for code 0.
  double recorded_j(double energy_j, double gain) const;

  ReceiverDescription description_;
  double noise_j_ = 0, source_upa_ = 0;
};

}  // namespace tubefoot
