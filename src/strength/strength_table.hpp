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

/// What is asked of a mesh. Directions are to the sonar, in the mesh's axes (sonar_direction()).
struct StrengthRequest {
  std::vector<double> azimuths_deg, elevations_deg, frequencies_hz;
  double sound_speed = 1500;  ///< m/s
  SmoothSurface surface;
  std::string surface_name;
  /// Lengths are certified, and bounds held against this (bounds_held()).
  std::optional<double> tolerance{};
};

/// Backscattering lengths by elevation, azimuth and frequency, the last running fastest; and the silhouette's
/// area by direction.
struct StrengthTable {
  StrengthRequest request;
  std::string mesh_name;
  std::vector<std::complex<double>> length_m;
  std::vector<double> silhouette_m2;
  /// As the lengths; empty where they are not certified: how far they may be from the mesh's true ones, and
  /// what of that is because a view puts vertices on a grid (CertifiedLength).
  std::vector<double> bound_m{}, grid_bound_m{};

  bool certified() const { return !bound_m.empty(); }
  std::size_t directions() const { return request.elevations_deg.size() * request.azimuths_deg.size(); }
  std::size_t index(std::size_t elevation, std::size_t azimuth, std::size_t frequency) const {
    return (elevation * request.azimuths_deg.size() + azimuth) * request.frequencies_hz.size() + frequency;
  }
  std::complex<double> at(std::size_t elevation, std::size_t azimuth, std::size_t frequency) const {
    return length_m[index(elevation, azimuth, frequency)];
  }
};

/// A mesh file in metres, z up. `unit_m`, `up`: as MeshAxes has them. Throws InputError.
ComponentMesh strength_mesh(const std::filesystem::path& file, std::optional<double> unit_m,
                            const std::optional<std::string>& up);

/// Of a body that is smaller than a wavelength, for which Kirchhoff's approximation is no model
/// (docs/smooth-surfaces.md, "Where Kirchhoff ends").
std::optional<std::string> too_small_for(const ComponentMesh& mesh, double lowest_frequency_hz,
                                         double sound_speed);
/// What the user should know of a mesh whose facets reflect: where it is open, and whether facets stand for
/// a curved surface that they are too coarse for at the highest frequency.
std::vector<std::string> warnings_of(const ComponentMesh& mesh, double highest_frequency_hz,
                                     double sound_speed);

/// Looks at the mesh from all directions. The result does not depend on the threads.
StrengthTable strength_of(const ComponentMesh& mesh, const std::string& name, const StrengthRequest& request,
                          bool quiet);

/// A length weaker than this, relative to the strongest of its frequency, is held to the tolerance as if it
/// were as strong: the nulls of a pattern have no digits to keep. Squared it is the floor of energies
/// (reference_floor).
constexpr double strength_floor = 1e-3;

/// How a table's bounds compare with what was asked for: tolerance times the length, or times the floor.
struct BoundsHeld {
  std::size_t over = 0;    ///< lengths with a wider bound
  double worst_ratio = 0;  ///< of a bound over what it should be
  std::size_t worst_elevation = 0, worst_azimuth = 0, worst_frequency = 0;
  double most_m = 0;     ///< the widest bound
  double most_grid = 0;  ///< the grid's largest part of any bound, of 1
};
BoundsHeld bounds_held(const StrengthTable& table);
/// What bounds_held() found, for people: the first line says whether the tolerance was kept.
std::string in_words(const BoundsHeld& held, const StrengthTable& table);

/// The weakest and the strongest of a table, dB re 1 m^2.
std::pair<double, double> spread_db(const StrengthTable& table);

}  // namespace tubefoot
