// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of runs: computes a run in memory and optionally writes a result folder. Exposes
// energies, labels and signals as views, and passes warnings on to Python.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>

#include "advice/advice.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "files/atomic_output.hpp"
#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "geometry/steps/stop.hpp"
#include "own_echo.hpp"
#include "plan/scene_drawing.hpp"
#include "result.hpp"
#include "run/labels.hpp"
#include "run/run_statistics.hpp"
#include "run/run_steps.hpp"
#include "run/run_warnings.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "run_apart.hpp"
#include "scene.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/recordings/pose_angles.hpp"
#include "sensors/recordings/receiver_output.hpp"
#include "sensors/recordings/run_context.hpp"
#include "sensors/recordings/sensor_kind.hpp"
#include "signals.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Queue of warnings for Python, which receives them from the thread that holds the interpreter lock.
class Warnings {
 public:
  void add(const std::string& warning, bool is_silence) {
    const std::scoped_lock lock(mutex_);
    waiting_.emplace_back(warning, is_silence);
  }
  /// Passes the new warnings on; the caller holds the interpreter lock.
  void tell(const py::object& image_receiver) {
    std::vector<std::pair<std::string, bool>> now;
    {
      const std::scoped_lock lock(mutex_);
      now.swap(waiting_);
    }
    for (const auto& [warning, is_silence] : now) image_receiver(warning, is_silence);
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::string, bool>> waiting_;
};

/// Computes a run as `tubefoot run` does, in memory and, on request, into a folder.
std::shared_ptr<NativeResult> compute(SceneDescription description, const RunOptions& options,
                                      const std::shared_ptr<const OwnEngine>& own, RunWatch& watch,
                                      Warnings& told) {
  const Clock::time_point start = Clock::now();
  if (options.arithmetic) description.run.arithmetic = *options.arithmetic;
  if (options.threads) description.run.threads = *options.threads;
  RunRequest request = requested(options, description);
  const OmittedFiles omitted = omitted_files(description, options);
  request.own_engine = own;
  std::optional<OutputFolder> output;
  if (!options.output.empty()) output.emplace(options.output, inputs_of(description));
  if (request.tolerance) pick_settings(description, request, true);
  stop_if_wanted();
  const ThreadLimit limit(description.run.threads);

  auto result = std::make_shared<NativeResult>();
  result->survey = open_survey(description, facets_for(request), request.coarseness);
  const Survey& survey = *result->survey;
  RunWarnings warnings([&](const std::string& warning, bool is_silence) { told.add(warning, is_silence); });
  warnings.foresee(survey, request);
  stop_if_wanted();
  const Clock::time_point simulation_start = Clock::now();
  result->store = std::make_shared<PingStore>(layout_of(survey, request));
  simulate(survey, request, *result->store, {true, &watch});
  stop_if_wanted();
  const SimulationStats stats = totals(survey, *result->store, request.selection);
  result->recordings = recordings_of(survey, result->store, request.selection);
  result->label_recordings = label_recordings_of(survey, request, result->store);
  warnings.look_back(survey, request, stats, result->recordings);

  result->provenance = provenance_of(survey.scene, request);
  nlohmann::ordered_json json = statistics_json(survey, request, stats);
  json["threads"] = limit.threads();
  json["seconds"] = {{"load", survey.loaded_scene->load_seconds},
                     {"tree", survey.loaded_scene->tree_seconds},
                     {"simulation", seconds_since(simulation_start)},
                     {"visibility_of_all_pings", stats.visibility_seconds},
                     {"echo_of_all_pings", stats.echo_seconds}};
  if (output) {
    std::vector<std::string> left_out;
    write_result_files(output->staging(), survey, request, result->recordings, left_out, {{}, true, omitted},
                       result->label_recordings);
    if (!omitted.scene_picture) write_scene_picture(output->staging() / scene_picture_name, survey);
    warnings.add(left_out);
    if (!omitted.names.empty()) json["omitted_files"] = omitted.names;
  }
  result->warnings = warnings.all();
  json["seconds"]["total"] = seconds_since(start);
  json["peak_memory_mb"] = peak_memory_mb();
  json["warnings"] = result->warnings;
  result->statistics = text_of(json);
  if (output) {
    write_file(output->staging() / "stats.json", result->statistics + "\n");
    stop_if_wanted();
    output->commit();
  }
  return result;
}

template <class T>
std::optional<T> option(const py::dict& options, const char* name) {
  if (!options.contains(name) || options[name].is_none()) return std::nullopt;
  return options[name].cast<T>();
}

std::shared_ptr<NativeResult> run(const NativeScene& scene, const py::dict& options,
                                  const std::optional<std::string>& own_name, const py::object& own,
                                  const py::object& progress, const py::object& warned) {
  RunOptions requested;
  requested.quiet = true;
  requested.arithmetic = option<std::string>(options, "arithmetic");
  requested.threads = option<int>(options, "threads");
  requested.output = option<std::string>(options, "output").value_or("");
  requested.selection = {option<std::string>(options, "sensor"), option<std::string>(options, "pings"),
                         option<std::string>(options, "beams")};
  requested.engine = option<std::string>(options, "engine");
  requested.binning = option<std::string>(options, "binning");
  requested.sampling = option<std::string>(options, "sampling");
  requested.rays = option<std::int64_t>(options, "rays");
  requested.rays_per_beam = option<std::int64_t>(options, "rays_per_beam");
  requested.seed = option<std::uint64_t>(options, "seed");
  requested.reference = option<bool>(options, "reference").value_or(false);
  requested.labels = option<bool>(options, "labels").value_or(false);
  requested.label_level_db = option<double>(options, "label_level");
  requested.tolerance = option<std::string>(options, "tolerance");
  requested.coarsen = option<std::string>(options, "coarsen");
  requested.gradient = option<std::string>(options, "gradient");
  requested.without = option<std::string>(options, "without");
  requested.gradient_steps = option<bool>(options, "gradient_steps").value_or(false);
  const auto engine = own_name ? own_engine(*own_name, own) : nullptr;
  RunWatch watch;
  std::shared_ptr<NativeResult> result;
  Warnings warnings;
  run_apart(
      watch, progress, [&] { result = compute(scene.description(), requested, engine, watch, warnings); },
      [&] { warnings.tell(warned); });
  return result;
}

py::dict arrays_of(const py::object& self, std::size_t sensor) {
  if (self.cast<const NativeResult&>().read) return read_arrays(self, sensor);
  const Recording& r = self.cast<const NativeResult&>().recordings.at(sensor);
  py::dict arrays;
  const auto beams = py::ssize_t(r.sensor->beams().size()), samples = py::ssize_t(r.sensor->samples().count);
  constexpr auto size = py::ssize_t(sizeof(double));
  for (const RecordedVariable& of : r.variables()) {
    const double* first = of.channel.values.data() + of.part * of.cells;
    const py::ssize_t pings = py::ssize_t(r.pings()), of_ping = py::ssize_t(of.cells * of.parts) * size;
    arrays[of.meaning.name.c_str()] =
        of.meaning.is_by_beam ? view(first, {pings, beams}, {of_ping, size}, self)
                              : view(first, {pings, beams, samples}, {of_ping, samples * size, size}, self);
  }
  arrays["ping_time"] = view_of<double>(r.ping_time_s, self);
  arrays["sensor_position"] = view_of<double>(r.ping_pose, &Pose::position_m, self, 3);
  const auto add_attitudes = [&](const std::string& sensor_name, const auto& pose_of) {
    std::vector<double> attitude, heading, pitch, roll;
    for (std::size_t ping = 0; ping < r.pings(); ++ping) {
      const glm::dquat q = glm::normalize(pose_of(ping).attitude);
      attitude.insert(attitude.end(), {q.w, q.x, q.y, q.z});
      const PoseAngles angles = angles_of(q);
      heading.push_back(angles.heading_deg);
      pitch.push_back(angles.pitch_deg);
      roll.push_back(angles.roll_deg);
    }
    arrays[(sensor_name + "_attitude").c_str()] = array_of(attitude, 4);
    arrays[(sensor_name + "_heading").c_str()] = array_of(heading);
    arrays[(sensor_name + "_pitch").c_str()] = array_of(pitch);
    arrays[(sensor_name + "_roll").c_str()] = array_of(roll);
  };
  add_attitudes("sensor", [&](std::size_t ping) { return r.ping_pose[ping]; });
  if (!r.recorded_poses.empty()) {
    std::vector<double> positions;
    for (std::size_t ping = 0; ping < r.pings(); ++ping) {
      const glm::dvec3 p = r.recorded_pose(ping).position_m;
      positions.insert(positions.end(), {p.x, p.y, p.z});
    }
    arrays["recorded_sensor_position"] = array_of(positions, 3);
    add_attitudes("recorded_sensor", [&](std::size_t ping) { return r.recorded_pose(ping); });
  }
  arrays["altitude"] = view_of<double>(r.altitude_m, self);
  const Provenance& provenance = self.cast<const NativeResult&>().provenance;
  for (const PingColumn& column : ping_columns(r, provenance)) arrays[column.name] = array_of(column.values);
  return arrays;
}

/// Returns a copy of the received data of a sensor, of shape (pings, beams, samples). Returns None for an
/// ideal receiver, for the lower receiver unless there is a pair, and for a file, whose arrays include them.
py::object received_of(const NativeResult& self, std::size_t sensor, bool lower) {
  if (self.read) return py::none();
  const Recording& r = self.recordings.at(sensor);
  RunContext run;
  run.seed = self.survey->scene.description.run.seed;
  const std::optional<ReceiverOutput> received = receiver_output_of(r, run);
  if (!received || (lower && !received->lower_energy_of)) return py::none();
  const auto samples = py::ssize_t(r.sensor->samples().count);
  py::array_t<double> values({py::ssize_t(r.pings()), py::ssize_t(r.cells()) / samples, samples});
  double* first = values.mutable_data();
  {
    const py::gil_scoped_release released;
    tbb::parallel_for(std::size_t{0}, r.pings(), [&](std::size_t ping) {
      std::ranges::copy(received->recorded_energy_of(ping, lower), first + ping * r.cells());
    });
  }
  return values;
}

/// Returns the labels of the energies of a sensor under the names of echoes.nc, with ping as the first
/// axis. Returns None if labels were not requested.
py::object label_recording_of(const py::object& result, std::size_t sensor) {
  const auto& self = result.cast<const NativeResult&>();
  if (self.read) return read_labels(result, sensor);
  if (self.label_recordings.empty()) return py::none();
  const Recording& r = self.recordings.at(sensor);
  const LabelRecording& label_recording = self.label_recordings.at(sensor);
  const auto samples = py::ssize_t(r.sensor->samples().count),
             beams = py::ssize_t(label_recording.cells) / samples;
  std::vector<double> objects, materials, unscattered, height, range;
  std::vector<std::int16_t> object, material;
  const auto append = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  for (std::size_t p = 0; p < r.pings(); ++p) {
    const LabelPing ping = label_recording.of(p);
    append(objects, ping.object_share);
    append(materials, ping.material_share);
    append(unscattered, ping.unscattered_share);
    append(height, ping.mean_height);
    append(range, ping.mean_range);
    append(object, ping.object_label);
    append(material, ping.material_label);
  }
  const auto pings = py::ssize_t(r.pings());
  const auto shares = [&](const std::vector<double>& values, std::size_t labels) {
    return array_of(values).reshape({pings, py::ssize_t(labels), beams, samples});
  };
  const auto cells = [&](const auto& values) { return array_of(values).reshape({pings, beams, samples}); };
  py::dict arrays;
  arrays["objects"] = label_recording.objects;
  arrays["materials"] = label_recording.materials;
  arrays["object_share"] = shares(objects, label_recording.objects.size());
  arrays["material_share"] = shares(materials, label_recording.materials.size());
  if (label_recording.has_unscattered) arrays["unscattered_share"] = cells(unscattered);
  arrays["mean_height"] = cells(height);
  arrays["mean_range"] = cells(range);
  arrays["object_label"] = cells(object);
  arrays["material_label"] = cells(material);
  return arrays;
}

/// Returns the signals of the elements of a sensor. Returns None for a file and for sensors that record
/// only energies.
py::object signals_of(const NativeResult& self, std::size_t sensor) {
  if (self.read) return py::none();
  const Recording& r = self.recordings.at(sensor);
  if (!r.signals) return py::none();
  return py::cast(std::make_shared<NativeSignals>(NativeSignals{element_signals_of(r)}));
}

py::dict axes_of(const NativeResult& self, std::size_t sensor) {
  if (self.read) return {};  // the arrays of a file include its axes
  const Recording& r = self.recordings.at(sensor);
  py::dict axes;
  std::vector<double> azimuth, elevation, azimuth_width, elevation_width;
  for (const BeamAxis& beam : r.sensor->beams()) {
    azimuth.push_back(degrees(beam.azimuth_rad));
    elevation.push_back(degrees(beam.elevation_rad));
    azimuth_width.push_back(degrees(beam.azimuth_width_rad));
    elevation_width.push_back(degrees(beam.elevation_width_rad));
  }
  axes["beam_azimuth"] = array_of(azimuth);
  axes["beam_elevation"] = array_of(elevation);
  axes["beam_azimuth_width"] = array_of(azimuth_width);
  axes["beam_elevation_width"] = array_of(elevation_width);
  for (const SectorColumn& column : sector_columns(r)) axes[column.name] = array_of(column.values);
  if (!r.beam_numbers.empty())
    axes["beam_number"] = array_of(std::vector<double>(r.beam_numbers.begin(), r.beam_numbers.end()));
  const RangeSamples& samples = r.sensor->samples();
  std::vector<double> centres, bounds, times;
  for (int k = 0; k < samples.count; ++k) {
    centres.push_back(samples.first_m + (k + 0.5) * samples.step_m);
    bounds.push_back(samples.first_m + k * samples.step_m);
    bounds.push_back(samples.first_m + (k + 1) * samples.step_m);
    times.push_back(2 * centres.back() / r.sound_speed_m_s);
  }
  axes["slant_range"] = array_of(centres);
  axes["slant_range_bounds"] = array_of(bounds, 2);
  axes["two_way_travel_time"] = array_of(times);
  return axes;
}

py::dict attributes_of(const NativeResult& self, std::size_t sensor) {
  if (self.read) return read_attributes(self, sensor);
  const Recording& r = self.recordings.at(sensor);
  py::dict attributes;
  attributes["sensor_name"] = r.sensor->description().name;
  attributes["sensor_kind"] = kind_of(r.sensor->description()).name();
  attributes["frequency_khz"] = r.sensor->frequency_khz();
  attributes["source_energy"] = "1 J/sr at 1 m";
  attributes["sound_speed_m_s"] = r.sound_speed_m_s;
  attributes["absorption_db_per_km"] = r.absorption_db_per_km;
  return attributes;
}

py::dict file_attributes(const NativeResult& self) {
  py::dict attributes;
  if (self.read)
    for (const auto& [name, value] : self.read->attributes) attributes[name.c_str()] = value;
  else
    for (const auto& [name, value] : tubefoot::attributes_of(self.provenance)) attributes[name] = value;
  return attributes;
}

}  // namespace

void bind_run(py::module_& module) {
  py::class_<NativeResult, std::shared_ptr<NativeResult>>(module, "Result")
      .def_property_readonly("sensors",
                             [](const NativeResult& self) {
                               std::vector<std::string> names;
                               if (self.read)
                                 for (const SensorEchoes& s : self.read->contents.sensors)
                                   names.push_back(s.name);
                               for (const Recording& r : self.recordings)
                                 names.push_back(r.sensor->description().name);
                               return names;
                             })
      .def_readonly("statistics", &NativeResult::statistics)
      .def_readonly("warnings", &NativeResult::warnings)
      .def("arrays", &arrays_of)
      .def("axes", &axes_of)
      .def("received", &received_of)
      .def("labels", &label_recording_of)
      .def("signals", &signals_of)
      .def("attributes", &attributes_of)
      .def("file_attributes", &file_attributes)
      .def("dimensions", &dimensions_of);
  module.def("run", &run);
}

}  // namespace tubefoot::python
