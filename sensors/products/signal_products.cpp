// SPDX-License-Identifier: GPL-3.0-or-later
// Requests for products of signals, their checks against array and signals, windows along an array, and the
// interpolator for a waveform's band.

#include "sensors/products/signal_products.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <stdexcept>

#include "sensors/beamforming/beams.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/signals/require.hpp"

namespace tubefoot {
namespace {

/// Smaller extents are rounding errors of mountings, which rotate positions.
constexpr double least_extent_m = 1e-6;

using std::numbers::pi;

void check(const SignalFan& fan, const char* of, const ElementArray& array) {
  constexpr std::size_t most_beams = 4096;
  require(fan.beams >= 2 && fan.beams <= most_beams,
          fmt::format("the {} has {} beams, but must have 2 to {}", of, fan.beams, most_beams));
  const bool across = fan.plane == SignalFan::Plane::across_track;
  require(fan.opening_rad > 0 && fan.opening_rad <= pi,
          fmt::format("the opening angle of the {} is {:g} degrees, but must be above 0 and at most 180", of,
                      degrees(fan.opening_rad)));
  require(
      !across || fan.depression_rad == 0,
      fmt::format("the {} is across the track and points straight down, so its depression must be 0", of));
  require(std::abs(fan.depression_rad) < pi / 2,
          fmt::format("the depression of the {} is {:g} degrees, but must be between -90 and 90", of,
                      degrees(fan.depression_rad)));
  weights_along(array, starboard_axis, fan.window);
}

/// False if an array cannot distinguish port from starboard, as elements on a line forward.
bool knows_sides(const ElementArray& array) {
  const auto away = [](glm::dvec3 a) { return glm::length(glm::dvec3(a.x, 0, a.z)); };
  return std::ranges::any_of(array.receivers_m, [&](glm::dvec3 place) {
    return away(place - array.receivers_m[0]) > least_extent_m;
  });
}

void check(const SignalSidescan& sidescan, const ElementArray& array) {
  require(std::abs(sidescan.depression_rad) < pi / 2,
          fmt::format("the depression of the sidescan beams is {:g} degrees, but must be between -90 and 90",
                      degrees(sidescan.depression_rad)));
  require(sidescan.sides != SignalSidescan::Sides::both || knows_sides(array),
          "a two-sided sidescan needs receivers that distinguish port from starboard, but these lie on a "
          "line along the forward axis: use one side, or place array elements beside or above each other");
  weights_along(array, forward_axis, sidescan.window);
}

void check(const SignalMultibeam& multibeam, const ElementArray& array) {
  check(multibeam.fan, "fan of soundings", array);
  require(multibeam.fan.plane == SignalFan::Plane::across_track,
          "the fan of the multibeam looks forward, but soundings need a fan across the track");
  if (!multibeam.split_beam) return;
  const auto [first, last] =
      std::ranges::minmax(array.receivers_m, {}, [](const glm::dvec3& place) { return place.x; });
  require(array.receivers_m.size() >= 2 && last.x - first.x > least_extent_m,
          fmt::format("a split beam needs two halves of an array, but the {} receiver{} not extend across "
                      "the track: place receivers to starboard of each other, or detect by amplitude only",
                      array.receivers_m.size(), array.receivers_m.size() == 1 ? " does" : "s do"));
}

void check(const SignalAperture& aperture, const ElementArray& array, std::size_t pings) {
  constexpr std::size_t most = SignalAperture::most_pixels;
  const PixelPlane& plane = aperture.plane;
  require(plane.columns >= 2 && plane.rows >= 2,
          fmt::format("the aperture picture has {} x {} pixels, but must have 2 x 2 or more", plane.columns,
                      plane.rows));
  require(plane.columns <= most / plane.rows, fmt::format("the aperture picture has {} x {} pixels, but the "
                                                          "limit is {}: use larger pixels, or a smaller area",
                                                          plane.columns, plane.rows, most));
  const double column_m = glm::length(plane.column_step_m), row_m = glm::length(plane.row_step_m);
  require(column_m > 0 && row_m > 0 && std::isfinite(column_m) && std::isfinite(row_m),
          fmt::format("the aperture pixels are {:g} x {:g} m, but must be above 0", column_m, row_m));
  require(pings >= 2, "a synthetic aperture needs two or more pings, but there is one ping");
  require(!aperture.half_beam_rad || (*aperture.half_beam_rad > 0 && *aperture.half_beam_rad <= pi / 2),
          "the half beam width of the aperture must be above 0 and at most 90 degrees");
  window_weights(aperture.ping_window, pings);
  weights_along(array, forward_axis, aperture.receiver_window);
}

void check(const SignalInterferogram& interferogram, const SignalCounts& counts) {
  for (const auto& [group, name] :
       {std::pair{&interferogram.upper, "upper"}, std::pair{&interferogram.lower, "lower"}}) {
    require(!group->empty(),
            fmt::format("the interferogram has no {} receivers: give at least one receiver", name));
    for (const std::size_t receiver : *group)
      require(receiver < counts.receivers,
              fmt::format("there is no {} receiver {} for the interferogram: receivers are 0 to {}", name,
                          receiver, counts.receivers - 1));
  }
  require(interferogram.upper != interferogram.lower,
          "the upper and lower receivers of the interferogram are the same, so the phase is 0 everywhere: "
          "choose different receivers");
  const double length = glm::length(interferogram.direction);
  require(length > 0 && std::isfinite(length),
          "the direction of the interferogram must be a finite vector with a length above 0");
  require(interferogram.looks_range >= 1 && interferogram.looks_range <= counts.samples &&
              interferogram.looks_pings >= 1 && interferogram.looks_pings <= counts.pings,
          fmt::format("a cell of the interferogram has {} samples and {} pings, but the signals have {} and "
                      "{}: a cell must have at least 1 of each and at most as many as the signals",
                      interferogram.looks_range, interferogram.looks_pings, counts.samples, counts.pings));
}

}  // namespace

std::vector<double> SignalFan::angles_rad() const {
  std::vector<double> angles;
  for (std::size_t k = 0; k < beams; ++k)
    angles.push_back(opening_rad *
                     (beams > 1 ? static_cast<double>(k) / static_cast<double>(beams - 1) - 0.5 : 0.0));
  return angles;
}

std::vector<glm::dvec3> SignalFan::directions() const {
  return plane == Plane::across_track ? across_track_fan(angles_rad())
                                      : forward_fan(angles_rad(), depression_rad);
}

std::vector<double> weights_along(const ElementArray& array, glm::dvec3 axis, const ApertureWindow& window) {
  if (window.law == ApertureWindow::Law::uniform) return {};
  const std::size_t count = array.receivers_m.size();
  std::vector<double> places;
  for (const glm::dvec3& receiver : array.receivers_m) places.push_back(glm::dot(receiver, axis));
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return places[k]; });
  const double first = places[order.front()], extent = places[order.back()] - first;
  require(extent > least_extent_m,
          "a non-uniform window needs receivers at different positions along the axis of its weights: use a "
          "uniform window, or place receivers along this axis");
  const double step = extent / static_cast<double>(count - 1);
  std::vector<double> weights(count);
  if (window.law == ApertureWindow::Law::chebyshev) {
    const std::vector<double> even = window_weights(window, count);
    for (std::size_t k = 0; k < count; ++k) {
      require(std::abs(places[order[k]] - first - static_cast<double>(k) * step) < 1e-3 * step,
              "the Chebyshev window needs uniformly spaced receivers: use the Taylor window");
      weights[order[k]] = even[k];
    }
    return weights;
  }
  // Each element is at the middle of its share. The aperture is one spacing longer than the distance between
  // the outermost elements.
  for (std::size_t k = 0; k < count; ++k)
    weights[k] = window_at(window, (places[k] - first - extent / 2) / (extent + step));
  return weights;
}

