// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/receiver/speckle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tubefoot {
namespace {

/// Mean energy of a steady echo in complex Gaussian noise over the looks, each with its own noise.
double echo_in_noise(const SampleRandom& random, int looks, double echo_j, double noise_j) {
  double sum = 0;
  for (int look = 0; look < looks; ++look) {
    const auto [first, second] = random.uniform_pair(Purpose::noise, static_cast<std::uint32_t>(look));
    const double noise = -noise_j * std::log(first);  // Box-Muller: energy and phase of the noise
    sum += echo_j + noise + 2 * std::sqrt(echo_j * noise) * std::cos(2 * std::numbers::pi * second);
  }
  return std::max(0.0, sum / looks);
}

}  // namespace

double mean_of_exponentials(const SampleRandom& random, int looks) {
  double sum = 0;
  for (int look = 0; look < looks; look += 2) {
    const auto pair = random.uniform_pair(Purpose::speckle, static_cast<std::uint32_t>(look / 2));
    sum -= std::log(pair[0]);
    if (look + 1 < looks) sum -= std::log(pair[1]);
  }
  return sum / looks;
}

double gamma_texture(const SampleRandom& random, double shape) {
  return gamma_quantile(random.uniform_pair(Purpose::texture)[0], shape);
}

double received_energy(const SampleRandom& random, const Speckle& speckle, double mean_j, double noise_j) {
  if (mean_j == 0 && noise_j == 0) return 0;
  switch (speckle.model) {
    case SpeckleModel::rayleigh:
      return (mean_j + noise_j) * mean_of_exponentials(random, speckle.looks);
    case SpeckleModel::k:
      return (mean_j * gamma_texture(random, speckle.shape) + noise_j) *
             mean_of_exponentials(random, speckle.looks);
    case SpeckleModel::none:
      break;
  }
  return noise_j > 0 ? echo_in_noise(random, speckle.looks, mean_j, noise_j) : mean_j;
}

}  // namespace tubefoot
