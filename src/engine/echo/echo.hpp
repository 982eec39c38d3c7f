// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "engine/law/beam_pattern.hpp"
#include "engine/law/facet_map.hpp"
#include "engine/law/reflectivity_field.hpp"
#include "engine/law/scattering_law.hpp"
#include "engine/sight/history.hpp"

namespace tubefoot {

/// Range samples of a receiver: sample k covers slant ranges [first + k step, first + (k+1) step).
struct RangeSamples {
  double first_m = 0;
  double step_m = 0;
  int count = 0;
};

/// How a path's energy follows from its geometry: a scattering law per material, spherical spreading both
/// ways, absorption both ways. Source energy: 1 J/sr at 1 m.
struct EchoLaw {
  std::span<const double> material_mu;      ///< Lambert parameter mu (linear) by material
  std::span<const std::uint16_t> material;  ///< material by facet
  double absorption_db_per_m = 0;           ///< one way
  const BeamPatterns* patterns = nullptr;   ///< none: beams are ideal, 1 inside their tubes and 0 outside
  /// With patterns or micro-texture: error of an energy relative to what its footprints would return at the
  /// patterns' peak from an even bed, 1e-12 to 0.01 (pattern_integral.hpp).
  double pattern_tolerance = 1e-6;
  /// Micro-texture by material; empty, or null where a material is even. It is a function of position in the
  /// local frame, where the history's apex is at `apex_m`.
  std::span<const std::shared_ptr<const ReflectivityField>> reflectivity{};
  glm::dvec3 apex_m{0};
  /// Scattering laws by material; empty, or null where a material is Lambert's by `material_mu`.
  std::span<const std::shared_ptr<const ScatteringLaw>> scattering{};

  /// Micro-texture of a facet that has a material; none: even.
  const ReflectivityField* texture(FacetId facet) const {
    return reflectivity.empty() ? nullptr : reflectivity[material[facet]].get();
  }
  /// The law of a facet that has a material; null: Lambert's.
  const ScatteringLaw* law_of(std::size_t facet) const {
    return scattering.empty() ? nullptr : scattering[material[facet]].get();
  }
  /// By facet: what it returns over what the straight law makes of it (apparent facets in refracting water,
  /// engine/water/straightening.hpp); empty: 1.
  std::span<const double> facet_factor{};
  /// By facet: where it lies, for textures (apparent facets); empty: where it is seen.
  std::span<const FacetMap> facet_map{};

  /// Where a place on a facet lies that is seen `from_apex_m`; local frame.
  glm::dvec3 true_place(FacetId facet, glm::dvec3 from_apex_m) const {
    return facet_map.empty() ? apex_m + from_apex_m : facet_map[facet].at(from_apex_m);
  }
  LyingPlane lying(FacetId facet, const FacetPlane& plane, const PlaneFrame& frame) const {
    return facet_map.empty() ? LyingPlane(plane, frame, apex_m) : LyingPlane(plane, frame, facet_map[facet]);
  }
};

/// How a footprint's energy gets into range samples.
enum class Binning {
  exact,     ///< cut at the samples' borders, integrated over each part
  spread,    ///< the law at the centroid, evenly over the footprint's interval of slant range
  centroid,  ///< the law at the centroid, all in the sample that holds the centroid's slant range
};

/// Name as in scene files; throws std::invalid_argument.
Binning binning_from_name(std::string_view name);

/// Energy [J] per beam and range sample of one ping, beam-major: energy[beam * samples + sample]. With
/// fringes (BeamPatterns) that is what the upper receiver hears, and three more such blocks follow.
struct Echo {
  int beams = 0;
  int samples = 0;
  std::vector<double> energy;
  double at(int beam, int sample) const { return energy[std::size_t(beam) * samples + sample]; }
};

/// Turns a history into the echo of a receiver whose beams are unions of tubes.
/// `beam_of_tube[t]` is the beam that tube t belongs to. Footprints are cut at the range samples' borders
/// (arcs on the facet), or binned as `binning` says, which reads what measure() filled; ray hits fall into
/// the sample that holds their range. Micro-texture is integrated with exact binning, taken at the centroid
/// with any other, and at a hit. With patterns the energy from an area element is weighed by transmit
/// and receive pattern in its own direction, and a beam hears the tubes that `law.patterns->beams_of_tube`
/// says.
Echo integrate_echo(const History& history, std::span<const std::uint32_t> beam_of_tube, int beams,
                    const RangeSamples& samples, const EchoLaw& law, Binning binning = Binning::exact);

}  // namespace tubefoot
