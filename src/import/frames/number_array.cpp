// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the picture and its axes among the arrays of a file and converts them to frames. It handles
// stacks of pictures, grey colours and the point maps of OceanSim.
#include "import/frames/number_array.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "files/limits.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"

namespace tubefoot {
namespace {

std::string in_words(const NumberArray& array) {
  const std::string shape = fmt::format("({})", fmt::join(array.shape, " x "));
  return array.name.empty() ? shape : fmt::format("'{}' {}", array.name, shape);
}

/// Returns the values of an axis of such pictures. The order of the picture later determines which axis it
/// is. A two-sided picture has two beams, and its ranges are half of its columns. Each picture gets a copy,
/// so that a longer array is rejected here.
std::vector<double> line_of(const NumberArray* array, std::size_t rows, std::size_t columns,
                            const SourcePlace& place) {
  if (!array) return {};
  // A table with a range for every bin is not an axis.
  if (std::ranges::count_if(array->shape, [](std::size_t n) { return n != 1; }) > 1)
    throw InputError(place, fmt::format("array {} is not an axis: expected one value per row or per column",
                                        in_words(*array)));
  const std::size_t count = array->values.size();
  if (count != rows && count != columns && 2 * count != columns && (count != 2 || columns % 2 != 0))
    throw InputError(place, fmt::format("array {} is not an axis of pictures with {} rows and {} columns: "
                                        "expected one value per row or per column",
                                        in_words(*array), rows, columns));
  return array->values;
}

/// Returns the grey values of a picture whose colour channels are equal. Other colours are a colour map and
/// no measurement; they are rejected.
NumberArray without_colours(const NumberArray& picture, const SourcePlace& place) {
  const std::size_t colours = picture.shape.back();
  NumberArray grey{picture.name, {picture.shape[0], picture.shape[1]}, {}, true};
  grey.values.reserve(picture.values.size() / colours);
  for (std::size_t k = 0; k < picture.values.size(); k += colours) {
    const double* pixel = &picture.values[k];
    if (pixel[0] != pixel[1] || pixel[0] != pixel[2])
      throw InputError(
          place, fmt::format("array {} holds colours (red {:g}, green {:g}, blue {:g} at row {}, "
                             "column {}): write the intensities before they are coloured",
                             in_words(picture), pixel[0], pixel[1], pixel[2], k / colours / picture.shape[1],
                             k / colours % picture.shape[1]));
    grey.values.push_back(pixel[0]);
  }
  return grey;
}

/// Reads the map of OceanSim: x (starboard), y (ahead) and intensity of each bin; a row is one range.
ForeignData of_points(const NumberArray& map, const SourcePlace& place) {
  const std::size_t rows = map.shape[0], columns = map.shape[1];
  ForeignFrame frame{rows, columns, {}, map.eight_bits, {}, {}, {}};
  for (std::size_t k = 0; k < rows * columns; ++k) frame.values.push_back(map.values[3 * k + 2]);
  const auto place_of = [&](std::size_t row, std::size_t column) {
    return &map.values[3 * (row * columns + column)];
  };
  for (std::size_t row = 0; row < rows; ++row)
    frame.range_m.push_back(std::hypot(place_of(row, 0)[0], place_of(row, 0)[1]));
  for (std::size_t column = 0; column < columns; ++column)
    frame.azimuth_rad.push_back(std::atan2(place_of(rows - 1, column)[0], place_of(rows - 1, column)[1]));
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const double *at = place_of(row, column), range_m = frame.range_m[row],
                   azimuth = frame.azimuth_rad[column];
      if (!(std::hypot(at[0] - range_m * std::sin(azimuth), at[1] - range_m * std::cos(azimuth)) <=
            1e-3 * frame.range_m[rows - 1]))
        throw InputError(place, fmt::format("array {} is not a fan: row {}, column {} is at x {:g}, y {:g}, "
                                            "not at the range of its row and the azimuth of its column",
                                            in_words(map), row, column, at[0], at[1]));
    }
  return {{std::move(frame)}, {"ranges and azimuths are those of the points"}};
}

const NumberArray* named(const std::vector<NumberArray>& arrays, const std::string& name,
                         const SourcePlace& place) {
  if (name.empty()) return nullptr;
  const auto found = std::ranges::find(arrays, name, &NumberArray::name);
  if (found != arrays.end()) return &*found;
  std::vector<std::string> names;
  for (const NumberArray& array : arrays) names.push_back(array.name);
  throw InputError(place, fmt::format("has no '{}'; it has {}", name,
                                      names.empty() ? std::string("no arrays") : one_of(names, '\'')));
}

}  // namespace

