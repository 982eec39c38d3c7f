// SPDX-License-Identifier: GPL-3.0-or-later
// Writes tables of target strengths as CSV, netCDF and PNG. Certified values are written with all digits,
// because bounds do not include rounding of the text.
#include "strength/strength_output.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "engine/signal/certified_strength.hpp"
#include "engine/signal/target_strength.hpp"
#include "files/checked_file.hpp"
#include "files/usage_error.hpp"
#include "sensors/formats/netcdf_stream.hpp"
#include "strength/strength_comparison.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

namespace {

double strength_bound_db(const StrengthTable& table, std::size_t k) {
  return target_strength_bound_db({table.length_m[k], table.bound_m[k], table.grid_bound_m[k]});
}

/// Two cells, which are empty if the comparison has no value.
std::string comparison_cells(const StrengthTable& table, std::size_t elevation, std::size_t azimuth,
                             std::size_t frequency) {
  const double difference = difference_db(table, elevation, azimuth, frequency);
  if (std::isnan(difference)) return ",,";
  return fmt::format(",{:.6f},{:.6f}",
                     table.comparison->strength_db[table.index(elevation, azimuth, frequency)], difference);
}

}  // namespace

StrengthOutput::StrengthOutput(const fs::path& place, const Inputs& inputs)
    : ending_(place.extension().string()) {
  const bool file = ending_ == ".csv" || ending_ == ".nc" || ending_ == ".png";
  if (!file && !ending_.empty() && !fs::is_directory(place))
    throw UsageError(fmt::format(
        "'{}': unknown suffix: expected .csv, .nc or .png, or no suffix for a folder", place.string()));
  if (file)
    file_.emplace(place, inputs);
  else
    folder_.emplace(place, inputs);
}

void StrengthOutput::write(const StrengthTable& table) {
  if (folder_) {
    write_file(folder_->staging() / "strength.csv", to_csv(table));
    write_netcdf(table, folder_->staging() / "strength.nc");
    write_picture(table, folder_->staging() / "strength.png");
    folder_->commit();
    return;
  }
  if (ending_ == ".csv")
    write_file(file_->path(), to_csv(table));
  else if (ending_ == ".nc")
    write_netcdf(table, file_->path());
  else
    write_picture(table, file_->path());
  file_->commit();
}

std::string to_csv(const StrengthTable& table) {
  std::string text =
      "elevation_deg,azimuth_deg,frequency_hz,target_strength_db,length_re_m,length_im_m,silhouette_m2";
  if (table.certified()) text += ",length_bound_m,target_strength_bound_db";
  if (table.comparison) text += ",compared_strength_db,difference_db";
  text += '\n';
  const StrengthRequest& request = table.request;
  // Certified numbers have all digits; a bound would otherwise have to include the omitted digits.
  const auto number = [&](double value) {
    return table.certified() ? fmt::format("{:.16e}", value) : fmt::format("{:.9e}", value);
  };
  for (std::size_t e = 0; e < request.elevations_deg.size(); ++e)
    for (std::size_t a = 0; a < request.azimuths_deg.size(); ++a)
      for (std::size_t f = 0; f < request.frequencies_hz.size(); ++f) {
        const std::size_t k = table.index(e, a, f);
        const std::complex<double> length = table.length_m[k];
        fmt::format_to(std::back_inserter(text), "{:.10g},{:.10g},{:.10g},{},{},{},{:.9e}",
                       request.elevations_deg[e], request.azimuths_deg[a], request.frequencies_hz[f],
                       table.certified() ? fmt::format("{:.16g}", target_strength_db(length))
                                         : fmt::format("{:.6f}", target_strength_db(length)),
                       number(length.real()), number(length.imag()),
                       table.silhouette_m2[e * request.azimuths_deg.size() + a]);
        if (table.certified())
          fmt::format_to(std::back_inserter(text), ",{:.16e},{:.16e}", table.bound_m[k],
                         strength_bound_db(table, k));
        if (table.comparison) text += comparison_cells(table, e, a, f);
        text += '\n';
      }
  return text;
}

void write_netcdf(const StrengthTable& table, const fs::path& file) {
  NetcdfStream stream(file);
  stream.reserve(table.length_m.size() * (table.certified() ? 48 : 24) +
                 table.length_m.size() * (table.comparison ? 8 : 0) + table.silhouette_m2.size() * 8);
  const NetcdfGroup group(stream, stream.id());
  const StrengthRequest& request = table.request;
  group.attribute("Conventions", "CF-1.8");
  group.attribute("title", "Target strength of " + table.mesh_name);
  group.attribute("source", "tubefoot: Kirchhoff approximation over the exactly visible surface, far field");
  group.attribute("surface", request.surface_name);
  group.attribute("directions_are",
                  "from the mesh to the sonar: azimuth from x towards y, elevation towards z");
  group.attribute("phase_convention",
                  "exp(-i omega t); distances and phases are relative to the origin of the mesh");
  group.attribute(NC_GLOBAL, "sound_speed_m_s", NC_DOUBLE, {request.sound_speed});
  group.attribute(NC_GLOBAL, "roughness_m", NC_DOUBLE, {request.surface.roughness_m});
  const int elevation = group.dimension("elevation", request.elevations_deg.size()),
            azimuth = group.dimension("azimuth", request.azimuths_deg.size()),
            frequency = group.dimension("frequency", request.frequencies_hz.size());
  group.put({"elevation", NC_DOUBLE, {elevation}, "degree", "elevation of the sonar"},
            request.elevations_deg);
  group.put({"azimuth", NC_DOUBLE, {azimuth}, "degree", "azimuth of the sonar"}, request.azimuths_deg);
  group.put({"frequency", NC_DOUBLE, {frequency}, "Hz", "frequency"}, request.frequencies_hz);
  std::vector<double> strength, real, imaginary;
  for (const std::complex<double>& length : table.length_m) {
    strength.push_back(target_strength_db(length));
    real.push_back(length.real());
    imaginary.push_back(length.imag());
  }
  const std::vector<int> all{elevation, azimuth, frequency};
  group.put({"target_strength", NC_DOUBLE, all, "dB", "target strength re 1 m2"}, strength);
  group.put({"length_re", NC_DOUBLE, all, "m", "backscattering length, real part"}, real);
  group.put({"length_im", NC_DOUBLE, all, "m", "backscattering length, imaginary part"}, imaginary);
  group.put({"silhouette",
             NC_DOUBLE,
             {elevation, azimuth},
             "m2",
             "projected area perpendicular to the line of sight"},
            table.silhouette_m2);
  if (table.certified()) {
    std::vector<double> bounds_db;
    for (std::size_t k = 0; k < table.bound_m.size(); ++k) bounds_db.push_back(strength_bound_db(table, k));
    group.attribute(NC_GLOBAL, "reference_tolerance", NC_DOUBLE, {request.tolerance.value_or(0)});
    group.put({"length_bound", NC_DOUBLE, all, "m", "certified half-width of the backscattering length"},
              table.bound_m);
    group.put({"length_grid_bound", NC_DOUBLE, all, "m",
               "part of length_bound that is due to rounding to the grid of the view"},
              table.grid_bound_m);
    group.put({"target_strength_bound", NC_DOUBLE, all, "dB", "certified half-width of the target strength"},
              bounds_db);
  }
  if (table.comparison) {
    group.attribute("compared_with", table.comparison->name);
    group.put({"compared_strength", NC_DOUBLE, all, "dB",
               "target strength of the compared file; NaN if it has none"},
              table.comparison->strength_db);
  }
  stream.finish();
}

}  // namespace tubefoot
