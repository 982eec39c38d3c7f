// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the legend of a scene drawing: sensors with their range gates, colours of heights, and the meaning of
// lines and marks.
#include "plan/legend.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "plan/seabed.hpp"
#include "sensors/recordings/sensor_kind.hpp"
#include "study/diagram.hpp"

namespace tubefoot {
namespace {

constexpr double swatch = 16, room = 236, letter_size = 10.5;
constexpr Lettering faint{.size = letter_size, .colour = "#5c646d"};

/// Returns the text, cut off to the width of the column.
std::string fitting(const std::string& text, double size, double width) {
  if (width_of(text, size) <= width) return text;
  std::string part = text;
  while (!part.empty() && width_of(part + "...", size) > width) {
    part.pop_back();
    while (!part.empty() && (part.back() & 0xC0) == 0x80) part.pop_back();
  }
  // Removes the first byte of a multi-byte character.
  if (!part.empty() && (part.back() & 0x80) != 0) part.pop_back();
  return part + "...";
}

class Column {
 public:
  Column(Sheet& sheet, glm::dvec2 at) : sheet_(sheet), at_(at) {}

  double bottom() const { return at_.y; }
  glm::dvec2 middle() const { return {at_.x + swatch / 2, at_.y + 6}; }
  Box mark() const { return {at_.x, at_.y, at_.x + swatch, at_.y + 12}; }
  Sheet& sheet() { return sheet_; }
  void words(const std::string& text, const Lettering& how) {
    sheet_.text({at_.x + swatch + 8, at_.y + 10}, fitting(text, how.size, room - swatch - 8), how);
    at_.y += how.size + 4.5;
  }
  void skip(double by) { at_.y += by; }

