// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sensors/recordings/ping_energies.hpp"

namespace tubefoot {

struct Recording;

/// Of one ping, beside its energies: [beam][sample] each, [object or material][beam][sample] the shares.
struct LabelPing {
  /// Parts of a sample's energy: with `unscattered_share` they add up to 1. 0 where nothing is received.
  std::vector<double> object_share, material_share;
  std::vector<double> unscattered_share;  ///< empty where all paths are scattered
  /// Means over what is scattered, weighed by energy, in the local frame [m]: of the height (z), and of the
  /// way from the sonar (half of the way there and back, where its ends are apart). Not a number without it.
  std::vector<double> mean_height, mean_range;
  /// The one with the largest share of what beams receive near the peak of their patterns
  /// (LabelRecording::label_level_db), of equals the first; `no_label` where that is nothing.
  std::vector<std::int16_t> object_label, material_label;
};

/// Whose the energies of a recording are, and where they come from: what `run --labels` keeps.
struct LabelRecording {
  static constexpr std::int16_t no_label = -1;
  struct Owner {
    std::uint16_t object = 0, material = 0;
  };

  std::vector<std::string> objects, materials;
  /// What energies are resolved by.
  std::vector<Owner> owners{};
  bool has_unscattered = false;
  /// Labels go by what is received within so many dB of a beam pattern's two-way peak; none: by all.
  std::optional<double> label_level_db{};
  std::size_t cells = 0;  ///< of a ping: beams times samples
  /// [ping][channel][beam][sample]: the energy of each owner [J], then energy times height and energy times
  /// range [J m], then the energy that comes without scattering, then, with `label_level_db`, what of the
  /// energy of each owner is received near the peak.
  std::span<const double> values{};
  std::shared_ptr<const PackedPings> packed{};  ///< in place of `values`, as one channel
  std::shared_ptr<const void> keeper{};         ///< keeps `values` in memory; null where somebody else does

  std::size_t first_near_peak() const { return owners.size() + 2 + (has_unscattered ? 1 : 0); }
  std::size_t channels() const { return first_near_peak() + (label_level_db ? owners.size() : 0); }
  /// Throws Interrupted if somebody wants to stop.
  LabelPing of(std::size_t ping) const;
};

/// Adds to an echoes.nc that write_echoes() wrote of these recordings whose the energies are; nothing without
/// truths. Throws std::runtime_error naming the file and what failed; it is then to be thrown away.
void add_labels(const std::filesystem::path& echoes, std::span<const Recording> recordings,
                std::span<const LabelRecording> label_recordings);

/// PNG of `bits` a component of whose the energies are, and how high: <sensor>-truth-<ping>.png of five pings
/// at most, evenly spread, or of one or two beams <sensor>-truth.png of all pings. Returns their names.
/// Throws as add_labels().
std::vector<std::filesystem::path> write_label_pictures(const std::filesystem::path& folder,
                                                        const Recording& recording,
                                                        const LabelRecording& label_recording, int bits = 8);

}  // namespace tubefoot
