// SPDX-License-Identifier: GPL-3.0-or-later
// Assembles the page of the viewer: the template with style and scripts, the metadata as JSON, and the
// compressed arrays of the view.
#include "viewer/page.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "files/shown.hpp"
#include "viewer/assets.hpp"
#include "viewer/packed_array.hpp"

namespace tubefoot {
namespace {

/// Precision of the energies of samples and footprints: relative error 8e-6, that is 3e-5 dB.
constexpr int energy_bits = 16;
/// Precision of numbers that the page shows with more digits, and full precision.
constexpr int finer_bits = 20, all_bits = 23;

/// Centre of the footprints, and the step of stored positions.
struct Frame {
  glm::dvec3 middle_m{0};
  double unit_m = 1e-4;
};

Frame frame_of(const ViewData& data) {
  const auto& points = data.shapes.corners_m;
  if (points.empty()) return {data.pings.empty() ? glm::dvec3(0) : data.pings.front().sensor_m};
  glm::dvec3 lo = points.front(), hi = lo;
  for (const glm::dvec3& p : points)
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], p[k]);
      hi[k] = std::max(hi[k], p[k]);
    }
  const glm::dvec3 size = hi - lo;
  constexpr double steps = 1 << 20;  // smaller steps are not visible
  const double extent = std::max({size.x, size.y, size.z, 1e-3});
  return {(lo + hi) / 2.0, extent / steps};
}

class PageWriter {
 public:
  explicit PageWriter(const ViewData& data) : data_(data), frame_(frame_of(data)), centre_(frame_.middle_m) {
    for (const double e : data.energy_j) scale_ = std::max(scale_, e);
    for (const ViewLink& link : data.links) scale_ = std::max(scale_, link.energy_j);
    if (!(scale_ > 0)) scale_ = 1;
  }

  std::string facts() const {
    nlohmann::ordered_json json{{"title", shown_line(data_.title)},
                                {"source", shown_line(data_.source)},
                                {"sceneHash", data_.scene_hash},
                                {"version", data_.version},
                                {"sensor", shown_line(data_.sensor)},
                                {"kind", data_.kind},
                                {"notes", lines(data_.notes)},
                                {"components", lines(data_.components)},
                                {"materials", lines(data_.materials)},
                                {"layout", data_.layout == PictureLayout::fan         ? "fan"
                                           : data_.layout == PictureLayout::waterfall ? "waterfall"
                                                                                      : "echogram"},
                                {"acrossTrack", data_.across_track},
                                {"receiverApart", data_.separate_receiver},
                                {"beams", data_.beams},
                                {"samples", data_.samples},
                                {"firstRange", data_.first_m},
                                {"rangeStep", data_.step_m},
                                {"beamAngles", data_.beam_angle_deg},
                                {"centre", {centre_.x, centre_.y, centre_.z}},
                                {"energyScale", scale_},
                                {"displayGain", data_.display_gain_db},
                                {"reference", shown_line(data_.reference_name)},
                                {"candidate", shown_line(data_.candidate_name)},
                                {"stripes", shown_line(data_.stripes)},
                                {"weakLinksLeftOut", data_.weak_links_left_out}};
    for (const ViewTransmission& transmission : data_.transmissions)
      json["transmissions"].push_back({{"delay", transmission.delay_s}, {"beams", transmission.beams}});
    for (const ViewPing& ping : data_.pings)
      json["pings"].push_back({{"number", ping.number},
                               {"time", ping.time_s},
                               {"sensor", place(ping.sensor_m)},
                               {"receiver", place(ping.receiver_m)},
                               {"shadows", ping.shadows}});
    std::string text = json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
    // A title must not end the script element that contains it.
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
    return text;
  }

  void arrays(std::string& html) const {
    PackedArrays out(html);
    std::vector<float> energy;
    for (const double e : data_.energy_j) energy.push_back(float(e / scale_));
    out.add("cellEnergy", energy, energy_bits);
    std::vector<float> candidate;
    for (const double e : data_.candidate_j) candidate.push_back(float(e / scale_));
    out.add("candidateEnergy", candidate, energy_bits);
    out.add("surfaces", data_.surfaces);
    footprints(out);
    std::vector<std::uint32_t> first(data_.footprints.size() + 1, 0), cell;
    std::vector<float> part;
    for (const ViewLink& link : data_.links) {
      ++first[link.footprint + 1];
      cell.push_back(link.cell);
      part.push_back(float(link.energy_j / scale_));
    }
    for (std::size_t f = 0; f + 1 < first.size(); ++f) first[f + 1] += first[f];
    out.add("linkFirst", first);
    out.add("linkCell", cell);
    out.add("linkEnergy", part, energy_bits);
    out.add("shapeCorners", data_.shapes.corners_of);
    places(out, "shapePoints", data_.shapes.corners_m);
    out.add("shadowCorners", data_.shadows.corners_of);
    places(out, "shadowPoints", data_.shadows.corners_m);
    places(out, "meshPoints", data_.mesh_vertices_m);
    out.add("meshFacets", data_.mesh_facets, 3);
    std::vector<std::uint32_t> owners;
    std::vector<glm::dvec3> edges;
    for (const ViewTube& tube : data_.tubes) {
      owners.insert(owners.end(), {tube.ping, tube.beam});
      edges.push_back(tube.apex_m);
      edges.insert(edges.end(), tube.ends_m, tube.ends_m + 4);
    }
    out.add("tubeOwner", owners, 2);
    places(out, "tubePoints", edges);
  }

