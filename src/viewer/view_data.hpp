// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tubefoot {

/// How beams and samples are laid out as a picture.
enum class PictureLayout {
  fan,        ///< a picture a ping: across beams, up slant range
  waterfall,  ///< one picture: a line a ping, port to the left, starboard to the right
  echogram,   ///< one picture: a column a ping, slant range downwards
};

struct ViewPing {
  std::uint32_t number = 0;  ///< as the sensor counts
  double time_s = 0;
  glm::dvec3 sensor_m{0};
  glm::dvec3 receiver_m{0};   ///< the same place, unless the receiver is apart
  std::uint32_t shadows = 0;  ///< as many polygons of ViewData::shadows
};

/// Polygons one after another: `corners_of` says how many of `corners_m` belong to each.
struct ViewPolygons {
  std::vector<std::uint16_t> corners_of;
  std::vector<glm::dvec3> corners_m;
};

struct ViewFootprint {
  std::uint32_t ping = 0;  ///< in ViewData::pings
  std::uint32_t beam = 0, tube = 0, facet = 0;
  std::uint32_t receive_tube = 0;  ///< the same, unless the receiver is apart
  std::uint32_t drawn_tube = 0;    ///< in ViewData::tubes
  std::uint32_t drawn_receive_tube = 0;
  std::uint32_t pieces = 0;     ///< as many polygons of ViewData::shapes
  std::uint32_t occluders = 0;  ///< how many facets took something away from it
  std::uint16_t component = 0, material = 0;
  double area_m2 = 0, solid_angle_sr = 0, grazing_rad = 0;
  double near_m = 0, far_m = 0;  ///< half paths
  double energy_j = 0;           ///< in all beams and samples
  glm::dvec3 centroid_m{0};
};

struct ViewTube {
  std::uint32_t ping = 0, beam = 0;
  glm::dvec3 apex_m{0};
  glm::dvec3 ends_m[4]{};  ///< of its edges
};

/// What a cell of the picture got from a footprint. Cell: (ping * beams + beam) * samples + sample.
struct ViewLink {
  std::uint32_t footprint = 0, cell = 0;
  double energy_j = 0;
};

/// One transmission of a ping, and the beams that listen to it.
struct ViewTransmission {
  double delay_s = 0;
  std::vector<std::uint32_t> beams;
};

/// Everything that a page of the viewer shows. Places are metres in the scene's local frame.
struct ViewData {
  std::string title, source, scene_hash, version;
  std::string drawing;  ///< of all of the scene (SVG); may be empty
  std::string sensor, kind;
  std::vector<std::string> notes;  ///< what the user must know of what is and is not shown
  std::vector<std::string> components, materials;

  PictureLayout layout = PictureLayout::fan;
  bool separate_receiver = false;
  bool across_track = false;  ///< the fan hangs down from the sonar, else it lies ahead
  std::vector<ViewPing> pings;
  std::uint32_t beams = 0, samples = 0;
  double first_m = 0, step_m = 0;      ///< of range samples
  std::vector<double> beam_angle_deg;  ///< across the fan, to starboard; by beam
  std::vector<double> energy_j;        ///< by cell
  /// By ping and beam: how many samples may hold a surface (samples_with_surfaces()); empty: not known.
  std::vector<std::uint32_t> surfaces;
  /// Another engine's, held against those; empty: none. And what both are called.
  std::vector<double> candidate_j;
  std::string reference_name, candidate_name;
  double display_gain_db = 0;
  std::vector<ViewTransmission> transmissions;  ///< of a ping; empty: one
  std::string stripes;  ///< why neighbouring beams see the scene from apart; empty: they do not

  std::vector<ViewFootprint> footprints;  ///< by ping
  ViewPolygons shapes;                    ///< of footprints
  std::vector<ViewLink> links;            ///< by footprint
  bool weak_links_left_out = false;

  std::vector<ViewTube> tubes;
  ViewPolygons shadows;  ///< facets in the tubes that are not wholly seen, by ping; footprints cover what is
  std::vector<glm::dvec3> mesh_vertices_m;
  std::vector<std::uint32_t> mesh_facets;  ///< three vertices each
};

}  // namespace tubefoot
