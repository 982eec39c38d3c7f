// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/paths/path_echo.hpp"
#include "engine/paths/receiver_pair_paths.hpp"
#include "run/labels.hpp"

// Whose the energies of a transmission's parts are (echo_parts.hpp). Nothing is done where nobody asks for
// the truth.
namespace tubefoot {

/// Of what a sensor receives of a history, whose facets are those of `mesh`. `model`: as for the energies.
void add_labels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
                const FacetMesh& mesh, const CommonVisibility& visibility, PingSums& sums);
/// By the law of a ground.
void add_labels(const Transmission& transmission, std::size_t sensor, const TransmissionSurface& surface_mesh,
                const FacetMesh& mesh, const CommonVisibility& visibility, PingSums& sums);
/// Of parts of a ground that several rays show; `law.material` is by part.
void add_labels_of_mixed_eigenrays(const Transmission& transmission, std::size_t sensor,
                                   const EchoModel& model, const ApparentSurface& surface_mesh,
                                   const CommonVisibility& visibility, PingSums& sums);

/// Of what the upper receiver of a fan receives.
void add_labels_of_receiver_pair(const Transmission& transmission, std::size_t sensor, std::uint32_t fan,
                                 const EchoModel& model, const FacetMesh& mesh,
                                 const ReceiverPairHistory& history, const ReceiverBaseline& receiver_pair,
                                 PingSums& sums);
/// Of a history between it and the transmitter.
void add_labels_of_receiver_pair(const Transmission& transmission, std::size_t sensor, std::uint32_t fan,
                                 const FacetMesh& mesh, const BistaticHistory& history, PingSums& sums);

/// What paths return: [beam of the transmission][sample], all orders that are wanted.
using PathRows = std::function<std::vector<double>(const FacetMesh& mesh, const EchoModel& model,
                                                   const PathSettings& settings)>;
/// Of these; what comes without scattering has a channel of its own.
void add_labels_of_paths(const Transmission& transmission, std::size_t sensor, const FacetMesh& mesh,
                         const EchoModel& model, PathSettings settings, PingSums& sums,
                         const PathRows& rows_of);
std::vector<double> wanted_orders(const Transmission& transmission, const PathEcho& paths);
/// Of the upper receiver.
std::vector<double> wanted_orders(const Transmission& transmission, const ReceiverPairPathEcho& paths);
/// One fan's samples among the beams of a transmission.
std::vector<double> row_of_fan(const Transmission& transmission, std::size_t sensor, std::uint32_t fan,
                               const std::vector<double>& samples);

}  // namespace tubefoot
