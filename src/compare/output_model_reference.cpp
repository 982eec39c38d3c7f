// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/output_model_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

std::vector<double> bounds_of(const SensorEchoes& sensor) {
  if (!sensor.slant_range_bounds_m.empty()) return sensor.slant_range_bounds_m;
  std::vector<double> bounds;
  const std::vector<double>& centres = sensor.slant_range_m;
  const double step = centres.size() > 1 ? centres[1] - centres[0] : 0;
  for (const double centre : centres) {
    bounds.push_back(centre - step / 2);
    bounds.push_back(centre + step / 2);
  }
  return bounds;
}

/// Converts energies sigma dOmega / r^2 to solid angles. The bound contains r^2 at both ends of the sample.
void put_solid_angles(BoundedPicture& picture, const SensorEchoes& energies, double strength_db) {
  const double strength = std::pow(10, strength_db / 10);
  for (std::size_t bin = 0; bin < energies.energy.size(); ++bin) {
    const std::size_t s = bin % picture.shape.samples;
    const double first = picture.slant_range_bounds_m[2 * s], last = picture.slant_range_bounds_m[2 * s + 1],
                 middle = (first + last) / 2, energy = energies.energy[bin] / strength,
                 bound = energies.energy_bound.empty() ? 0 : energies.energy_bound[bin] / strength;
    const double low = std::max(energy - bound, 0.0) * first * first, high = (energy + bound) * last * last;
    picture.solid_angle_sr.push_back(energy * middle * middle);
    picture.solid_angle_bound_sr.push_back(
        std::max(high - energy * middle * middle, energy * middle * middle - low));
  }
}

}  // namespace

bool needs_solid_angles(const OutputModel& output_model) {
  return std::ranges::any_of(output_model.steps, [](const OutputModelStep& step) {
    return std::holds_alternative<MeanStep>(step.kind) || std::holds_alternative<CountStep>(step.kind);
  });
}

void apply_output_model(const OutputModel& output_model, EchoContents& reference, const EchoPairs& pairs,
                        const std::optional<EchoContents>& own_angles) {
  std::optional<EchoContents> angles = own_angles;
  const double strength_db = own_angles ? 0 : output_model.solid_angle_strength_db;
  if (!angles && output_model.solid_angles) angles = read_echo_file(*output_model.solid_angles);
  for (const EchoPairs::Sensor& pair : pairs.sensors) {
    const auto sensor =
        std::ranges::find_if(reference.sensors, [&](const SensorEchoes& s) { return &s == pair.reference; });
    BoundedPicture picture{{sensor->pings, sensor->beams, sensor->samples},
                           sensor->energy,
                           sensor->energy_bound,
                           bounds_of(*sensor),
                           {},
                           {}};
    if (angles) {
      const EchoPairs matched = pair_echoes(reference, *angles, sensor->name, true);
      put_solid_angles(picture, *matched.sensors.front().candidate, strength_db);
    }
    for (const OutputModelStep& step : output_model.steps) apply(step, picture);
    sensor->energy = std::move(picture.value);
    sensor->energy_bound = std::move(picture.bound);
  }
}

}  // namespace tubefoot
