// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of element signals: exposes the signals of a run or a file as complex arrays. It computes
// signals of points, and applies beamforming, focusing and matched filters.
#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "files/atomic_output.hpp"
#include "run_apart.hpp"
#include "sensors/beamforming/back_projection.hpp"
#include "sensors/beamforming/beams.hpp"
#include "sensors/formats/signals_netcdf.hpp"
#include "sensors/signals/matched_filter.hpp"
#include "sensors/signals/point_signals.hpp"
#include "signals.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

using Complex = std::complex<double>;
using Reals = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Complexes = py::array_t<Complex, py::array::c_style | py::array::forcecast>;

using Shared = std::shared_ptr<NativeSignals>;

/// Returns the values of an array of that shape in sequence. `what` begins the error message for another
/// shape.
std::vector<double> values_of(const Reals& array, std::size_t width, const std::string& what) {
  const bool fits =
      width == 0 ? array.ndim() == 1 : array.ndim() == 2 && std::size_t(array.shape(1)) == width;
  if (!fits)
    throw std::invalid_argument(what + (width == 0
                                            ? " must have the shape (N,)"
                                            : " must have the shape (N, " + std::to_string(width) + ")"));
  return {array.data(), array.data() + array.size()};
}

std::vector<glm::dvec3> places_of(const Reals& array, const std::string& what) {
  const std::vector<double> values = values_of(array, 3, what);
  std::vector<glm::dvec3> places;
  for (std::size_t k = 0; k < values.size(); k += 3)
    places.emplace_back(values[k], values[k + 1], values[k + 2]);
  return places;
}

using Place = std::array<double, 3>;
glm::dvec3 vector_of(const Place& place) { return {place[0], place[1], place[2]}; }

template <class Work>
auto apart(const Work& work) {
  std::optional<decltype(work())> result;
  RunWatch watch;
  run_apart(watch, py::none(), [&] { result.emplace(work()); });
  return std::move(*result);
}

Shared made(const std::function<ElementSignals()>& work) {
  return apart([&] { return std::make_shared<NativeSignals>(NativeSignals{work()}); });
}

ApertureWindow window_of(const std::string& model, double side_lobe_db, int nearly_equal) {
  using Law = ApertureWindow::Law;
  const std::pair<const char*, Law> models[] = {{"uniform", Law::uniform},
                                                {"hann", Law::hann},
                                                {"hamming", Law::hamming},
                                                {"taylor", Law::taylor},
                                                {"chebyshev", Law::chebyshev}};
  for (const auto& [name, known] : models)
    if (model == name) return {known, side_lobe_db, nearly_equal};
  throw std::invalid_argument("unknown window '" + model +
                              "': expected uniform, hann, hamming, taylor or chebyshev");
}

/// Returns a complex array that owns its values.
py::array complex_array(std::vector<Complex> values, const std::vector<py::ssize_t>& shape) {
  auto* kept = new std::vector<Complex>(std::move(values));
  const py::capsule owner(kept, [](void* memory) { delete static_cast<std::vector<Complex>*>(memory); });
  return py::array_t<Complex>(shape, kept->data(), owner);
}

Shared points(const Reals& targets, const Complexes& strengths, const Place& transmitter,
              const Reals& receivers, const std::array<double, 4>& waveform, double baseband_hz,
              double rate_hz, double first_s, std::size_t samples, const Reals& track_times,
              const Reals& positions, const Reals& attitudes, const Reals& ping_times, bool stop_and_hop,
              double sound_speed) {
  const std::vector<glm::dvec3> places = places_of(targets, "targets"),
                                at = places_of(positions, "positions");
  const std::vector<double> turned = values_of(attitudes, 4, "attitudes"),
                            times = values_of(track_times, 0, "track_times");
  if (std::size_t(strengths.size()) != places.size() || at.size() != times.size() ||
      turned.size() != 4 * times.size())
    throw std::invalid_argument(
        "the arguments need one strength per target, and one position and attitude per time of the track");
  std::vector<PointScatterer> scatterers;
  for (std::size_t k = 0; k < places.size(); ++k) scatterers.push_back({places[k], strengths.data()[k]});
  std::vector<Trajectory::Sample> track;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double* q = &turned[4 * k];
    track.push_back({times[k], {at[k], {q[0], q[1], q[2], q[3]}}});
  }
  const ElementArray array{vector_of(transmitter), places_of(receivers, "receivers")};
  const std::vector<double> starts = values_of(ping_times, 0, "ping_times");
  return made([&] {
    return point_signals(scatterers, array, {waveform[0], waveform[1], waveform[2], waveform[3]},
                         {baseband_hz, rate_hz, first_s, samples}, VehicleMotion(track, starts, stop_and_hop),
                         sound_speed);
  });
}

