// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"

// Checked arguments of derivatives of energies.
namespace tubefoot {

/// Derivative of the absorption per metre by the one-way absorption in dB/m.
constexpr double per_db = std::numbers::ln10 / 10;

/// Throws std::invalid_argument.
[[noreturn]] void reject_gradient(const std::string& what);
/// Throws std::invalid_argument for weights of another number and for a weight that is not finite.
void check_weights(std::span<const double> weights, const ReceiveBeams& beams, const RangeSamples& samples);

/// Parameters of scattering models by material.
class ScatteringParameters {
 public:
  /// `model` must outlive this object.
  explicit ScatteringParameters(const EchoModel& model)
      : of_material(model.material_mu.size()), numbers(model.material_mu.size()), model_(model) {}
  /// Throws std::invalid_argument for a material without a scattering model.
  void add(const MaterialParameter& parameter);

  std::vector<std::vector<const ScatteringDerivative*>> of_material;
  std::vector<std::vector<std::size_t>> numbers;  ///< in the order of add()
  std::size_t count = 0;

 private:
  const EchoModel& model_;
};

}  // namespace tubefoot
