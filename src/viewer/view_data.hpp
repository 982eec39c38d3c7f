// SPDX-License-Identifier: GPL-3.0-or-later
// Data of a page of the viewer: pings, footprints, tubes, energies by cell, and the links between footprints
// and cells.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// Arrangement of beams and samples in a picture.
enum class PictureLayout {
  fan,        ///< one picture per ping: beams across, slant range upwards
  waterfall,  ///< one picture, one line per ping: port to the left, starboard to the right
  echogram,   ///< one picture, one column per ping: slant range downwards
};

struct ViewPing {
  std::uint32_t number = 0;  ///< number of the ping in the sensor
  double time_s = 0;
  glm::dvec3 sensor_m{0};
  glm::dvec3 receiver_m{0};   ///< equal to sensor_m, unless the receiver is separate
  std::uint32_t shadows = 0;  ///< number of polygons in ViewData::shadows
};

/// Consecutive polygons. `corners_of` has the number of corners of each.
struct ViewPolygons {
  std::vector<std::uint16_t> corners_of;
  std::vector<glm::dvec3> corners_m;
};

struct ViewFootprint {
  std::uint32_t ping = 0;  ///< index in ViewData::pings
  std::uint32_t beam = 0, tube = 0, facet = 0;
  std::uint32_t receive_tube = 0;  ///< equal to `tube`, unless the receiver is separate
  std::uint32_t drawn_tube = 0;    ///< index in ViewData::tubes
  std::uint32_t drawn_receive_tube = 0;
  std::uint32_t pieces = 0;     ///< number of polygons in ViewData::shapes
  std::uint32_t occluders = 0;  ///< number of facets that hide part of its facet in the tube
  std::uint16_t component = 0, material = 0;
  double area_m2 = 0, solid_angle_sr = 0, grazing_rad = 0;
  double near_m = 0, far_m = 0;  ///< smallest and largest slant range
  double energy_j = 0;           ///< sum over all beams and samples
  glm::dvec3 centroid_m{0};
};

struct ViewTube {
  std::uint32_t ping = 0, beam = 0;
  glm::dvec3 apex_m{0};
  glm::dvec3 ends_m[4]{};  ///< ends of its edges
};

/// Energy of a footprint in a cell of the picture. Cell: (ping * beams + beam) * samples + sample.
struct ViewLink {
  std::uint32_t footprint = 0, cell = 0;
  double energy_j = 0;
};

/// One transmission of a ping, and the beams that receive its echoes.
struct ViewTransmission {
  double delay_s = 0;
  std::vector<std::uint32_t> beams;
};

/// All data of a page of the viewer. Positions are in metres in the local frame of the scene.
struct ViewData {
  std::string title, source, scene_hash, version;
  std::string drawing;  ///< drawing of the whole scene (SVG); may be empty
  std::string sensor, kind;
  std::vector<std::string> notes;  ///< remarks on the contents of the page
  std::vector<std::string> components, materials;

  PictureLayout layout = PictureLayout::fan;
  bool separate_receiver = false;
  bool across_track = false;  ///< the fan looks down from the sonar, otherwise forward
  std::vector<ViewPing> pings;
  std::uint32_t beams = 0, samples = 0;
  double first_m = 0, step_m = 0;      ///< of the range samples
  std::vector<double> beam_angle_deg;  ///< angle across the fan to starboard, by beam
  std::vector<double> energy_j;        ///< by cell
  /// By ping and beam: number of samples that may contain a surface (samples_with_surfaces()); empty if
  /// unknown.
  std::vector<std::uint32_t> surfaces;
  /// Energies of another engine for comparison, or empty; and the names of both.
  std::vector<double> candidate_j;
  std::string reference_name, candidate_name;
  double display_gain_db = 0;
  std::vector<ViewTransmission> transmissions;  ///< transmissions of a ping; empty for a single one
  std::string stripes;  ///< reason for a displacement between adjacent beams; empty if there is none

  std::vector<ViewFootprint> footprints;  ///< ordered by ping
  ViewPolygons shapes;                    ///< polygons of the footprints
  std::vector<ViewLink> links;            ///< ordered by footprint
  bool weak_links_left_out = false;

  std::vector<ViewTube> tubes;
  ViewPolygons shadows;  ///< parts of facets in the tubes that are partly hidden, by ping; footprints cover
                         ///< their visible parts
  std::vector<glm::dvec3> mesh_vertices_m;
  std::vector<std::uint32_t> mesh_facets;  ///< three vertices per facet
};

}  // namespace tubefoot
