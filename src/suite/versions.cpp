// SPDX-License-Identifier: GPL-3.0-or-later
// The versions of the benchmark suite: their scenes, and the differences between their files.
#include <fmt/format.h>

#include <array>

#include "files/usage_error.hpp"
#include "suite/suite_scene.hpp"

namespace tubefoot {
namespace {

constexpr std::array third{
    Aspect{"range-law", "the decrease of echoes with range, and the unit of energy", range_law_scene},
    Aspect{"absorption", "two-way absorption", absorption_scene},
    Aspect{"grazing", "the dependence of the seabed echo on the grazing angle", grazing_scene},
    Aspect{"even-angles", "equiangular beams", equiangular_scene},
    Aspect{"even-tangents", "equidistant beams, like the pixels of a plane image", equidistant_scene},
    Aspect{"listed-angles", "beams with given angles", listed_angles_scene},
    Aspect{"side-lobes", "the energy that a beam receives outside of its main lobe", side_lobes_scene},
    Aspect{"near-plane", "the shadow of an object that is nearer than the first sample", near_plane_scene},
    Aspect{"thin-wall", "a wall that is thinner than the distance of samples", thin_wall_scene},
    Aspect{"silhouettes", "the edges of a sphere and of its shadow", silhouettes_scene},
    Aspect{"occlusion-order", "the order of plates that hide or intersect each other", occlusion_order_scene},
    Aspect{"large-flat", "large facets far from the origin", large_flat_scene},
    Aspect{"many-small", "objects that are smaller than a beam", many_small_scene},
    Aspect{"terrain", "rough terrain that hides parts of itself", terrain_scene},
    Aspect{"moving-sonar", "the position and direction of the sonar at each ping", moving_sonar_scene},
    Aspect{"layered-water", "refraction by a sound speed that changes with depth", layered_water_scene},
    Aspect{"surface-multiple", "paths with two and three reflections at the sea surface",
           surface_multiple_scene},
    Aspect{"two-scatterings", "scattering from one plate to another and back", two_scatterings_scene},
    Aspect{"receivers-apart", "a receiver next to the transmitter", separate_receivers_scene},
    Aspect{"volume", "scattering in the water", volume_scene},
    Aspect{"half-sample", "ranges to a fraction of a sample", half_sample_scene},
    Aspect{"sectors", "the tilt, time and absorption of each transmit sector", transmit_sectors_scene},
    Aspect{"moving-object", "the position of a moving object at each ping", moving_object_scene},
    Aspect{"gradient", "derivatives of energies, with the motion of edges and shadows", derivatives_scene},
    Aspect{"shadow-border", "diffraction at the border of a shadow", shadow_border_scene},
    Aspect{"strength-m3", "the target strength of a convex body", strength_m3_scene},
    Aspect{"strength-m5a", "the target strength of two bodies side by side", strength_m5a_scene},
    Aspect{"strength-m5b", "the target strength of two bodies that hide each other", strength_m5b_scene},
};

}  // namespace

const SuiteVersion& suite_version(int number) {
  static const std::array versions{
      second_version(),
      SuiteVersion{
          newest_suite, third, "3.0",
          "# Benchmark suite v3: README.md describes the scene in words, and scene.json in numbers.\n",
          "tubefoot benchmark suite", 0.5}};
  for (const SuiteVersion& version : versions)
    if (version.number == number) return version;
  throw UsageError(fmt::format(
      "--version {}: there is no such suite: expected 2 or 3; version 1 is a folder of the source "
      "code (validation/reference/v1)",
      number));
}

}  // namespace tubefoot
