// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/read_environment.h"

#include <algorithm>
#include <cmath>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"
#include "core/image/image_io.h"
#include "core/image/unreadable_picture.h"

namespace glint {
namespace {

void check_size(const OIIO::ImageSpec& spec, const std::string& file) {
  const bool is_whole = spec.width > 0 && spec.height > 0 && spec.nchannels > 0 && spec.depth <= 1;
  if (!is_whole || std::int64_t{spec.width} * spec.height > kMaxPixels) {
    throw ConfigError(fmt::format("{}: holds no picture of 1 to {} pixels", file, kMaxPixels));
  }
}

}  // namespace

Environment read_environment(const std::filesystem::path& path, const Eigen::Array3f& scale) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) {
    throw_unreadable_picture(path, OIIO::geterror());
  }
  const OIIO::ImageSpec spec = input->spec();
  check_size(spec, path.string());
  const int channels = spec.nchannels >= 3 ? 3 : 1;
  const auto stride = static_cast<std::size_t>(channels);
  std::vector<float> values(static_cast<std::size_t>(spec.width) *
                            static_cast<std::size_t>(spec.height) * stride);
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data())) {
    throw_unreadable_picture(path, input->geterror());
  }
  if (!std::ranges::all_of(values, [](float v) { return v >= 0.0F && std::isfinite(v); })) {
    throw ConfigError(path.string() + ": holds negative values or values that are no numbers");
  }
  std::vector<std::array<float, 3>> pixels(values.size() / stride);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      pixels[i][c] = values[i * stride + (channels == 3 ? c : 0)] * scale[static_cast<int>(c)];
    }
  }
  return {spec.width, spec.height, std::move(pixels)};
}

}  // namespace glint
