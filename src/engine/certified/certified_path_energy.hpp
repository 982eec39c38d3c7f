// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/certified_gain.hpp"
#include "engine/certified/certified_path_integral.hpp"
#include "engine/scattering/echo_model.hpp"

// Encloses the integrand of a bistatic path over a polygon's plane. It is the density of density.hpp with
// mirror losses, beam patterns and texture. Values are enclosed in balls and intervals, and bounded over
// complex positions for the quadrature error.
namespace tubefoot {

/// One end of a path over a polygon's plane, with all factors that depend only on its range and direction.
class CertifiedEnd {
 public:
  /// `place_m`: position of its apex relative to the polygon's apex.
  CertifiedEnd(const CertifiedPolygon& polygon, const std::array<Ball, 3>& place_m);
  /// `seen`: apparent positions of the plane's points (BistaticFacet), whose distances differ from the
  /// ranges. Directions are apparent positions divided by ranges.
  CertifiedEnd(const ApexOverPlane& over, const LyingPlane& seen);

  const ApexOverPlane& over() const { return over_; }

  /// Cosine between the direction to a point and an axis, times the range.
  using Trace = PlaneFunction<Ball>;
  using IntervalTrace = PlaneFunction<Interval>;
  Trace trace(const glm::dvec3& axis) const;
  static Ball cosine(const Trace& trace, const PlanePlace<Ball>& p, const Ball& range);
  static Interval cosine(const IntervalTrace& trace, const PlanePlace<Interval>& p, const Interval& range);

  Ball range(const PlanePlace<Ball>& p) const;
  Interval range(const PlanePlace<Interval>& p) const;
  /// Square of the range.
  ComplexBall range2(const PlanePlace<ComplexBall>& p) const;

  /// Sets the mirror losses as a function of direction.
  void take_loss(const MirrorLoss& loss);
  Ball passed(const PlanePlace<Ball>& p, const Ball& range) const;
  Interval passed(const PlanePlace<Interval>& p, const Interval& range) const;

  /// Cross-section of a model at this point. It uses the piece of take_piece(), or, for real points, all
  /// pieces.
  bool take_piece(const ScatteringModel& model, const PlanePlace<Ball>& box);
  void take_all_pieces() { piece_ = nullptr; }
  Ball cross_section(const ScatteringModel& model, const PlanePlace<Ball>& p, const Ball& range) const;
  Interval cross_section(const ScatteringModel& model, const PlanePlace<Interval>& p,
                         const Interval& range) const;

  /// Upper bounds over complex positions, in logarithms. Infinite where a factor is not analytic.
  struct Bound {
    ComplexBall per_range;        ///< 1 / range
    double least_range = 0;       ///< of the modulus of the range
    double least_real_range = 0;  ///< of the real part of the range
    double passed = 0;            ///< of the logarithm of the mirror losses
    double cross_section = 0;     ///< of the logarithm of the model's cross-section, for the chosen piece
  };
  /// Returns false where the factors are not analytic.
  bool bound(const ScatteringModel* model, const PlanePlace<ComplexBall>& p, Bound& bound) const;
  static ComplexBall cosine(const Trace& trace, const PlanePlace<ComplexBall>& p, const Bound& bound) {
    return trace.at(p.x, p.y) * bound.per_range;
  }

 private:
  Ball incidence(const PlanePlace<Ball>& p) const;
  Interval incidence(const PlanePlace<Interval>& p) const;
  void take_doubles();

  /// Frame of the plane; vector from the apex to the polygon's foot point.
  std::array<Ball, 3> u_, v_, to_foot_;
  ApexOverPlane over_;
  Interval height_, x_, y_;  ///< the values of `over_` in doubles
  const MirrorLoss* loss_ = nullptr;
  std::vector<Trace> rough_;
  std::vector<IntervalTrace> rough_in_doubles_;
  const ScatteringModel::Piece* piece_ = nullptr;
};

/// Return of the seabed along a path between two apexes (density.hpp), on transmit and receive leg, with
/// texture, patterns and mirrors as factors.
class CertifiedPathEnergy {
 public:
  /// `rx_m`: position of the receive apex relative to the polygon's apex.
  CertifiedPathEnergy(const CertifiedPolygon& polygon, const std::array<Ball, 3>& rx_m,
                      const EchoModel& model, const SurfaceProperties& seabed, const Ball& beta_per_m);
  /// For a flattened facet. Either each end has its own model, or no end has one (Lambert's law with `mu`).
  CertifiedPathEnergy(CertifiedEnd tx, CertifiedEnd rx, const Path& path,
                      const std::array<const ScatteringModel*, 2>& models, double mu, const Ball& beta_per_m);

