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

/// A bin smaller than this, relative to its beam's strongest (and its square, to the ping's strongest), is
/// held to the tolerance as if it were as large: a sliver in an empty bin must not force endless work.
constexpr double reference_floor = 1e-6;

/// An echo of which every energy is known to lie within its bound.
struct CertifiedEcho {
  Echo echo;
  std::vector<double> bound;  ///< half-width [J] of each energy's enclosure, laid out as the energies
  /// Bins whose bound is above what was asked for, and the worst of them: bound over what it should be.
  std::size_t bins_over = 0;
  double worst_ratio = 0;  ///< of all finite bounds; at most 1 if these keep the tolerance
  int worst_beam = 0, worst_sample = 0;
};

/// What each energy's bound is to be.
std::vector<double> reference_targets(const Echo& echo, double tolerance);
/// Counts the bins whose bound is above that, what surely is there taken for their energy.
void compare_with(CertifiedEcho& certified, double tolerance);

/// The first material whose micro-texture no reference can enclose: certify_echo() would refuse it. Perlin
/// noise, maps and products of them can be enclosed.
std::optional<std::size_t> material_without_enclosure(
    std::span<const std::shared_ptr<const ReflectivityField>> reflectivity);

/// The micro-textures of a law by material, null where it is even. Throws std::invalid_argument for one that
/// cannot be enclosed.
std::vector<std::shared_ptr<const CertifiedTexture>> certified_textures(const EchoModel& model);

/// Of a texture, in one piece: half a minute's work. A piece of more is enclosed by the texture's range.
constexpr std::size_t most_cells = 1 << 16;

/// Encloses the echo of one ping: exact visibility, corners from exact integers, iso-range cuts and integrals
/// in ball arithmetic, refined until each bound is at most tolerance * max(energy, reference_floor * the
/// beam's strongest, reference_floor^2 * the ping's strongest). `ordinary` is the same ping's echo by
/// integrate_echo() and only guides the work. `options` must name an exact arithmetic. docs/reference.md says
/// what is certain and what is not.
CertifiedEcho certify_echo(const FacetMesh& mesh, const SceneTree& tree, const History& history,
                           const VisibilityOptions& options, std::span<const std::uint32_t> beam_of_tube,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance);

/// The same of what two apexes share, in isovelocity water, or two images of them (law.path): corners rounded
/// as FootprintSharer rounds them, ellipses of one path length and integrals in ball arithmetic. `mesh`: of
/// the history's facets. `ordinary` is integrate_echo()'s of the same arguments.
CertifiedEcho certify_echo(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model, const Echo& ordinary,
                           double tolerance);

}  // namespace tubefoot