SignalInterpolator interpolator_for(const TransmitWaveform& waveform, const SignalSampling& sampling,
                                    double error) {
  constexpr double least = 0.5, most = 0.95;
  const FrequencyBand band = band_of(waveform);
  const double widest_hz =
      std::max(std::abs(band.low_hz - sampling.baseband_hz), std::abs(band.high_hz - sampling.baseband_hz));
  return SignalInterpolator(std::clamp(2 * widest_hz / sampling.rate_hz, least, most), error);
}

const SignalFan* fan_of_complex_beams(const SignalProducts& products) {
  if (products.fan && products.fan->plane == SignalFan::Plane::across_track) return &*products.fan;
  return products.multibeam ? &products.multibeam->fan : nullptr;
}

void check(const SignalProducts& products, const ElementArray& array, const SignalCounts& counts) {
  require(!products.name.empty() && products.name != "." && products.name != ".." &&
              products.name.find('/') == std::string::npos,
          fmt::format("'{}' cannot be a file name", products.name));
  require(!array.receivers_m.empty() && counts.receivers == array.receivers_m.size() && counts.pings > 0 &&
              counts.samples > 0,
          "products of signals need pings, receivers and samples");
  require(products.picture_ping < counts.pings,
          fmt::format("there is no ping {} to draw: the signals have {} pings", products.picture_ping,
                      counts.pings));
  require(products.ping_numbers.empty() || products.ping_numbers.size() == counts.pings,
          fmt::format("there are {} ping numbers for {} pings", products.ping_numbers.size(), counts.pings));
  if (products.fan) check(*products.fan, "fan", array);
  if (products.sidescan) check(*products.sidescan, array);
  if (products.multibeam) check(*products.multibeam, array);
  if (products.aperture) check(*products.aperture, array, counts.pings);
  if (products.interferogram) check(*products.interferogram, counts);
  require(!products.jsf || products.sidescan, "a JSF file needs the beams of a sidescan: add a sidescan");
  require(!products.sonar_netcdf || fan_of_complex_beams(products) != nullptr,
          "a SONAR-netCDF4 file of complex beams needs a fan across the track: add a fan or a multibeam");
}

}  // namespace tubefoot
