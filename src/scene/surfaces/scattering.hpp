// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scattering/scattering_derivative.hpp"
#include "engine/scattering/scattering_model.hpp"

namespace tubefoot {

struct MaterialDescription;
struct SceneDescription;

/// Returns the scattering models of a scene by material; null for Lambert's law, which needs only its mu.
/// Throws InputError for a table that cannot be read. A model that scatters more than it receives at some
/// angle is an error, too, unless the material is `unbounded`. Adds warnings for sensors whose frequency is
/// outside of a sediment's table, and for models that are unbounded by permission.
std::vector<std::shared_ptr<const ScatteringModel>> load_scattering(const SceneDescription& scene,
                                                                    std::vector<std::string>& warnings);

/// A key of a material by which its scattering model has a derivative.
struct ScatteringKey {
  std::string_view name, unit;
  bool is_table = false;  ///< whether the key contains one number per angle of a table
};

/// Returns these keys of a material: those of a GSAB model that the scene sets, and both columns of a table
/// in the scene file. Sediments and tables in separate files have none.
std::vector<ScatteringKey> scattering_keys(const MaterialDescription& material);

/// Returns the derivative by a key of scattering_keys() in its unit. `number`: of the angle in a table. The
/// material must be valid.
ScatteringDerivative scattering_derivative(const MaterialDescription& material, std::string_view key,
                                           std::size_t number);

}  // namespace tubefoot
