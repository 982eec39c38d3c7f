// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/signal/smooth_surface.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// Directions, frequencies and surface for the target strength of a mesh. Directions point to the sonar, in
/// the axes of the mesh (sonar_direction()).
struct StrengthRequest {
  std::vector<double> azimuths_deg, elevations_deg, frequencies_hz;
  double sound_speed = 1500;  ///< m/s
  SmoothSurface surface;
  std::string surface_name;
  /// If set, lengths are certified and bounds are compared with it (bounds_held()).
  std::optional<double> tolerance{};
};

/// Target strengths of another method or of a measurement.
struct StrengthComparison {
  std::string name;                 ///< of the file
  std::vector<double> strength_db;  ///< in the order of StrengthTable::length_m; NaN: the file has no value
};

/// Backscattering lengths by elevation, azimuth and frequency, with frequency varying fastest, and areas of
/// the silhouette by direction.
struct StrengthTable {
  StrengthRequest request;
  std::string mesh_name;
  std::vector<std::complex<double>> length_m;
  std::vector<double> silhouette_m2;
  /// Bounds of the lengths relative to those of the exact mesh. `grid_bound_m` is the part that the rounding
  /// of vertices to the grid of a view causes (CertifiedLength). Both are empty if lengths are not certified.
  std::vector<double> bound_m{}, grid_bound_m{};
  std::optional<StrengthComparison> comparison{};  ///< see strength_comparison.hpp

  bool certified() const { return !bound_m.empty(); }
  std::size_t directions() const { return request.elevations_deg.size() * request.azimuths_deg.size(); }
  std::size_t index(std::size_t elevation, std::size_t azimuth, std::size_t frequency) const {
    return (elevation * request.azimuths_deg.size() + azimuth) * request.frequencies_hz.size() + frequency;
  }
  std::complex<double> at(std::size_t elevation, std::size_t azimuth, std::size_t frequency) const {
    return length_m[index(elevation, azimuth, frequency)];
  }
};

/// Reads a mesh file in metres with z up. `unit_m`, `up`: as in MeshAxes. Throws InputError.
ComponentMesh strength_mesh(const std::filesystem::path& file, std::optional<double> unit_m,
                            const std::optional<std::string>& up);

/// Returns a warning for a body smaller than a wavelength, for which Kirchhoff's approximation is invalid
/// (validation/target-strength.md).
std::optional<std::string> too_small_for(const ComponentMesh& mesh, double lowest_frequency_hz,
                                         double sound_speed);
/// Returns warnings about a reflecting mesh: open or overfull edges, and facets that are too coarse for a
/// curved surface at the highest frequency.
std::vector<std::string> warnings_of(const ComponentMesh& mesh, double highest_frequency_hz,
                                     double sound_speed);

/// Computes the table for all directions. The result does not depend on the number of threads.
StrengthTable strength_of(const ComponentMesh& mesh, const std::string& name, const StrengthRequest& request,
                          bool quiet);

/// Floor relative to the strongest length of the same frequency. The tolerance of a weaker length is that
/// of the floor, because the nulls of a pattern have no significant digits. Its square is the floor of
/// energies (reference_floor).
constexpr double strength_floor = 1e-3;

/// Comparison of the bounds of a table with the requested tolerance times the length, or times the floor.
struct BoundsHeld {
  std::size_t over = 0;    ///< number of lengths with a wider bound
  double worst_ratio = 0;  ///< largest ratio of a bound to the requested one
  std::size_t worst_elevation = 0, worst_azimuth = 0, worst_frequency = 0;
  double most_m = 0;     ///< the widest bound
  double most_grid = 0;  ///< largest share of the grid in a bound, at most 1
};
BoundsHeld bounds_held(const StrengthTable& table);
/// Describes the comparison. The first line reports whether the tolerance was satisfied.
std::string in_words(const BoundsHeld& held, const StrengthTable& table);

/// Returns the weakest and the strongest value of a table, in dB re 1 m^2.
std::pair<double, double> spread_db(const StrengthTable& table);

}  // namespace tubefoot
