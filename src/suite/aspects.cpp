// SPDX-License-Identifier: GPL-3.0-or-later
// Version 2 of the benchmark suite. Its debug set is published, so that these texts do not change.
#include <array>

#include "suite/suite_scene.hpp"

namespace tubefoot {

SuiteVersion second_version() {
  static constexpr std::array all{
      Aspect{"range-law", "how echoes fall with range, and the unit of energy", range_law_scene},
      Aspect{"absorption", "loss in the water, both ways", absorption_scene},
      Aspect{"grazing", "how a bed's echo falls with the grazing angle", grazing_scene},
      Aspect{"even-angles", "beams that are even in angle", equiangular_scene},
      Aspect{"even-tangents", "beams that are even in tangent, as pixels of a flat picture are",
             equidistant_scene},
      Aspect{"listed-angles", "beams of a list of angles", listed_angles_scene},
      Aspect{"side-lobes", "what a beam hears beside its main lobe", side_lobes_scene},
      Aspect{"near-plane", "shadow of what is nearer than the first sample", near_plane_scene},
      Aspect{"thin-wall", "things thinner than any sampling", thin_wall_scene},
      Aspect{"silhouettes", "edges of round things and of their shadows", silhouettes_scene},
      Aspect{"occlusion-order", "which of several things is in front, one through the other included",
             occlusion_order_scene},
      Aspect{"large-flat", "large facets, far from the origin", large_flat_scene},
      Aspect{"many-small", "facets smaller than a beam", many_small_scene},
      Aspect{"terrain", "rough ground that hides parts of itself", terrain_scene},
      Aspect{"moving-sonar", "where and which way the sonar looks at each ping", moving_sonar_scene},
      Aspect{"layered-water", "bent rays, in water whose sound speed changes with depth",
             layered_water_scene},
      Aspect{"surface-multiple", "two and three bounces, over a sea surface that mirrors",
             surface_multiple_scene},
      Aspect{"two-scatterings", "two bounces, from one plate to another and back", two_scatterings_scene},
      Aspect{"receivers-apart", "a receiver that is not where the transmitter is", separate_receivers_scene},
  };
  return {2,
          all,
          "2.0",
          "# Reference pack v2: README.md says in plain words what this is, scene.json in numbers.\n",
          "tubefoot reference pack",
          {},
          true};
}

}  // namespace tubefoot
