// SPDX-License-Identifier: GPL-3.0-or-later
// Applies the steps of an output model to a picture with bounds. A monotone step maps both ends of the
// interval of a bin. A linear step (blur) transforms bounds as it transforms values.
// docs/engine-validation.md lists the formulas.
#include "compare/output_models/output_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tubefoot {
namespace {

/// An interval. The lower end of a value that is not negative stays at least 0.
struct Ends {
  double low, high;
};

Ends ends_of(const BoundedPicture& picture, std::size_t bin) {
  const double b = picture.bound.empty() ? 0 : picture.bound[bin];
  return {std::max(picture.value[bin] - b, 0.0), picture.value[bin] + b};
}

/// Sets value and bound of a bin from the result of a step and the interval of possible results.
void set(BoundedPicture& picture, std::size_t bin, double value, Ends ends) {
  picture.value[bin] = value;
  if (!picture.bound.empty()) picture.bound[bin] = std::max({ends.high - value, value - ends.low, 0.0});
}

/// Applies an increasing function to each bin.
void map(BoundedPicture& picture, const std::function<double(double)>& f) {
  for (std::size_t bin = 0; bin < picture.value.size(); ++bin) {
    const Ends ends = ends_of(picture, bin);
    set(picture, bin, f(picture.value[bin]), {f(ends.low), f(ends.high)});
  }
}

/// Multiplies by a range factor. The bound of a bin covers the factor at every range of its sample.
void put(const RangeLawStep& step, const SourcePlace&, BoundedPicture& picture) {
  const auto model = [&](double r) {
    return std::pow(r, step.exponent) * std::pow(10, step.absorption_db_per_km * 2 * r / 1e4);
  };
  for (std::size_t bin = 0; bin < picture.value.size(); ++bin) {
    const std::size_t s = bin % picture.shape.samples;
    const double first = model(picture.slant_range_bounds_m[2 * s]),
                 last = model(picture.slant_range_bounds_m[2 * s + 1]);
    const double middle =
        model((picture.slant_range_bounds_m[2 * s] + picture.slant_range_bounds_m[2 * s + 1]) / 2);
    const Ends ends = ends_of(picture, bin);
    set(picture, bin, picture.value[bin] * middle,
        {ends.low * std::min({first, middle, last}), ends.high * std::max({first, middle, last})});
  }
}

void require_solid_angles(const SourcePlace& place, const BoundedPicture& picture, const char* what) {
  if (picture.solid_angle_sr.empty())
    throw InputError(place,
                     std::string(what) +
                         " needs the solid angle of the visible surfaces in each bin: add solid_angles = "
                         "\"FILE.nc\" to the output model (docs/engine-validation.md describes this file)");
}

/// Returns intervals of the median solid angle of each row, over its bins with a positive solid angle, ping
/// by ping.
std::vector<Ends> medians_of(const BoundedPicture& picture) {
  const EchoShape& shape = picture.shape;
  const std::vector<double>& bounds = picture.solid_angle_bound_sr;
  std::vector<Ends> medians(shape.pings * shape.samples, Ends{0, 0});
  for (std::size_t row = 0; row < medians.size(); ++row) {
    std::vector<double> seen;
    double bound = 0;
    for (std::size_t beam = 0; beam < shape.beams; ++beam) {
      const std::size_t bin =
          (row / shape.samples * shape.beams + beam) * shape.samples + row % shape.samples;
      if (!(picture.solid_angle_sr[bin] > 0)) continue;
      seen.push_back(picture.solid_angle_sr[bin]);
      if (!bounds.empty()) bound = std::max(bound, bounds[bin]);
    }
    if (seen.empty()) continue;
    const auto middle = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
    std::nth_element(seen.begin(), middle, seen.end());
    medians[row] = {*middle - bound, *middle + bound};
  }
  return medians;
}

void put(const MeanStep& step, const SourcePlace& place, BoundedPicture& picture) {
  require_solid_angles(place, picture, "a mean per bin");
  const std::vector<Ends> usual = step.least_share > 0 ? medians_of(picture) : std::vector<Ends>{};
  for (std::size_t bin = 0; bin < picture.value.size(); ++bin) {
    const Ends ends = ends_of(picture, bin);
    const double omega = picture.solid_angle_sr[bin],
                 b = picture.solid_angle_bound_sr.empty() ? 0 : picture.solid_angle_bound_sr[bin];
    if (!(omega > 0)) {
      set(picture, bin, 0, {0, ends.high > 0 ? INFINITY : 0});
      continue;
    }
    const double least = omega - b;
    double value = picture.value[bin] / omega;
    Ends of_mean{ends.low / (omega + b), least > 0 ? ends.high / least : INFINITY};
    if (!usual.empty()) {
      const std::size_t row = bin / (picture.shape.beams * picture.shape.samples) * picture.shape.samples +
                              bin % picture.shape.samples;
      const double low = step.least_share * usual[row].low, high = step.least_share * usual[row].high;
      if (omega < (low + high) / 2) value = 0;
      if (omega - b < high) of_mean.low = 0;  // the bin may lie below the least share
      if (omega + b < low) of_mean.high = 0;  // the bin certainly lies below the least share
    }
    set(picture, bin, value, of_mean);
  }
}

void put(const CountStep& step, const SourcePlace& place, BoundedPicture& picture) {
  require_solid_angles(place, picture, "a count");
  picture.value = picture.solid_angle_sr;
  if (!picture.bound.empty()) {
    picture.bound = picture.solid_angle_bound_sr;
    picture.bound.resize(picture.value.size());
  }
  map(picture, [&](double omega) { return omega * step.points_per_sr; });
}

/// Returns a kernel of weights that are not negative and sum to 1. At the border of the picture the weights
/// stay unchanged; values outside count as 0.
std::vector<double> kernel_of(double deviation, std::int64_t size) {
  std::vector<double> kernel;
  double sum = 0;
  for (std::int64_t k = -(size / 2); k <= size / 2; ++k) {
    const auto x = static_cast<double>(k);
    kernel.push_back(deviation > 0 ? std::exp(-x * x / (2 * deviation * deviation)) : double(k == 0));
    sum += kernel.back();
  }
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

void blur_line(std::vector<double>& values, std::size_t first, std::size_t stride, std::size_t length,
               const std::vector<double>& kernel) {
  std::vector<double> line(length);
  const auto reach = static_cast<std::ptrdiff_t>(kernel.size() / 2), n = static_cast<std::ptrdiff_t>(length);
  for (std::ptrdiff_t i = 0; i < n; ++i)
    for (std::ptrdiff_t k = std::max(-reach, -i); k <= reach && i + k < n; ++k)
      line[static_cast<std::size_t>(i)] += kernel[static_cast<std::size_t>(k + reach)] *
                                           values[first + static_cast<std::size_t>(i + k) * stride];
  for (std::size_t i = 0; i < length; ++i) values[first + i * stride] = line[i];
}

/// Blurs values and bounds with the same weights, which are not negative.
void put(const BlurStep& step, const SourcePlace&, BoundedPicture& picture) {
  const EchoShape& shape = picture.shape;
  const std::vector<double> across = kernel_of(step.beams, step.size),
                            along = kernel_of(step.samples, step.size);
  for (std::vector<double>* values : {&picture.value, &picture.bound}) {
    if (values->empty()) continue;
    for (std::size_t column = 0; column < shape.pings * shape.beams; ++column)
      blur_line(*values, column * shape.samples, 1, shape.samples, along);
    for (std::size_t row = 0; row < shape.pings * shape.samples; ++row)
      blur_line(*values, row / shape.samples * shape.beams * shape.samples + row % shape.samples,
                shape.samples, shape.beams, across);
  }
}

/// Returns the number of the group of bins that are normalised together.
std::size_t group_of(const std::string& over, const EchoShape& shape, std::size_t bin) {
  const std::size_t column = bin / shape.samples, ping = column / shape.beams;
  if (over == "image") return ping;
  if (over == "beam") return column;
  return ping * shape.samples + bin % shape.samples;
}

void put(const NormaliseStep& step, const SourcePlace&, BoundedPicture& picture) {
  const EchoShape& shape = picture.shape;
  const std::size_t groups = group_of(step.over, shape, shape.bins() - 1) + 1;
  std::vector<double> whole(groups), low(groups), high(groups);
  const auto gather = [&](double& total, double value) {
    total = step.by == "sum" ? total + value : std::max(total, value);
  };
  for (std::size_t bin = 0; bin < shape.bins(); ++bin) {
    const std::size_t g = group_of(step.over, shape, bin);
    const Ends ends = ends_of(picture, bin);
    gather(whole[g], picture.value[bin]);
    gather(low[g], ends.low);
    gather(high[g], ends.high);
  }
  for (std::size_t bin = 0; bin < shape.bins(); ++bin) {
    const std::size_t g = group_of(step.over, shape, bin);
    const Ends ends = ends_of(picture, bin);
    if (!(whole[g] > 0)) {
      set(picture, bin, 0, {0, high[g] > 0 ? 1.0 : 0.0});
      continue;
    }
    // No bin exceeds the total of its group.
    set(picture, bin, picture.value[bin] / whole[g],
        {ends.low / high[g], low[g] > 0 ? std::min(1.0, ends.high / low[g]) : 1.0});
  }
}

void put(const AmplitudeStep&, const SourcePlace&, BoundedPicture& picture) {
  map(picture, [](double e) { return std::sqrt(e); });
}
void put(const DecibelStep& step, const SourcePlace&, BoundedPicture& picture) {
  map(picture, [&](double e) {
    const double level = e > 0 ? 10 * std::log10(e) : -INFINITY;
    return std::clamp((level - step.low_db) / (step.high_db - step.low_db), 0.0, 1.0);
  });
}
void put(const ClampStep& step, const SourcePlace&, BoundedPicture& picture) {
  map(picture, [&](double e) { return std::clamp(e, step.low, step.high); });
}
void put(const QuantiseStep& step, const SourcePlace&, BoundedPicture& picture) {
  map(picture, [&](double e) {
    const double levels = std::ldexp(1, static_cast<int>(step.bits)) - 1;
    return std::round(std::clamp(e / step.full, 0.0, 1.0) * levels) / levels * step.full;
  });
}
void put(const GainStep& step, const SourcePlace&, BoundedPicture& picture) {
  map(picture, [&](double e) { return e * step.factor; });
}

}  // namespace

void apply(const OutputModelStep& step, BoundedPicture& picture) {
  std::visit([&](const auto& kind) { put(kind, step.place, picture); }, step.kind);
}

}  // namespace tubefoot
