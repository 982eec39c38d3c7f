// SPDX-License-Identifier: GPL-3.0-or-later
// Arranges the numbers of a frame as beams (port first) of range samples (nearest first) and converts their
// scale to energy. It also determines the order of rows and columns from the shape of the frame.
#include "import/arrangement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

/// Direction of the values of an axis in the file: increasing or decreasing.
enum class Run { up, down };
Run run_of(const std::vector<double>& values, const char* what, const SourcePlace& place) {
  const bool up = std::ranges::adjacent_find(values, std::greater_equal()) == values.end(),
             down = std::ranges::adjacent_find(values, std::less_equal()) == values.end();
  const bool finite = std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  if (!finite || (!up && !down))
    throw InputError(place,
                     fmt::format("its {} neither increase nor decrease, so they do not form an axis", what));
  return up ? Run::up : Run::down;
}

void turn_beams(PolarPicture& picture) {
  for (std::size_t b = 0; b < picture.beams / 2; ++b)
    std::swap_ranges(
        picture.energy.begin() + static_cast<std::ptrdiff_t>(b * picture.samples),
        picture.energy.begin() + static_cast<std::ptrdiff_t>((b + 1) * picture.samples),
        picture.energy.begin() + static_cast<std::ptrdiff_t>((picture.beams - 1 - b) * picture.samples));
}

void turn_samples(PolarPicture& picture) {
  for (std::size_t b = 0; b < picture.beams; ++b)
    std::reverse(picture.energy.begin() + static_cast<std::ptrdiff_t>(b * picture.samples),
                 picture.energy.begin() + static_cast<std::ptrdiff_t>((b + 1) * picture.samples));
}

/// Reverses an axis together with the picture if the file lists it from the far or starboard end.
void take_axes(PolarPicture& picture, const ForeignFrame& frame, const SourcePlace& place) {
  if (!frame.range_m.empty()) {
    if (frame.range_m.size() != picture.samples)
      throw InputError(place, fmt::format("has {} ranges for {} range bins: try another --order",
                                          frame.range_m.size(), picture.samples));
    picture.axes.range_m = frame.range_m;
    if (run_of(frame.range_m, "ranges", place) == Run::down) {
      std::ranges::reverse(picture.axes.range_m);
      turn_samples(picture);
    }
  }
  if (frame.azimuth_rad.empty()) return;
  if (frame.azimuth_rad.size() != picture.beams)
    throw InputError(place, fmt::format("has {} azimuths for {} beams: try another --order",
                                        frame.azimuth_rad.size(), picture.beams));
  for (const double azimuth : frame.azimuth_rad)
    picture.axes.azimuth_deg.push_back(azimuth * 180 / std::numbers::pi);
  if (run_of(frame.azimuth_rad, "azimuths", place) == Run::up) return;
  std::ranges::reverse(picture.axes.azimuth_deg);
  turn_beams(picture);
}

}  // namespace

ValueScale::ValueScale(const std::string& words) {
  if (words == "energy") return;
  if (words == "amplitude") {
    kind_ = Kind::amplitude;
  } else if (words == "8bit") {
    kind_ = Kind::eight_bits;
  } else if (words == "db" || words.starts_with("db:")) {
    kind_ = Kind::db;
    if (words == "db") return;
    const char *first = words.data() + 3, *last = words.data() + words.size();
    const auto [end, error] = std::from_chars(first, last, reference_);
    if (error != std::errc{} || end != last || !std::isfinite(reference_) || !(reference_ > 0))
      throw UsageError(
          fmt::format("--scale '{}': expected db:REFERENCE, where REFERENCE is the energy that corresponds "
                      "to 0 dB and must be above 0",
                      words));
  } else {
    throw UsageError(
        fmt::format("--scale{} must name the kind of the picture's numbers: energy, amplitude, db, "
                    "db:REFERENCE (the energy that corresponds to 0 dB) or 8bit",
                    words.empty() ? "" : " '" + words + "'"));
  }
}

