// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of single transmissions: exposes tubes, beams, poses and traced footprints as arrays, for
// engines in Python.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <glm/geometric.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "transmission.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

const NativeTransmission& transmission_in(const py::object& self) {
  return self.cast<const NativeTransmission&>();
}

py::array three(glm::dvec3 v) { return array_of(std::vector<double>{v.x, v.y, v.z}); }

py::array rays(const TubeSet& tubes) {
  std::vector<double> directions;
  for (const GridPoint& r : tubes.rays) {
    const glm::dvec3 d = glm::normalize(glm::dvec3(r.x, r.y, r.z));
    directions.insert(directions.end(), {d.x, d.y, d.z});
  }
  return array_of(directions, 3);
}

py::array beam_of_tube(const NativeTransmission& transmission) {
  return array_of(transmission.sensor().beam_of_tube(transmission.which().transmission));
}

py::array range_edges(const NativeTransmission& transmission) {
  const RangeSamples samples = transmission.sensor().samples(transmission.which().transmission);
  std::vector<double> edges;
  for (int k = 0; k <= samples.count; ++k) edges.push_back(samples.first_m + k * samples.step_m);
  return array_of(edges);
}

/// Returns one value per beam of the transmission.
template <class Value>
py::array by_beam(const NativeTransmission& transmission, Value value) {
  std::vector<double> values;
  for (const std::uint32_t b : transmission.sensor().beams_of_transmission(transmission.which().transmission))
    values.push_back(value(transmission.sensor().beams()[b]));
  return array_of(values);
}

/// Returns the baseline of the receiver pair of each beam; None for a single receiver.
py::object receiver_pairs(const NativeTransmission& transmission) {
  const std::size_t number = transmission.which().transmission;
  const BeamPatterns patterns = transmission.sensor().patterns(transmission.receiver_pose(),
                                                               transmission.pings().sound_speed_m_s, number);
  if (patterns.baselines.empty()) return py::none();
  std::vector<double> ways(3 * transmission.sensor().beams_of_transmission(number).size());
  const std::vector<std::uint32_t>& beams = transmission.sensor().beam_of_tube(number);
  for (std::size_t tube = 0; tube < beams.size(); ++tube) {
    const ReceiverBaseline& receiver_pair = patterns.baselines[patterns.fan_of_tube[tube]];
    for (int k = 0; k < 3; ++k)
      ways[3 * beams[tube] + std::size_t(k)] = receiver_pair.baseline_m * receiver_pair.axis[k];
  }
  return array_of(ways, 3);
}

py::array base_facets(const NativeTransmission& transmission) {
  std::vector<std::uint32_t> base(transmission.mesh().facets.size());
  for (FacetId facet = 0; facet < base.size(); ++facet) base[facet] = transmission.ends().base_facet(facet);
  return array_of(base);
}

std::vector<std::string> material_names(const NativeTransmission& transmission) {
  std::vector<std::string> names;
  for (const MaterialDescription& m : transmission.survey().scene.description.materials)
    names.push_back(m.name);
  return names;
}

py::array attitude(const NativeTransmission& transmission) {
  const glm::dquat q = glm::normalize(transmission.pose().attitude);
  return array_of(std::vector<double>{q.w, q.x, q.y, q.z});
}

