// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file/scene_file_ranges.hpp"
#include "scene/file/scene_file_sections.hpp"

namespace tubefoot {
namespace {

void check_paths(const PathsDescription& paths, const TomlTable& table) {
  if (paths.scatterings > paths.order)
    throw InputError(table.place_of("scatterings"),
                     fmt::format("{} scatterings need {} interactions: increase 'order', which is {}",
                                 paths.scatterings, paths.scatterings, paths.order));
  if (!paths.only_order || (*paths.only_order <= paths.order && (*paths.only_order > 0 || paths.direct)))
    return;
  throw InputError(table.place_of("only_order"),
                   *paths.only_order == 0
                       ? "order 0 is the direct path from transmitter to receiver: add 'direct = true'"
                       : fmt::format("'only_order' selects paths of order {}, but 'order' permits only paths "
                                     "up to order {}: increase 'order'",
                                     *paths.only_order, paths.order));
}

void check_sea_surface(const SeaSurfaceDescription& sea, const TomlTable& table) {
  if (!sea.has_facets()) {
    for (const std::string_view key :
         {"centre_m", "cell_m", "wind_speed_m_s", "wind_direction_deg", "spectrum", "fetch_m", "spreading",
          "seed", "material", "scattering_khz"})
      if (table.has(key))
        throw InputError(
            table.place_of(key),
            fmt::format("'{}' applies only to a sea surface with facets: add 'size_m', or remove "
                        "'{}'",
                        key, key));
    return;
  }
  if (!table.has("wind_speed_m_s"))
    throw InputError(table.place_of("wind_speed_m_s"),
                     "a sea surface with facets ('size_m') needs the key 'wind_speed_m_s'");
  const bool grows = sea.spectrum == "jonswap";
  if (grows && !table.has("fetch_m"))
    throw InputError(table.place_of("spectrum"), "spectrum = \"jonswap\" needs the key 'fetch_m'");
  if (!grows && table.has("fetch_m"))
    throw InputError(table.place_of("fetch_m"),
                     fmt::format("'fetch_m' belongs to spectrum = \"jonswap\", but this sea surface has "
                                 "spectrum = \"{}\"",
                                 sea.spectrum));
  if (table.has("scattering_khz") && table.has("material"))
    throw InputError(table.place_of("scattering_khz"),
                     "'scattering_khz' belongs to the scattering model of the sea surface, which 'material' "
                     "replaces: remove one of them");
}

}  // namespace

const TomlSection<SeaSurfaceDescription>& sea_surface_section() {
  using S = SeaSurfaceDescription;
  constexpr ValueRange cell{.lo = 0.05, .hi = 1000}, wind{.lo = 0.5, .hi = 30},
      fetch{.lo = 100, .hi = 10000000}, kilohertz{.lo = 0.1, .hi = 10000};
  static const auto section =
      TomlSection<S>("[sea_surface]",
                     "Horizontal mirror above the scene. All sonars must be below this mirror. Without this "
                     "section, the sea surface reflects no sound. With `size_m`, the sea surface also has "
                     "facets that move as waves and scatter sound.")
          .keys(
              {field("height_m", &S::height_m,
                     {.meaning = "Height (z) of the sea surface, and mean height of its waves.",
                      .ranges = {coordinate}}),
               field("loss_db", &S::loss_db,
                     {.meaning = "Loss per reflection.", .ranges = {{.lo = 0, .hi = 120}}}),
               field("rms_roughness_m", &S::rms_roughness_m,
                     {.meaning =
                          "Standard deviation sigma of the surface height. In addition to the loss, "
                          "roughness multiplies the intensity by exp(-(2 k sigma sin(grazing angle))^2).",
                      .ranges = {{.lo = 0, .hi = 10}},
                      .default_value = "0; with `size_m`, that of the waves"}),
               field("size_m", &S::size_m,
                     {.meaning = "Extent of the facets: east, north. Without this key, there are none.",
                      .ranges = {size, size}}),
               field("centre_m", &S::centre_m,
                     {.meaning = "Centre of the facets: east, north.", .ranges = {coordinate, coordinate}}),
               field("cell_m", &S::cell_m,
                     {.meaning = "Largest side of a cell of two facets. The facets show waves of four cells "
                                 "or longer.",
                      .ranges = {cell}}),
               field("wind_speed_m_s", &S::wind_speed_m_s,
                     {.meaning = "Wind speed 10 m above the sea. Required with `size_m`.",
                      .ranges = {wind},
                      .default_value = "required with `size_m`"}),
               field("wind_direction_deg", &S::wind_direction_deg,
                     {.meaning = "Compass direction from which the wind blows.", .ranges = {heading}}),
               field(
                   "spectrum", &S::spectrum,
                   {.meaning = "Spectrum of the waves: pierson-moskowitz for a fully developed sea, jonswap "
                               "for a sea that grows along `fetch_m`.",
                    .choices = {"pierson-moskowitz", "jonswap"}}),
               field("fetch_m", &S::fetch_m,
                     {.meaning = "jonswap: distance along which the wind blows over the water.",
                      .ranges = {fetch},
                      .default_value = "required with jonswap"}),
               field("spreading", &S::spreading,
                     {.meaning = "Exponent s of the directions of the waves: their energy is proportional to "
                                 "cos^2s of half the angle from the wind.",
                      .ranges = {{.lo = 0, .hi = 100}}}),
               field("seed", &S::seed, {.meaning = "Seed of the waves.", .ranges = {not_negative}}),
               field("material", &S::material,
                     {.meaning = "Material of the facets. Without this key, they scatter as the sea surface "
                                 "at this wind speed (APL-UW TR 9407).",
                      .default_value = "the sea surface"}),
               field(
                   "scattering_khz", &S::scattering_khz,
                   {.meaning = "Frequency of the scattering model of the sea surface, 10 to 100 kHz without "
                               "a warning.",
                    .ranges = {kilohertz},
                    .default_value = "that of the first sensor"})})
          .check(check_sea_surface);
  return section;
}

const TomlSection<PathsDescription>& paths_section() {
  using P = PathsDescription;
  static const auto section =
      TomlSection<P>("[paths]",
                     "Paths with reflections and multiple scattering. The sea surface and materials with "
                     "`specular_loss_db` reflect sound.")
          .keys(
              {field("order", &P::order,
                     {.meaning = "Largest number of interactions (reflections and scatterings) along a path.",
                      .ranges = {{.lo = 1, .hi = 8}}}),
               field("only_order", &P::only_order,
                     {.meaning = "Write only the echoes of this order. 0: the direct path from transmitter "
                                 "to receiver.",
                      .ranges = {{.lo = 0, .hi = 8}}}),
               field("cutoff_db", &P::cutoff_db,
                     {.meaning = "Reflection loss above which paths are omitted. At each scattering, "
                                 "tubefoot also omits the weakest patches, whose total energy is at least "
                                 "this far below that of the first scattering.",
                      .ranges = {{.lo = 0, .hi = 300}}}),
               field("scatterings", &P::scatterings,
                     {.meaning = "Largest number of scatterings along a path. Values above 1 are slow, "
                                 "because tubefoot computes the visibility of the scene from each patch.",
                      .ranges = {{.lo = 1, .hi = 8}}}),
               field("patch_m", &P::patch_m,
                     {.meaning = "Longest edge of a radiosity patch, for multiple scattering.",
                      .ranges = {size}}),
               field("most_images", &P::most_images,
                     {.meaning =
                          "Largest number of image apexes per apex. The limit for pairs of image apexes is a "
                          "hundred times higher. If a limit is exceeded, the run ends with an error.",
                      .ranges = {{.lo = 1, .hi = 10000000}}}),
               field("direct", &P::direct,
                     {.meaning = "true: a separate receiver also receives sound along the direct path from "
                                 "the transmitter."})})
          .check(check_paths);
  return section;
}

}  // namespace tubefoot
