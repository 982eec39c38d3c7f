// SPDX-License-Identifier: GPL-3.0-or-later
// Axes of beams and range samples: derived from options, from the file or from the reference, and compared
// with those of the reference. Pictures are rebinned by the overlaps of the bins of two axes.
#include "import/bin_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "files/csv_file.hpp"
#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

constexpr double axis_tolerance_deg = 1e-3, sample_share = 0.01, beam_share = 0.01;

bool near(const Bins& a, const Bins& b, double tolerance) {
  if (a.count() != b.count()) return false;
  for (std::size_t k = 0; k < a.count(); ++k)
    if (!(std::abs(a.centres[k] - b.centres[k]) <= tolerance)) return false;
  return true;
}

Bins even_bins(double first, double last, std::size_t count) {
  std::vector<double> edges;
  for (std::size_t k = 0; k <= count; ++k)
    edges.push_back(first + (last - first) * static_cast<double>(k) / static_cast<double>(count));
  return bin_intervals(std::move(edges));
}

/// Number of views side by side in the words "tangent", "tangent:3" or "tangent:20deg" (views of at most 20
/// degrees), for a fan of this width.
std::size_t views_of(const std::string& words, double width_deg, std::size_t beams) {
  if (words == "tangent") return 1;
  std::string_view number = std::string_view(words).substr(std::string_view("tangent:").size());
  const bool is_width = number.ends_with("deg");
  if (is_width) number.remove_suffix(3);
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size() || !(value > 0) ||
      (!is_width && value != std::floor(value)))
    throw UsageError(
        fmt::format("--azimuths {}: expected a number of views, as in tangent:3, or their largest width, as "
                    "in tangent:20deg",
                    words));
  const double views = is_width ? std::ceil(width_deg / value - 1e-9) : value;
  if (views > static_cast<double>(beams))
    throw UsageError(
        fmt::format("--azimuths {}: {:.0f} views are more than the {} beams", words, views, beams));
  return static_cast<std::size_t>(std::max(views, 1.0));
}

/// Returns bins that are equal parts of straight lines, one per view. Views lie side by side, perpendicular
/// to their axes. All views but the last have the rounded mean number of beams. All views have the width of
/// the one with most beams, as in Stonefish (OpenGLFLS.cpp).
Bins tangent_bins(const Bins& reference, std::size_t count, std::size_t views) {
  const double first = reference.edges.front(), width = reference.edges.back() - first,
               share = width / static_cast<double>(count);
  const auto of_view =
      static_cast<std::size_t>(std::round(static_cast<double>(count) / static_cast<double>(views)));
  if (of_view * (views - 1) >= count)
    throw UsageError(fmt::format("{} beams cannot be divided among {} views", count, views));
  const std::size_t of_last = count - of_view * (views - 1);
  const auto columns = static_cast<double>(std::max(of_view, of_last));
  const double half = share * columns / 2;
  if (!(half < 90)) throw UsageError("--azimuths tangent needs views of less than 180 degrees");
  Bins bins;
  bins.edges.push_back(first);
  for (std::size_t view = 0; view < views; ++view) {
    const double middle = first + share * static_cast<double>(view * of_view) + half;
    const auto at = [&](double place) {
      return middle + std::atan((2 * place / columns - 1) * std::tan(half * degree)) / degree;
    };
    bins.edges.back() = (bins.edges.back() + at(0)) / 2;  // the seam between two views
    for (std::size_t k = 0; k < (view + 1 < views ? of_view : of_last); ++k) {
      bins.centres.push_back(at(static_cast<double>(k) + 0.5));
      bins.edges.push_back(at(static_cast<double>(k) + 1));
    }
  }
  return bins;
}

/// Returns whether the reference has the columns of this number of views as its beams. The sector of listed
/// beams is wider than that of the columns, because a list of axes does not contain the outer borders.
bool has_views(const Bins& reference, std::size_t count, std::size_t views) {
  const double beam = (reference.edges.back() - reference.edges.front()) / static_cast<double>(count);
  return count == reference.count() &&
         near(tangent_bins(reference, count, views), reference, beam_share * beam);
}

std::vector<double> listed_azimuths(const std::string& file) {
  std::vector<double> azimuths;
  constexpr std::string_view columns[] = {"azimuth_deg"};
  read_csv(file, columns, [&](const CsvRow& row) {
    if (!azimuths.empty() && !(row.values[0] > azimuths.back()))
      throw InputError(row.places[0], "azimuths must increase, from port (negative) to starboard");
    azimuths.push_back(row.values[0]);
  });
  return azimuths;
}

/// Interprets ranges as near edges of bins. The length of a bin is the distance to the next edge.
Bins by_near_edges(std::vector<double> edges) {
  const std::size_t n = edges.size();
  edges.push_back(n > 1 ? 2 * edges[n - 1] - edges[n - 2] : 2 * edges[0]);
  return bin_intervals(std::move(edges));
}