  const CertifiedEnd& tx() const { return tx_; }
  const CertifiedEnd& rx() const { return rx_; }

  /// Density without patterns or texture.
  Ball density_at(const PlanePlace<Ball>& p, const Ball& tx_range, const Ball& rx_range) const;
  Interval density_at(const PlanePlace<Interval>& p, const Interval& tx_range,
                      const Interval& rx_range) const;
  /// Upper bound of the logarithm of the density over complex positions. Infinite where the density is not
  /// analytic. Sets the bounds of both ends.
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

/// Products of the patterns of both ends.
class CertifiedPathGains {
 public:
  /// Creates an object without patterns.
  CertifiedPathGains() = default;
  CertifiedPathGains(const CertifiedEnd& tx, const CertifiedEnd& rx, const TransmitPattern& transmit,
                     std::span<const Directivity> receive);

  std::size_t beams() const { return any_ ? receive_.size() : 1; }
  /// Multiplies the value of each beam by its pattern, in balls or in intervals of doubles.
  template <class N>
  void weigh(const PlanePlace<N>& p, const N& tx_range, const N& rx_range, std::vector<N>& values) const {
    if (!any_) return;
    N sent;
    for (const Gain& beam : transmit_) sent += gain_at(beam, p, tx_range);
    for (std::size_t b = 0; b < receive_.size(); ++b)
      values[b] = values[b] * sent * gain_at(receive_[b], p, rx_range);
  }
  /// Adds the logarithm of each beam's pattern bound to `bounds`.
  void weigh(const PlanePlace<ComplexBall>& p, const CertifiedEnd::Bound& tx, const CertifiedEnd::Bound& rx,
             std::vector<double>& bounds) const;
  /// Replaces tables by the cubic of one segment over a box. Adds the error to `off` by beam.
  void take_segments(const PlanePlace<Ball>& box, const Ball& tx_range, const Ball& rx_range,
                     std::vector<double>& off);
  /// Returns whether no receive pattern has a zero in the box.
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
  Ball gain_at(const Gain& gain, const PlanePlace<Ball>& p, const Ball& range) const;
  Interval gain_at(const Gain& gain, const PlanePlace<Interval>& p, const Interval& range) const;
  double log_bound(const Gain& gain, const PlanePlace<ComplexRange>& p, const ComplexRange& per_range) const;
  bool any_ = false, tables_ = false, by_segment_ = false;
  std::vector<Gain> transmit_, receive_;
  double smooth_rad_ = 1;
};

/// Energies of one receiver, by beam.
class CertifiedPathIntegrand : public CertifiedIntegrand {
 public:
  CertifiedPathIntegrand(CertifiedPathEnergy energy, CertifiedPathGains gains, const CertifiedCell* texture)
      : energy_(std::move(energy)), gains_(std::move(gains)), texture_(texture) {}

  std::size_t values() const override { return gains_.beams(); }
  double scale_m(const PlanePlace<Ball>& place) const override;
  void at(const PlanePlace<Ball>& place, std::vector<Ball>& values) const override { enclose(place, values); }
  bool at(const PlanePlace<Interval>& place, std::vector<Interval>& values) const override {
    enclose(place, values);
    return true;
  }
  bool take(const PlanePlace<Ball>& box, std::vector<double>& off) override;
  void take_whole() override;
  void log_bounds(const PlanePlace<ComplexBall>& place, std::vector<double>& bounds) const override;

 private:
  template <class N>
  void enclose(const PlanePlace<N>& place, std::vector<N>& values) const {
    const N tx = energy_.tx().range(place), rx = energy_.rx().range(place);
    N value = energy_.density_at(place, tx, rx);
    if (texture_ != nullptr) value = value * texture_->factor_at(place.x, place.y);
    values.assign(gains_.beams(), value);
    gains_.weigh(place, tx, rx, values);
  }

  CertifiedPathEnergy energy_;
  CertifiedPathGains gains_;
  const CertifiedCell* texture_;
};

}  // namespace tubefoot
