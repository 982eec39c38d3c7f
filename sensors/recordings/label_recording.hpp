// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sensors/recordings/recorded_channel.hpp"

namespace tubefoot {

struct Recording;

/// Labels of one ping: [beam][sample] each; shares are [object or material][beam][sample].
struct LabelPing {
  /// Shares of a sample's energy. Together with `unscattered_share` they add up to 1. They are 0 if nothing
  /// is received.
  std::vector<double> object_share, material_share;
  std::vector<double> unscattered_share;  ///< empty if all paths are scattered
  /// Means over the scattered energy, weighted by energy, in the local frame [m]. They are the height (z)
  /// and the range from the sonar (half of the two-way path if both ends are separate). NaN without
  /// scattered energy.
  std::vector<double> mean_height, mean_range;
  /// The label with the largest share of the energy received near the peak of the patterns
  /// (LabelRecording::label_level_db). The first of equal ones applies. `no_label` if there is no such
  /// energy.
  std::vector<std::int16_t> object_label, material_label;
};

/// Attribution of the energies of a recording to objects and materials, and their origin. `run --labels`
/// records it.
struct LabelRecording {
  static constexpr std::int16_t no_label = -1;
  struct Owner {
    std::uint16_t object = 0, material = 0;
  };

  std::vector<std::string> objects, materials;
  /// The pairs of object and material by which energies are separated.
  std::vector<Owner> owners{};
  bool has_unscattered = false;
  /// Labels depend on the energy received within this many dB of a beam pattern's two-way peak; unset: on
  /// all energy.
  std::optional<double> label_level_db{};
  std::size_t cells = 0;  ///< per ping: beams times samples
  /// [ping][channel][beam][sample]. The channels are the energy of each owner [J/m^2], energy times height
  /// and energy times range [J m], then the energy without scattering. With `label_level_db` the part of each
  /// owner's energy that is received near the peak follows.
  RecordedChannel recorded{};

  std::size_t first_near_peak() const { return owners.size() + 2 + (has_unscattered ? 1 : 0); }
  std::size_t channels() const { return first_near_peak() + (label_level_db ? owners.size() : 0); }
  /// Throws Interrupted if a stop is requested.
  LabelPing of(std::size_t ping) const;
};

/// Adds the labels to an echoes.nc that write_echoes() wrote of these recordings. Does nothing without
/// labels. Throws std::runtime_error that names the file and the failed operation; the file is then invalid.
void add_labels(const std::filesystem::path& echoes, std::span<const Recording> recordings,
                std::span<const LabelRecording> label_recordings);

/// Writes PNG pictures of labels and heights, with `bits` per component, and returns their names. They are
/// <sensor>-labels-<ping>.png of at most five uniformly spaced pings. Sonars of one or two beams have one
/// <sensor>-labels.png of all pings. Throws as add_labels() does.
std::vector<std::filesystem::path> write_label_pictures(const std::filesystem::path& folder,
                                                        const Recording& recording,
                                                        const LabelRecording& label_recording, int bits = 8);

}  // namespace tubefoot
