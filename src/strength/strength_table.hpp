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
};

/// Backscattering lengths by elevation, azimuth and frequency, the last running fastest; and the silhouette's
/// area by direction.
struct StrengthTable {
  StrengthRequest request;
  std::string mesh_name;
  std::vector<std::complex<double>> length_m;
  std::vector<double> silhouette_m2;

  std::size_t directions() const { return request.elevations_deg.size() * request.azimuths_deg.size(); }
  std::complex<double> at(std::size_t elevation, std::size_t azimuth, std::size_t frequency) const {
    return length_m[(elevation * request.azimuths_deg.size() + azimuth) * request.frequencies_hz.size() +
                    frequency];
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

/// The weakest and the strongest of a table, dB re 1 m^2.
std::pair<double, double> spread_db(const StrengthTable& table);

}  // namespace tubefoot
