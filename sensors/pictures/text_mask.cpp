// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/text_mask.hpp"

#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "sensors/pictures/image_file.hpp"

namespace tubefoot {
namespace {

TextMask drawn(const std::string& line, int size, const std::string& font) {
  TextMask mask;
  const OIIO::ROI box = OIIO::ImageBufAlgo::text_size(line, size, font);
  if (!box.defined()) return mask;
  mask.length = box.width();
  // Letters may extend beyond the box by less than their height.
  const int around = size, columns = mask.length + 2 * around, rows = 3 * size, baseline = 2 * size;
  std::vector<float> grey(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0.0f);
  OIIO::ImageBuf image(OIIO::ImageSpec(columns, rows, 1, OIIO::TypeDesc::FLOAT), grey.data());
  const float white[] = {1};
  if (!OIIO::ImageBufAlgo::render_text(image, around, baseline, line, size, font, white))
    throw std::runtime_error("cannot draw a label: " + reason_in_words(image.geterror()));

  int left = columns, right = 0, top = rows, bottom = 0;
  const auto covered = [&](int x, int y) {
    return grey[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      if (covered(x, y) > 0) {
        left = std::min(left, x), right = std::max(right, x + 1);
        top = std::min(top, y), bottom = std::max(bottom, y + 1);
      }
  if (left >= right) return mask;
  mask.left = left - around, mask.top = top - baseline;
  mask.width = right - left, mask.height = bottom - top;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x)
      mask.coverage.push_back(static_cast<unsigned char>(std::lround(255 * covered(x, y))));
  return mask;
}

}  // namespace

const TextMask& text_mask(const std::string& line, int size, const std::string& font) {
  // Titles differ between pictures. The cache is cleared when it has more lines than a picture.
  constexpr std::size_t most_lines = 300;
  thread_local std::map<std::tuple<std::string, int, std::string>, TextMask> kept;
  const auto key = std::tie(line, size, font);
  if (const auto known = kept.find(key); known != kept.end()) return known->second;
  TextMask mask = drawn(line, size, font);
  if (kept.size() >= most_lines) kept.clear();
  return kept.emplace(key, std::move(mask)).first->second;
}

}  // namespace tubefoot
