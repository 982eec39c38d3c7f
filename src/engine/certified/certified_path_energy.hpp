// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/certified_gain.hpp"
#include "engine/certified/certified_path_integral.hpp"
#include "engine/scattering/echo_model.hpp"

namespace tubefoot {

/// One end of a path over a polygon's plane: of what depends on its range and direction alone.
class CertifiedEnd {
 public:
  /// `place_m`: of its apex, relative to the polygon's.
  CertifiedEnd(const CertifiedPolygon& polygon, const std::array<Ball, 3>& place_m);
  /// `seen`: where it sees the plane's points, which are at other ranges (BistaticFacet): directions are
  /// those places over the ranges.
  CertifiedEnd(const ApexOverPlane& over, const LyingPlane& seen);

  const ApexOverPlane& over() const { return over_; }

  /// Cosine of the direction to a place with an axis, times the range.
  struct Trace {
    Ball at_foot, along_u, along_v;
    template <class N>
    N at(const PlanePlace<N>& p) const {
      return N(at_foot) + N(along_u) * p.x + N(along_v) * p.y;
    }
  };
  Trace trace(const glm::dvec3& axis) const;
  static Ball cosine(const Trace& trace, const PlanePlace<Ball>& p, const Ball& range);
  /// The same in intervals of doubles.
  struct IntervalTrace {
    Interval at_foot, along_u, along_v;

    IntervalTrace() = default;
    explicit IntervalTrace(const Trace& trace)
        : at_foot(interval_of(trace.at_foot)),
          along_u(interval_of(trace.along_u)),
          along_v(interval_of(trace.along_v)) {}
    Interval at(const PlanePlace<Interval>& p) const { return at_foot + along_u * p.x + along_v * p.y; }
  };
  static Interval cosine(const IntervalTrace& trace, const PlanePlace<Interval>& p, const Interval& range);

  Ball range(const PlanePlace<Ball>& p) const;
  Interval range(const PlanePlace<Interval>& p) const;
  /// Its square.
  ComplexBall range2(const PlanePlace<ComplexBall>& p) const;

  /// What mirrors leave in a direction.
  void take_loss(const MirrorLoss& loss);
  Ball passed(const PlanePlace<Ball>& p, const Ball& range) const;
  Interval passed(const PlanePlace<Interval>& p, const Interval& range) const;

  /// A law's cross-section there; by the piece that was taken, or (real) whatever pieces there are.
  bool take_piece(const ScatteringModel& model, const PlanePlace<Ball>& box);
  void take_all_pieces() { piece_ = nullptr; }
  Ball cross_section(const ScatteringModel& model, const PlanePlace<Ball>& p, const Ball& range) const;
  Interval cross_section(const ScatteringModel& model, const PlanePlace<Interval>& p,
                         const Interval& range) const;

  /// Upper bounds over complex places, in logarithms; infinite where something is not analytic.
  struct Bound {
    ComplexBall per_range;        ///< 1 / range
    double least_range = 0;       ///< of its modulus
    double least_real_range = 0;  ///< of its real part
    double passed = 0;            ///< of the logarithm of what mirrors leave
    double cross_section = 0;     ///< of that of the law, of the piece that was taken
  };
  /// False where it is not analytic.
  bool bound(const ScatteringModel* model, const PlanePlace<ComplexBall>& p, Bound& bound) const;
  static ComplexBall cosine(const Trace& trace, const PlanePlace<ComplexBall>& p, const Bound& bound) {
    return trace.at(p) * bound.per_range;
  }

 private:
  Ball incidence(const PlanePlace<Ball>& p) const;
  Interval incidence(const PlanePlace<Interval>& p) const;
  void take_doubles();

  std::array<Ball, 3> u_, v_, to_foot_;  ///< the plane's frame; from the apex to the polygon's foot point
  ApexOverPlane over_;
  Interval height_, x_, y_;  ///< the same in doubles
  const MirrorLoss* loss_ = nullptr;
  std::vector<Trace> rough_;
  std::vector<IntervalTrace> rough_in_doubles_;
  const ScatteringModel::Piece* piece_ = nullptr;
};

/// What the seabed returns along a path (density.hpp) that is gone transmit and receive between two apexes,
/// weighed by texture, patterns and mirrors.
class CertifiedPathEnergy {
 public:
  /// `rx_m`: its apex, relative to the polygon's.
  CertifiedPathEnergy(const CertifiedPolygon& polygon, const std::array<Ball, 3>& rx_m,
                      const EchoModel& model, const SurfaceProperties& seabed, const Ball& beta_per_m);
  /// Of a facet flattened: each end has a law of its own, or none has (Lambert's `mu`).
  CertifiedPathEnergy(CertifiedEnd tx, CertifiedEnd rx, const Path& path,
                      const std::array<const ScatteringModel*, 2>& models, double mu, const Ball& beta_per_m);

