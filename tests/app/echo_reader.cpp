// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/echo_reader.hpp"

#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace tubefoot {
namespace {

void require(int status, const std::string& what) {
  if (status != NC_NOERR) throw std::runtime_error(what + ": " + nc_strerror(status));
}

struct NetcdfFile {
  int id = -1;
  explicit NetcdfFile(const std::filesystem::path& file) {
    require(nc_open(file.c_str(), NC_NOWRITE, &id), file.string());
  }
  ~NetcdfFile() { nc_close(id); }
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;
};

std::vector<std::size_t> shape(int group, int variable) {
  int count = 0;
  require(nc_inq_varndims(group, variable, &count), "dimensions");
  std::vector<int> ids(static_cast<std::size_t>(count));
  require(nc_inq_vardimid(group, variable, ids.data()), "dimensions");
  std::vector<std::size_t> lengths(ids.size());
  for (std::size_t k = 0; k < ids.size(); ++k) require(nc_inq_dimlen(group, ids[k], &lengths[k]), "length");
  return lengths;
}

std::vector<double> values(int group, const char* name, std::vector<std::size_t>& lengths) {
  int variable = 0;
  require(nc_inq_varid(group, name, &variable), name);
  lengths = shape(group, variable);
  std::vector<double> result(
      std::accumulate(lengths.begin(), lengths.end(), std::size_t{1}, std::multiplies<>()));
  require(nc_get_var_double(group, variable, result.data()), name);
  return result;
}

}  // namespace

std::size_t Echoes::sample_at(double range_m) const {
  for (std::size_t k = 0; k < samples; ++k)
    if (first_m(k) <= range_m && range_m < last_m(k)) return k;
  throw std::out_of_range("no sample at " + std::to_string(range_m) + " m");
}

double Echoes::beam_total(std::size_t ping, std::size_t beam) const {
  const auto first = energy.begin() + static_cast<std::ptrdiff_t>((ping * beams + beam) * samples);
  return std::accumulate(first, first + static_cast<std::ptrdiff_t>(samples), 0.0);
}

double Echoes::total() const { return std::accumulate(energy.begin(), energy.end(), 0.0); }

Echoes read_echoes(const std::filesystem::path& file, const std::string& sensor) {
  const NetcdfFile netcdf(file);
  int group = netcdf.id;
  if (!sensor.empty()) require(nc_inq_grp_ncid(netcdf.id, sensor.c_str(), &group), "group " + sensor);
  Echoes echoes;
  std::vector<std::size_t> lengths;
  echoes.energy = values(group, "energy", lengths);
  echoes.pings = lengths.at(0), echoes.beams = lengths.at(1), echoes.samples = lengths.at(2);
  int bound = 0;
  if (nc_inq_varid(group, "energy_bound", &bound) == NC_NOERR) {
    echoes.bound = values(group, "energy_bound", lengths);
    if (lengths != std::vector{echoes.pings, echoes.beams, echoes.samples})
      throw std::runtime_error("energy_bound has another shape than energy");
  }
  echoes.slant_range_bounds_m = values(group, "slant_range_bounds", lengths);
  return echoes;
}

std::string read_attribute(const std::filesystem::path& file, const std::string& name) {
  const NetcdfFile netcdf(file);
  std::size_t length = 0;
  require(nc_inq_attlen(netcdf.id, NC_GLOBAL, name.c_str(), &length), name);
  std::string text(length, ' ');
  require(nc_get_att_text(netcdf.id, NC_GLOBAL, name.c_str(), text.data()), name);
  return text;
}

Echoes echoes_in(const TestFolder& folder, const std::string& scene,
                 const std::vector<std::string>& arguments, const std::string& sensor) {
  const auto file = folder.write("scene.toml", scene);
  std::vector<std::string> words{"run", file.string(), "-o", (folder / "results").string(), "--quiet"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const Outcome outcome = run_program(words);
  if (outcome.exit_code != 0)
    throw std::runtime_error("exit code " + std::to_string(outcome.exit_code) + ", signal " +
                             std::to_string(outcome.signal) + ": " + outcome.err);
  return read_echoes(folder / "results" / "echoes.nc", sensor);
}

Echoes echoes_of(const std::string& scene, const std::vector<std::string>& arguments,
                 const std::string& sensor) {
  const TestFolder folder;
  return echoes_in(folder, scene, arguments, sensor);
}

double largest_relative_difference(const Echoes& a, const Echoes& b) {
  if (a.pings != b.pings || a.beams != b.beams || a.samples != b.samples)
    return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t k = 0; k < a.energy.size(); ++k)
    if (a.energy[k] != b.energy[k])
      worst = std::max(worst, std::abs(a.energy[k] - b.energy[k]) /
                                  std::max(std::abs(a.energy[k]), std::abs(b.energy[k])));
  return worst;
}

}  // namespace tubefoot