std::vector<double> ValueScale::energies(const ForeignFrame& frame, const SourcePlace& place) const {
  std::vector<double> energies = frame.values;
  const auto refuse = [&](std::size_t k, const char* expected) {
    throw InputError(place, fmt::format("has {} at row {}, column {}; expected {}", frame.values[k],
                                        k / frame.columns, k % frame.columns, expected));
  };
  for (std::size_t k = 0; k < energies.size(); ++k) {
    double& value = energies[k];
    if (kind_ == Kind::db) {
      if (std::isnan(value) || value == INFINITY) refuse(k, "decibels");
      value = reference_ * std::pow(10, value / 10);  // minus infinity, for no sound, becomes 0
    } else if (!std::isfinite(value)) {
      refuse(k, "a finite number");
    } else if (kind_ == Kind::amplitude) {
      value *= value;
    } else if (value < 0) {
      refuse(k, "0 or more: are these amplitudes (--scale amplitude) or decibels (--scale db)?");
    } else if (kind_ == Kind::eight_bits) {
      if (value > 255 || value != std::floor(value)) refuse(k, "a whole number from 0 to 255 (--scale 8bit)");
      value /= 255;
    }
    if (!std::isfinite(value)) refuse(k, "a number whose energy is finite");
  }
  return energies;
}

std::string order_of(const ForeignFrame& frame, const std::string& declared, const BinAxes& reference) {
  if (!declared.empty()) return declared;
  const std::size_t beams = reference.beams.count(), samples = reference.samples.count();
  const bool ranges_first = frame.rows == samples && frame.columns == beams,
             beams_first = frame.rows == beams && frame.columns == samples;
  if (ranges_first != beams_first) return ranges_first ? "range-first" : "beam-first";
  throw UsageError(
      fmt::format("a picture of {} rows and {} columns does not show which axis is the range (the reference "
                  "has {} beams of {} samples): set --order range-first (one row per range) or beam-first",
                  frame.rows, frame.columns, beams, samples));
}

std::vector<PolarPicture> arranged(const ForeignFrame& frame, const std::string& order, bool flip_beams,
                                   bool flip_range, const ValueScale& scale, const SourcePlace& place) {
  std::vector<double> energies = scale.energies(frame, place);
  std::vector<PolarPicture> pictures;
  if (order == "beam-first") {
    pictures.push_back({frame.rows, frame.columns, std::move(energies), {}});
  } else if (order == "range-first") {
    PolarPicture picture{frame.columns, frame.rows, std::vector<double>(energies.size()), {}};
    for (std::size_t row = 0; row < frame.rows; ++row)
      for (std::size_t column = 0; column < frame.columns; ++column)
        picture.energy[column * frame.rows + row] = energies[row * frame.columns + column];
    pictures.push_back(std::move(picture));
  } else if (order == "two-sided") {
    const std::size_t samples = frame.columns / 2;
    if (frame.columns % 2 != 0 || samples == 0)
      throw InputError(
          place, fmt::format(
                     "has {} columns, which cannot be divided into two sides with the same number of samples",
                     frame.columns));
    for (std::size_t row = 0; row < frame.rows; ++row) {
      const auto first = energies.begin() + static_cast<std::ptrdiff_t>(row * frame.columns);
      PolarPicture picture{2, samples, {first, first + static_cast<std::ptrdiff_t>(frame.columns)}, {}};
      std::reverse(picture.energy.begin(), picture.energy.begin() + static_cast<std::ptrdiff_t>(samples));
      pictures.push_back(std::move(picture));
    }
  } else {
    throw UsageError(fmt::format("--order '{}': expected range-first, beam-first or two-sided", order));
  }
  for (PolarPicture& picture : pictures) {
    take_axes(picture, frame, place);
    if (flip_beams) turn_beams(picture);
    if (flip_range) turn_samples(picture);
  }
  return pictures;
}

}  // namespace tubefoot
