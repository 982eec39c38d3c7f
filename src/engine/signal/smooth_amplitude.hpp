// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/signal/smooth_surface.hpp"
#include "engine/visibility/common_visibility.hpp"
#include "geometry/integrals/edge_form.hpp"
#include "geometry/integrals/path_cut.hpp"

// Coherent echoes of smooth polygons in the Kirchhoff approximation: pressure of a wave e^{ikr}/r that is
// sent, over a surface that reflects all of it (R = 1). docs/smooth-surfaces.md
namespace tubefoot {

/// A polygon's echo as if waves were plane on it, and how far that is from the Kirchhoff integral, proven.
struct FarAmplitude {
  std::complex<double> pressure;  ///< 1/m, of R = 1
  double error = 0;               ///< at most, 1/m; roundings (1e-15 of `most`) aside
  double most = 0;                ///< of the modulus, whatever the phases: area times density
};

/// `polygon`: convex, seen by the apex of the transmit leg; `k` in rad/m.
FarAmplitude far_amplitude(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double k);

/// Amplitudes of smooth polygons at several wave numbers: by plane waves where these are proven to be good
/// enough, by the edges, which need no such condition, elsewhere. Holds scratch memory: one per thread.
/// Law Q6 (near and far): what is farther goes over into what plane waves make.
/// Law Q7 (edges between): polygons of one plane have no edge where they meet.
class SmoothAmplitude {
 public:
  /// Polygons that were taken either way, by wave number.
  struct Count {
    std::size_t far = 0, near = 0;
  };

  /// `wave_numbers_per_m`: 2 pi f / c, positive, increasing. `tolerance`: of the error of plane waves,
  /// relative to the largest amplitude a polygon of that area and place can have; 0: by edges only.
  SmoothAmplitude(std::span<const double> wave_numbers_per_m, double tolerance);

  /// Adds a convex polygon's pressure at each wave number to `out` (1/m). Reflection and roughness count as
  /// at the polygon's place of shortest path.
  void add(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, const SmoothSurface& surface,
           std::span<std::complex<double>> out);

  /// Adds all that both ends of a path see. `surface_of`: of a facet; null: it is rough, without an
  /// amplitude. Facets lie where they are seen (isovelocity water); losses of mirrors and absorption are the
  /// caller's.
  void add(const CommonVisibility& visibility, const std::function<const SmoothSurface*(FacetId)>& surface_of,
           std::span<std::complex<double>> out);

  Count count() const { return count_; }

 private:
  std::vector<double> wave_numbers_;
  double tolerance_;
  std::vector<std::complex<double>> edges_;
  Count count_;
};

/// The polygon's point nearest to the plane's place of shortest path, about the foot point of the transmit
/// leg.
glm::dvec2 place_of_shortest_path(const PlanarPolygon& polygon, const PathCutter::Receiver& rx);
/// The sine that SmoothSurface::factor takes, there.
double mean_sine(const PlanarPolygon& polygon, const PathCutter::Receiver& rx);

/// A transmitted pulse: pressure over time at 1 m, complex (analytic, or at baseband with its carrier).
struct TransmittedPulse {
  std::function<std::complex<double>(double time_s)> pressure;
  /// |pressure(t + i y)| grows no faster than e^{growth |y|}: for a carrier omega in an envelope of width
  /// sigma, omega + 8 / sigma does.
  double growth_per_s = 0;
};

/// Adds a polygon's echo of a pulse at the times given, R = 1: exact in the Kirchhoff approximation, by
/// edges. `sound_speed` in m/s.
void add_pulse_echo(const PlanarPolygon& polygon, const PathCutter::Receiver& rx,
                    const TransmittedPulse& pulse, double sound_speed, std::span<const double> times_s,
                    std::span<std::complex<double>> out);

}  // namespace tubefoot
