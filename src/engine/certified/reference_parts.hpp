// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "engine/certified/certified_texture.hpp"
#include "engine/certified/reference.hpp"

// What references of one apex and of two have in common. Heavy: include only in .cpp files.
namespace tubefoot {

constexpr double least_allowed = 1e-300;
/// Of a texture, in one piece: half a minute's work. A piece of more is enclosed by the texture's range.
constexpr std::size_t most_cells = 1 << 16;

/// Enclosures by bin, of one task.
using Bins = std::map<std::size_t, Ball>;

/// By material; null where it is even. Throws std::invalid_argument for one that cannot be enclosed.
std::vector<std::shared_ptr<const CertifiedTexture>> certified_textures(const EchoLaw& law);

/// Energies and bounds of enclosures, held against a tolerance.
CertifiedEcho enclosed_echo(const Echo& ordinary, const std::vector<Ball>& total, double tolerance);

/// How a bin's tolerance is shared out among its parts is a guess, which a bin of very many small parts may
/// prove wrong: then all of them are done again, as much narrower as that bin needs, at most twice.
/// `enclose(working, coarse)`: parts enclosed to `working`; `coarse`: no narrower try would help.
CertifiedEcho narrowed(double tolerance, const std::function<CertifiedEcho(double, bool&)>& enclose);

}  // namespace tubefoot