py::array beams(const NativeSignals& self, const std::vector<std::size_t>& pings, const Reals& directions,
                const Reals& weights, const Place& reference, bool near_field, bool by_phase, double band,
                double error) {
  const ElementSignals& signals = self.signals;
  const BeamSteering steering{places_of(directions, "directions"), values_of(weights, 0, "weights"),
                              vector_of(reference), near_field};
  std::vector<Complex> all = apart([&] {
    const SignalInterpolator interpolator(band, error);
    std::vector<Complex> values;
    for (const std::size_t ping : pings) {
      const std::vector<Complex> own = by_phase ? phase_and_sum(signals, ping, steering)
                                                : delay_and_sum(signals, ping, steering, interpolator);
      values.insert(values.end(), own.begin(), own.end());
    }
    return values;
  });
  return complex_array(std::move(all), {py::ssize_t(pings.size()), py::ssize_t(steering.directions.size()),
                                        py::ssize_t(signals.samples())});
}

py::array focused(const NativeSignals& self, const Place& first, const Place& column_step,
                  const Place& row_step, std::size_t columns, std::size_t rows, const Reals& ping_weights,
                  const Reals& receiver_weights, std::optional<double> half_beam_rad, bool spreading_undone,
                  double band, double error) {
  const PixelPlane plane{vector_of(first), vector_of(column_step), vector_of(row_step), columns, rows};
  const BackProjection how{values_of(ping_weights, 0, "ping_weights"),
                           values_of(receiver_weights, 0, "receiver_weights"), half_beam_rad,
                           spreading_undone};
  std::vector<Complex> picture =
      apart([&] { return back_projected(self.signals, plane, SignalInterpolator(band, error), how); });
  return complex_array(std::move(picture), {py::ssize_t(rows), py::ssize_t(columns)});
}

py::dict arrays(const py::object& self) {
  const ElementSignals& signals = self.cast<const NativeSignals&>().signals;
  py::dict all;
  const py::ssize_t pings = py::ssize_t(signals.pings()), receivers = py::ssize_t(signals.receivers()),
                    samples = py::ssize_t(signals.samples()), width = sizeof(Complex);
  all["pressure"] = view(signals.pressure.data(), {pings, receivers, samples},
                         {receivers * samples * width, samples * width, width}, self);
  if (!signals.derivatives.empty()) {
    py::dict gradient;
    for (const ElementSignals::Derivative& by : signals.derivatives)
      gradient[by.parameter.c_str()] = view(by.values.data(), {pings, receivers, samples},
                                            {receivers * samples * width, samples * width, width}, self);
    all["gradient"] = gradient;
  }
  all["ping_times"] = view_of<double>(signals.motion.ping_start_s(), self);
  all["receivers"] = view_of<double>(signals.array.receivers_m, self, 3);
  std::vector<double> times, positions, attitudes;
  for (std::size_t k = 0; k < signals.samples(); ++k) times.push_back(signals.sampling.time_s(k));
  for (std::size_t k = 0; k < signals.pings(); ++k) {
    const auto& [p, q] = signals.motion.ping_pose(k);
    positions.insert(positions.end(), {p.x, p.y, p.z});
    attitudes.insert(attitudes.end(), {q.w, q.x, q.y, q.z});
  }
  all["sample_times"] = array_of(times);
  all["positions"] = array_of(positions, 3);
  all["attitudes"] = array_of(attitudes, 4);
  return all;
}

py::dict numbers(const NativeSignals& self) {
  const ElementSignals& s = self.signals;
  py::dict all;
  all["baseband_frequency"] = s.sampling.baseband_hz;
  all["sample_rate"] = s.sampling.rate_hz;
  all["sound_speed"] = s.sound_speed_m_s;
  all["transmitter"] = Place{s.array.transmitter_m.x, s.array.transmitter_m.y, s.array.transmitter_m.z};
  all["waveform"] =
      std::array<double, 4>{s.waveform.start_hz, s.waveform.stop_hz, s.waveform.duration_s, s.waveform.taper};
  all["stop_and_hop"] = s.motion.stop_and_hop();
  all["matched_filtered"] = s.matched_filtered;
  return all;
}

void write(const NativeSignals& self, const std::string& file) {
  apart([&] {
    OutputFile output(file, {});
    write_signals(output.path(), self.signals, {"", "", "", "", TUBEFOOT_VERSION});
    output.commit();
    return true;
  });
}

}  // namespace

void bind_signals(py::module_& module) {
  py::class_<NativeSignals, std::shared_ptr<NativeSignals>>(module, "Signals")
      .def("arrays", [](const py::object& self) { return arrays(self); })
      .def("numbers", &numbers)
      .def("beams", &beams)
      .def("focused", &focused)
      .def("matched_filtered",
           [](const NativeSignals& self, const std::string& window, double side_lobe_db, int nearly_equal) {
             return made([&] {
               return matched_filtered(self.signals, window_of(window, side_lobe_db, nearly_equal));
             });
           })
      .def("write", &write);
  module.def("read_signals",
             [](const std::string& file) { return made([&] { return read_signals(file); }); });
  module.def("point_signals", &points);
  module.def("window_weights",
             [](const std::string& window, std::size_t elements, double side_lobe_db, int nearly_equal) {
               return array_of(window_weights(window_of(window, side_lobe_db, nearly_equal), elements));
             });
}

}  // namespace tubefoot::python
