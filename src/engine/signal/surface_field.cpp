// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/signal/surface_field.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace tubefoot {

double SurfaceField::texture_of(glm::dvec3 cell) const {
  if (texture == SurfaceTexture::none) return 1;
  const double uniform =
      SampleRandom(seed, std::uint32_t(std::int64_t(cell.z)), std::uint32_t(std::int64_t(cell.y)),
                   std::uint32_t(std::int64_t(cell.x)))
          .uniform_pair(Purpose::surface_texture)[0];
  if (texture == SurfaceTexture::gamma) return gamma_quantile(uniform, shape);
  const double log_variance = std::log1p(1 / shape);
  return std::exp(std::sqrt(log_variance) * normal_quantile(uniform) - log_variance / 2);
}

namespace {

/// Least cosine between a plane's normal and the axis that the plane faces most. It is slightly below 1 /
/// sqrt 3 because of the weights of lattice_axis().
constexpr double least_cosine = 0.5689;

void check_seen(double bandwidth_hz, double wavelength_m, double sound_speed_m_s, double look_angles_rad,
                double grazing_cosine) {
  if (!(bandwidth_hz > 0 && wavelength_m > 0 && sound_speed_m_s > 0 && look_angles_rad > 0 &&
        grazing_cosine > 0))
    throw std::invalid_argument(
        fmt::format("the density of a scatterer field needs a bandwidth, a wavelength, a sound speed, look "
                    "angles and a cosine above 0, not {} Hz, {} m, {} m/s, {} rad and {}",
                    bandwidth_hz, wavelength_m, sound_speed_m_s, look_angles_rad, grazing_cosine));
}

}  // namespace

double surface_spacing_m(double bandwidth_hz, double wavelength_m, double sound_speed_m_s,
                         double look_angles_rad, double grazing_cosine) {
  check_seen(bandwidth_hz, wavelength_m, sound_speed_m_s, look_angles_rad, grazing_cosine);
  const double per_m2 =
      2 * bandwidth_hz * grazing_cosine / sound_speed_m_s * (2 * look_angles_rad / wavelength_m);
  return std::sqrt(least_cosine / per_m2);
}

double speckle_spacing_m(double bandwidth_hz, double wavelength_m, double sound_speed_m_s,
                         double look_angles_rad, double grazing_cosine) {
  check_seen(bandwidth_hz, wavelength_m, sound_speed_m_s, look_angles_rad, grazing_cosine);
  // A focus with a uniform spectrum over a by b wavenumbers has the weights sinc^2 (a x) sinc^2 (b y).
  // Consider their sum over places that are uniformly distributed over cells of spacing d. Its variance is
  // pi^2 d^4 (2/3) (1/15) (a^3 b + a b^3) / 3 of its squared mean, minus terms of higher orders
  // (docs/notes/signals.md).
  constexpr double variance = 0.007, per_spacing4 = 9.8696 * 2 / 3 / 15 / 3;
  const double along = 2 * bandwidth_hz * grazing_cosine / sound_speed_m_s,
               across = 2 * look_angles_rad / wavelength_m;
  return std::pow(variance / (per_spacing4 * along * across * (along * along + across * across)), 0.25) *
         std::sqrt(least_cosine);
}

void check(const SurfaceField& field) {
  const auto wrong = [](double value) { return !(value > 0 && std::isfinite(value)); };
  if (wrong(field.spacing_m))
    throw std::invalid_argument(fmt::format(
        "the spacing of a scatterer field must be above 0 and finite, not {} m", field.spacing_m));
  if (field.texture != SurfaceTexture::none && (wrong(field.shape) || wrong(field.texture_cell_m)))
    throw std::invalid_argument(fmt::format(
        "the texture of a scatterer field needs a shape and cells above 0 and finite, not {} and {} m",
        field.shape, field.texture_cell_m));
}

void check_reach(const SurfaceField& field, glm::dvec3 place_m) {
  const double farthest =
      0x1p31 * std::min(field.spacing_m,
                        field.texture == SurfaceTexture::none ? field.spacing_m : field.texture_cell_m);
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(place_m[axis]) < farthest))
      throw std::invalid_argument(
          fmt::format("a scatterer field with a spacing of {} m reaches only {} m from the origin of the "
                      "frame, but a coordinate is {} m: use a larger spacing or a nearer origin",
                      field.spacing_m, farthest, place_m[axis]));
}

}  // namespace tubefoot
