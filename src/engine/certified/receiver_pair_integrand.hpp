// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "engine/certified/certified_path_energy.hpp"

// Integrand of the mean product of a receiver pair's two signals from a facet, in balls. Include this heavy
// header only in .cpp files.
namespace tubefoot {

/// Path to one of the receivers: return of the seabed along the path, and patterns.
struct ReceiverPairPath {
  CertifiedPathEnergy energy;
  CertifiedPathGains gains;
};

/// Phase between the two receivers: turn * along / (range to the upper + range to the lower).
struct ReceiverPairPhase {
  CertifiedEnd::Trace along;
  Ball turn;
  double growth = 0;  ///< approximate change of the phase per radian

  /// For points at their true positions. `middle_m`: position of the pair's middle relative to the apex of
  /// the transmit leg. The form (upper^2 - lower^2) / (upper + lower) avoids cancellation for short
  /// baselines.
  ReceiverPairPhase(const CertifiedEnd& out, const ReceiverBaseline& receiver_pair,
                    const glm::dvec3& middle_m);
  /// For two receivers over the plane of a flattened facet.
  ReceiverPairPhase(const ApexOverPlane& upper, const ApexOverPlane& lower, double wavenumber_rad_m);
};

/// Geometric mean of both energies: its size, and its real and imaginary part with the phase between the
/// receivers.
class ReceiverPairIntegrand : public CertifiedIntegrand {
 public:
  /// `with_energies`: both energies are two additional values.
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

/// Returns the part of a polygon that lies in another polygon of the same plane, and the area of the
/// uncertain part along their edges. If the part has no points, only the uncertain part may be common.
std::pair<CertifiedPolygon, Ball> common_part(const CertifiedPolygon& one, const CertifiedPolygon& other);

}  // namespace tubefoot
