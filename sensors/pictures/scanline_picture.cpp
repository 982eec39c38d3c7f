// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/scanline_picture.hpp"

#include <OpenImageIO/filesystem.h>
#include <fmt/format.h>

#include <exception>
#include <stdexcept>

#include "files/checked_file.hpp"
#include "files/streamed_file.hpp"
#include "sensors/pictures/image_file.hpp"

namespace tubefoot {

/// Output stream for OpenImageIO's encoders. It detects a full disk, which their own stream does not.
/// Exceptions must not pass through the C libraries, so that a failure is stored for later.
class ScanlinePicture::Stream : public OIIO::Filesystem::IOProxy {
 public:
  explicit Stream(const std::filesystem::path& file) : IOProxy(file.string(), Write), file_(file) {}

  const char* proxytype() const override { return "tubefoot"; }
  std::size_t write(const void* bytes, std::size_t size) override {
    if (failure_) return 0;
    const std::span<const std::uint8_t> all(static_cast<const std::uint8_t*>(bytes), size);
    const auto begin = static_cast<std::uint64_t>(m_pos);
    try {
      if (begin == file_.size())
        file_.append(all);
      else
        file_.overwrite(begin, all);
    } catch (const std::exception&) {
      failure_ = std::current_exception();
      return 0;
    }
    m_pos += static_cast<std::int64_t>(size);
    return size;
  }
  std::size_t size() const override { return file_.size(); }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }
  void complete() { file_.close(); }

 private:
  StreamedFile file_;
  std::exception_ptr failure_;
};

ScanlinePicture::ScanlinePicture(const std::filesystem::path& file, int width, int height,
                                 OIIO::ImageSpec spec)
    : path_(file), stream_(std::make_unique<Stream>(file)), spec_(std::move(spec)) {
  spec_.width = spec_.full_width = width;
  spec_.height = spec_.full_height = height;
  const std::string name = file.filename().string();
  output_ = OIIO::ImageOutput::create(name);
  if (!output_) throw write_error(file, "cannot encode the picture: " + reason_in_words(OIIO::geterror()));
  output_->set_ioproxy(stream_.get());
  check(output_->open(name, spec_));
}

ScanlinePicture::~ScanlinePicture() = default;

void ScanlinePicture::check(bool done) {
  const std::string reason = output_->geterror();  // always fetched, because OpenImageIO prints errors that
                                                   // are not fetched
  stream_->rethrow();
  if (!done) throw write_error(path_, "cannot encode the picture: " + reason_in_words(reason));
}

void ScanlinePicture::add_row(const void* values) {
  if (rows_ >= spec_.height)
    throw std::logic_error(fmt::format("{}: the picture has only {} rows, but more rows were given",
                                       path_.string(), spec_.height));
  check(output_->write_scanline(rows_++, 0, spec_.format, values));
}

void ScanlinePicture::finish() {
  if (rows_ != spec_.height)
    throw std::logic_error(
        fmt::format("{}: only {} of the picture's {} rows were given", path_.string(), rows_, spec_.height));
  check(output_->close());
  stream_->complete();
}

}  // namespace tubefoot
