// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings of studies: compares echoes, measures work-precision charts that may include engines in
// Python, and gives advice on settings.
#include <pybind11/stl.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <variant>

#include "advice/advice_json.hpp"
#include "advice/chart_folder.hpp"
#include "advice/trials.hpp"
#include "bindings.hpp"
#include "compare/comparison.hpp"
#include "files/atomic_output.hpp"
#include "files/json_text.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "own_echo.hpp"
#include "result.hpp"
#include "run/settings.hpp"
#include "run_apart.hpp"
#include "scene.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

/// An echo file by name, or a result that is converted as if read from a file.
using Echoes = std::variant<std::shared_ptr<NativeResult>, std::string>;

std::shared_ptr<const EchoContents> contents_of(const Echoes& echoes, const std::string& called) {
  if (const auto* file = std::get_if<std::string>(&echoes))
    return std::make_shared<const EchoContents>(read_echo_file(*file));
  const auto& result = std::get<std::shared_ptr<NativeResult>>(echoes);
  if (!result) throw py::type_error("compare: expected a result or the name of an echo file, not None");
  return contents_of(*result, called);
}

std::string compare(const Echoes& first, const Echoes& second, const std::optional<std::string>& sensor,
                    std::size_t worst, bool any_scene) {
  const std::shared_ptr<const EchoContents> reference = contents_of(first, "reference"),
                                            candidate = contents_of(second, "candidate");
  const EchoPairs pairs = pair_echoes(*reference, *candidate, sensor, any_scene);
  return text_of(comparison_json(*reference, *candidate, pairs, errors_of(pairs, worst)));
}

struct ChartRequest {
  std::vector<std::shared_ptr<NativeScene>> scenes;
  std::vector<std::string> builtin;  ///< names of engines: tube, ray
  std::vector<std::pair<std::string, py::object>> own;
  std::string output;  ///< folder; empty for none
  std::string pings = "0";
  std::optional<std::size_t> first_pings;  ///< number of first pings, instead of `pings`
  int repeats = 3;
  double seconds = 4;
};

std::vector<EngineSetting> settings_of(const std::vector<std::string>& builtin, std::size_t beams) {
  std::vector<EngineSetting> settings;
  for (const std::string& name : builtin)
    for (EngineSetting& s : name == "tube" ? tube_settings() : ray_settings(beams))
      settings.push_back(std::move(s));
  return settings;
}

std::vector<Trial> chart(const ChartRequest& request, RunWatch& watch) {
  Inputs inputs;
  for (const auto& scene : request.scenes) {
    const Inputs its = inputs_of(scene->description());
    inputs.insert(inputs.end(), its.begin(), its.end());
  }
  std::optional<OutputFolder> output;
  if (!request.output.empty()) output.emplace(request.output, inputs);
  const ThreadLimit one_thread(1);  // the seconds of a setting do not depend on other threads
  watch.total = request.scenes.size() * (settings_of(request.builtin, 1).size() + request.own.size());
  const auto step = [&watch] {
    ++watch.pings;
    stop_if_wanted();
  };
  std::set<std::string> names;
  std::vector<Trial> trials;
  for (const auto& described : request.scenes) {
    TrialScene scene(described->description(),
                     request.first_pings ? first_pings(*request.first_pings) : chosen_pings(request.pings),
                     chart_reference_tolerance);
    if (!names.insert(scene.name()).second)
      throw UsageError("two scenes have the name '" + scene.name() +
                       "', so the chart cannot distinguish them: rename a file or its folder");
    std::vector<EngineSetting> settings = settings_of(request.builtin, scene.beams());
    for (const auto& [name, function] : request.own) {
      EngineSetting& own = settings.emplace_back();
      own.engine = name;
      own.setting = "Python";
      own.run.own_engine = own_engine(name, function);
    }
    for (Trial& trial : all_trials(scene, settings, request.repeats, {.seconds = request.seconds}, step))
      trials.push_back(std::move(trial));
  }
  if (output) {
    write_chart(output->staging(), trials,
                chart_origin("<code>tubefoot.chart</code>", request.pings, request.repeats));
    output->commit();
  }
  return trials;
}