std::string window(const Bins& bins, const char* unit) {
  return fmt::format("{:.6g} to {:.6g} {}", bins.edges.front(), bins.edges.back(), unit);
}

Bins beam_bins(std::size_t count, const AxesOfFile& file, const Bins& reference, const ImportOptions& options,
               std::vector<std::string>& told) {
  const std::string& word = options.azimuths;
  Bins bins;
  std::string from;
  if (word == "even") {
    bins = even_bins(reference.edges.front(), reference.edges.back(), count);
    from = "equiangular over the sector of the reference";
  } else if (word == "tangent" || word.starts_with("tangent:")) {
    const double width = reference.edges.back() - reference.edges.front(),
                 beam = width / static_cast<double>(count);
    std::size_t views = views_of(word, width, count);
    // With a largest width, the wider sector of listed beams may appear to need another view.
    if (const std::size_t fewer = views_of(word, width - beam, count);
        fewer < views && has_views(reference, count, fewer))
      views = fewer;
    const bool same = has_views(reference, count, views);
    bins = same ? reference : tangent_bins(reference, count, views);
    from = fmt::format("equidistant in {} view{}, {}", views, views > 1 ? "s" : "",
                       same ? "as the beams of the reference" : "over the sector of the reference");
  } else if (word.ends_with(".csv")) {
    bins = bins_about(listed_azimuths(word));
    from = "from " + word;
  } else if (!word.empty()) {
    const auto [first, last] = first_and_last(word, "--azimuths");
    const double half = count > 1 ? (last - first) / static_cast<double>(count - 1) / 2 : 0.5;
    bins = even_bins(first - half, last + half, count);
    from = "as declared";
  } else if (!file.azimuth_deg.empty()) {
    bins = bins_about(file.azimuth_deg);
    from = "from the file";
  } else if (count == reference.count()) {
    bins = reference;
    from = "from the reference, because no others are given";
  } else {
    throw UsageError(
        fmt::format("the picture has {} beams, but the reference has {}: give the azimuths with --azimuths",
                    count, reference.count()));
  }
  if (bins.count() != count)
    throw UsageError(fmt::format("there are {} azimuths for {} beams", bins.count(), count));
  told.push_back(fmt::format("azimuths {}: {}", window(bins, "degrees"), from));
  return bins;
}

Bins sample_bins(std::size_t count, const AxesOfFile& file, const Bins& reference,
                 const ImportOptions& options, std::vector<std::string>& told) {
  const bool at_edges = options.range_origin == "edges";
  Bins bins;
  std::string from;
  if (!options.ranges.empty()) {
    const auto [first, last] = first_and_last(options.ranges, "--ranges");
    if (options.range_origin == "centres") {
      const double half = count > 1 ? (last - first) / static_cast<double>(count - 1) / 2 : first;
      bins = even_bins(first - half, last + half, count);
      from = "as declared, with the centres of the first and the last bin";
    } else {
      bins = even_bins(first, last, count);
      from = "as declared";
    }
  } else if (!file.range_m.empty()) {
    bins = at_edges ? by_near_edges(file.range_m) : bins_about(file.range_m);
    from = at_edges ? "from the file, as near edges of the bins" : "from the file, as centres of the bins";
  } else if (count == reference.count()) {
    bins = reference;
    from = "from the reference, because no others are given";
  } else {
    throw UsageError(
        fmt::format("the picture has {} range bins, but the reference has {}: give the ranges with --ranges "
                    "(the reference has {})",
                    count, reference.count(), window(reference, "m")));
  }
  told.push_back(fmt::format("ranges {}: {}", window(bins, "m"), from));
  return bins;
}

/// Share of a bin of another axis in a bin.
struct Overlap {
  std::size_t from;
  double share;
};
/// Relative tolerance for edges that differ only by rounding. A section of a picture keeps its numbers
/// exactly.
constexpr double same = 1e-6;
std::vector<std::vector<Overlap>> parts_of(const Bins& from, const Bins& to) {
  std::vector<std::vector<Overlap>> parts(to.count());
  for (std::size_t t = 0; t < to.count(); ++t) {
    const double begin = to.edges[t], end = to.edges[t + 1];
    auto f = static_cast<std::size_t>(std::upper_bound(from.edges.begin(), from.edges.end(), begin) -
                                      from.edges.begin());
    for (f = f > 0 ? f - 1 : 0; f < from.count() && from.edges[f] < end; ++f) {
      const double overlap = std::min(end, from.edges[f + 1]) - std::max(begin, from.edges[f]);
      const double share = overlap / (end - begin);
      if (share > same) parts[t].push_back({f, share > 1 - same ? 1 : share});
    }
  }
  return parts;
}

