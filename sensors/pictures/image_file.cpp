// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pictures/image_file.hpp"

#include <OpenImageIO/filesystem.h>

#include "files/checked_file.hpp"

namespace tubefoot {

std::string reason_in_words(const std::string& said) {
  return said.empty() ? "no reason is given: there may be too little memory"
                      : said + ", or there is too little memory";
}

std::vector<unsigned char> encoded_image(const std::filesystem::path& file, const OIIO::ImageSpec& spec,
                                         const float* pixels) {
  const auto fail = [&](const std::string& reason) {
    throw write_error(file, "cannot encode the picture: " + reason_in_words(reason));
  };
  auto output = OIIO::ImageOutput::create(file.filename().string());
  if (!output) fail(OIIO::geterror());
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  output->set_ioproxy(&memory);
  if (!output->open(file.filename().string(), spec) || !output->write_image(OIIO::TypeDesc::FLOAT, pixels) ||
      !output->close())
    fail(output->geterror());
  return bytes;
}

void write_image(const std::filesystem::path& file, const OIIO::ImageSpec& spec, const float* pixels) {
  write_file(file, encoded_image(file, spec, pixels));
}

OIIO::ImageSpec exr_spec(const OIIO::ParamValueList& attributes) {
  OIIO::ImageSpec spec(1, 1, 1, OIIO::TypeDesc::FLOAT);
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // prevents OpenImageIO from writing the time of day, so that equal runs
                                   // give equal files
  for (const auto& attribute : attributes) spec.extra_attribs.push_back(attribute);
  return spec;
}

void write_exr(const std::filesystem::path& file, int width, int height, const std::vector<float>& values,
               const OIIO::ParamValueList& attributes) {
  OIIO::ImageSpec spec = exr_spec(attributes);
  spec.width = spec.full_width = width;
  spec.height = spec.full_height = height;
  write_image(file, spec, values.data());
}

}  // namespace tubefoot
