// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/receiver/speckle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tubefoot {
namespace {

/// Energy of a steady echo in complex Gaussian noise. `draw`: number of the random pair.
double look_in_noise(const SampleRandom& random, int draw, double echo_j, double noise_j) {
  const auto [first, second] = random.uniform_pair(Purpose::noise, static_cast<std::uint32_t>(draw));
  const double noise = -noise_j * std::log(first);  // Box-Muller: energy and phase of the noise
  return echo_j + noise + 2 * std::sqrt(echo_j * noise) * std::cos(2 * std::numbers::pi * second);
}

/// The mean over the looks, each with its own noise.
double echo_in_noise(const SampleRandom& random, int looks, double echo_j, double noise_j,
                     int first_draw = 0) {
  double sum = 0;
  for (int look = 0; look < looks; ++look) sum += look_in_noise(random, first_draw + look, echo_j, noise_j);
  return std::max(0.0, sum / looks);
}

/// The exponential variates whose mean is mean_of_exponentials().
double exponential(const SampleRandom& random, int look) {
  return -std::log(
      random.uniform_pair(Purpose::speckle, static_cast<std::uint32_t>(look / 2))[look % 2 == 0 ? 0 : 1]);
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

double lower_received_energy(const SampleRandom& random, const Speckle& speckle, double upper_j,
                             double lower_j, double product_j, double noise_j) {
  if (lower_j == 0 && noise_j == 0) return 0;
  if (speckle.model == SpeckleModel::none)  // the upper receiver has the first draws
    return noise_j > 0 ? echo_in_noise(random, speckle.looks, lower_j, noise_j, speckle.looks) : lower_j;
  const double texture = speckle.model == SpeckleModel::k ? gamma_texture(random, speckle.shape) : 1,
               upper = upper_j * texture + noise_j, lower = lower_j * texture + noise_j,
               product = product_j * texture;
  // The square root precedes the product, because squares of small energies underflow.
  const double coherence = upper > 0 && lower > 0 ? product / std::sqrt(upper) / std::sqrt(lower) : 0,
               common = std::min(1.0, coherence * coherence);
  double sum = 0;
  for (int look = 0; look < speckle.looks; ++look)
    sum += look_in_noise(random, look, lower * common * exponential(random, look), lower * (1 - common));
  return std::max(0.0, sum / speckle.looks);
}

}  // namespace tubefoot