/// Derives the edges of beams that are equidistant in the tangent of their azimuth from these tangents. The
/// opening angle then has the meaning that it has in a scene.
void end_by_tangents(Bins& beams) {
  const std::size_t n = beams.count();
  if (n < 3 || !(beams.centres.front() > -89) || !(beams.centres.back() < 89)) return;
  std::vector<double> tangents;
  for (const double centre : beams.centres) tangents.push_back(std::tan(centre * degree));
  const double step = (tangents.back() - tangents.front()) / static_cast<double>(n - 1);
  for (std::size_t k = 0; k < n; ++k)
    if (std::abs(tangents[k] - tangents[0] - static_cast<double>(k) * step) > 1e-6 * std::abs(step)) return;
  beams.edges.front() = std::atan(tangents.front() - step / 2) / degree;
  beams.edges.back() = std::atan(tangents.back() + step / 2) / degree;
}

}  // namespace

Bins bins_about(std::vector<double> centres) {
  Bins bins{std::move(centres), {}};
  const std::vector<double>& c = bins.centres;
  const std::size_t n = c.size();
  if (n == 0) return bins;
  const double first = n > 1 ? (c[1] - c[0]) / 2 : 0.5, last = n > 1 ? (c[n - 1] - c[n - 2]) / 2 : 0.5;
  bins.edges.push_back(c[0] - first);
  for (std::size_t k = 1; k < n; ++k) bins.edges.push_back((c[k - 1] + c[k]) / 2);
  bins.edges.push_back(c[n - 1] + last);
  return bins;
}

Bins bin_intervals(std::vector<double> edges) {
  Bins bins{{}, std::move(edges)};
  for (std::size_t k = 1; k < bins.edges.size(); ++k)
    bins.centres.push_back((bins.edges[k - 1] + bins.edges[k]) / 2);
  return bins;
}

BinAxes axes_of(const WholeEchoFile& reference, std::size_t index) {
  const SensorEchoes& echoes = reference.contents.sensors.at(index);
  BinAxes axes{bins_about(echoes.beam_azimuth_deg), bins_about(echoes.slant_range_m)};
  const EchoVariable* width = reference.more.at(index).variable("beam_azimuth_width");
  if (width && width->along({"beam"}) && width->values.size() == echoes.beams) {
    axes.beams.edges.front() = axes.beams.centres.front() - width->values.front() / 2;
    axes.beams.edges.back() = axes.beams.centres.back() + width->values.back() / 2;
  }
  end_by_tangents(axes.beams);
  if (!echoes.slant_range_bounds_m.empty()) {
    for (std::size_t k = 0; k < echoes.samples; ++k)
      axes.samples.edges[k] = echoes.slant_range_bounds_m[2 * k];
    axes.samples.edges.back() = echoes.slant_range_bounds_m.back();
  }
  return axes;
}

std::pair<double, double> first_and_last(const std::string& words, const char* option) {
  double values[2] = {};
  const char *at = words.data(), *end = at + words.size();
  for (double& value : values) {
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || !std::isfinite(value)) at = nullptr;
    if (!at) break;
    at = rest;
    if (&value == values && (at == end || *at++ != ':')) at = nullptr;
    if (!at) break;
  }
  if (at != end || !(values[0] < values[1]))
    throw UsageError(
        fmt::format("{} '{}': expected FIRST:LAST, two increasing numbers{}", option, words,
                    std::string_view(option) == "--azimuths" ? ", or even, tangent or FILE.csv" : ""));
  return {values[0], values[1]};
}

BinAxes picture_axes(std::size_t beams, std::size_t samples, const AxesOfFile& file, const BinAxes& reference,
                     const ImportOptions& options, std::vector<std::string>& told) {
  BinAxes axes;
  axes.beams = beam_bins(beams, file, reference.beams, options, told);
  axes.samples = sample_bins(samples, file, reference.samples, options, told);
  if (same_axes(axes, reference)) return reference;
  return axes;
}

bool same_axes(const BinAxes& a, const BinAxes& b) {
  const double sample = b.samples.edges[1] - b.samples.edges[0];
  return near(a.beams, b.beams, axis_tolerance_deg) && near(a.samples, b.samples, sample_share * sample);
}

std::vector<double> rebinned(const std::vector<double>& picture, const BinAxes& from, const BinAxes& to) {
  const auto beams = parts_of(from.beams, to.beams), samples = parts_of(from.samples, to.samples);
  std::vector<double> result(to.beams.count() * to.samples.count(), 0);
  for (std::size_t b = 0; b < beams.size(); ++b)
    for (const Overlap& beam : beams[b]) {
      const double* row = &picture[beam.from * from.samples.count()];
      for (std::size_t s = 0; s < samples.size(); ++s)
        for (const Overlap& sample : samples[s])
          result[b * samples.size() + s] += beam.share * sample.share * row[sample.from];
    }
  return result;
}

}  // namespace tubefoot
