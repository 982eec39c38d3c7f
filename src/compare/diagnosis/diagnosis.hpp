// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with a candidate, by how much, and how sure that is.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/diagnosis/alignment.hpp"
#include "compare/measures/noise_floor.hpp"

namespace tubefoot {

/// What is looked at. Spans outlive the call.
struct DiagnosisInput {
  EchoPair pair;
  std::span<const double> beam_azimuth_deg;
  std::span<const double> as_given;  ///< the candidate's numbers before any fit: for their steps (8 bits)
  std::span<const double> ideal_j;   ///< of a perfect engine with the candidate's sampling; or empty
};

/// One mistake.
struct Finding {
  std::string fault;  ///< a short name that stays: "mirror", "sample-shift"
  double size = 0, error = 0;
  std::string unit;
  std::string words;  ///< a sentence
};

/// How far a part of the fan is off beside the whole, beams and samples.
struct LocalShift {
  std::size_t first_beam = 0, last_beam = 0;
  Estimate beams, samples;
};

/// Where shadows begin and end in the candidate, beside where the aligned truth has them: positive where the
/// candidate's shadow is larger.
struct EdgeOffsets {
  std::size_t edges = 0;
  Estimate mean;      ///< beams at sides, samples at ends
  double spread = 0;  ///< standard deviation of single edges
};

struct Diagnosis {
  std::vector<Finding> findings;
  Alignment alignment;
  NoiseFloor floor;
  std::vector<LocalShift> along_fan;
  EdgeOffsets sides, ends;
  /// Relative L1 error as it is; after gain and law; after displacement and blur; without what is wrongly lit
  /// and the floor. What is left is sampling, or a mistake that has no name here.
  double l1 = 0, l1_after_gain = 0, l1_after_warp = 0, l1_left = 0;
  std::optional<double> ideal_l1;  ///< of the perfect engine of the same sampling
  double scatter = 0;              ///< relative deviation of single bins in even areas
  bool has(const std::string& fault) const;
};

/// Pings beyond what `most_bins` allow are left out, evenly.
Diagnosis diagnose(const DiagnosisInput& input, std::size_t most_bins = 400'000);

}  // namespace tubefoot
