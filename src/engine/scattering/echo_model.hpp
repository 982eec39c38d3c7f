// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/scattering/beam_pattern.hpp"
#include "engine/scattering/path.hpp"
#include "engine/scattering/reflectivity_field.hpp"
#include "engine/scattering/scattering_model.hpp"

namespace tubefoot {

/// What lies on a facet.
struct SurfaceProperties {
  double factor = 1;                            ///< of whatever law (Path::facet_factor)
  double mu = 0;                                ///< Lambert's, times the factor
  const ScatteringModel* scattering = nullptr;  ///< null: Lambert's
  const ReflectivityField* texture = nullptr;   ///< null: even

  /// There and back at one grazing angle.
  double cross_section(double sine, double cosine) const {
    return scattering != nullptr ? factor * scattering->cross_section(sine, cosine) : mu * sine * sine;
  }
};

/// How a path's energy follows from its geometry: a scattering model per material, spherical spreading both
/// ways, absorption both ways. Source energy: 1 J/sr at 1 m.
struct EchoModel {
  std::span<const double> material_mu;      ///< Lambert parameter mu (linear) by material
  std::span<const std::uint16_t> material;  ///< material by facet
  double absorption_db_per_m = 0;           ///< one way
  const BeamPatterns* patterns = nullptr;   ///< none: beams are ideal, 1 inside their tubes and 0 outside
  /// With patterns or micro-texture: error of an energy relative to what its footprints would return at the
  /// patterns' peak from an even seabed, 1e-12 to 0.01 (pattern_integral.hpp).
  double pattern_tolerance = 1e-6;
  /// Micro-texture by material; empty, or null where a material is even. It is a function of position in the
  /// local frame.
  std::span<const std::shared_ptr<const ReflectivityField>> reflectivity{};
  Path path{};
  /// Scattering laws by material; empty, or null where a material is Lambert's by `material_mu`.
  std::span<const std::shared_ptr<const ScatteringModel>> scattering{};

  /// Micro-texture of a facet that has a material; none: even.
  const ReflectivityField* texture(FacetId facet) const {
    return reflectivity.empty() ? nullptr : reflectivity[material[facet]].get();
  }
  /// The law of a facet that has a material; null: Lambert's.
  const ScatteringModel* model_of(std::size_t facet) const {
    return scattering.empty() ? nullptr : scattering[material[facet]].get();
  }
  /// Throws std::invalid_argument for a facet without material, or one that the path does not know.
  SurfaceProperties seabed(FacetId facet) const;
};

/// Throws std::invalid_argument for lists that do not fit each other, or values that are none.
void check(const EchoModel& model);

/// beta [1/m] of the one-way energy factor exp(-beta r) = 10^(-alpha r / 10), alpha in dB/m.
double absorption_per_m(double absorption_db_per_m);

/// The patterns by directions that images send in and receive from: those of the true apexes are the
/// patterns' own.
BeamPatterns as_images_have(const BeamPatterns& patterns, const Path& path);

/// The patterns of one fan of two receivers (one beam) alone, for `tubes` tubes of it.
BeamPatterns patterns_of_fan(const BeamPatterns& patterns, std::uint32_t fan, std::size_t tubes);

}  // namespace tubefoot
