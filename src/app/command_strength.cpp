// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "app/commands.hpp"
#include "files/memory_at_hand.hpp"
#include "files/usage_error.hpp"
#include "run/console/say.hpp"
#include "run/settings.hpp"
#include "strength/strength_comparison.hpp"
#include "strength/strength_output.hpp"
#include "strength/strength_request.hpp"

namespace tubefoot {
namespace {

StrengthRequest request_of(const StrengthOptions& options) {
  StrengthRequest request{angles_of(options.azimuths, "--azimuths"),
                          angles_of(options.elevations, "--elevations"),
                          frequencies_of(options.frequencies),
                          options.sound_speed,
                          surface_of(options.reflection, options.roughness_m),
                          options.reflection,
                          options.reference ? std::optional(options.tolerance) : std::nullopt};
  if (request.elevations_deg.front() < -90 || request.elevations_deg.back() > 90)
    throw UsageError(
        fmt::format("--elevations '{}': expected elevations from -90 to 90 degrees", options.elevations));
  if (request.azimuths_deg.front() < -360 || request.azimuths_deg.back() > 360)
    throw UsageError(
        fmt::format("--azimuths '{}': expected azimuths from -360 to 360 degrees", options.azimuths));
  for (const double hertz : {request.frequencies_hz.front(), request.frequencies_hz.back()}) {
    constexpr double shortest_m = 1e-9, longest_m = 1e9;
    const double wavelength_m = request.sound_speed / hertz;
    if (!(wavelength_m >= shortest_m && wavelength_m <= longest_m))
      throw UsageError(fmt::format(
          "--frequencies '{}': at {:g} m/s the wavelength of {:g} Hz is {:g} m, but must be {:g} to {:g} m",
          options.frequencies, request.sound_speed, hertz, wavelength_m, shortest_m, longest_m));
  }
  if (!(options.tolerance >= 1e-12 && options.tolerance <= 0.1))
    throw UsageError(
        fmt::format("with --reference, --tolerance must be a relative bound from 1e-12 to 0.1, not '{:g}'",
                    options.tolerance));
  if (options.roughness_m > 0) request.surface_name += fmt::format(", roughness {:g} m", options.roughness_m);
  constexpr double most_cells = 5e7;
  const double cells = static_cast<double>(request.azimuths_deg.size()) *
                       static_cast<double>(request.elevations_deg.size()) *
                       static_cast<double>(request.frequencies_hz.size());
  if (cells > most_cells)
    throw UsageError(
        fmt::format("the command line requests {:g} target strengths, more than {:g}: increase the steps of "
                    "--azimuths, --elevations or --frequencies",
                    cells, most_cells));
  return request;
}

}  // namespace

int strength_command(const StrengthOptions& options) {
  const StrengthRequest request = request_of(options);
  StrengthOutput output(options.output,
                        options.compared ? Inputs{options.mesh, *options.compared} : Inputs{options.mesh});
  const ThreadLimit limit(options.threads.value_or(0));
  const ComponentMesh mesh = strength_mesh(options.mesh, options.unit_m, options.up);
  std::vector<std::string> warnings = mesh.warnings;
  for (const std::string& warning : warnings_of(mesh, request.frequencies_hz.back(), request.sound_speed))
    warnings.push_back(options.mesh.string() + ": " + warning);
  if (const auto small = too_small_for(mesh, request.frequencies_hz.front(), request.sound_speed))
    warnings.push_back(options.mesh.string() + ": " + *small);
  print_warnings(warnings, options.quiet);
  const double bytes_a_cell =  // numbers and their text
      (options.reference ? 300 : 160) + (options.compared ? 40 : 0);
  require_memory(bytes_a_cell * static_cast<double>(request.azimuths_deg.size()) *
                     static_cast<double>(request.elevations_deg.size()) *
                     static_cast<double>(request.frequencies_hz.size()),
                 {options.mesh.string()}, "the table of target strengths",
                 "increase the steps of the ranges");
  std::optional<StrengthComparison> comparison;
  if (options.compared) comparison = read_comparison(*options.compared, request);
  StrengthTable table = strength_of(mesh, options.mesh.filename().string(), request, options.quiet);
  table.comparison = std::move(comparison);
  output.write(table);
  if (std::ranges::all_of(table.silhouette_m2, [](double area) { return area == 0; }))
    print_warnings({fmt::format("{}: no facet is visible from any of these directions: each facet has no "
                                "area, or is seen edge-on",
                                options.mesh.string())},
                   options.quiet);

  const auto [weakest, strongest] = spread_db(table);
  tell("facets         {}\n", mesh.triangles.size());
  tell("directions     {}\n", table.directions());
  tell("frequencies    {}\n", request.frequencies_hz.size());
  tell("strength       {:.2f} to {:.2f} dB re 1 m2\n", weakest, strongest);
  if (table.certified()) tell("{}", in_words(bounds_held(table), table));
  if (table.comparison) tell("{}", in_words(differences_of(table), table));
  tell("wrote {}\n", options.output.string());
  return 0;
}

}  // namespace tubefoot
