// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "files/input_error.hpp"
#include "import/bin_axes.hpp"
#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// A picture of a frame as beams (port first) of range samples (nearest first), as energies.
struct PolarPicture {
  std::size_t beams = 0, samples = 0;
  std::vector<double> energy;  ///< [beam][sample]
  AxesOfFile axes;
};

/// What a number of a picture stands for.
class ValueScale {
 public:
  /// energy, amplitude, db, db:REFERENCE (the energy of 0 dB) or 8bit. Throws UsageError.
  explicit ValueScale(const std::string& words);
  /// Throws InputError at `place` for numbers that are none of that scale.
  std::vector<double> energies(const ForeignFrame& frame, const SourcePlace& place) const;

 private:
  enum class Kind { energy, amplitude, db, eight_bits } kind_ = Kind::energy;
  double reference_ = 1;
};

/// The frame's order, "range-first", "beam-first" or "two-sided", as declared or as its shape tells beside
/// the reference's. Throws UsageError where it does not.
std::string order_of(const ForeignFrame& frame, const std::string& declared, const BinAxes& reference);

/// The pictures of a frame: one, or of a two-sided waterfall one a row.
std::vector<PolarPicture> arranged(const ForeignFrame& frame, const std::string& order, bool flip_beams,
                                   bool flip_range, const ValueScale& scale, const SourcePlace& place);

}  // namespace tubefoot
