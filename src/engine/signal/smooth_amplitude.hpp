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

// Computes coherent echoes of smooth polygons in the Kirchhoff approximation. The result is the pressure of a
// transmitted wave e^{ikr}/r after reflection with the coefficient R = 1. Source:
// docs/notes/smooth-surfaces.md.
namespace tubefoot {

/// Echo of a polygon for plane waves, with a proven bound of the difference to the Kirchhoff integral.
struct FarAmplitude {
  std::complex<double> pressure;  ///< in 1/m, for R = 1
  double error = 0;               ///< bound in 1/m, except for rounding (1e-15 of `most`)
  double most = 0;                ///< bound of the modulus for any phases: area times density
};

/// `polygon`: convex, visible from the apex of the transmit leg. `k`: in rad/m.
FarAmplitude far_amplitude(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, double k);

/// Amplitudes of smooth polygons at several wave numbers. The plane-wave form is used if its error bound
/// meets the tolerance, and otherwise the edge form, which has no such condition. Contains scratch memory:
/// use one object per thread.
/// Law Q6 (near and far): with increasing distance the amplitude converges to the plane-wave form.
/// Law Q7 (edges between): polygons of one plane have no edge echo at a common edge.
class SmoothAmplitude {
 public:
  /// Numbers of polygons computed in each form, summed over the wave numbers.
  struct Count {
    std::size_t far = 0, near = 0;
  };

  /// `wave_numbers_per_m`: 2 pi f / c, positive and increasing. `tolerance`: error of plane waves, relative
  /// to the largest amplitude of a polygon with the same area and place; 0: edge form only.
  SmoothAmplitude(std::span<const double> wave_numbers_per_m, double tolerance);

  /// Adds the pressure of a convex polygon at each wave number to `out`, in 1/m. Reflection and roughness
  /// are those at the polygon's place of shortest path.
  void add(const PlanarPolygon& polygon, const PathCutter::Receiver& rx, const SmoothSurface& surface,
           std::span<std::complex<double>> out);

  /// Adds the pressures of all polygons of a common visibility. `surface_of`: surface of a facet; null:
  /// rough, no coherent amplitude. For isovelocity water only. The caller applies mirror losses and
  /// absorption.
  void add(const CommonVisibility& visibility, const std::function<const SmoothSurface*(FacetId)>& surface_of,
           std::span<std::complex<double>> out);

  Count count() const { return count_; }

 private:
  std::vector<double> wave_numbers_;
  double tolerance_;
  std::vector<std::complex<double>> edges_;
  Count count_;
};

/// Point of the polygon that is nearest to the plane's place of shortest path, relative to the foot point of
/// the transmit leg.
glm::dvec2 place_of_shortest_path(const PlanarPolygon& polygon, const PathCutter::Receiver& rx);
/// Sine for SmoothSurface::factor at this point.
double mean_sine(const PlanarPolygon& polygon, const PathCutter::Receiver& rx);

/// Transmitted pulse: pressure over time at 1 m, complex (analytic, or at baseband including its carrier).
struct TransmittedPulse {
  std::function<std::complex<double>(double time_s)> pressure;
  /// Bound: |pressure(t + i y)| grows no faster than e^{growth |y|}. For a carrier omega in an envelope of
  /// width sigma, omega + 8 / sigma is sufficient.
  double growth_per_s = 0;
};

/// Adds the echo of a pulse from a polygon at the given times, for R = 1. The edge form is exact in the
/// Kirchhoff approximation. `sound_speed`: in m/s.
void add_pulse_echo(const PlanarPolygon& polygon, const PathCutter::Receiver& rx,
                    const TransmittedPulse& pulse, double sound_speed, std::span<const double> times_s,
                    std::span<std::complex<double>> out);

}  // namespace tubefoot
