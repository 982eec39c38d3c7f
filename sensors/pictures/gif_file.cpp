// SPDX-License-Identifier: GPL-3.0-or-later
// Encodes animations as GIF files. OpenImageIO dithers each frame with a search of a colour tree per pixel,
// which takes most of the time of an animation (validation/performance.md).
#include "sensors/pictures/gif_file.hpp"

#include <fmt/format.h>
#include <gif_lib.h>

#include <algorithm>
#include <new>

namespace tubefoot {
namespace {

constexpr std::size_t most_colours = 255;  // number 0 is transparent

/// A colour of a picture, and the number of its pixels.
struct CountedColour {
  std::uint32_t rgb;
  std::uint64_t pixels;

  std::uint64_t component(int axis) const { return rgb >> (16 - 8 * axis) & 255; }
};

/// The colours of a picture in the order of their first pixels, and their places by value. The table has open
/// addresses, and at least half of its places are empty.
class ColourTable {
 public:
  explicit ColourTable(std::span<const std::uint32_t> rgb) : places_(1024, none) {
    std::size_t last = 0;
    for (const std::uint32_t pixel : rgb) {
      if (colours_.empty() || colours_[last].rgb != pixel) last = added(pixel);
      ++colours_[last].pixels;
    }
  }

  const std::vector<CountedColour>& colours() const { return colours_; }
  std::size_t place_of(std::uint32_t rgb) const { return places_[slot_of(rgb)]; }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  std::size_t slot_of(std::uint32_t rgb) const {
    const std::size_t mask = places_.size() - 1;
    std::size_t slot = rgb * std::size_t{0x9e3779b97f4a7c15} >> 32 & mask;
    while (places_[slot] != none && colours_[places_[slot]].rgb != rgb) slot = (slot + 1) & mask;
    return slot;
  }
  std::size_t added(std::uint32_t rgb) {
    std::size_t slot = slot_of(rgb);
    if (places_[slot] != none) return places_[slot];
    if (2 * (colours_.size() + 1) > places_.size()) {
      places_.assign(2 * places_.size(), none);
      for (std::size_t k = 0; k < colours_.size(); ++k)
        places_[slot_of(colours_[k].rgb)] = static_cast<std::uint32_t>(k);
      slot = slot_of(rgb);
    }
    places_[slot] = static_cast<std::uint32_t>(colours_.size());
    colours_.push_back({rgb, 0});
    return colours_.size() - 1;
  }

  std::vector<CountedColour> colours_;
  std::vector<std::uint32_t> places_;  ///< numbers of colours; the size is a power of two
};

/// Colours [begin, end) that become one.
struct ColourGroup {
  std::size_t begin, end;
  std::uint64_t pixels = 0;
  std::array<std::uint64_t, 3> sums{};
  double error = 0;  ///< sum of the squared differences from the mean
  int axis = 0;      ///< the component with the largest part of it

  ColourGroup(const std::vector<CountedColour>& colours, std::size_t first, std::size_t last)
      : begin(first), end(last) {
    std::array<std::uint64_t, 3> squares{};
    for (std::size_t k = begin; k < end; ++k) {
      pixels += colours[k].pixels;
      for (int a = 0; a < 3; ++a) {
        const std::uint64_t component = colours[k].component(a);
        sums[std::size_t(a)] += colours[k].pixels * component;
        squares[std::size_t(a)] += colours[k].pixels * component * component;
      }
    }
    double largest = -1;
    for (int a = 0; a < 3; ++a) {
      const double sum = static_cast<double>(sums[std::size_t(a)]),
                   own =
                       static_cast<double>(squares[std::size_t(a)]) - sum * sum / static_cast<double>(pixels);
      error += own;
      if (own > largest) largest = own, axis = a;
    }
    if (end - begin == 1) error = 0;
  }
  std::array<std::uint8_t, 3> mean() const {
    std::array<std::uint8_t, 3> colour{};
    for (std::size_t a = 0; a < 3; ++a)
      colour[a] = static_cast<std::uint8_t>((sums[a] + pixels / 2) / pixels);
    return colour;
  }
};

/// Divides colours into at most 255 groups. Reorders them, so that the colours of a group follow each other.
std::vector<ColourGroup> grouped(std::vector<CountedColour>& colours) {
  std::vector<ColourGroup> groups{ColourGroup(colours, 0, colours.size())};
  while (groups.size() < most_colours) {
    const auto widest = std::ranges::max_element(groups, {}, &ColourGroup::error);
    if (!(widest->error > 0)) break;
    const ColourGroup whole = *widest;
    const std::uint64_t sum = whole.sums[std::size_t(whole.axis)];
    const auto first = colours.begin();
    const auto middle = std::partition(
        first + static_cast<std::ptrdiff_t>(whole.begin), first + static_cast<std::ptrdiff_t>(whole.end),
        [&](const CountedColour& colour) { return colour.component(whole.axis) * whole.pixels <= sum; });
    const auto place = static_cast<std::size_t>(middle - first);
    // Rounding may give an error above 0 to a group whose colours agree in this component.
    if (place == whole.begin || place == whole.end) {
      widest->error = 0;
      continue;
    }
    *widest = ColourGroup(colours, whole.begin, place);
    groups.emplace_back(colours, place, whole.end);
  }
  return groups;
}

[[noreturn]] void fail(int error) {
  const char* reason = GifErrorString(error);
  throw GifError(reason != nullptr ? reason : "giflib gives no reason");
}

}  // namespace

IndexedPicture indexed(std::span<const std::uint32_t> rgb) {
  if (rgb.empty()) return {};
  const ColourTable table(rgb);
  std::vector<std::uint8_t> number(table.colours().size());  // by place in the table
  IndexedPicture picture;
  std::vector<CountedColour> colours = table.colours();
  const bool exact = colours.size() <= most_colours;
  for (const ColourGroup& group : exact ? std::vector<ColourGroup>() : grouped(colours)) {
    picture.colours.push_back(group.mean());
    for (std::size_t k = group.begin; k < group.end; ++k)
      number[table.place_of(colours[k].rgb)] = static_cast<std::uint8_t>(picture.colours.size());
  }
  for (std::size_t k = 0; exact && k < colours.size(); ++k) {
    const std::uint32_t own = colours[k].rgb;
    picture.colours.push_back({static_cast<std::uint8_t>(own >> 16), static_cast<std::uint8_t>(own >> 8),
                               static_cast<std::uint8_t>(own)});
    number[k] = static_cast<std::uint8_t>(k + 1);
  }
  picture.pixels.resize(rgb.size());
  std::uint32_t last = ~rgb.front();
  std::uint8_t of_last = 0;
  for (std::size_t k = 0; k < rgb.size(); ++k) {
    if (rgb[k] != last) {
      last = rgb[k];
      of_last = number[table.place_of(last)];
    }
    picture.pixels[k] = of_last;
  }
  return picture;
}

struct GifFile::State {
  int width, height, delay;
  std::vector<unsigned char> bytes{};
  std::vector<std::uint32_t> before{};  ///< pixels of the last frame
  GifFileType* gif = nullptr;

