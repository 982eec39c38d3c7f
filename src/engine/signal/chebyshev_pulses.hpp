// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

#include "engine/signal/baseband_pulse.hpp"

namespace tubefoot {

/// A pulse after filters T_j(2 f / bandwidth), j = 0, 1, ..., Chebyshev's polynomials over its band: an echo
/// whose amplitude over frequencies is a sum of these polynomials is the sum of these pulses. T_0 leaves the
/// pulse as it is, whatever it has beyond its band; beyond, the others are as at the band's ends.
class ChebyshevPulses {
 public:
  /// `most`: as many polynomials may be asked for. `left_out`: of the pulse's peak, where its filtered forms
  /// are cut off in time.
  ChebyshevPulses(const BasebandPulse& pulse, const SignalTimes& times, int most, double left_out);

  int most() const { return int(tables_.size()); }
  /// As tables, made when first asked for, from any thread.
  const PulseTable& table(int order) const;
  BasebandPulse filtered(int order) const;

 private:
  struct Table {
    std::once_flag once;
    std::optional<PulseTable> table;
  };

  BasebandPulse pulse_;
  SignalTimes times_;
  double left_out_;
  mutable std::deque<Table> tables_;
};

}  // namespace tubefoot
