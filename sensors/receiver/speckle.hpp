// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/scattering/counter_random.hpp"

namespace tubefoot {

/// Statistical model of the interference of the many scatterers in a resolution cell. Every model is a
/// factor of energy with unit mean.
enum class SpeckleModel {
  none,      ///< factor 1: the cell's mean energy
  rayleigh,  ///< fully developed: Rayleigh amplitude, exponential energy; gamma of shape L over L looks
  k,         ///< fully developed speckle times a gamma-distributed texture: few scatterers (Jakeman & Pusey
             ///< 1976)
};

struct Speckle {
  SpeckleModel model = SpeckleModel::none;
  double shape = 1;  ///< nu of the K distribution, above 0: smaller values are spikier; Rayleigh in the
                     ///< limit
  int looks = 1;     ///< number of independent looks at one texture whose energies are averaged, 1 to 1024
};

/// Gamma variate of unit mean and variance 1 / looks: the mean of that many exponential variates.
double mean_of_exponentials(const SampleRandom& random, int looks);

/// Gamma variate of unit mean and variance 1 / shape, as the quantile of one uniform number.
double gamma_texture(const SampleRandom& random, double shape);

/// Average energy over the looks at a cell: `mean_j` after the speckle, in receiver noise of mean energy
/// `noise_j`. With speckle, signal and noise are both complex Gaussian, and so is their sum. Without speckle
/// a steady echo has Rice's distribution in the noise. Without both the result is bitwise `mean_j`.
double received_energy(const SampleRandom& random, const Speckle& speckle, double mean_j, double noise_j);

/// Average energy over the looks at the lower receiver of a pair; received_energy() draws that of the upper.
/// `product_j` is the absolute mean product of their signals. With speckle, both signals are complex
/// Gaussian. Given the upper signal, the lower one is a steady part with the share g^2 of the energy, and
/// noise. Here g is the coherence, including receiver noise. The energies of one look have the correlation
/// g^2. Both receivers have the same texture and independent noise.
double lower_received_energy(const SampleRandom& random, const Speckle& speckle, double upper_j,
                             double lower_j, double product_j, double noise_j);

}  // namespace tubefoot