  void require(int success) const {
    if (success == GIF_ERROR) fail(gif->Error);
  }
  static int take(GifFileType* gif, const GifByteType* data, int size) {
    auto& bytes = static_cast<State*>(gif->UserData)->bytes;
    bytes.insert(bytes.end(), data, data + size);
    return size;
  }
};

GifFile::GifFile(int width, int height, int delay) : state_(new State{width, height, delay}) {
  constexpr int most = 65535;
  if (width < 1 || height < 1 || width > most || height > most)
    throw GifError(
        fmt::format("an animation of {} x {} pixels is not possible: expected 1 to {}", width, height, most));
  int error = 0;
  state_->gif = EGifOpen(state_.get(), State::take, &error);
  if (state_->gif == nullptr) fail(error);
  EGifSetGifVersion(state_->gif, true);
  constexpr int bits = 8;
  state_->require(EGifPutScreenDesc(state_->gif, width, height, bits, 0, nullptr));
  const unsigned char without_end[] = {1, 0, 0};
  state_->require(EGifPutExtensionLeader(state_->gif, APPLICATION_EXT_FUNC_CODE));
  state_->require(EGifPutExtensionBlock(state_->gif, 11, "NETSCAPE2.0"));
  state_->require(EGifPutExtensionBlock(state_->gif, 3, without_end));
  state_->require(EGifPutExtensionTrailer(state_->gif));
}

GifFile::~GifFile() {
  if (state_->gif != nullptr) EGifCloseFile(state_->gif, nullptr);
}

void GifFile::add(std::vector<std::uint32_t> rgb, const IndexedPicture& picture) {
  State& state = *state_;
  const auto width = static_cast<std::size_t>(state.width), height = static_cast<std::size_t>(state.height);
  if (rgb.size() != width * height || picture.pixels.size() != rgb.size())
    throw GifError("a frame has another size than the animation");
  const bool first = state.before.empty();
  std::size_t left = width, right = 0, top = height, bottom = 0;
  for (std::size_t y = 0; y < height; ++y) {
    std::size_t from = 0, end = width;
    if (!first) {
      const std::uint32_t *now = &rgb[y * width], *then = &state.before[y * width];
      while (from < end && now[from] == then[from]) ++from;
      while (end > from && now[end - 1] == then[end - 1]) --end;
    }
    if (from == end) continue;
    left = std::min(left, from), right = std::max(right, end);
    top = std::min(top, y), bottom = y + 1;
  }
  if (left >= right) left = top = 0, right = bottom = 1;  // a frame has at least one pixel

  GraphicsControlBlock control{};
  control.DisposalMode = DISPOSE_DO_NOT;
  control.DelayTime = state.delay;
  control.TransparentColor = 0;
  GifByteType block[4];
  EGifGCBToExtension(&control, block);
  state.require(EGifPutExtension(state.gif, GRAPHICS_EXT_FUNC_CODE, sizeof block, block));
  std::array<GifColorType, 256> colours{};
  for (std::size_t k = 0; k < picture.colours.size(); ++k)
    colours[k + 1] = {picture.colours[k][0], picture.colours[k][1], picture.colours[k][2]};
  const std::unique_ptr<ColorMapObject, decltype(&GifFreeMapObject)> map(
      GifMakeMapObject(int(colours.size()), colours.data()), &GifFreeMapObject);
  if (!map) throw std::bad_alloc();
  state.require(EGifPutImageDesc(state.gif, int(left), int(top), int(right - left), int(bottom - top), false,
                                 map.get()));
  std::vector<GifPixelType> row(right - left);
  for (std::size_t y = top; y < bottom; ++y) {
    for (std::size_t x = left; x < right; ++x) {
      const std::size_t pixel = y * width + x;
      row[x - left] = !first && rgb[pixel] == state.before[pixel] ? 0 : picture.pixels[pixel];
    }
    state.require(EGifPutLine(state.gif, row.data(), int(row.size())));
  }
  state.before = std::move(rgb);
}

std::vector<unsigned char> GifFile::finish() {
  int error = 0;
  GifFileType* const gif = state_->gif;
  state_->gif = nullptr;
  if (EGifCloseFile(gif, &error) == GIF_ERROR) fail(error);
  return std::move(state_->bytes);
}

}  // namespace tubefoot
