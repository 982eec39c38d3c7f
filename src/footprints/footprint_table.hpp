// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <variant>
#include <vector>

#include "run/transmission.hpp"

namespace tubefoot {

/// Footprints of a sensor as columns, whatever they are written to (docs/footprints.md): each column has one
/// element a footprint. Rows are ordered by ping, transmission, path, tube and facet.
struct FootprintTable {
  /// Of the seabed: several rays lead to them, and these rows are of the first that arrives. Echoes have all.
  std::size_t facets_of_several_rays = 0;
  std::vector<std::uint32_t> ping, transmission;
  std::vector<std::uint32_t> beam;  ///< of the sensor, that the receive tube belongs to
  std::vector<std::uint32_t> tube;  ///< of the transmission
  std::vector<std::uint32_t>
      receive_tube;  ///< that it is received in: the same, unless the receiver is apart
  std::vector<std::uint32_t> facet,
      base_facet;  ///< of the transmission's ground; of the scene without relief
  std::vector<std::uint32_t> component, material;     ///< as the scene numbers them
  std::vector<std::uint32_t> path_order;              ///< interactions of the path: 1 is the ordinary echo
  std::vector<std::uint32_t> mirrors_tx, mirrors_rx;  ///< of the transmit leg, and of the receive leg
  std::vector<double> area_m2, solid_angle_sr, grazing_deg;
  /// Of the direction from the sensor to the centroid: clockwise from the local frame's north, [0, 360).
  std::vector<double> azimuth_deg;
  std::vector<double> slant_range_min_m, slant_range_max_m;
  /// What it adds to the echo over all range samples, in all beams that receive it and in its own beam
  /// (FootprintEnergies).
  std::vector<double> energy_j, own_beam_energy_j;
  std::vector<double> centroid_east_m, centroid_north_m, centroid_up_m;  ///< in the local frame

  /// Ragged: row r has pieces [first_piece[r], first_piece[r + 1]), piece p corners [first_corner[p],
  /// first_corner[p + 1]), row r occluders [first_occluder[r], first_occluder[r + 1]).
  std::vector<std::uint64_t> first_piece{0}, first_corner{0}, first_occluder{0};
  std::vector<glm::dvec3> corners_m;     ///< convex pieces, counter-clockwise for the sensor; local frame
  std::vector<std::uint32_t> occluders;  ///< facets that took something of the footprint's facet in its tube

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
  /// All corners of a row, and its pieces in them.
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

/// A column of numbers, as files name it.
struct FootprintColumn {
  using Integers = std::vector<std::uint32_t> FootprintTable::*;
  using Reals = std::vector<double> FootprintTable::*;
  const char *name, *units, *long_name;  ///< units as UDUNITS has them; integers are counted from 0: "1"
  std::variant<Integers, Reals> values;
};

/// All columns of numbers, in the order of files.
std::span<const FootprintColumn> footprint_columns();

/// The footprints of a transmission in a sensor's tubes of `beams` (of the sensor; sorted; empty: all), with
/// energies as a run of the tube engine would count them. Through refracting water corners, centroid and area
/// are true; solid angle, grazing angle, azimuth and ranges are those of the apparent facet. With a receiver
/// apart a footprint is what one of its tubes and one of the transmitter's both see of a facet, `beams` are
/// the receiver's, ranges half paths, the other measures as the transmitter sees it, and occluders those
/// of either. Footprints of paths that are scattered once over mirrors follow, told like those of two ends,
/// which are images then: tubes are those of the true apexes, directions those at them. `only_order` of
/// [paths] chooses. Does not depend on the number of threads. Throws InputError as a run does.
FootprintTable footprint_table(const Transmission& transmission, std::size_t sensor,
                               std::span<const std::uint32_t> beams = {});

/// The tubes of a transmission of a sensor that belong to some of its beams (sorted; empty: all).
std::vector<std::uint32_t> tubes_of_beams(const Transmission& transmission, std::size_t sensor,
                                          std::span<const std::uint32_t> beams);
/// Of a set, those tubes and no others.
TubeSet only_tubes(TubeSet set, std::span<const std::uint32_t> tubes);

}  // namespace tubefoot
