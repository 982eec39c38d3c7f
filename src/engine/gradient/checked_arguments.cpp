// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/checked_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tubefoot {

void reject_gradient(const std::string& what) { throw std::invalid_argument("gradient: " + what); }

void check_weights(std::span<const double> weights, const ReceiveBeams& beams, const RangeSamples& samples) {
  if (weights.size() != std::size_t(beams.count) * std::size_t(samples.count))
    reject_gradient(fmt::format("there are {} weights, expected {} x {}: one per beam and range bin",
                                weights.size(), beams.count, samples.count));
  if (const auto bad = std::ranges::find_if_not(weights, [](double w) { return std::isfinite(w); });
      bad != weights.end())
    reject_gradient(fmt::format("weight {} is {}, expected a finite number", bad - weights.begin(), *bad));
}

void ScatteringParameters::add(const MaterialParameter& parameter) {
  if (parameter.material >= model_.material_mu.size())
    reject_gradient(
        fmt::format("there is no material {} (there are {})", parameter.material, model_.material_mu.size()));
  if (model_.scattering.empty() || model_.scattering[parameter.material] == nullptr)
    reject_gradient(fmt::format("material {} has Lambert's law, which has no other parameter than mu",
                                parameter.material));
  of_material[parameter.material].push_back(&parameter.derivative);
  numbers[parameter.material].push_back(count++);
}

}  // namespace tubefoot
