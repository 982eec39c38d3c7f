// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/reflectivity_gradient.hpp"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "engine/scattering/layered_reflectivity.hpp"
#include "geometry/numbers/dual.hpp"

namespace tubefoot {
namespace {

/// A dual number by the three coordinates of a place. The polynomials of Perlin noise have integers.
struct PlaceNumber {
  Dual<3> x;
  PlaceNumber() = default;
  explicit PlaceNumber(int constant) : x(double(constant)) {}
  explicit PlaceNumber(const Dual<3>& number) : x(number) {}
  friend PlaceNumber operator+(const PlaceNumber& a, const PlaceNumber& b) { return PlaceNumber(a.x + b.x); }
  friend PlaceNumber operator-(const PlaceNumber& a, const PlaceNumber& b) { return PlaceNumber(a.x - b.x); }
  friend PlaceNumber operator*(const PlaceNumber& a, const PlaceNumber& b) { return PlaceNumber(a.x * b.x); }
};

ReflectivityGradient::Value value_of(const MapReflectivity& map, glm::dvec3 place_m) {
  const glm::dvec2 p = glm::dvec2(place_m) - map.placing().first_m;
  const double column = glm::dot(p, map.to_column()), row = glm::dot(p, map.to_row());
  const double i = std::floor(column), j = std::floor(row), x = column - i, y = row - j;
  const double a = map.value(i, j), b = map.value(i + 1, j), c = map.value(i, j + 1),
               d = map.value(i + 1, j + 1);
  const double first = (1 - x) * a + x * b, second = (1 - x) * c + x * d;
  const double by_column = (1 - y) * (b - a) + y * (d - c), by_row = second - first;
  return {(1 - y) * first + y * second, glm::dvec3(by_column * map.to_column() + by_row * map.to_row(), 0)};
}

ReflectivityGradient::Value value_of(const PerlinReflectivity& noise, glm::dvec3 place_m) {
  const auto number = [](double value, std::size_t which) {
    return PlaceNumber(Dual<3>::parameter(value, which));
  };
  ReflectivityGradient::Value sum;
  for (const PerlinReflectivity::Octave& octave : noise.octaves()) {
    const glm::dvec3 p = place_m * octave.per_m, cell = glm::floor(p), q = p - cell;
    const Dual<3> value = noise.lattice()
                              .in_cell(std::int64_t(cell.x), std::int64_t(cell.y), std::int64_t(cell.z),
                                       number(q.x, 0), number(q.y, 1), number(q.z, 2))
                              .x;
    sum.factor += octave.amplitude * value.value;
    const auto& by = value.derivative;
    sum.gradient += octave.amplitude * octave.per_m * glm::dvec3(by[0], by[1], by[2]);
  }
  return sum;
}

}  // namespace

ReflectivityGradient::ReflectivityGradient(const ReflectivityField& field) { add(field); }

void ReflectivityGradient::add(const ReflectivityField& field) {
  if (const auto* map = dynamic_cast<const MapReflectivity*>(&field)) return maps_.push_back(map);
  if (const auto* noise = dynamic_cast<const PerlinReflectivity*>(&field)) return noises_.push_back(noise);
  const auto* layered = dynamic_cast<const LayeredReflectivity*>(&field);
  if (layered == nullptr)
    throw std::invalid_argument(
        "gradient: a reflectivity texture of this kind has no derivative: use maps and Perlin noise");
  for (const auto& layer : layered->layers()) add(*layer);
}

ReflectivityGradient::Value ReflectivityGradient::at(glm::dvec3 place_m) const {
  Value product;
  const auto multiply = [&](const Value& own) {
    product.gradient = product.factor * own.gradient + own.factor * product.gradient;
    product.factor *= own.factor;
  };
  for (const MapReflectivity* map : maps_) multiply(value_of(*map, place_m));
  for (const PerlinReflectivity* noise : noises_) multiply(value_of(*noise, place_m));
  return product;
}

}  // namespace tubefoot
