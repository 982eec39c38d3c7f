// SPDX-License-Identifier: GPL-3.0-or-later
// Reads PNG, TIFF and OpenEXR pictures with OpenImageIO as stored, without colour conversion. Each page of
// a TIFF and each part of an EXR is a frame.
#include "import/frames/picture_frames.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>

#include "files/input_error.hpp"
#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "files/tiff_file.hpp"
#include "files/words.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using namespace std::string_view_literals;

constexpr int most_pages = 10'000, most_channels = 64;

class PictureFile {
 public:
  PictureFile(const std::filesystem::path& file, std::string_view bytes, const std::string& channel)
      : place_{file.string()}, channel_(channel), memory_(bytes.data(), bytes.size()) {
    const std::string name(picture_format(bytes));  // given a file name, OpenImageIO would open the file
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // otherwise OpenImageIO multiplies colours by alpha
    input_ = OIIO::ImageInput::create(name);
    if (!input_) fail(OIIO::geterror());
    OIIO::Filesystem::IOProxy* bytes_in_memory = &memory_;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, static_cast<void*>(&bytes_in_memory));
    OIIO::ImageSpec spec;
    if (!input_->open(name, spec, config)) fail(input_->geterror());
  }

  ForeignData read() {
    ForeignData data;
    for (int page = 0; input_->seek_subimage(page, 0); ++page) {
      stop_if_wanted();
      if (page == most_pages) fail(fmt::format("it has more than {} pages", most_pages));
      data.frames.push_back(frame(page));
    }
    if (data.frames.empty()) fail(input_->geterror());
    if (data.frames.size() > 1)
      data.noticed.push_back(
          fmt::format("there are {} pages, and each is read as a ping", data.frames.size()));
    return data;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(place_,
                     fmt::format("cannot be read as a picture: {}: it is cut off or damaged; write it again",
                                 why.empty() ? "the reason is unknown" : why));
  }

  ForeignFrame frame(int page) {
    const OIIO::ImageSpec spec = input_->spec();
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 ||
        spec.nchannels > most_channels)
      fail(fmt::format("it has {} x {} x {} pixels with {} channels", spec.width, spec.height, spec.depth,
                       spec.nchannels));
    const double pixels = static_cast<double>(spec.width) * spec.height;
    if (pixels > static_cast<double>(limits::ping_cells))
      throw InputError(place_, fmt::format("has {} x {} pixels, more than any ping (at most {})", spec.width,
                                           spec.height, limits::ping_cells));
    total_ += pixels * (sizeof(double) + 8.0 * spec.nchannels);
    require_memory(total_, place_, "its pixels", "write fewer pages per file");
    switch (spec.format.basetype) {
      case OIIO::TypeDesc::UINT8:
        return frame_of<std::uint8_t>(spec, page);
      case OIIO::TypeDesc::UINT16:
        return frame_of<std::uint16_t>(spec, page);
      case OIIO::TypeDesc::UINT32:
        return frame_of<std::uint32_t>(spec, page);
      case OIIO::TypeDesc::INT16:
        return frame_of<std::int16_t>(spec, page);
      case OIIO::TypeDesc::INT32:
        return frame_of<std::int32_t>(spec, page);
      case OIIO::TypeDesc::HALF:
      case OIIO::TypeDesc::FLOAT:
        return frame_of<float>(spec, page);
      case OIIO::TypeDesc::DOUBLE:
        return frame_of<double>(spec, page);
      default:
        fail(fmt::format("its pixels are of type {}", spec.format.c_str()));
    }
  }

  template <class Stored>
  ForeignFrame frame_of(const OIIO::ImageSpec& spec, int page) {
    const auto rows = static_cast<std::size_t>(spec.height), columns = static_cast<std::size_t>(spec.width),
               channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<Stored> pixels(rows * columns * channels);
    if (!input_->read_image(page, 0, 0, spec.nchannels, OIIO::BaseTypeFromC<Stored>::value, pixels.data()))
      fail(input_->geterror());
    ForeignFrame result{rows, columns, {}, std::is_same_v<Stored, std::uint8_t>, {}, {}, {}};
    result.values.reserve(rows * columns);
    const std::size_t taken = channel_of(spec);
    const bool colours = channel_.empty() && channels >= 3;
    for (std::size_t k = 0; k < pixels.size(); k += channels) {
      if (colours && (pixels[k] != pixels[k + 1] || pixels[k] != pixels[k + 2]))
        throw InputError(
            place_,
            fmt::format("is in colours (row {}, column {}: red {}, green {}, blue {}), which do not measure "
                        "intensity: write the intensities in grey, or choose a channel with --variable {}",
                        k / channels / columns, k / channels % columns, +pixels[k], +pixels[k + 1],
                        +pixels[k + 2], one_of(spec.channelnames, '\'')));
      result.values.push_back(static_cast<double>(pixels[k + taken]));
    }
    return result;
  }

  std::size_t channel_of(const OIIO::ImageSpec& spec) const {
    if (channel_.empty()) {
      if (spec.nchannels <= 4 && spec.format.basetype != OIIO::TypeDesc::UNKNOWN) return 0;
      throw InputError(place_, fmt::format("has {} channels: choose one with --variable {}", spec.nchannels,
                                           one_of(spec.channelnames, '\'')));
    }
    const auto found = std::ranges::find(spec.channelnames, channel_);
    if (found == spec.channelnames.end())
      throw InputError(
          place_, fmt::format("has no channel '{}'; it has {}", channel_, one_of(spec.channelnames, '\'')));
    return static_cast<std::size_t>(found - spec.channelnames.begin());
  }

  SourcePlace place_;
  std::string channel_;
  OIIO::Filesystem::IOMemReader memory_;
  std::unique_ptr<OIIO::ImageInput> input_;
  double total_ = 0;
};

}  // namespace

std::string_view picture_format(std::string_view head) {
  if (head.starts_with("\x89PNG\r\n\x1a\n"sv)) return "png";
  if (head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv) || head.starts_with("II+\0"sv) ||
      head.starts_with("MM\0+"sv))
    return "tiff";
  if (head.starts_with("\x76\x2f\x31\x01"sv)) return "openexr";
  return {};
}

ForeignData read_picture(const std::filesystem::path& file, std::string_view bytes,
                         const std::string& channel) {
  if (picture_format(bytes) == "tiff") refuse_long_tiff(file);
  return PictureFile(file, bytes, channel).read();
}

}  // namespace tubefoot
