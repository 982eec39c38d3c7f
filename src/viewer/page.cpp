// SPDX-License-Identifier: GPL-3.0-or-later
#include "viewer/page.hpp"

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string_view>

#include "files/shown.hpp"
#include "viewer/assets.hpp"

namespace tubefoot {
namespace {

static_assert(std::endian::native == std::endian::little, "pages hold little-endian numbers, as browsers do");

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? std::uint32_t(static_cast<unsigned char>(bytes[i + k])) : 0u;
    };
    const std::uint32_t three = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (int k = 0; k < 4; ++k)
      text += std::size_t(k) > bytes.size() - i ? '=' : digits[three >> (18 - 6 * k) & 63];
  }
  return text;
}

/// Arrays by name, each in a script element of its own that no browser runs.
class Arrays {
 public:
  explicit Arrays(std::string& html) : html_(html) {}
  template <class T>
  void add(const char* name, const std::vector<T>& values) {
    const char* type = sizeof(T) == 2                ? "Uint16Array"
                       : std::is_floating_point_v<T> ? "Float32Array"
                                                     : "Uint32Array";
    static_assert(sizeof(T) == 2 || sizeof(T) == 4);
    html_ += "<script type=\"text/plain\" class=\"array\" data-name=\"";
    html_ += name;
    html_ += "\" data-type=\"";
    html_ += type;
    html_ += "\">";
    html_ += base64({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
    html_ += "</script>\n";
  }

 private:
  std::string& html_;
};

glm::dvec3 middle_of(const ViewData& data) {
  const auto& points = data.shapes.corners_m;
  if (points.empty()) return data.pings.empty() ? glm::dvec3(0) : data.pings.front().sensor_m;
  glm::dvec3 lo = points.front(), hi = lo;
  for (const glm::dvec3& p : points)
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], p[k]);
      hi[k] = std::max(hi[k], p[k]);
    }
  return (lo + hi) / 2.0;
}

class PageWriter {
 public:
  explicit PageWriter(const ViewData& data) : data_(data), centre_(middle_of(data)) {
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
                                {"receiverApart", data_.receiver_apart},
                                {"beams", data_.beams},
                                {"samples", data_.samples},
                                {"firstRange", data_.first_m},
                                {"rangeStep", data_.step_m},
                                {"beamAngles", data_.beam_angle_deg},
                                {"centre", {centre_.x, centre_.y, centre_.z}},
                                {"energyScale", scale_},
                                {"weakLinksLeftOut", data_.weak_links_left_out}};
    for (const ViewPing& ping : data_.pings)
      json["pings"].push_back({{"number", ping.number},
                               {"time", ping.time_s},
                               {"sensor", place(ping.sensor_m)},
                               {"receiver", place(ping.receiver_m)},
                               {"shadows", ping.shadows}});
    std::string text = json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
    // Nothing in a title may end the script element that holds it.
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
    return text;
  }

  void arrays(std::string& html) const {
    Arrays out(html);
    std::vector<float> energy;
    for (const double e : data_.energy_j) energy.push_back(float(e / scale_));
    out.add("cellEnergy", energy);
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
    out.add("linkEnergy", part);
    out.add("shapeCorners", data_.shapes.corners_of);
    out.add("shapePoints", points(data_.shapes.corners_m));
    out.add("shadowCorners", data_.shadows.corners_of);
    out.add("shadowPoints", points(data_.shadows.corners_m));
    out.add("meshPoints", points(data_.mesh_vertices_m));
    out.add("meshFacets", data_.mesh_facets);
    std::vector<std::uint32_t> owners;
    std::vector<glm::dvec3> edges;
    for (const ViewTube& tube : data_.tubes) {
      owners.insert(owners.end(), {tube.ping, tube.beam});
      edges.push_back(tube.apex_m);
      edges.insert(edges.end(), tube.ends_m, tube.ends_m + 4);
    }
    out.add("tubeOwner", owners);
    out.add("tubePoints", points(edges));
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
  std::vector<float> points(const std::vector<glm::dvec3>& places) const {
    std::vector<float> values;
    values.reserve(3 * places.size());
    for (const glm::dvec3& p : places)
      for (int k = 0; k < 3; ++k) values.push_back(float(p[k] - centre_[k]));
    return values;
  }

  void footprints(Arrays& out) const {
    const auto column = [&]<class T>(const char* name, T, const auto& value) {
      std::vector<T> values;
      values.reserve(data_.footprints.size());
      for (const ViewFootprint& f : data_.footprints) values.push_back(static_cast<T>(value(f)));
      out.add(name, values);
    };
    using F = const ViewFootprint&;
    constexpr std::uint32_t whole = 0;
    constexpr float real = 0;
    column("ping", whole, [](F f) { return f.ping; });
    column("beam", whole, [](F f) { return f.beam; });
    column("tube", whole, [](F f) { return f.tube; });
    column("facet", whole, [](F f) { return f.facet; });
    column("receiveTube", whole, [](F f) { return f.receive_tube; });
    column("drawnReceiveTube", whole, [](F f) { return f.drawn_receive_tube; });
    column("drawnTube", whole, [](F f) { return f.drawn_tube; });
    column("pieces", whole, [](F f) { return f.pieces; });
    column("occluders", whole, [](F f) { return f.occluders; });
    column("component", std::uint16_t{0}, [](F f) { return f.component; });
    column("material", std::uint16_t{0}, [](F f) { return f.material; });
    column("area", real, [](F f) { return f.area_m2; });
    column("solidAngle", real, [](F f) { return f.solid_angle_sr; });
    column("grazing", real, [](F f) { return f.grazing_rad; });
    column("near", real, [](F f) { return f.near_m; });
    column("far", real, [](F f) { return f.far_m; });
    column("energy", real, [this](F f) { return f.energy_j / scale_; });
    std::vector<glm::dvec3> centroids;
    for (const ViewFootprint& f : data_.footprints) centroids.push_back(f.centroid_m);
    out.add("centroid", points(centroids));
  }

  const ViewData& data_;
  glm::dvec3 centre_;
  double scale_ = 0;
};

}  // namespace

std::string view_page(const ViewData& data) {
  const PageWriter writer(data);
  std::string html;
  std::string_view page = page_html;
  // The template's marks, each alone in a comment.
  while (!page.empty()) {
    const std::size_t begin = page.find("<!--{"), end = page.find("}-->", begin);
    html += page.substr(0, begin);
    if (begin == std::string_view::npos) break;
    const std::string_view mark = page.substr(begin + 5, end - begin - 5);
    if (mark == "title") {
      html += shown_markup(shown_line(data.title) + " - " + shown_line(data.sensor));
    } else if (mark == "style") {
      html.append("<style>\n").append(page_css).append("</style>");
    } else if (mark == "data") {
      html.append("<script type=\"application/json\" id=\"facts\">")
          .append(writer.facts())
          .append("</script>\n");
      writer.arrays(html);
    } else if (mark == "scripts") {
      html.append("<script>\n\"use strict\";\n(() => {\n").append(page_js).append("})();\n</script>");
    } else {
      throw std::logic_error("the viewer's page has an unknown mark: " + std::string(mark));
    }
    page.remove_prefix(end + 4);
  }
  return html;
}

}  // namespace tubefoot
