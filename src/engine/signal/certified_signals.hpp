// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/scattering/echo_model.hpp"
#include "engine/signal/coherent_signals.hpp"
#include "engine/signal/smooth_surface.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// Signals that are proven. docs/smooth-surfaces.md
namespace tubefoot {

/// A pulse in closed form, of energy 1: frequencies go evenly from one to the other, flanks are a raised
/// cosine's, `taper` the share of the duration that both take.
struct TaperedChirp {
  double start_hz = 0, stop_hz = 0, duration_s = 0, taper = 0;
};

/// Signals and how far the true ones may be from them: of real and imaginary parts each. Infinite: no bound.
struct CertifiedSignals {
  ChannelSignals signals;
  std::vector<std::complex<double>> bound;
};

/// What smooth_signals() computes, in balls: the pulse along the visible polygons' edges, with its flanks and
/// the water's absorption of every path.
class CertifiedSmoothSignals {
 public:
  /// What patches are polygons of.
  struct Seen {
    const FacetMesh& mesh;
    GridPoint apex;              ///< of the tubes, at the patches' origin
    glm::dvec3 other_apex_m{0};  ///< that of the receive leg, from there
    double grid_unit_m = 0;
  };

  /// `times`: those of the samples, told by time_s(). `baseband_hz`: what is mixed with.
  CertifiedSmoothSignals(const Seen& seen, const TaperedChirp& pulse, const SignalTimes& times,
                         double baseband_hz, double sound_speed_m_s)
      : seen_(seen), pulse_(pulse), times_(times), baseband_hz_(baseband_hz), sound_speed_(sound_speed_m_s) {}

  /// Whether there is a bound of what such a surface returns to a channel: uniform patterns, ends at rest,
  /// and a surface that reflects every frequency at every angle alike.
  static bool can_bound(const SmoothSurface& surface, const SignalChannel& channel, const Path& path);

  /// Of patches all of which have a surface that can be bounded, or none (null): these are silent. `allowed`,
  /// by channel: of what quadratures of all patches may be off; what bounds have beyond it is the corners'.
  /// Positions, surfaces, pulse, times and sound speed are taken as the doubles that they are. The same bits
  /// for any number of threads.
  /// Law Q12 (certain signals): exact arithmetic's signals lie within the bounds.
  CertifiedSignals of(const VisiblePolygons& patches, const std::vector<SignalChannel>& channels,
                      double absorption_db_per_m,
                      const std::function<const SmoothSurface*(FacetId)>& surface_of,
                      std::span<const double> allowed) const;

  /// The bounds of samples that may hold something of patches that have none become infinite; the others are
  /// surely silent of them.
  void leave_open(const VisiblePolygons& patches, const std::vector<SignalChannel>& channels,
                  std::span<std::complex<double>> bound) const;

 private:
  Seen seen_;
  TaperedChirp pulse_;
  SignalTimes times_;
  double baseband_hz_, sound_speed_;
};

}  // namespace tubefoot
