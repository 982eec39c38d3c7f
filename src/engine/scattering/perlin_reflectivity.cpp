// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/perlin_reflectivity.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace tubefoot {
namespace {

/// Largest coefficients of a cell's polynomial along a line, from the first power on. They are the maxima
/// over 400 000 cells and lines (corners, edges and diagonals among them), plus a tenth.
constexpr std::array steepest{3.2,   6.4,   21.0,  51.0,  50.0,  60.0, 181.0, 240.0,
                              155.0, 187.0, 250.0, 195.0, 100.0, 30.0, 5.8,   0.5};

PerlinReflectivity::Settings checked(const PerlinReflectivity::Settings& s) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument(what); };
  if (!(s.wavelength_m > 0 && std::isfinite(s.wavelength_m)))
    refuse(fmt::format("the wavelength of a texture must be finite and above 0, not {} m", s.wavelength_m));
  if (!(s.octaves >= 1 && s.octaves <= PerlinReflectivity::most_octaves))
    refuse(fmt::format("a texture must have 1 to {} octaves, not {}", PerlinReflectivity::most_octaves,
                       s.octaves));
  if (!(s.persistence >= 0 && s.persistence <= 1))
    refuse(fmt::format("the persistence of a texture must be from 0 to 1, not {}", s.persistence));
  if (!(s.depth >= 0 && s.depth * PerlinLattice::largest <= 1))
    refuse(fmt::format(
        "the depth of a texture must be from 0 to {:.4f}, not {}, because scattering cannot be negative",
        1 / PerlinLattice::largest, s.depth));
  return s;
}

}  // namespace

PerlinReflectivity::PerlinReflectivity(const Settings& settings)
    : settings_(checked(settings)), lattice_(settings.seed) {
  double sum = 0, amplitude = 1, per_m = 1 / settings.wavelength_m;
  for (int i = 0; i < settings.octaves; ++i, amplitude *= settings.persistence, per_m *= 2) {
    octaves_.push_back({per_m, amplitude});
    sum += amplitude;
  }
  for (Octave& octave : octaves_) octave.amplitude *= settings.depth / sum;
  // The cells of a longer octave are unions of those of the shortest.
  for (const glm::dvec3 axis : {glm::dvec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
    cells_.push_back({axis, 0, finest_m()});
}

double PerlinReflectivity::factor(glm::dvec3 place_m) const {
  double factor = 1;
  for (const Octave& octave : octaves_) {
    const glm::dvec3 p = place_m * octave.per_m;
    factor += octave.amplitude * lattice_(p.x, p.y, p.z);
  }
  return factor;
}

double PerlinReflectivity::largest() const { return 1 + settings_.depth * PerlinLattice::largest; }

double PerlinReflectivity::finest_m() const {
  return std::ldexp(settings_.wavelength_m, 1 - settings_.octaves);
}

double PerlinReflectivity::change(double away_m) const {
  double change = 0;
  for (const Octave& octave : octaves_) {
    const double y = away_m * octave.per_m;
    double noise = 0;
    for (std::size_t k = steepest.size(); k-- > 0;) noise = (noise + steepest[k]) * y;
    change += octave.amplitude * noise;
  }
  return change;
}

}  // namespace tubefoot