  const CertifiedEnd& tx() const { return tx_; }
  const CertifiedEnd& rx() const { return rx_; }

  /// Without patterns or texture.
  Ball density_at(const PlanePlace<Ball>& p, const Ball& tx_range, const Ball& rx_range) const;
  Interval density_at(const PlanePlace<Interval>& p, const Interval& tx_range,
                      const Interval& rx_range) const;
  /// Of its logarithm, over complex places; infinite where it is not analytic. Fills those of its ends.
  double log_bound(const PlanePlace<ComplexBall>& p, CertifiedEnd::Bound& tx, CertifiedEnd::Bound& rx) const;
  bool has_pieces() const;
  bool take_pieces(const PlanePlace<Ball>& box);
  void take_all_pieces();
  double scale_m(const PlanePlace<Ball>& p) const;

 private:
  Ball scattered(const PlanePlace<Ball>& p, const Ball& tx_range, const Ball& rx_range) const;
  Ball spread(const Ball& tx_range, const Ball& rx_range) const;

  void take(const Path& path, double factor, double mu);

  CertifiedEnd tx_, rx_;
  const ScatteringModel *tx_model_, *rx_model_;
  Ball factor_, beta_;
  Interval factor_in_doubles_, beta_in_doubles_;
  double smooth_rad_ = 1;
};

/// Patterns of both ends, times each other.
class CertifiedPathGains {
 public:
  /// Without any.
  CertifiedPathGains() = default;
  CertifiedPathGains(const CertifiedEnd& tx, const CertifiedEnd& rx, const TransmitPattern& transmit,
                     std::span<const Directivity> receive);

  std::size_t beams() const { return any_ ? receive_.size() : 1; }
  /// Multiplies each beam's value.
  void weigh(const PlanePlace<Ball>& p, const Ball& tx_range, const Ball& rx_range,
             std::vector<Ball>& values) const;
  void weigh(const PlanePlace<Interval>& p, const Interval& tx_range, const Interval& rx_range,
             std::vector<Interval>& values) const;
  /// Adds to the logarithms of each beam's bound.
  void weigh(const PlanePlace<ComplexBall>& p, const CertifiedEnd::Bound& tx, const CertifiedEnd::Bound& rx,
             std::vector<double>& bounds) const;
  /// Takes tables for one segment's cubic over a box; adds to `off` by beam.
  void take_segments(const PlanePlace<Ball>& box, const Ball& tx_range, const Ball& rx_range,
                     std::vector<double>& off);
  /// Of all that receives.
  bool has_no_zero(const PlanePlace<Ball>& box, const Ball& rx_range) const;
  void take_tables() { by_segment_ = false; }
  bool has_tables() const { return tables_; }
  double smooth_rad() const { return smooth_rad_; }

 private:
  struct Gain : CertifiedGain {
    CertifiedEnd::Trace trace;
    Ball most;
    CertifiedEnd::IntervalTrace trace_in_doubles;
    double most_in_doubles = 1;
  };
  double log_bound(const Gain& gain, const PlanePlace<ComplexRange>& p, const ComplexRange& per_range) const;
  bool any_ = false, tables_ = false, by_segment_ = false;
  std::vector<Gain> transmit_, receive_;
  double smooth_rad_ = 1;
};

/// Energies by beam of one receiver.
class CertifiedPathIntegrand : public CertifiedIntegrand {
 public:
  CertifiedPathIntegrand(CertifiedPathEnergy energy, CertifiedPathGains gains, const CertifiedCell* texture)
      : energy_(std::move(energy)), gains_(std::move(gains)), texture_(texture) {}

  std::size_t values() const override { return gains_.beams(); }
  double scale_m(const PlanePlace<Ball>& place) const override;
  void at(const PlanePlace<Ball>& place, std::vector<Ball>& values) const override;
  bool at(const PlanePlace<Interval>& place, std::vector<Interval>& values) const override;
  bool take(const PlanePlace<Ball>& box, std::vector<double>& off) override;
  void take_whole() override;
  void log_bounds(const PlanePlace<ComplexBall>& place, std::vector<double>& bounds) const override;

 private:
  CertifiedPathEnergy energy_;
  CertifiedPathGains gains_;
  const CertifiedCell* texture_;
};

}  // namespace tubefoot
