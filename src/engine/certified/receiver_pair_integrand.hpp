// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "engine/certified/certified_path_energy.hpp"

// The mean product of what two receivers on a receiver pair receive of a facet, in balls. Heavy: include only
// in .cpp files.
namespace tubefoot {

/// The way by one of them: what the seabed returns along it, and patterns.
struct ReceiverPairPath {
  CertifiedPathEnergy energy;
  CertifiedPathGains gains;
};

/// The phase between both: turn * along / (range to the upper + range to the lower).
struct ReceiverPairPhase {
  CertifiedEnd::Trace along;
  Ball turn;
  double growth = 0;  ///< about how much it changes over a radian

  /// Of a place that lies where it is seen, the receiver pair's middle there from the apex of the transmit
  /// leg: (upper^2 - lower^2) / (upper + lower), so that nothing cancels where the baseline is short.
  ReceiverPairPhase(const CertifiedEnd& out, const ReceiverBaseline& receiver_pair,
                    const glm::dvec3& middle_m);
  /// Of two receivers over the plane of a facet that is flattened.
  ReceiverPairPhase(const ApexOverPlane& upper, const ApexOverPlane& lower, double wavenumber_rad_m);
};

/// The root of both energies' product: its size, and its parts with the phase between the receivers.
class ReceiverPairIntegrand : public CertifiedIntegrand {
 public:
  /// `with_energies`: two values more, both energies.
  ReceiverPairIntegrand(ReceiverPairPath upper, ReceiverPairPath lower, ReceiverPairPhase phase,
                        const CertifiedCell* texture, bool with_energies = false)
      : upper_(std::move(upper)),
        lower_(std::move(lower)),
        phase_(std::move(phase)),
        texture_(texture),
        with_energies_(with_energies) {}

  std::size_t values() const override { return with_energies_ ? 5 : 3; }
  std::size_t size_of(std::size_t value) const override { return value < 3 ? 0 : value; }
  bool positive() const override { return false; }
  double scale_m(const PlanePlace<Ball>& p) const override;
  void at(const PlanePlace<Ball>& p, std::vector<Ball>& values) const override;
  bool take(const PlanePlace<Ball>& box, std::vector<double>& off) override;
  void take_whole() override;
  void log_bounds(const PlanePlace<ComplexBall>& p, std::vector<double>& bounds) const override;

 private:
  ReceiverPairPath upper_, lower_;
  ReceiverPairPhase phase_;
  const CertifiedCell* texture_;
  bool with_energies_;
};

/// What of a polygon lies in another one of the same plane, and the area of what may, at their edges. No
/// points: no more than that.
std::pair<CertifiedPolygon, Ball> common_part(const CertifiedPolygon& one, const CertifiedPolygon& other);

}  // namespace tubefoot
