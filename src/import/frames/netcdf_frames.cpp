// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/frames/netcdf_frames.hpp"

#include "sensors/recordings/netcdf_group.hpp"

namespace tubefoot {
namespace {

/// Returns a numeric attribute of a variable, if it exists.
std::optional<double> number_of(const NetcdfInput& file, int variable, const char* attribute) {
  std::size_t length = 0;
  nc_type type = 0;
  const int status = nc_inq_att(file.id(), variable, attribute, &type, &length);
  if (status == NC_ENOTATT) return std::nullopt;
  const std::string task = fmt::format("read attribute '{}'", attribute);
  file.check(status, task);
  if (length != 1 || type == NC_CHAR || type > NC_UINT64 || type == NC_STRING)
    file.fail(fmt::format("attribute '{}' is not a number", attribute));
  double value = 0;
  file.check(nc_get_att_double(file.id(), variable, attribute, &value), task);
  return value;
}

NumberArray array_of(const NetcdfInput& file, EchoVariable table) {
  int id = 0;
  nc_type type = 0;
  file.check(nc_inq_varid(file.id(), table.name.c_str(), &id), "find a variable");
  file.check(nc_inq_vartype(file.id(), id, &type), "read a variable's type");
  const auto fill = number_of(file, id, "_FillValue"), scale = number_of(file, id, "scale_factor"),
             offset = number_of(file, id, "add_offset");
  for (double& value : table.values)
    value = fill && value == *fill ? NAN : value * scale.value_or(1) + offset.value_or(0);
  return {table.name, table.shape, std::move(table.values), type == NC_UBYTE && !scale && !offset};
}

}  // namespace

ForeignData read_netcdf_frames(const std::filesystem::path& path, const WantedArrays& wanted) {
  const NetcdfInput file(path);
  const EchoGroupInput root(file, file.id(), "");
  const std::vector<std::string> names = root.tables();
  double bytes = 0;
  for (const std::string& name : names) bytes += 2 * root.bytes_of(name.c_str());
  require_memory(bytes, {path.string()}, "its values", "write fewer values per file");
  std::vector<NumberArray> arrays;
  for (const std::string& name : names) arrays.push_back(array_of(file, root.table(name)));
  return frames_of(arrays, wanted, {path.string()});
}

}  // namespace tubefoot
