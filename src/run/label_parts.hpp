// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "engine/echo/receiver_pair_echo.hpp"
#include "engine/paths/path_echo.hpp"
#include "engine/paths/receiver_pair_paths.hpp"
#include "run/labels.hpp"

// This header declares the labels for the contributions to a transmission (contributions.hpp): object and
// material of each energy. All functions return immediately if the run does not request labels.
namespace tubefoot {

/// Adds the labels of the echoes that a sensor receives. The facets of `visibility` are those of `mesh`.
/// `model`: the model that the energies use.
void add_labels(const Transmission& transmission, std::size_t sensor, const EchoModel& model,
                const FacetMesh& mesh, const CommonVisibility& visibility, PingSums& sums);
/// Adds the labels with the echo model of a transmission surface.
void add_labels(const Transmission& transmission, std::size_t sensor, const TransmissionSurface& surface_mesh,
                const FacetMesh& mesh, const CommonVisibility& visibility, PingSums& sums);
/// Adds the labels of mixed-eigenray returns, for parts of a surface that several rays reach.
/// `model.material` is by part.
void add_labels_of_mixed_eigenrays(const Transmission& transmission, std::size_t sensor,
                                   const EchoModel& model, const ApparentSurface& surface_mesh,
                                   const CommonVisibility& visibility, PingSums& sums);

/// Adds the labels of the echoes that the upper receiver of a fan receives.
void add_labels_of_receiver_pair(const Transmission& transmission, std::size_t sensor, std::uint32_t fan,
                                 const EchoModel& model, const FacetMesh& mesh,
                                 const ReceiverPairHistory& history, const ReceiverBaseline& receiver_pair,
                                 PingSums& sums);
/// Adds the labels of a history between the upper receiver and the transmitter.
void add_labels_of_receiver_pair(const Transmission& transmission, std::size_t sensor, std::uint32_t fan,
                                 const FacetMesh& mesh, const BistaticHistory& history, PingSums& sums);

/// Function that returns the energies of paths, [beam of the transmission][sample], summed over all wanted
/// orders.
using PathRows = std::function<std::vector<double>(const FacetMesh& mesh, const EchoModel& model,
                                                   const PathSettings& settings)>;
/// Adds the labels of these paths. Arrivals without scattering have a channel of their own.
void add_labels_of_paths(const Transmission& transmission, std::size_t sensor, const FacetMesh& mesh,
                         const EchoModel& model, PathSettings settings, PingSums& sums,
                         const PathRows& rows_of);
std::vector<double> wanted_orders(const Transmission& transmission, const PathEcho& paths);
/// Returns the energies of the upper receiver.
std::vector<double> wanted_orders(const Transmission& transmission, const ReceiverPairPathEcho& paths);
/// Places the samples of one fan among the beams of a transmission.
std::vector<double> row_of_fan(const Transmission& transmission, std::size_t sensor, std::uint32_t fan,
                               const std::vector<double>& samples);

}  // namespace tubefoot
