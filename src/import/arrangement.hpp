// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "files/input_error.hpp"
#include "import/bin_axes.hpp"
#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// A picture of a frame as energies, in beams (port first) of range samples (nearest first).
struct PolarPicture {
  std::size_t beams = 0, samples = 0;
  std::vector<double> energy;  ///< [beam][sample]
  AxesOfFile axes;
};

/// Scale of the numbers of a picture.
class ValueScale {
 public:
  /// Parses energy, amplitude, db, db:REFERENCE (the energy of 0 dB) or 8bit. Throws UsageError.
  explicit ValueScale(const std::string& words);
  /// Throws InputError at `place` for numbers outside the range of the scale.
  std::vector<double> energies(const ForeignFrame& frame, const SourcePlace& place) const;

 private:
  enum class Kind { energy, amplitude, db, eight_bits } kind_ = Kind::energy;
  double reference_ = 1;
};

/// Returns the order of the frame: "range-first", "beam-first" or "two-sided". The order is `declared`, or
/// it follows from the shapes of the frame and of the reference. Throws UsageError if they do not determine
/// it.
std::string order_of(const ForeignFrame& frame, const std::string& declared, const BinAxes& reference);

/// Returns the pictures of a frame: one picture, or one picture per row of a two-sided waterfall.
std::vector<PolarPicture> arranged(const ForeignFrame& frame, const std::string& order, bool flip_beams,
                                   bool flip_range, const ValueScale& scale, const SourcePlace& place);

}  // namespace tubefoot
