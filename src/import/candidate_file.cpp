// SPDX-License-Identifier: GPL-3.0-or-later
// Writes an imported candidate as an echo file: its energies and axes, and the times and poses of the
// sensor of the reference (docs/output-files.md).
#include "import/candidate_file.hpp"

#include <fmt/format.h>

#include <map>
#include <span>
#include <stdexcept>
#include <utility>

#include "geometry/steps/stop.hpp"
#include "sensors/formats/echo_netcdf.hpp"

namespace tubefoot {
namespace {

class CandidateFile {
 public:
  CandidateFile(const std::filesystem::path& file, const CandidateEchoes& candidate,
                const WholeEchoFile& reference, std::size_t sensor)
      : file_(file),
        group_(file_.root()),
        candidate_(candidate),
        echoes_(reference.contents.sensors.at(sensor)),
        more_(reference.more.at(sensor)),
        provenance_(reference.contents.provenance) {}

  void write() {
    attributes();
    const BinAxes& axes = candidate_.axes;
    const std::size_t beams = axes.beams.count(), samples = axes.samples.count();
    if (candidate_.energy.size() != candidate_.pings * beams * samples)
      throw std::logic_error(fmt::format("{} energies for {} pings of {} beams x {} samples",
                                         candidate_.energy.size(), candidate_.pings, beams, samples));
    lengths_ = {{"ping", candidate_.pings},
                {"beam", beams},
                {"sample", samples},
                {"bound", 2},
                {"xyz", 3},
                {"wxyz", 4}};
    for (const char* name : {"ping", "beam", "sample", "bound", "xyz", "wxyz"})
      along_[name] = group_.dimension(name, lengths_.at(name));
    put("slant_range", {"sample"}, "m", "slant range of the sample's centre", axes.samples.centres);
    std::vector<double> bounds;
    for (std::size_t k = 0; k < samples; ++k)
      bounds.insert(bounds.end(), {axes.samples.edges[k], axes.samples.edges[k + 1]});
    put("slant_range_bounds", {"sample", "bound"}, "m",
        "slant ranges of the sample's near edge (inclusive) and far edge (exclusive)", bounds);
    put("beam_azimuth", {"beam"}, "degree",
        "azimuth of the beam's axis in the sensor's frame, clockwise from forward, starboard positive",
        axes.beams.centres);
    if (beams == echoes_.beams && !echoes_.beam_elevation_deg.empty())
      put("beam_elevation", {"beam"}, "degree",
          "elevation of the beam's axis above the sensor's horizontal plane", echoes_.beam_elevation_deg);
    if (!echoes_.ping_time_s.empty())
      put("ping_time", {"ping"}, "s", "time of the transmission on the scene's clock",
          of_pings(echoes_.ping_time_s, 1));
    for (const EchoVariable& variable : more_.variables) copy(variable, beams);
    const int energy =
        group_.define("energy", along({"ping", "beam", "sample"}), "J m-2",
                      "imported: see the attributes import_*; J m-2 only if import_unit is J m-2");
    group_.chunk(energy, "energy", {1, beams, samples});
    group_.write();
    const auto of_ping = [&](std::size_t ping) {
      return packed_chunk(std::span(candidate_.energy).subspan(ping * beams * samples, beams * samples));
    };
    write_pings(file_.chunks(bytes_of(candidate_)), "/", {{"energy", of_ping}}, candidate_.pings,
                beams * samples, [](std::size_t) { stop_if_wanted(); });
    file_.close();
  }

 private:
  static std::size_t bytes_of(const CandidateEchoes& candidate) {
    return candidate.energy.size() * sizeof(double);
  }

  void attributes() {
    const auto text = [&](const std::string& name, const std::string& value) {
      if (!value.empty()) group_.attribute(name, value);
    };
    text("title", provenance_.title);
    text("Conventions", "tubefoot-echoes-1.0");
    text("scene_hash", provenance_.scene_hash);
    for (const auto& [name, value] : candidate_.attributes) text(name, value);
    text("sensor_name", echoes_.name);
    for (const EchoAttribute& attribute : more_.attributes) {
      if (attribute.name == "sensor_name") continue;
      if (const auto* words = std::get_if<std::string>(&attribute.value))
        text(attribute.name, *words);
      else
        group_.attribute(attribute.name, std::get<double>(attribute.value));
    }
  }

  void put(const std::string& name, const std::vector<std::string>& dimensions, const std::string& units,
           const std::string& long_name, std::vector<double> values) {
    std::size_t count = 1;
    for (const std::string& dimension : dimensions) count *= lengths_.at(dimension);
    if (values.size() != count)
      throw std::logic_error(fmt::format("{} values of '{}' for {}", values.size(), name, count));
    group_.variable(name, along(dimensions), units, long_name, std::move(values));
  }

  std::vector<int> along(const std::vector<std::string>& dimensions) const {
    std::vector<int> ids;
    for (const std::string& dimension : dimensions) ids.push_back(along_.at(dimension));
    return ids;
  }

  /// Returns the values of the reference, `each` per ping, for the pings of the candidate.
  std::vector<double> of_pings(const std::vector<double>& values, std::size_t each) const {
    std::vector<double> result;
    for (const std::size_t ping : candidate_.ping_of_reference)
      for (std::size_t k = 0; k < each; ++k) result.push_back(values.at(ping * each + k));
    return result;
  }

  /// Copies variables of the pose and the beam widths of the sensor. Skips variables of the echoes of the
  /// reference, and those along a dimension of another length.
  void copy(const EchoVariable& variable, std::size_t beams) {
    const std::vector<std::string>& along = variable.dimensions;
    const bool of_sensor = variable.name.starts_with("sensor_") || variable.name == "ping_number";
    const auto as_long = [&](std::size_t k) {
      return lengths_.contains(along[k]) && lengths_.at(along[k]) == variable.shape[k];
    };
    if (of_sensor && along.size() <= 2 && along[0] == "ping" && variable.shape[0] == echoes_.pings &&
        (along.size() == 1 || (along[1] != "ping" && as_long(1))) &&
        (variable.name != "ping_number" || candidate_.pings == echoes_.pings))
      put(variable.name, along, variable.units, variable.long_name,
          of_pings(variable.values, along.size() == 2 ? variable.shape[1] : 1));
    else if (variable.along({"beam"}) && beams == echoes_.beams && as_long(0))
      put(variable.name, along, variable.units, variable.long_name, variable.values);
  }

  EchoNetcdf file_;
  EchoGroup group_;
  const CandidateEchoes& candidate_;
  const SensorEchoes& echoes_;
  const WholeEchoFile::More& more_;
  const Provenance& provenance_;
  std::map<std::string, std::size_t> lengths_;
  std::map<std::string, int> along_;
};

}  // namespace

void write_candidate(const std::filesystem::path& file, const CandidateEchoes& candidate,
                     const WholeEchoFile& reference, std::size_t sensor) {
  CandidateFile(file, candidate, reference, sensor).write();
}

}  // namespace tubefoot
