// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/exr_reader.h"

#include <vector>

#include <OpenImageIO/imageio.h>

#include "core/error.h"

namespace glint::test {

std::map<std::string, ImageF> channels_of(const std::filesystem::path& path) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) {
    throw IoError(path.string() + ": " + OIIO::geterror());
  }
  const OIIO::ImageSpec spec = input->spec();
  const auto count = static_cast<std::size_t>(spec.nchannels);
  std::vector<float> values(spec.image_pixels() * count);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data())) {
    throw IoError(path.string() + ": " + input->geterror());
  }
  std::map<std::string, ImageF> channels;
  for (std::size_t c = 0; c < count; ++c) {
    ImageF& image = channels[spec.channelnames[c]] = ImageF(spec.width, spec.height);
    for (std::size_t i = 0; i < image.size(); ++i) {
      image.values()[i] = values[count * i + c];
    }
  }
  return channels;
}

}  // namespace glint::test
