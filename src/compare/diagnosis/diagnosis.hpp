// SPDX-License-Identifier: GPL-3.0-or-later
// Systematic errors of a candidate, with their sizes and standard errors.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/diagnosis/alignment.hpp"
#include "compare/measures/noise_floor.hpp"
#include "compare/measures/scene_labels.hpp"

namespace tubefoot {

/// Input of the diagnosis. The spans must outlive the call.
struct DiagnosisInput {
  EchoPair pair;
  std::span<const double> beam_azimuth_deg;
  /// Numbers of the candidate before any fit, for the detection of quantisation (8 bits)
  std::span<const double> as_given;
  /// Energies of a perfect engine with the sampling of the candidate; or empty.
  std::span<const double> ideal_j;
  const SceneLabels* labels = nullptr;  ///< or null, if the scene is not known
  /// Gain and range dependence that were removed from the candidate; or null.
  const EnergyFit* fit = nullptr;
  double l1_before_fit = 0;  ///< relative L1 error before they were removed
};

/// One systematic error.
struct Finding {
  std::string fault;  ///< short name that does not change between versions: "mirror", "sample-shift"
  double size = 0, error = 0;
  std::string unit;
  std::string words;  ///< a sentence
  /// Part of the relative L1 error that the correction of this error alone removes, if it is known. For the
  /// gain and for --fit, the whole is the error as given. For the range dependence, it is that of the aligned
  /// candidate. For the others, it is the error after the correction of both.
  std::optional<double> share = std::nullopt;
};

/// A systematic error that was not found, and the smallest size that would have been found.
struct ResolvableSize {
  std::string fault;
  double size = 0;  ///< infinite: the echoes do not determine the error
  std::string unit;
  std::string remark;  ///< for example the size that a usual engine would have; or empty
};

/// Additional displacement of a part of the fan relative to the whole, in beams and samples.
struct LocalShift {
  std::size_t first_beam = 0, last_beam = 0;
  Estimate beams, samples;
};

/// Offsets of the borders of shadows in the candidate from those in the aligned reference. Positive values
/// mean that the shadow of the candidate is larger.
struct EdgeOffsets {
  std::size_t edges = 0;
  Estimate mean;      ///< beams at the sides of shadows, samples at their ends
  double spread = 0;  ///< standard deviation of single borders
};

struct Diagnosis {
  /// Gain and range dependence first, then the others by their shares in the error.
  std::vector<Finding> findings;
  std::vector<ResolvableSize> not_found;
  Alignment alignment;
  NoiseFloor floor;
  std::vector<LocalShift> along_fan;
  EdgeOffsets sides, ends;
  /// Relative L1 errors: as given; after gain and range dependence; after displacement and blur; without
  /// wrongly insonified bins and the noise floor. The last one is sampling error or an unknown systematic
  /// error.
  double l1 = 0, l1_after_gain = 0, l1_after_warp = 0, l1_left = 0;
  std::optional<double> ideal_l1;  ///< of the perfect engine with the same sampling
  double scatter = 0;              ///< relative deviation of single bins in uniform areas
  bool has(const std::string& fault) const;
};

/// Pings that are diagnosed: all, or pings at equal intervals if there are more than `most_bins` bins.
std::vector<std::size_t> diagnosed_pings(const EchoShape& shape, std::size_t most_bins = 400'000);

/// Diagnoses a candidate at diagnosed_pings().
Diagnosis diagnose(const DiagnosisInput& input, std::size_t most_bins = 400'000);

}  // namespace tubefoot
