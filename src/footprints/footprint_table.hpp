// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <variant>
#include <vector>

#include "run/transmission.hpp"

// Computes the table of footprints of a transmission: one row per footprint with its measures, energies,
// corners and occluders. All file formats share its columns (docs/footprints.md).

namespace tubefoot {

/// Footprints of a sensor as columns, independent of the file format (docs/footprints.md). Each column has
/// one element per footprint. Rows are ordered by ping, transmission, path, tube and facet.
struct FootprintTable {
  /// Number of facets of the surface mesh that several rays reach. The rows here contain only the first
  /// arrival; echoes contain all arrivals.
  std::size_t facets_of_several_rays = 0;
  std::vector<std::uint32_t> ping, transmission;
  std::vector<std::uint32_t> beam;  ///< beam of the sensor that the receive tube belongs to
  std::vector<std::uint32_t> tube;  ///< number in the transmission
  std::vector<std::uint32_t>
      receive_tube;  ///< tube of the receiver; differs from `tube` for separate receivers and mirror paths
  std::vector<std::uint32_t> facet,
      base_facet;  ///< facet of the transmission's surface mesh, and facet of the scene without relief
  std::vector<std::uint32_t> component, material;  ///< numbers in the scene
  std::vector<std::uint32_t> path_order;  ///< number of interactions of the path; 1 is the ordinary echo
  std::vector<std::uint32_t> mirrors_tx,
      mirrors_rx;  ///< number of mirrors on the transmit leg and on the receive leg
  std::vector<double> area_m2, solid_angle_sr, grazing_deg;
  /// Direction from the sensor to the centroid, clockwise from the local frame's north, in [0, 360).
  std::vector<double> azimuth_deg;
  std::vector<double> slant_range_min_m, slant_range_max_m;
  /// Contribution of the footprint to the echo over all range samples (FootprintEnergies): in all beams
  /// that receive it, and in its own beam.
  std::vector<double> energy_j, own_beam_energy_j;
  std::vector<double> centroid_east_m, centroid_north_m, centroid_up_m;  ///< in the local frame

  /// Offsets of ragged arrays. Row r has the pieces [first_piece[r], first_piece[r + 1]) and the occluders
  /// [first_occluder[r], first_occluder[r + 1]). Piece p has the corners [first_corner[p], first_corner[p +
  /// 1]).
  std::vector<std::uint64_t> first_piece{0}, first_corner{0}, first_occluder{0};
  std::vector<glm::dvec3>
      corners_m;  ///< convex pieces in the local frame, counter-clockwise as seen from the sensor
  std::vector<std::uint32_t> occluders;  ///< facets that hide a part of the footprint's facet in its tube

  std::size_t rows() const { return ping.size(); }
  std::size_t pieces() const { return first_corner.size() - 1; }
  std::uint32_t pieces_of(std::size_t row) const {
    return static_cast<std::uint32_t>(first_piece[row + 1] - first_piece[row]);
  }
  std::span<const glm::dvec3> corners_of(std::uint64_t piece) const {
    return std::span(corners_m).subspan(first_corner[piece], first_corner[piece + 1] - first_corner[piece]);
  }
  std::span<const std::uint32_t> occluders_of(std::size_t row) const {
    return std::span(occluders).subspan(first_occluder[row], first_occluder[row + 1] - first_occluder[row]);
  }
  /// Returns all corners of a row. pieces_in_row() divides them into pieces.
  std::span<const glm::dvec3> corners_of_row(std::size_t row) const {
    const std::uint64_t begin = first_corner[first_piece[row]], end = first_corner[first_piece[row + 1]];
    return std::span(corners_m).subspan(begin, end - begin);
  }
  std::vector<Piece> pieces_in_row(std::size_t row) const {
    std::vector<Piece> pieces;
    const std::uint64_t begin = first_corner[first_piece[row]];
    for (std::uint64_t piece = first_piece[row]; piece < first_piece[row + 1]; ++piece)
      pieces.push_back({static_cast<std::uint32_t>(first_corner[piece] - begin),
                        static_cast<std::uint32_t>(first_corner[piece + 1] - first_corner[piece])});
    return pieces;
  }
  void append(const FootprintTable& more);
};

/// A column of numbers, with its name in files.
struct FootprintColumn {
  using Integers = std::vector<std::uint32_t> FootprintTable::*;
  using Reals = std::vector<double> FootprintTable::*;
  const char *name, *units,
      *long_name;  ///< units as in UDUNITS; integers are counted from 0 and have the unit "1"
  std::variant<Integers, Reals> values;
};

/// Returns all columns of numbers, in the order of files.
std::span<const FootprintColumn> footprint_columns();

/// Computes the footprints of a transmission in the tubes of `beams` (of the sensor; sorted; empty: all).
/// Energies are those of a run of the tube engine.
/// In stratified water, corners, centroid and area are true; solid angle, grazing angle, azimuth and ranges
/// are those of the apparent facet.
/// With a separate receiver, a footprint is the part of a facet that a transmit tube and a receive tube
/// both see. `beams` are those of the receiver, ranges are half the path length, and the other measures
/// refer to the transmitter. Occluders are those of both ends.
/// The footprints of paths that are scattered once over mirrors follow. Their ends are images. Tubes are
/// those of the true apexes, and directions are those at the true apexes. `only_order` of [paths] selects
/// the orders.
/// The result does not depend on the number of threads. Throws InputError under the same conditions as a
/// run.
FootprintTable footprint_table(const Transmission& transmission, std::size_t sensor,
                               std::span<const std::uint32_t> beams = {});

/// Returns the tubes of a transmission that belong to some beams of a sensor (sorted; empty: all).
std::vector<std::uint32_t> tubes_of_beams(const Transmission& transmission, std::size_t sensor,
                                          std::span<const std::uint32_t> beams);
/// Returns a set with only the given tubes.
TubeSet only_tubes(TubeSet set, std::span<const std::uint32_t> tubes);

}  // namespace tubefoot
