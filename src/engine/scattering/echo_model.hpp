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

/// Scattering properties of a facet.
struct SurfaceProperties {
  double factor = 1;                            ///< factor of any scattering model (Path::facet_factor)
  double mu = 0;                                ///< Lambert parameter times the factor
  const ScatteringModel* scattering = nullptr;  ///< null: Lambert's law
  const ReflectivityField* texture = nullptr;   ///< null: uniform

  /// Returns the cross-section for equal grazing angles of both legs.
  double cross_section(double sine, double cosine) const {
    return scattering != nullptr ? factor * scattering->cross_section(sine, cosine) : mu * sine * sine;
  }
};

/// The relation between a path's geometry and its energy: a scattering model per material, and spherical
/// spreading and absorption on both legs. The source energy is 1 J/sr at 1 m.
struct EchoModel {
  std::span<const double> material_mu;      ///< Lambert parameter mu (linear) per material
  std::span<const std::uint16_t> material;  ///< material per facet
  double absorption_db_per_m = 0;           ///< one way
  const BeamPatterns* patterns = nullptr;   ///< null: beams are ideal, 1 inside their tubes and 0 outside
  /// With patterns or micro-texture: permitted error of an energy, 1e-12 to 0.01. It is relative to the
  /// energy that the same footprints would return at the patterns' peak from a uniform seabed
  /// (pattern_integral.hpp).
  double pattern_tolerance = 1e-6;
  /// Micro-texture per material, a function of position in the local frame. Empty for no texture; null for a
  /// uniform material.
  std::span<const std::shared_ptr<const ReflectivityField>> reflectivity{};
  Path path{};
  /// Scattering models per material. Empty for none; null for a material with Lambert's law and
  /// `material_mu`.
  std::span<const std::shared_ptr<const ScatteringModel>> scattering{};

  /// Returns the micro-texture of a facet that has a material; null: uniform.
  const ReflectivityField* texture(FacetId facet) const {
    return reflectivity.empty() ? nullptr : reflectivity[material[facet]].get();
  }
  /// Returns the scattering model of a facet that has a material; null: Lambert's law.
  const ScatteringModel* model_of(std::size_t facet) const {
    return scattering.empty() ? nullptr : scattering[material[facet]].get();
  }
  /// Throws std::invalid_argument for a facet without material, or one that is missing in the path.
  SurfaceProperties seabed(FacetId facet) const;
};

/// Throws std::invalid_argument for lists of different lengths or invalid values.
void check(const EchoModel& model);

/// Returns beta [1/m] of the one-way energy factor exp(-beta r) = 10^(-alpha r / 10), alpha in dB/m.
double absorption_per_m(double absorption_db_per_m);

/// Returns the patterns as functions of directions at the image apexes. `patterns` refers to directions at
/// the true apexes.
BeamPatterns as_images_have(const BeamPatterns& patterns, const Path& path);

/// Returns the patterns of one fan of two receivers (one beam) alone, for `tubes` tubes of it.
BeamPatterns patterns_of_fan(const BeamPatterns& patterns, std::uint32_t fan, std::size_t tubes);

}  // namespace tubefoot
