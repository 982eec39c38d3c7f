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

// Computes signals of smooth surfaces with proven bounds. Source: docs/notes/smooth-surfaces.md, "Certified
// signals".
namespace tubefoot {

/// Pulse in closed form with energy 1 and a linear frequency sweep. The flanks are those of a raised cosine.
/// Both flanks together take the fraction `taper` of the duration.
struct TaperedChirp {
  double start_hz = 0, stop_hz = 0, duration_s = 0, taper = 0;
};

/// Signals, and bounds of the differences to the true signals, for real and imaginary parts separately. An
/// infinite bound means that there is none.
struct CertifiedSignals {
  ChannelSignals signals;
  std::vector<std::complex<double>> bound;
};

/// Signals of smooth_signals() in ball arithmetic: the pulse along the edges of the visible polygons, with
/// its flanks and the absorption of every path.
class CertifiedSmoothSignals {
 public:
  /// Mesh and apexes of the visible polygons.
  struct Seen {
    const FacetMesh& mesh;
    GridPoint apex;              ///< apex of the tubes, at the polygons' origin
    glm::dvec3 other_apex_m{0};  ///< apex of the receive leg, relative to `apex`
    double grid_unit_m = 0;
  };

  /// `times`: sampling times as given by time_s(). `baseband_hz`: mixing frequency.
  CertifiedSmoothSignals(const Seen& seen, const TaperedChirp& pulse, const SignalTimes& times,
                         double baseband_hz, double sound_speed_m_s)
      : seen_(seen), pulse_(pulse), times_(times), baseband_hz_(baseband_hz), sound_speed_(sound_speed_m_s) {}

  /// Whether a bound exists for the echo of this surface in this channel. The conditions are uniform
  /// patterns, ends at rest, and a reflection factor that does not depend on frequency and angle.
  static bool can_bound(const SmoothSurface& surface, const SignalChannel& channel, const Path& path);

  /// Signals of polygons whose surfaces can be bounded. Polygons without a surface (null) return nothing.
  /// `allowed`: per channel, allowed error of the quadratures of all polygons together. The rest of a bound
  /// comes from the corners. Positions, surfaces, pulse, times and sound speed count as exact doubles. The
  /// result has the same bits for any number of threads.
  /// Law Q12 (certain signals): the exact signals lie within the bounds.
  CertifiedSignals of(const VisiblePolygons& patches, const std::vector<SignalChannel>& channels,
                      double absorption_db_per_m,
                      const std::function<const SmoothSurface*(FacetId)>& surface_of,
                      std::span<const double> allowed) const;

  /// Sets infinite bounds for all samples to which polygons without a bound may contribute. These polygons
  /// certainly do not contribute to the other samples.
  void leave_open(const VisiblePolygons& patches, const std::vector<SignalChannel>& channels,
                  std::span<std::complex<double>> bound) const;

 private:
  Seen seen_;
  TaperedChirp pulse_;
  SignalTimes times_;
  double baseband_hz_, sound_speed_;
};

}  // namespace tubefoot