std::size_t counted(const std::vector<std::size_t>& shape, const SourcePlace& place) {
  std::size_t count = 1;
  for (const std::size_t length : shape)
    if (__builtin_mul_overflow(count, length, &count))
      throw InputError(place,
                       fmt::format("declares {} values, an impossible number", fmt::join(shape, " x ")));
  return count;
}

ForeignData frames_of(const NumberArray& given, const NumberArray* ranges, const NumberArray* azimuths,
                      bool points, const SourcePlace& place) {
  NumberArray picture = given;
  auto& shape = picture.shape;
  if (shape.size() > 2) std::erase(shape, std::size_t{1});
  if (shape.size() == 1) shape.insert(shape.begin(), 1);
  if (shape.size() == 3 && points && shape.back() == 3) {
    if (picture.values.empty()) throw InputError(place, fmt::format("array {} is empty", in_words(given)));
    if (ranges || azimuths)
      throw UsageError(
          fmt::format("--{}-variable: the points of array {} already have positions: omit the option",
                      ranges ? "range" : "azimuth", in_words(given)));
    return of_points(picture, place);
  }
  if (shape.size() == 3 && picture.eight_bits && (shape[2] == 3 || shape[2] == 4))
    picture = without_colours(picture, place);
  if (shape.empty() || shape.size() > 3)
    throw InputError(
        place, fmt::format("array {} is not a picture: expected two axes, or three for several pictures",
                           in_words(given)));
  if (picture.values.empty()) throw InputError(place, fmt::format("array {} is empty", in_words(given)));
  const std::size_t frames = shape.size() == 3 ? shape[0] : 1, rows = shape[shape.size() - 2],
                    columns = shape.back();
  if (static_cast<double>(rows) * static_cast<double>(columns) > static_cast<double>(limits::ping_cells))
    throw InputError(
        place, fmt::format("a picture of {} x {} values is larger than any ping (at most {} values)", rows,
                           columns, limits::ping_cells));
  const std::vector<double> range_m = line_of(ranges, rows, columns, place),
                            azimuth_rad = line_of(azimuths, rows, columns, place);
  ForeignData data;
  for (std::size_t k = 0; k < frames; ++k) {
    const auto first = picture.values.begin() + static_cast<std::ptrdiff_t>(k * rows * columns);
    data.frames.push_back({rows,
                           columns,
                           {first, first + static_cast<std::ptrdiff_t>(rows * columns)},
                           picture.eight_bits,
                           range_m,
                           azimuth_rad,
                           {}});
  }
  return data;
}

ForeignData frames_of(const std::vector<NumberArray>& arrays, const WantedArrays& wanted,
                      const SourcePlace& place) {
  const NumberArray* picture = named(arrays, wanted.variable, place);
  if (!picture) {
    std::vector<std::string> names;
    for (const NumberArray& array : arrays)
      if (array.shape.size() >= 2 && array.values.size() > 1) {
        picture = &array;
        names.push_back(in_words(array));
      }
    if (names.size() != 1)
      throw InputError(place, names.empty()
                                  ? "contains no array with two or more axes"
                                  : fmt::format("contains several pictures, {}: choose one with --variable",
                                                fmt::join(names, " and ")));
  }
  ForeignData data = frames_of(*picture, named(arrays, wanted.range_variable, place),
                               named(arrays, wanted.azimuth_variable, place), wanted.points, place);
  if (arrays.size() > 1) data.noticed.push_back(fmt::format("the picture is {}", in_words(*picture)));
  return data;
}

}  // namespace tubefoot
