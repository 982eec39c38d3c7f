// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/echo/echo.hpp"
#include "engine/echo/volume_regions.hpp"
#include "engine/scattering/volume_scattering.hpp"
#include "engine/visibility/history.hpp"
#include "engine/water/water_column.hpp"

namespace tubefoot {

/// Returns the volume reverberation that a sensor receives, in J/m^2 for 1 J/sr at 1 m. It is the echo of the
/// water in front of all surfaces. With the distances r from the apex and the unobstructed solid angle
/// Omega(r), weighted by the beam patterns, a range sample receives
///
///     integral of s_v Omega(r) r^-2 e^(-2 beta r) dr.
///
/// The visible polygons give Omega(r) exactly (VolumeRegions). `history`: footprints of one apex in
/// isovelocity water, with unobstructed regions (VisibilityOptions::open_water) if needs_open_water().
/// `volume`: heights in the local frame. `model`: apex, absorption and patterns; materials are not read.
/// Without patterns, the error is about that of rounding. With patterns it is model.pattern_tolerance,
/// relative to the echo if all water had the largest coefficient. Throws std::invalid_argument for samples
/// that begin at range 0, where the integral is infinite.
Echo volume_echo(const History& history, const ReceiveBeams& beams, const RangeSamples& samples,
                 const EchoModel& model, const VolumeScattering& volume);

/// Returns whether volume_echo() needs the unobstructed regions of the history. In uniform water with ideal
/// beams, the solid angle of the tubes minus that of the visible polygons suffices.
bool needs_open_water(const VolumeScattering& volume, bool has_patterns);

/// Water in which rays are arcs of circles.
struct RefractingWater {
  const WaterColumn& column;
  double surface_height_m;
  double reference_speed_m_s;  ///< of ranges: travel time multiplied by this speed
};

/// The same in stratified water. `history`: on apparent positions, whose directions are those of launch and
/// whose ranges are travel times multiplied by the reference speed. The water along a ray returns
///
///     s_v(z) (c / c_0)^2 A^-1 e^(-2 absorption) c dt per steradian,
///
/// where A is the area of the ray tube per steradian, c the sound speed at the depth z, and c_0 that at the
/// apex. The cones are divided into strips of elevation, within which the rays differ little. A strip is at
/// most `strip_width_rad` high. Echoes that return along another ray than they went are not included.
Echo refracted_volume_echo(const History& history, const ReceiveBeams& beams, const RangeSamples& samples,
                           const EchoModel& model, const VolumeScattering& volume,
                           const RefractingWater& water, double strip_width_rad = 2e-3);

/// The same for a separate receiver in isovelocity water: the water that both ends see, from one ellipsoid of
/// equal path length to the next. `transmit` and `receive`: histories of the two apexes, the latter with
/// unobstructed regions. `receiver_m` is relative to the transmitter. Sample k contains the half paths from
/// first + k step on. The directions of the receiver are divided into cells that are at most `cell_width_rad`
/// wide. The error decreases with the square of this width.
Echo bistatic_volume_echo(const History& transmit, const History& receive, glm::dvec3 receiver_m,
                          const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                          const VolumeScattering& volume, double cell_width_rad = 5e-3);

/// Returns the content of a tube of a history. `surface` and `open` are the tube's first footprint and first
/// unobstructed region. They become those of the next tube.
TubeContent<DoubleSpace> tube_content(const History& history, std::uint32_t tube, std::size_t& surface,
                                      std::size_t& open);

}  // namespace tubefoot
