// SPDX-License-Identifier: GPL-3.0-or-later
// Defines the group Bathymetry of XSF in SONAR-netCDF4 files: detections, their positions, and the qualities
// of each beam.
#include "sensors/formats/sonar_netcdf_builder.hpp"

namespace tubefoot {

void SonarNetcdfBuilder::bathymetry() {
  const NetcdfGroup g = beam_group_.group("Bathymetry");
  g.code_attribute("detection_conversion_equation_type", conversion_, conversion_type_5);
  const nc_type detection_type =
      g.enumeration("detection_type_t", {{"invalid", 0}, {"amplitude", 1}, {"phase", 2}, {"unknown", 127}});
  g.enumeration("seafloor_backscatter_equation_t", {{"type_1", 1}, {"type_2", 2}});
  const int detection = g.dimension("detection", header_.beams);
  g.dimension("seabed_sample", 1);  // readers expect it; the time series of the beams are in backscatter_r

  const auto found = [&](const NetcdfVariable& row, double (*value)(const SonarDetection&),
                         const char* crs = nullptr) {
    each_beam(g, row, [value](const Ping& p, std::size_t k) {
      return p.detections[k].found ? value(p.detections[k]) : SonarDetection::none;
    });
    if (crs) g.attribute(last_, "crs", crs);
  };
  using D = const SonarDetection&;
  found({"detection_latitude",
         NC_DOUBLE,
         {ping_, detection},
         "degrees_north",
         "latitude of the detection",
         "latitude",
         -90,
         90},
        [](D d) { return d.latitude_deg; });
  found({"detection_longitude",
         NC_DOUBLE,
         {ping_, detection},
         "degrees_east",
         "longitude of the detection",
         "longitude",
         -180,
         180},
        [](D d) { return d.longitude_deg; });
  found(
      {"detection_x",
       NC_FLOAT,
       {ping_, detection},
       "m",
       "along distance from the platform's reference point, forward positive"},
      [](D d) { return d.forward_starboard_down_m.x; }, "SCS");
  found(
      {"detection_y",
       NC_FLOAT,
       {ping_, detection},
       "m",
       "across distance from the platform's reference point, starboard positive"},
      [](D d) { return d.forward_starboard_down_m.y; }, "SCS");
  found(
      {"detection_z",
       NC_FLOAT,
       {ping_, detection},
       "m",
       "vertical distance from the platform's reference point, down positive"},
      [](D d) { return d.forward_starboard_down_m.z; }, "SCS");
  constexpr int valid = 0, rejected = 1, invalid_acquisition = 2;
  each_beam(
      g,
      {"status",
       NC_BYTE,
       {ping_, detection},
       nullptr,
       "validity: 0 valid; bits 1 rejected, 2 invalid acquisition, 4 invalid conversion, 8 invalid "
       "swath, 16 invalid sounding row"},
      [](const Ping& p, std::size_t k) {
        return !p.detections[k].found ? invalid_acquisition : p.detections[k].rejected ? rejected : valid;
      });
  constexpr int automatic = 1, doubtful = 2;
  each_beam(
      g,
      {"status_detail", NC_BYTE, {ping_, detection}, nullptr, "0 unknown, 1 automatic, 2 doubtful, 3 manual"},
      [](const Ping& p, std::size_t k) { return p.detections[k].doubtful ? doubtful : automatic; });
  every_ping(
      g, {"multiping_sequence", NC_UBYTE, {ping_}, nullptr, "sequence number among the swaths of a ping"}, 0);
  each_beam(g, {"detection_type", detection_type, {ping_, detection}, nullptr, "type of detection"},
            [](const Ping& p, std::size_t k) { return p.detections[k].found ? 1 : 0; });
  every_ping(g,
             {"detection_beam_stabilisation",
              stabilisation_,
              {ping_},
              nullptr,
              "beam stabilisation applied (or not)"},
             header_.beams_stabilised ? 1 : 0);
  each_beam(g,
            {"detection_beam_pointing_angle",
             NC_FLOAT,
             {ping_, detection},
             "arc_degree",
             "beam pointing angle from the platform's down axis, port positive"},
            [](const Ping& p, std::size_t k) { return -p.detections[k].beam_angle_deg + 0.0; });
  found({"detection_two_way_travel_time", NC_FLOAT, {ping_, detection}, "s", "two-way travel time"},
        [](D d) { return d.two_way_travel_time_s; });
  found({"detection_quality_factor",
         NC_FLOAT,
         {ping_, detection},
         "percent",
         "standard deviation in per cent of the detected depth"},
        [](D d) { return d.quality; });
  every_beam(
      g, {"detection_rx_transducer_index", NC_SHORT, {ping_, detection}, nullptr, "receive transducer index"},
      0);
  each_beam(g, {"detection_rx_beam", NC_SHORT, {ping_, detection}, nullptr, "receive beam index"},
            [](const Ping&, std::size_t k) { return static_cast<double>(k); });
  every_beam_by_tx(g, {"detection_tx_beam", NC_SHORT, {ping_, detection}, nullptr, "transmit beam index"},
                   [](std::size_t tx) { return static_cast<double>(tx); });
  every_beam(
      g,
      {"detection_tx_transducer_index", NC_SHORT, {ping_, detection}, nullptr, "transmit transducer index"},
      0);
  found({"detection_backscatter_r", NC_FLOAT, {ping_, detection}, "dB", "backscatter of the detection"},
        [](D d) { return d.backscatter_db; });
  every_beam(g,
             {"detection_backscatter_i",
              NC_FLOAT,
              {ping_, detection},
              "dB",
              "imaginary part of the backscatter: none, levels are in dB"},
             SonarDetection::none);
  every_beam_by_tx(g,
                   {"detection_mean_absorption_coefficient",
                    NC_FLOAT,
                    {ping_, detection},
                    "dB/km",
                    "mean absorption coefficient, one way"},
                   [&](std::size_t tx) { return 1000 * tx_beams_[tx].absorption_db_per_m; });
  if (header_.source_level_db)
    every_beam(g,
               {"detection_source_level_applied",
                NC_FLOAT,
                {ping_, detection},
                "dB",
                "source level, dB re 1 uPa at 1 m"},
               *header_.source_level_db);
}

}  // namespace tubefoot
