// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/picture_orientation.h"

#include <algorithm>
#include <memory>

#include <OpenImageIO/imageio.h>

#include "core/image/unreadable_picture.h"

namespace glint {

int picture_orientation(const std::filesystem::path& path) {
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path.string());
  if (!input) {
    throw_unreadable_picture(path, OIIO::geterror());
  }
  return std::clamp(input->spec().get_int_attribute("Orientation", 1), 1, 8);
}

}  // namespace glint