void bind_transmission_class(py::module_& module) {
  py::class_<NativeTransmission, std::shared_ptr<NativeTransmission>>(module, "Transmission")
      .def_property_readonly("sensor",
                             [](const NativeTransmission& s) { return s.sensor().description().name; })
      .def_property_readonly("ping", [](const NativeTransmission& s) { return s.which().ping; })
      .def_property_readonly("transmission",
                             [](const NativeTransmission& s) { return s.which().transmission; })
      .def_property_readonly(
          "frequency_khz",
          [](const NativeTransmission& s) { return s.sensor().frequency_khz(s.which().transmission); })
      .def_property_readonly("sound_speed_m_s",
                             [](const NativeTransmission& s) { return s.pings().sound_speed_m_s; })
      .def_property_readonly("absorption_db_per_m",
                             [](const NativeTransmission& s) {
                               return absorption_db_per_m(s.survey().scene, s.sensor(),
                                                          s.which().transmission);
                             })
      .def_property_readonly("time_s",
                             [](const NativeTransmission& s) {
                               return s.pings().times_s[s.which().ping] +
                                      s.sensor().transmission_delay_s(s.which().transmission);
                             })
      .def_property_readonly("apex_m",
                             [](const NativeTransmission& s) { return three(s.metres(s.tubes().apex)); })
      .def_property_readonly("position_m",
                             [](const NativeTransmission& s) { return three(s.pose().position_m); })
      .def_property_readonly("attitude", &attitude)
      .def_property_readonly("beams",
                             [](const py::object& self) {
                               const NativeTransmission& s = transmission_in(self);
                               return view_of<std::uint32_t>(
                                   s.sensor().beams_of_transmission(s.which().transmission), self);
                             })
      .def_property_readonly("beam_azimuth_rad",
                             [](const NativeTransmission& s) {
                               return by_beam(s, [](const BeamAxis& b) { return b.azimuth_rad; });
                             })
      .def_property_readonly("beam_elevation_rad",
                             [](const NativeTransmission& s) {
                               return by_beam(s, [](const BeamAxis& b) { return b.elevation_rad; });
                             })
      .def_property_readonly("range_edges_m", &range_edges)
      .def_property_readonly("receiver_baseline_m", &receiver_pairs)
      .def_property_readonly("rays", [](const NativeTransmission& s) { return rays(s.tubes()); })
      .def_property_readonly("receive_rays",
                             [](const NativeTransmission& s) { return rays(s.receive_tubes()); })
      .def_property_readonly(
          "receiver_apex_m",
          [](const NativeTransmission& s) { return three(s.metres(s.receive_tubes().apex)); })
      .def_property_readonly("tubes",
                             [](const py::object& self) {
                               return view_of<std::uint32_t>(transmission_in(self).tubes().tubes, self, 4);
                             })
      .def_property_readonly("beam_of_tube", &beam_of_tube)
      .def_property_readonly(
          "vertices_m",
          [](const py::object& self) { return view_of<double>(transmission_in(self).vertices_m(), self, 3); })
      .def_property_readonly("facets",
                             [](const py::object& self) {
                               return view_of<std::uint32_t>(transmission_in(self).mesh().facets, self, 3);
                             })
      .def_property_readonly("material",
                             [](const py::object& self) {
                               return view_of<std::uint16_t>(transmission_in(self).mesh().material, self);
                             })
      .def_property_readonly("component",
                             [](const py::object& self) {
                               return view_of<std::uint16_t>(transmission_in(self).mesh().component, self);
                             })
      .def_property_readonly("base_facet", &base_facets)
      .def_property_readonly(
          "material_mu", [](const NativeTransmission& s) { return array_of(s.survey().scene.material_mu); })
      .def_property_readonly("material_names", &material_names)
      .def(
          "trace", [](const NativeTransmission& s) { return s.trace(); },
          py::call_guard<py::gil_scoped_release>());
}

using Histories = py::class_<NativeHistory, std::shared_ptr<NativeHistory>>;

template <class T, class S, class Member>
void column(Histories& histories, const char* name, std::vector<S> FootprintSet::*elements, Member S::*member,
            std::size_t width = 1) {
  histories.def_property_readonly(name, [=](const py::object& self) {
    return view_of<T>(self.cast<const NativeHistory&>().footprints.*elements, member, self, width);
  });
}

void bind_history_class(py::module_& module) {
  Histories histories(module, "History");
  using F = Footprint;
  const auto footprints = &FootprintSet::footprints;
  column<std::uint32_t>(histories, "tube", footprints, &F::tube);
  column<std::uint32_t>(histories, "facet", footprints, &F::facet);
  column<double>(histories, "area_m2", footprints, &F::area_m2);
  column<double>(histories, "solid_angle_sr", footprints, &F::solid_angle_sr);
  column<double>(histories, "centroid_m", footprints, &F::centroid_m, 3);
  column<double>(histories, "normal", footprints, &F::plane_normal, 3);
  column<double>(histories, "plane_distance_m", footprints, &F::plane_distance_m);
  column<double>(histories, "grazing_rad", footprints, &F::grazing_angle_rad);
  column<double>(histories, "range_min_m", footprints, &F::slant_range_min_m);
  column<double>(histories, "range_max_m", footprints, &F::slant_range_max_m);
  column<std::uint32_t>(histories, "first_piece", footprints, &F::first_piece);
  column<std::uint32_t>(histories, "pieces", footprints, &F::piece_count);
  column<std::uint32_t>(histories, "first_occluder", footprints, &F::first_occluder);
  column<std::uint32_t>(histories, "occluders", footprints, &F::occluder_count);
  column<std::uint32_t>(histories, "piece_first_corner", &FootprintSet::pieces, &Piece::first);
  column<std::uint32_t>(histories, "piece_corners", &FootprintSet::pieces, &Piece::count);
  histories
      .def_property_readonly("receive_tube",
                             [](const py::object& self) {
                               return view_of<std::uint32_t>(self.cast<const NativeHistory&>().receive_tube,
                                                             self);
                             })
      .def_property_readonly("receive_distance_m",
                             [](const py::object& self) {
                               return view_of<double>(self.cast<const NativeHistory&>().receive_distance_m,
                                                      self);
                             })
      .def_property_readonly("corners_m",
                             [](const py::object& self) {
                               return view_of<double>(self.cast<const NativeHistory&>().footprints.corners_m,
                                                      self, 3);
                             })
      .def_property_readonly("occluder_facets", [](const py::object& self) {
        return view_of<std::uint32_t>(self.cast<const NativeHistory&>().footprints.occluders, self);
      });
}

}  // namespace

void bind_transmission(py::module_& module) {
  bind_transmission_class(module);
  bind_history_class(module);
}

}  // namespace tubefoot::python