 private:
  Sheet& sheet_;
  glm::dvec2 at_;
};

void add_sensors(Column& column, const Survey& survey) {
  constexpr std::size_t most = 8;
  for (std::size_t s = 0; s < std::min(most, survey.sensors.size()); ++s) {
    const SensorPings& pings = survey.sensors[s];
    const Sensor& sensor = *pings.sensor;
    const RangeSamples& samples = sensor.samples();
    column.sheet().rectangle(
        column.mark(), fmt::format("fill=\"{0}\" fill-opacity=\"0.45\" stroke=\"{0}\"", series_colour(s)));
    column.words(sensor.description().name, {.size = 11.5, .bold = true});
    column.words(fmt::format("{}, {:g} kHz", kind_of(sensor.description()).name(), sensor.frequency_khz()),
                 faint);
    column.words(fmt::format("{} ping{}, range {:.4g} to {:.4g} m", pings.times_s.size(),
                             pings.times_s.size() == 1 ? "" : "s", samples.first_m,
                             samples.first_m + samples.step_m * samples.count),
                 faint);
    column.skip(5);
  }
  if (survey.sensors.size() > most) {
    column.words(fmt::format("and {} more sensors", survey.sensors.size() - most), faint);
    column.skip(5);
  }
}

void add_meanings(Column& column, const SceneMarks& marks) {
  Sheet& sheet = column.sheet();
  const auto sector = [&](const char* style, const char* meaning) {
    sheet.rectangle(column.mark(), std::string("fill=\"#555555\" stroke=\"#555555\" ") + style);
    column.words(meaning, faint);
    column.skip(3);
  };
  sector("fill-opacity=\"0.42\"", "received: within the range gate");
  sector("fill-opacity=\"0.2\" stroke-dasharray=\"4 3\"", "in the gate, below the seabed");
  sector("fill-opacity=\"0.07\" stroke-dasharray=\"1 3\"", "nearer than the range gate");
  sheet.circle(column.middle(), 3.6, "fill=\"#555555\" stroke=\"#ffffff\" stroke-width=\"1.2\"");
  column.words("sensor at the drawn pings", faint);
  column.skip(3);
  if (std::ranges::any_of(marks.sectors, [](const SectorMark& s) { return s.receiver_m.has_value(); })) {
    sheet.circle(column.middle(), 3.2, "fill=\"#ffffff\" stroke=\"#555555\" stroke-width=\"1.6\"");
    column.words("receiver", faint);
    column.skip(3);
  }
  const glm::dvec2 tip = column.middle() + glm::dvec2(8, 0);
  sheet.line(column.middle() - glm::dvec2(8, 0), tip - glm::dvec2(6, 0),
             "stroke=\"#22262a\" stroke-width=\"1.8\"");
  sheet.path(fmt::format("M{:.1f} {:.1f}l-7 3.5v-7Z", tip.x, tip.y), "fill=\"#22262a\"");
  column.words("track and heading", faint);
  column.skip(3);
  if (!marks.objects.empty()) {
    sheet.rectangle(column.mark(),
                    "fill=\"#6d1b1b\" fill-opacity=\"0.4\" stroke=\"#6d1b1b\" stroke-width=\"1.2\"");
    column.words(marks.objects.size() == 1 ? "object" : fmt::format("objects ({})", marks.objects.size()),
                 faint);
    column.skip(3);
  }
  if (std::ranges::any_of(marks.objects, &ObjectMark::is_buried)) {
    sheet.rectangle(column.mark(),
                    "fill=\"#6d1b1b\" fill-opacity=\"0.12\" stroke=\"#6d1b1b\" stroke-width=\"1.2\" "
                    "stroke-dasharray=\"3 2\"");
    column.words("object below the seabed", faint);
    column.skip(3);
  }
}

void add_targets(Column& column, const SceneDescription& description) {
  Sheet& sheet = column.sheet();
  if (!description.targets.empty()) {
    sheet.circle(column.middle(), 2.4, "fill=\"#0b5a8a\" stroke=\"#ffffff\" stroke-width=\"0.8\"");
    column.words("target in the water", faint);
    column.skip(3);
  }
  if (description.target_populations.empty()) return;
  sheet.rectangle(column.mark(),
                  "fill=\"#0b5a8a\" fill-opacity=\"0.08\" stroke=\"#0b5a8a\" stroke-width=\"1\" "
                  "stroke-dasharray=\"4 2\"");
  column.words("population of targets", faint);
  column.skip(3);
}

void add_seabed(Column& column, const SceneMarks& marks, bool is_coarse) {
  Sheet& sheet = column.sheet();
  if (marks.terrain.empty()) {
    column.words("The scene has no terrain.", faint);
    return;
  }
  column.words("seabed height (m)", faint);
  constexpr int steps = 12;
  constexpr double height = 6;
  const double lo = marks.terrain.lo_m.z, hi = marks.terrain.hi_m.z;
  const double top = column.bottom();
  const int drawn = hi > lo ? steps : 2;
  for (int k = 0; k < drawn; ++k) {
    const Box box{column.mark().left, top + k * height, column.mark().right, top + (k + 1) * height};
    sheet.rectangle(box, fmt::format("fill=\"{}\"", seabed_colour(hi > lo ? 1 - (k + 0.5) / steps : 0.5)));
  }
  const int decimals =
      std::clamp(2 - static_cast<int>(std::floor(std::log10(std::max(hi - lo, 1e-3)))), 0, 3);
  const glm::dvec2 beside(column.mark().right + 8, top + 9);
  sheet.text(beside, fmt::format("{:.{}f}", hi, decimals), faint);
  if (hi > lo)
    sheet.text(beside + glm::dvec2(0, steps * height - 9), fmt::format("{:.{}f}", lo, decimals), faint);
  column.skip(drawn * height + 8);
  if (is_coarse) column.words("seabed drawn from its tiles", faint);
}

}  // namespace

double draw_legend(Sheet& sheet, glm::dvec2 top_left, const Survey& survey, const SceneMarks& marks,
                   bool is_seabed_coarse) {
  Column column(sheet, top_left);
  add_sensors(column, survey);
  column.skip(6);
  add_meanings(column, marks);
  add_targets(column, survey.scene.description);
  column.skip(6);
  add_seabed(column, marks, is_seabed_coarse);
  if (survey.scene.water->refracts())
    column.words("The water is stratified, but sectors", faint),
        column.words("are drawn with straight rays.", faint);
  return column.bottom();
}

std::string frame_words(const Scene& scene) {
  if (!scene.frame.is_georeferenced()) return "metres east, north and up in the local frame";
  glm::dvec3 origin(0);
  scene.frame.to_lon_lat({&origin, 1}, {scene.description.file.string(), 0, 0});
  return fmt::format("metres east, north and up of latitude {:.6f}, longitude {:.6f}", origin.y, origin.x);
}

}  // namespace tubefoot
