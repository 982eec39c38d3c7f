// SPDX-License-Identifier: GPL-3.0-or-later
// Geometric transformation of a picture: order of beams, displacement along beams and samples, and blur. It
// reads values between bins with the cubic interpolation of Catmull and Rom and sets negative results to 0.
#include "compare/diagnosis/warp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace tubefoot {
namespace {

constexpr double radians = 0.017453292519943295;

/// Catmull-Rom weights of four values along an axis. Values outside of the axis are 0.
struct Tap {
  std::ptrdiff_t first;
  std::array<double, 4> weights;
};

Tap tap_at(double position) {
  const double below = std::floor(position), t = position - below;
  return {static_cast<std::ptrdiff_t>(below) - 1,
          {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2 - 1.5 * t)),
           t * t * (-0.5 + 0.5 * t)}};
}

double read(const double* values, std::size_t stride, std::size_t length, const Tap& tap) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::ptrdiff_t place = tap.first + static_cast<std::ptrdiff_t>(k);
    if (place < 0 || place >= static_cast<std::ptrdiff_t>(length)) continue;
    sum += tap.weights[k] * values[static_cast<std::size_t>(place) * stride];
  }
  return std::max(sum, 0.0);
}

/// Exchanges energy between neighbours until the variance of each place is reached. The exchange is
/// symmetric, so that no energy is lost.
void blur_along(std::vector<double>& values, std::size_t first, std::size_t stride,
                std::span<const double> variances, std::vector<double>& line) {
  const std::size_t length = variances.size();
  const int times = std::max(1, static_cast<int>(std::ceil(std::ranges::max(variances) / 0.3)));
  line.resize(length);
  for (int k = 0; k < times; ++k) {
    for (std::size_t i = 0; i < length; ++i) line[i] = values[first + i * stride];
    const auto exchange = [&](std::size_t i) {
      return (variances[i] + variances[i + 1]) / (4 * times) * (line[i + 1] - line[i]);
    };
    for (std::size_t i = 0; i < length; ++i)
      values[first + i * stride] =
          std::max(0.0, line[i] + (i + 1 < length ? exchange(i) : 0) - (i > 0 ? exchange(i - 1) : 0));
  }
}

std::size_t ordered(BeamOrder order, std::size_t beam, std::size_t beams) {
  if (order == BeamOrder::mirrored) return beams - 1 - beam;
  if (order == BeamOrder::halves_swapped) return (beam + beams / 2) % beams;
  if (order == BeamOrder::halves_mirrored) return (2 * beams - 1 - beam + beams / 2) % beams;
  return beam;
}

}  // namespace

Fan::Fan(const EchoShape& shape, std::vector<double> beam_azimuth_deg, std::vector<double> slant_range_m)
    : shape_(shape), azimuths_deg_(std::move(beam_azimuth_deg)), ranges_m_(std::move(slant_range_m)) {
  if (shape.samples > 1)
    sample_m_ = (ranges_m_.back() - ranges_m_.front()) / static_cast<double>(shape.samples - 1);
  if (azimuths_deg_.size() > 1) {
    beam_deg_ = (azimuths_deg_.back() - azimuths_deg_.front()) / static_cast<double>(shape.beams - 1);
    middle_deg_ = (azimuths_deg_.back() + azimuths_deg_.front()) / 2;
  }
  if (beam_deg_ == 0) beam_deg_ = 1;
}

double Fan::tangent_displacement(int views, std::size_t beam) const {
  const double half = std::abs(beam_deg_) * static_cast<double>(shape_.beams) / 2, view = half / views;
  if (view >= 85) return 0;
  const double from_edge = azimuths_deg_[beam] - middle_deg_ + half;
  const double number = std::clamp(std::floor(from_edge / (2 * view)), 0.0, views - 1.0);
  const double off = from_edge - (2 * number + 1) * view;
  const double shown = std::atan(off / view * std::tan(view * radians)) / radians;
  return (off - shown) / beam_deg_;
}

double Fan::beam_displacement(const Warp& warp, std::size_t beam) const {
  double moved = warp.beams;
  if (warp.azimuth_scale != 0) moved += warp.azimuth_scale * (azimuths_deg_[beam] - middle_deg_) / beam_deg_;
  if (warp.tangent != 0) moved += warp.tangent * tangent_displacement(warp.views, beam);
  return moved;
}

