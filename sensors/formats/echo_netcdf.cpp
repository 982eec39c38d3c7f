// SPDX-License-Identifier: GPL-3.0-or-later
// Writes netCDF-4 files of echoes: definitions and small variables through netCDF in memory. The packed
// chunks of pings follow, in memory or in reserved disk space.

#include "sensors/formats/echo_netcdf.hpp"

#include <fmt/format.h>
#include <netcdf.h>
#include <netcdf_mem.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "files/checked_file.hpp"
#include "geometry/steps/in_order.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

EchoNetcdf::EchoNetcdf(fs::path path) : path_(std::move(path)) {
  const std::vector<unsigned char> image = empty_hdf5_file(path_);
  NC_memio memory{image.size(), std::malloc(image.size()), 0};
  if (memory.memory == nullptr) throw std::bad_alloc();
  std::memcpy(memory.memory, image.data(), image.size());
  // From here on netCDF owns these bytes and reallocates them.
  check(nc_open_memio(path_.c_str(), NC_WRITE, &memory, &id_), "create the file");
  defining_ = true;
}

EchoNetcdf::~EchoNetcdf() {
  if (!finished_) discard();
}

EchoGroup EchoNetcdf::root() { return {*this, id_}; }

Hdf5Chunks& EchoNetcdf::chunks(std::size_t bytes_of_values) {
  constexpr std::size_t most_bytes_in_memory = std::size_t{16} << 20;
  defining_ = false;
  NC_memio memory{};
  check(nc_close_memio(id_, &memory), "complete the file");
  const std::unique_ptr<void, decltype(&std::free)> owned(memory.memory, &std::free);
  const std::span image(static_cast<const unsigned char*>(memory.memory), memory.size);
  if (bytes_of_values <= most_bytes_in_memory) return chunks_.emplace(path_, image);
  write_file(path_, image);
  space_.emplace(path_);
  // Data that deflate cannot compress keep their size. The entry of a chunk takes some ten bytes.
  constexpr std::size_t margin_bytes = 4 << 20;
  space_->reserve(bytes_of_values + bytes_of_values / 64 + margin_bytes);
  return chunks_.emplace(path_);
}

void EchoNetcdf::close() {
  chunks_->close();
  finished_ = true;
}

void EchoNetcdf::check(int status, const std::string& task) const {
  if (status != NC_NOERR) throw write_error(path_, fmt::format("cannot {}: {}", task, nc_strerror(status)));
}

void EchoNetcdf::discard() {
  if (defining_) nc_abort(id_);
  chunks_.reset();
  if (!space_) return;  // the whole file is in memory
  space_.reset();
  discard_file(path_);
}

EchoGroup EchoGroup::group(const std::string& name) {
  int id = 0;
  check(nc_def_grp(id_, name.c_str(), &id), "define group", name);
  return {*file_, id};
}

int EchoGroup::dimension(const std::string& name, std::size_t length) {
  int dimension = 0;
  check(nc_def_dim(id_, name.c_str(), length, &dimension), "define dimension", name);
  return dimension;
}

void EchoGroup::attribute(const std::string& name, const std::string& text) {
  attribute(NC_GLOBAL, name.c_str(), text);
}

void EchoGroup::attribute(const std::string& name, double value) {
  check(nc_put_att_double(id_, NC_GLOBAL, name.c_str(), NC_DOUBLE, 1, &value), "write attribute", name);
}

void EchoGroup::attribute(int variable, const char* name, const std::string& text) {
  check(nc_put_att_text(id_, variable, name, text.size(), text.c_str()), "write attribute", name);
}

void EchoGroup::attribute(int variable, const char* name, double value) {
  check(nc_put_att_double(id_, variable, name, NC_DOUBLE, 1, &value), "write attribute", name);
}

int EchoGroup::define(const std::string& name, const std::vector<int>& dimensions, const std::string& units,
                      const std::string& long_name) {
  int variable = 0;
  check(nc_def_var(id_, name.c_str(), NC_DOUBLE, static_cast<int>(dimensions.size()), dimensions.data(),
                   &variable),
        "define variable", name);
  if (!units.empty()) attribute(variable, "units", units);
  attribute(variable, "long_name", long_name);
  return variable;
}

int EchoGroup::variable(const std::string& name, const std::vector<int>& dimensions, const std::string& units,
                        const std::string& long_name, std::vector<double> values) {
  const int variable = define(name, dimensions, units, long_name);
  pending_.push_back({name, variable, std::move(values)});
  return variable;
}

void EchoGroup::chunk(int variable, const std::string& name, const std::vector<std::size_t>& lengths) {
  check(nc_def_var_chunking(id_, variable, NC_CHUNKED, lengths.data()), "chunk variable", name);
  constexpr int shuffle = 1, deflate = 1, level = 4;
  check(nc_def_var_deflate(id_, variable, shuffle, deflate, level), "compress variable", name);
}

void EchoGroup::write() {
  for (const Pending& pending : pending_)
    check(nc_put_var_double(id_, pending.id, pending.values.data()), "write variable", pending.name);
  pending_.clear();
}

void EchoGroup::check(int status, const char* task, const std::string& name) const {
  if (status != NC_NOERR) file_->check(status, fmt::format("{} '{}'", task, name));
}

void write_pings(Hdf5Chunks& file, const std::string& group, const std::vector<PingVariable>& variables,
                 std::size_t pings, std::size_t cells, const std::function<void(std::size_t)>& done) {
  const std::size_t of_a_ping = variables.size();
  in_order(
      0, pings * of_a_ping, cells * sizeof(double),
      [&](std::size_t chunk) { return variables[chunk % of_a_ping].chunk(chunk / of_a_ping); },
      [&](std::size_t chunk, const std::vector<unsigned char>& packed) {
        const std::size_t ping = chunk / of_a_ping, variable = chunk % of_a_ping;
        file.write(group + variables[variable].name, ping, packed);
        if (variable + 1 == of_a_ping) done(ping);
      });
}

}  // namespace tubefoot
