// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/targets/target_echo.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "engine/certified/certified_gain.hpp"
#include "geometry/numbers/int128.hpp"

// Computes the echoes of targets in closed form. One template serves doubles and intervals, so that the
// certified sum encloses the same expression.

namespace tubefoot {
namespace {

/// Absorption of the model, as absorption_per_m(), which has fewer than eight roundings.
template <class N>
N beta_of(const EchoModel& model) {
  const double beta = model.absorption_db_per_m == 0 ? 0 : absorption_per_m(model.absorption_db_per_m);
  if constexpr (std::is_same_v<N, Interval>)
    return beta == 0 ? Interval(0) : outwards(beta, beta, 8);
  else
    return beta;
}

double root_of(double x) { return std::sqrt(x); }
Interval root_of(const Interval& x) { return root(x); }
double exp_of(double x) { return std::exp(x); }
Interval exp_of(const Interval& x) { return exp(x); }
double square_of(double x) { return x * x; }
Interval square_of(const Interval& x) { return squared(x); }

/// Cosine and sine of an angle. Both have slopes of at most 1.
std::array<double, 2> cos_sin(double angle) { return {std::cos(angle), std::sin(angle)}; }
std::array<Interval, 2> cos_sin(const Interval& angle) {
  const double middle = angle.middle(), off = angle.width() + library_units * 0x1p-52;
  const auto about = [&](double value) {
    return Interval(std::max(value - off, -1.0), std::min(value + off, 1.0));
  };
  return {about(std::cos(middle)), about(std::sin(middle))};
}

double gain_of(const Directivity& pattern, const std::array<double, 3>& d) {
  return pattern.gain({d[0], d[1], d[2]});
}
Interval gain_of(const Directivity& pattern, const std::array<Interval, 3>& d) {
  if (pattern.kind == Directivity::Kind::uniform) return 1;
  const CertifiedGain gain(pattern);
  const Interval cosine = pattern.axis.x * d[0] + pattern.axis.y * d[1] + pattern.axis.z * d[2];
  return gain.at(Interval(std::max(cosine.lo, -1.0), std::min(cosine.hi, 1.0)), false, gain.largest().hi());
}

template <class N>
N transmit_gain(const TransmitPattern& pattern, const std::array<N, 3>& direction) {
  N sum = 0;
  for (const Directivity& beam : pattern.beams) sum += gain_of(beam, direction);
  return sum;
}

/// Whether a beam receives a two-way gain (BeamPatterns::least).
enum class Reception { none, possible, certain };
Reception reception(const BeamPatterns& patterns, std::size_t beam, double gain) {
  return patterns.receives(beam, gain) ? Reception::certain : Reception::none;
}
Reception reception(const BeamPatterns& patterns, std::size_t beam, const Interval& gain) {
  if (!patterns.receives(beam, gain.hi)) return Reception::none;
  return patterns.receives(beam, gain.lo) ? Reception::certain : Reception::possible;
}

/// Value that may be absent.
double possible(double value) { return value; }
Interval possible(const Interval& value) { return {std::min(value.lo, 0.0), std::max(value.hi, 0.0)}; }

/// Returns whether the square root of an integer is at least `border`, exactly.
bool reaches(UInt128 square, double border) {
  if (!(border > 0)) return true;
  const double root = std::sqrt(static_cast<double>(square));
  if (std::abs(root - border) > 1e-12 * border) return root > border;
  int exponent = 0;
  constexpr int digits = 53;
  const auto mantissa =
      static_cast<UInt128>(static_cast<std::uint64_t>(std::ldexp(std::frexp(border, &exponent), digits)));
  const UInt128 border_square = mantissa * mantissa;  // times 2^(2 (exponent - digits))
  const int shift = 2 * (digits - exponent);
  // Both squares are nearly equal, so that a shift of either gives less than 2^107.
  return shift >= 0 ? square << shift >= border_square : square >= border_square << -shift;
}

}  // namespace

template <class N>
TargetLeg<N> straight_leg(const std::array<N, 3>& d, const EchoModel& model) {
  const N beta = beta_of<N>(model);
  const N square = square_of(d[0]) + square_of(d[1]) + square_of(d[2]), range = root_of(square);
  return {range, exp_of(-(beta * range)) / square, {d[0] / range, d[1] / range, d[2] / range}};
}
template TargetLeg<double> straight_leg(const std::array<double, 3>&, const EchoModel&);
template TargetLeg<Interval> straight_leg(const std::array<Interval, 3>&, const EchoModel&);

std::optional<TargetBins> bin_of_range(const SampleFinder& samples, GridPoint apex, GridPoint target,
                                       double grid_unit_m) {
  const auto square = [](std::int32_t to, std::int32_t from) {
    const std::int64_t d = std::int64_t(to) - from;
    return static_cast<UInt128>(Int128(d) * d);
  };
  const UInt128 range2 = square(target.x, apex.x) + square(target.y, apex.y) + square(target.z, apex.z);
  const std::vector<double>& borders = samples.borders();
  const auto past = [&](std::size_t k) { return reaches(range2, borders[k] / grid_unit_m); };
  if (!past(0) || past(borders.size() - 1)) return {};
  const double range_m = std::sqrt(static_cast<double>(range2)) * grid_unit_m;
  std::size_t k = samples.at(std::clamp(range_m, borders.front(), std::nextafter(borders.back(), 0.0)));
  while (!past(k)) --k;
  while (past(k + 1)) ++k;
  return TargetBins{k, k + 1, true};
}

std::optional<TargetBins> bin_of_half_path(const SampleFinder& samples, double half_path_m) {
  if (!samples.holds(half_path_m)) return {};
  const std::size_t k = samples.at(half_path_m);
  return TargetBins{k, k + 1, true};
}

std::optional<TargetBins> bin_of_half_path(const SampleFinder& samples, const Interval& half_path_m) {
  const std::vector<double>& borders = samples.borders();
  if (!(half_path_m.hi >= borders.front() && half_path_m.lo < borders.back())) return {};
  const bool inside = half_path_m.lo >= borders.front() && half_path_m.hi < borders.back();
  const std::size_t first = half_path_m.lo < borders.front() ? 0 : samples.at(half_path_m.lo),
                    last = half_path_m.hi >= borders.back() ? borders.size() - 2 : samples.at(half_path_m.hi);
  return TargetBins{first, last + 1, inside && first == last};
}

std::optional<TargetBins> bin_of_moving_receiver(const SampleFinder& samples, double end_m,
                                                 const MovingHalfPaths<double>& half_paths) {
  const std::vector<double>& borders = samples.borders();
  if (!(half_paths.at_begin_m >= borders.front() && half_paths.at_end_m < end_m)) return {};
  return bin_of_half_path(samples, std::clamp(half_paths.at_middle_m, borders.front(),
                                              std::nextafter(borders.back(), borders.front())));
}

std::optional<TargetBins> bin_of_moving_receiver(const SampleFinder& samples, double end_m,
                                                 const MovingHalfPaths<Interval>& half_paths) {
  const std::vector<double>& borders = samples.borders();
  if (!(half_paths.at_begin_m.hi >= borders.front() && half_paths.at_end_m.lo < end_m)) return {};
  const auto within = [&](double value) {
    return std::clamp(value, borders.front(), std::nextafter(borders.back(), borders.front()));
  };
  auto bins = bin_of_half_path(
      samples, Interval(within(half_paths.at_middle_m.lo), within(half_paths.at_middle_m.hi)));
  if (bins && !(half_paths.at_begin_m.lo >= borders.front() && half_paths.at_end_m.hi < end_m))
    bins->certain = false;
  return bins;
}

template <class N>
TargetEchoSum<N>::TargetEchoSum(const ReceiveBeams& beams, const SampleFinder& samples,
                                const EchoModel& model)
    : beams_(beams),
      samples_(samples.borders().size() - 1),
      model_(model),
      sums_(static_cast<std::size_t>(beams.count) * samples_, N(0)) {}

template <class N>
void TargetEchoSum<N>::add(const N& cross_section_m2, const TargetLeg<N>& tx, const TargetLeg<N>& rx,
                           const TargetBins& bins, std::span<const std::uint32_t> tx_tubes,
                           std::span<const std::uint32_t> rx_tubes, bool same_tube) {
  const N uniform = cross_section_m2 * tx.intensity_per_m2 * rx.intensity_per_m2;
  const auto receive = [&](std::uint32_t tube) {
    if (model_.patterns == nullptr) return add_to(beams_.of_tube[tube], bins, uniform);
    const BeamPatterns& patterns = *model_.patterns;
    const N sent = transmit_gain(patterns.transmit[patterns.fan_of_tube[tube]], tx.direction);
    for (auto [beam, end] = patterns.beams_of_tube[tube]; beam != end; ++beam) {
      const N gain = sent * gain_of(patterns.receive[beam], rx.direction);
      const Reception how = reception(patterns, beam, gain);
      if (how == Reception::certain)
        add_to(beam, bins, uniform * gain);
      else if (how == Reception::possible)
        add_to(beam, bins, possible(uniform * gain));
    }
  };
  for (const std::uint32_t out : tx_tubes) {
    if (same_tube)
      receive(out);
    else
      for (const std::uint32_t back : rx_tubes)
        if (beams_.in_one_fan(out, back)) receive(back);
  }
}

template <class N>
void TargetEchoSum<N>::add_to(std::uint32_t beam, const TargetBins& bins, const N& energy) {
  has_any_ = true;
  for (std::size_t k = bins.first; k < bins.end; ++k)
    sums_[beam * samples_ + k] += bins.certain ? energy : possible(energy);
}
template class TargetEchoSum<double>;
template class TargetEchoSum<Interval>;

template <class N>
TargetPairSum<N>::TargetPairSum(const ReceiverBaseline& receiver_pair, std::uint32_t fan,
                                const SampleFinder& samples, const EchoModel& model)
    : receiver_pair_(receiver_pair),
      fan_(fan),
      samples_(samples),
      model_(model),
      sums_(4 * (samples.borders().size() - 1), N(0)) {}

template <class N>
void TargetPairSum<N>::add(const N& cross_section_m2, glm::dvec3 from_transmitter_m, glm::dvec3 from_middle_m,
                           bool seen_by_upper, bool seen_by_lower) {
  const BeamPatterns& patterns = *model_.patterns;
  const auto vector = [](glm::dvec3 v) { return std::array<N, 3>{N(v.x), N(v.y), N(v.z)}; };
  const std::array<N, 3> axis = vector(receiver_pair_.axis), middle = vector(from_middle_m);
  const TargetLeg<N> tx = straight_leg<N>(vector(from_transmitter_m), model_);
  const N sent = transmit_gain(patterns.transmit[fan_], tx.direction);
  struct Receiver {
    N energy, range;
    TargetBins bins;
  };
  const auto receiver = [&](double end, bool seen) -> std::optional<Receiver> {
    std::array<N, 3> from;
    for (std::size_t k = 0; k < 3; ++k) from[k] = middle[k] - end * receiver_pair_.baseline_m / 2 * axis[k];
    const TargetLeg<N> rx = straight_leg<N>(from, model_);
    const N gain = sent * gain_of(patterns.receive[fan_], rx.direction);
    const Reception how = reception(patterns, fan_, gain);
    if (!seen || how == Reception::none) return {};
    auto bins = bin_of_half_path(samples_, 0.5 * (tx.range_m + rx.range_m));
    if (!bins) return {};
    bins->certain = bins->certain && how == Reception::certain;
    return Receiver{cross_section_m2 * tx.intensity_per_m2 * rx.intensity_per_m2 * gain, rx.range_m, *bins};
  };
  const std::array<std::optional<Receiver>, 2> both{receiver(1, seen_by_upper), receiver(-1, seen_by_lower)};
  for (std::size_t row = 0; row < 2; ++row)
    if (both[row])
      for (std::size_t k = both[row]->bins.first; k < both[row]->bins.end; ++k)
        add_to(row, k, both[row]->energy, both[row]->bins.certain);
  if (!both[0] || !both[1]) return;
  // r_upper - r_lower = (r_upper^2 - r_lower^2) / (r_upper + r_lower), without cancellation.
  const N along = axis[0] * middle[0] + axis[1] * middle[1] + axis[2] * middle[2],
          difference = -2 * receiver_pair_.baseline_m * along / (both[0]->range + both[1]->range);
  const auto [cosine, sine] = cos_sin(receiver_pair_.wavenumber_rad_m * difference);
  const N product = root_of(both[0]->energy * both[1]->energy);
  const TargetBins &upper = both[0]->bins, &lower = both[1]->bins;
  for (std::size_t k = std::max(upper.first, lower.first); k < std::min(upper.end, lower.end); ++k) {
    add_to(2, k, product * cosine, upper.certain && lower.certain);
    add_to(3, k, product * sine, upper.certain && lower.certain);
  }
}

template <class N>
void TargetPairSum<N>::add_to(std::size_t row, std::size_t sample, const N& value, bool certain) {
  has_any_ = true;
  sums_[row * (samples_.borders().size() - 1) + sample] += certain ? value : possible(value);
}
template class TargetPairSum<double>;
template class TargetPairSum<Interval>;

CertifiedEcho certified_echo_of(std::span<const Interval> sums, std::size_t rows) {
  CertifiedEcho echo{{static_cast<int>(rows), static_cast<int>(sums.size() / rows), {}}, {}};
  for (const Interval& sum : sums) {
    const double middle = sum.lo == 0 && sum.hi == 0 ? 0 : sum.middle();
    echo.echo.energy.push_back(middle);
    const double half = std::max(sum.hi - middle, middle - sum.lo);
    echo.bound.push_back(half > 0 ? half * (1 + 0x1p-50) : 0);
  }
  return echo;
}

}  // namespace tubefoot