 private:
  static std::vector<std::string> lines(const std::vector<std::string>& texts) {
    std::vector<std::string> all;
    for (const std::string& text : texts) all.push_back(shown_line(text));
    return all;
  }
  nlohmann::ordered_json place(glm::dvec3 p) const {
    return {float(p.x - centre_.x), float(p.y - centre_.y), float(p.z - centre_.z)};
  }
  void places(PackedArrays& out, const char* name, const std::vector<glm::dvec3>& points) const {
    out.add_places(name, points, centre_, frame_.unit_m);
  }

  void footprints(PackedArrays& out) const {
    const auto column = [&]<class T>(T, const auto& value) {
      std::vector<T> values;
      values.reserve(data_.footprints.size());
      for (const ViewFootprint& f : data_.footprints) values.push_back(static_cast<T>(value(f)));
      return values;
    };
    using F = const ViewFootprint&;
    const auto whole = [&](const char* name, const auto& value) {
      out.add(name, column(std::uint32_t{0}, value));
    };
    const auto real = [&](const char* name, int bits, const auto& value) {
      out.add(name, column(0.0f, value), bits);
    };
    whole("ping", [](F f) { return f.ping; });
    whole("beam", [](F f) { return f.beam; });
    whole("tube", [](F f) { return f.tube; });
    whole("facet", [](F f) { return f.facet; });
    whole("drawnTube", [](F f) { return f.drawn_tube; });
    if (data_.separate_receiver) {
      whole("receiveTube", [](F f) { return f.receive_tube; });
      whole("drawnReceiveTube", [](F f) { return f.drawn_receive_tube; });
    }
    whole("pieces", [](F f) { return f.pieces; });
    whole("occluders", [](F f) { return f.occluders; });
    out.add("component", column(std::uint16_t{0}, [](F f) { return f.component; }));
    out.add("material", column(std::uint16_t{0}, [](F f) { return f.material; }));
    real("area", energy_bits, [](F f) { return f.area_m2; });
    real("solidAngle", energy_bits, [](F f) { return f.solid_angle_sr; });
    real("grazing", finer_bits, [](F f) { return f.grazing_rad; });
    real("near", all_bits, [](F f) { return f.near_m; });
    real("far", all_bits, [](F f) { return f.far_m; });
    real("energy", energy_bits, [this](F f) { return f.energy_j / scale_; });
    std::vector<glm::dvec3> centroids;
    for (const ViewFootprint& f : data_.footprints) centroids.push_back(f.centroid_m);
    places(out, "centroid", centroids);
  }

  const ViewData& data_;
  Frame frame_;
  glm::dvec3 centre_;
  double scale_ = 0;
};

}  // namespace

std::string view_page(const ViewData& data) {
  const PageWriter writer(data);
  std::string html;
  std::string_view page = page_html;
  // Marks of the template, each in a comment.
  while (!page.empty()) {
    const std::size_t begin = page.find("<!--{"), end = page.find("}-->", begin);
    html += page.substr(0, begin);
    if (begin == std::string_view::npos) break;
    const std::string_view mark = page.substr(begin + 5, end - begin - 5);
    if (mark == "title") {
      html += shown_markup(shown_line(data.title) + " - " + shown_line(data.sensor));
    } else if (mark == "style") {
      html.append("<style>\n").append(page_css).append("</style>");
    } else if (mark == "drawing") {
      if (!data.drawing.empty())
        html.append("<details id=\"drawing\"><summary>Plan and sections</summary><div>")
            .append(data.drawing)
            .append("</div></details>");
    } else if (mark == "data") {
      html.append("<script type=\"application/json\" id=\"facts\">")
          .append(writer.facts())
          .append("</script>\n");
      writer.arrays(html);
    } else if (mark == "scripts") {
      html.append("<script>\n\"use strict\";\n(async () => {\n").append(page_js).append("})();\n</script>");
    } else {
      throw std::logic_error("the page template has an unknown placeholder: " + std::string(mark));
    }
    page.remove_prefix(end + 4);
  }
  return html;
}

}  // namespace tubefoot
