// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/counter_random.hpp"

namespace tubefoot {

/// How the many scatterers of a resolution cell interfere. Every law has unit mean: it multiplies an energy.
enum class SpeckleModel {
  none,      ///< 1: the cell's mean energy
  rayleigh,  ///< fully developed: amplitude Rayleigh, energy exponential; gamma of shape L over L looks
  k,         ///< the same times a gamma-distributed texture: few scatterers (Jakeman & Pusey 1976)
};

struct Speckle {
  SpeckleModel model = SpeckleModel::none;
  double shape = 1;  ///< nu of the K law, above 0: the smaller, the spikier; Rayleigh in the limit
  int looks = 1;     ///< independent looks at one texture whose energies are averaged, 1 to 1024
};

/// Gamma variate of unit mean and variance 1 / looks: the mean of that many exponential variates.
double mean_of_exponentials(const SampleRandom& random, int looks);

/// Gamma variate of unit mean and variance 1 / shape, as the quantile of one uniform number.
double gamma_texture(const SampleRandom& random, double shape);

/// Energy of one look-average at a cell: `mean_j` after the speckle, in receiver noise of mean energy
/// `noise_j`. With speckle, signal and noise are both complex Gaussian, and so is their sum. Without it a
/// steady echo stands in the noise (Rice's law). With neither it returns `mean_j`, the very bits.
double received_energy(const SampleRandom& random, const Speckle& speckle, double mean_j, double noise_j);

}  // namespace tubefoot