double Fan::sample_displacement(const Warp& warp, std::size_t sample) const {
  return warp.samples + warp.range_scale * ranges_m_[sample] / sample_m_;
}

double Fan::largest_of_tangent(int views) const {
  double largest = 0;
  for (std::size_t beam = 0; beam < shape_.beams; ++beam)
    largest = std::max(largest, std::abs(tangent_displacement(views, beam)));
  return largest;
}

std::optional<std::size_t> Fan::source_of(const Warp& warp, std::size_t bin) const {
  const std::size_t s = bin % shape_.samples, beam = bin / shape_.samples % shape_.beams,
                    ping = bin / shape_.samples / shape_.beams;
  const double sample = std::round(static_cast<double>(s) - sample_displacement(warp, s)),
               across = std::round(static_cast<double>(beam) - beam_displacement(warp, beam));
  if (!(sample >= 0 && sample < double(shape_.samples) && across >= 0 && across < double(shape_.beams)))
    return std::nullopt;
  const std::size_t from = ordered(warp.order, static_cast<std::size_t>(across), shape_.beams);
  return (ping * shape_.beams + from) * shape_.samples + static_cast<std::size_t>(sample);
}

std::vector<double> Fan::variances(double blur, double growth) const {
  std::vector<double> result(shape_.samples, blur);
  if (growth != 0)
    for (std::size_t s = 0; s < shape_.samples; ++s)
      result[s] = std::max(-0.2, blur + growth * std::pow(ranges_m_[s] / ranges_m_.back(), 2));
  return result;
}

std::vector<double> Fan::blurred(std::vector<double> energy_j, double beam_blur, double sample_blur,
                                 double beam_growth, double sample_growth) const {
  std::vector<double> line;
  if (sample_blur != 0 || sample_growth != 0) {
    const std::vector<double> along = variances(sample_blur, sample_growth);
    for (std::size_t column = 0; column < shape_.pings * shape_.beams; ++column)
      blur_along(energy_j, column * shape_.samples, 1, along, line);
  }
  if (beam_blur != 0 || beam_growth != 0) {
    const std::vector<double> of_row = variances(beam_blur, beam_growth);
    std::vector<double> across(shape_.beams);
    for (std::size_t row = 0; row < shape_.pings * shape_.samples; ++row) {
      across.assign(shape_.beams, of_row[row % shape_.samples]);
      blur_along(energy_j, row / shape_.samples * shape_.beams * shape_.samples + row % shape_.samples,
                 shape_.samples, across, line);
    }
  }
  return energy_j;
}

std::vector<double> Fan::warped(const std::vector<double>& energy_j, const Warp& warp) const {
  const std::size_t beams = shape_.beams, samples = shape_.samples;
  std::vector<double> along_range(energy_j.size()), result(energy_j.size());
  std::vector<Tap> taps(samples);
  bool moves = false;
  for (std::size_t s = 0; s < samples; ++s) {
    const double moved = sample_displacement(warp, s);
    taps[s] = tap_at(static_cast<double>(s) - moved);
    moves = moves || moved != 0;
  }
  for (std::size_t column = 0; column < shape_.pings * beams; ++column) {
    const std::size_t ping = column / beams, beam = column % beams;
    const double* from = &energy_j[(ping * beams + ordered(warp.order, beam, beams)) * samples];
    double* to = &along_range[column * samples];
    if (moves)
      for (std::size_t s = 0; s < samples; ++s) to[s] = read(from, 1, samples, taps[s]);
    else
      std::copy(from, from + samples, to);
  }
  for (std::size_t column = 0; column < shape_.pings * beams; ++column) {
    const std::size_t ping = column / beams, beam = column % beams;
    const double moved = beam_displacement(warp, beam);
    const Tap tap = tap_at(static_cast<double>(beam) - moved);
    const double* from = &along_range[ping * beams * samples];
    double* to = &result[column * samples];
    if (moved == 0)
      std::copy(from + beam * samples, from + (beam + 1) * samples, to);
    else
      for (std::size_t s = 0; s < samples; ++s) to[s] = read(from + s, samples, beams, tap);
  }
  return blurred(std::move(result), warp.beam_blur, warp.sample_blur, warp.beam_growth, warp.sample_growth);
}

}  // namespace tubefoot