std::vector<py::dict> chart_from_python(const py::dict& requested, const py::object& progress) {
  ChartRequest request;
  request.scenes = requested["scenes"].cast<decltype(request.scenes)>();
  if (std::ranges::any_of(request.scenes, [](const auto& scene) { return scene == nullptr; }))
    throw py::type_error("chart: expected scenes, not None");
  request.builtin = requested["builtin"].cast<decltype(request.builtin)>();
  request.own = requested["own"].cast<decltype(request.own)>();
  request.output = requested["output"].cast<std::string>();
  request.pings = requested["pings"].cast<std::string>();
  request.first_pings = requested["first_pings"].cast<std::optional<std::size_t>>();
  request.repeats = requested["repeats"].cast<int>();
  request.seconds = requested["seconds"].cast<double>();
  RunWatch watch;
  std::vector<Trial> trials;
  run_apart(watch, progress, [&] { trials = chart(request, watch); });
  std::vector<py::dict> rows;
  for (const Trial& t : trials) {
    py::dict& row = rows.emplace_back();
    row["scene"] = t.scene;
    row["engine"] = t.engine;
    row["setting"] = t.setting;
    row["l1_error"] = t.l1_error;
    row["rms_db_error"] = t.rms_db_error;
    row["seconds"] = t.work.seconds;
    row["processor_seconds"] = t.work.processor_seconds;
    row["instructions"] = t.work.instructions > 0 ? py::cast(t.work.instructions) : py::object(py::none());
    row["bound"] = t.bound;
    row["rays"] = t.samples;
  }
  return rows;
}

/// Returns advice as the text of `tubefoot advise --json`.
std::string advise_from_python(const NativeScene& scene, const std::string& tolerance,
                               const std::string& pings, std::size_t trial_pings,
                               std::optional<int> threads) {
  std::string said;
  RunWatch watch;
  run_apart(watch, py::none(), [&] {
    AdviceOptions options;
    options.pings = pings;
    options.trial_pings = trial_pings;
    options.seed = scene.description().run.seed;
    options.quiet = true;
    const ThreadLimit limit(threads.value_or(scene.description().run.threads));
    said = text_of(
        json_of(advise(scene.description(), requested_tolerance(tolerance), options), scene.description()));
  });
  return said;
}

}  // namespace

std::shared_ptr<const EchoContents> contents_of(const NativeResult& result, const std::string& called) {
  if (result.read) return {result.read, &result.read->contents};
  EchoContents contents{called, result.provenance, {}};
  for (const Recording& r : result.recordings) {
    SensorEchoes sensor;
    sensor.name = r.sensor->description().name;
    sensor.pings = r.pings();
    sensor.beams = r.sensor->beams().size();
    sensor.samples = std::size_t(r.sensor->samples().count);
    for (std::size_t ping = 0; ping < r.pings(); ++ping) {
      const PingEnergies kept = r.energy_of(ping);
      const std::span<const double> energy = kept;
      sensor.energy.insert(sensor.energy.end(), energy.begin(), energy.end());
    }
    for (std::size_t ping = 0; ping < r.pings() && r.has_bounds(); ++ping) {
      const PingEnergies kept = r.bound_of(ping, 0);
      const std::span<const double> bound = kept;
      sensor.energy_bound.insert(sensor.energy_bound.end(), bound.begin(), bound.end());
    }
    const RangeSamples& samples = r.sensor->samples();
    for (int k = 0; k < samples.count; ++k) {
      sensor.slant_range_m.push_back(samples.first_m + (k + 0.5) * samples.step_m);
      sensor.slant_range_bounds_m.push_back(samples.first_m + k * samples.step_m);
      sensor.slant_range_bounds_m.push_back(samples.first_m + (k + 1) * samples.step_m);
    }
    for (const BeamAxis& beam : r.sensor->beams()) {
      sensor.beam_azimuth_deg.push_back(degrees(beam.azimuth_rad));
      sensor.beam_elevation_deg.push_back(degrees(beam.elevation_rad));
    }
    sensor.ping_time_s = r.ping_time_s;
    contents.sensors.push_back(std::move(sensor));
  }
  return std::make_shared<const EchoContents>(std::move(contents));
}

void bind_study(py::module_& module) {
  module.def("compare", &compare, py::call_guard<py::gil_scoped_release>());
  module.def("chart", &chart_from_python);
  module.def("advise", &advise_from_python);
}

}  // namespace tubefoot::python
