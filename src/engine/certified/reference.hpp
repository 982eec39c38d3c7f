// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/certified/certified_texture.hpp"
#include "engine/echo/echo.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// Floor of the required accuracy, relative to the strongest bin of the beam. Its square is the floor
/// relative to the strongest bin of the ping. A smaller bin has the tolerance of a bin of this size, so that
/// slivers in empty bins do not require endless work.
constexpr double reference_floor = 1e-6;

/// An echo in which each energy is proven to lie within its bound.
struct CertifiedEcho {
  Echo echo;
  std::vector<double> bound;  ///< half-width [J/m^2] of each energy's enclosure, in the order of the energies
  /// Number of bins whose bound exceeds the requested bound, and the worst of them by the ratio of bound to
  /// requested bound.
  std::size_t bins_over = 0;
  double worst_ratio = 0;  ///< over all finite bounds; at most 1 if they keep the tolerance
  int worst_beam = 0, worst_sample = 0;
};

/// Returns the requested bound of each energy.
std::vector<double> reference_targets(const Echo& echo, double tolerance);
/// Counts the bins whose bound exceeds the requested bound. The lower end of each enclosure counts as the
/// energy.
void compare_with(CertifiedEcho& certified, double tolerance);

/// Returns the first material whose micro-texture cannot be enclosed, which certify_echo() rejects. Perlin
/// noise, maps and products of them can be enclosed.
std::optional<std::size_t> material_without_enclosure(
    std::span<const std::shared_ptr<const ReflectivityField>> reflectivity);

/// Returns the micro-textures of a model by material, null for untextured ones. Throws std::invalid_argument
/// for a texture that cannot be enclosed.
std::vector<std::shared_ptr<const CertifiedTexture>> certified_textures(const EchoModel& model);

/// Encloses the echo of one ping with exact visibility, corners from exact integers, iso-range cuts, and
/// integrals in ball arithmetic. The enclosures are refined until each bound is at most tolerance *
/// max(energy, reference_floor * strongest of the beam, reference_floor^2 * strongest of the ping).
/// `ordinary` is the echo of the same ping by integrate_echo() and only guides the work. `options` must name
/// an exact arithmetic. The page docs/notes/certified-energies.md states what is certain.
CertifiedEcho certify_echo(const FacetMesh& mesh, const SceneTree& tree, const History& history,
                           const VisibilityOptions& options, std::span<const std::uint32_t> beam_of_tube,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance);

/// Does the same for the common visibility of two apexes, or of two images of them (model.path), in
/// isovelocity water. Corners are as accurate as the history has them (SharedDetails::corner_rests). Ellipses
/// of equal path length and integrals are computed in ball arithmetic. `mesh` contains the facets of the
/// history. `ordinary` is the result of integrate_echo() for the same arguments.
CertifiedEcho certify_echo(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance);

}  // namespace tubefoot
