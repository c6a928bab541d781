// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/texture_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"
#include "core/image/image_io.h"
#include "core/image/unreadable_picture.h"
#include "simulator/material/fresnel.h"

namespace glint {
namespace {

void check_spec(const OIIO::ImageSpec& spec, const std::filesystem::path& path) {
  const bool is_whole = spec.width > 0 && spec.height > 0 && spec.nchannels > 0 && spec.depth <= 1;
  if (!is_whole || std::int64_t{spec.width} * spec.height > kMaxPixels) {
    throw ConfigError(
        fmt::format("{}: holds no picture of 1 to {} pixels", path.string(), kMaxPixels));
  }
}

/// Rounding may leave a decoded white a little above 1.
float decoded(float value, bool is_srgb) {
  return is_srgb ? std::min(1.0F, static_cast<float>(linear_from_srgb(255.0 * double{value})))
                 : value;
}

TexturePicture three_channels(const std::vector<float>& values,
                              const OIIO::ImageSpec& spec,
                              std::size_t channels) {
  TexturePicture picture(spec.width, spec.height);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      picture.values()[i][c] = values[i * channels + (channels == 3 ? c : 0)];
    }
  }
  return picture;
}

/// The pixels left and right of a place along one axis, and the share of the right one.
struct Neighbours {
  int first = 0;
  int second = 0;
  double share = 0.0;
};

Neighbours neighbours(double place, int count) {
  const double wrapped = place - std::floor(place);
  const double at = wrapped * count - 0.5;
  const double below = std::floor(at);
  // `at` lies in [-0.5, count - 0.5], of which both ends may round to one beyond the last pixel.
  const int first = (static_cast<int>(below) + count) % count;
  return {.first = first, .second = (first + 1) % count, .share = at - below};
}

Eigen::Array3d value_at(const TexturePicture& picture, int x, int y) {
  const std::array<float, 3>& pixel = picture(x, y);
  return {double{pixel[0]}, double{pixel[1]}, double{pixel[2]}};
}

}  // namespace

TexturePicture read_texture_picture(const std::filesystem::path& path, TextureEncoding encoding) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) {
    throw_unreadable_picture(path, OIIO::geterror());
  }
  const OIIO::ImageSpec spec = input->spec();
  check_spec(spec, path);
  const std::size_t channels = spec.nchannels >= 3 ? 3 : 1;
  std::vector<float> values(spec.image_pixels() * channels);
  if (!input->read_image(
          0, 0, 0, static_cast<int>(channels), OIIO::TypeDesc::FLOAT, values.data())) {
    throw_unreadable_picture(path, input->geterror());
  }
  // The comparison is false for values that are no numbers.
  if (!std::ranges::all_of(values, [](float v) { return v >= 0.0F && v <= 1.0F; })) {
    throw ConfigError(path.string() + ": holds values that are no factors; must be in [0, 1]");
  }
  const bool is_srgb = encoding == TextureEncoding::kSrgb ||
                       (encoding == TextureEncoding::kAuto && spec.format == OIIO::TypeDesc::UINT8);
  std::ranges::transform(values, values.begin(), [&](float v) { return decoded(v, is_srgb); });
  return three_channels(values, spec, channels);
}

Eigen::Array3d bilinear(const TexturePicture& picture, const Eigen::Vector2d& place) {
  const Neighbours x = neighbours(place.x(), picture.width());
  const Neighbours y = neighbours(place.y(), picture.height());
  const Eigen::Array3d top = (1.0 - x.share) * value_at(picture, x.first, y.first) +
                             x.share * value_at(picture, x.second, y.first);
  const Eigen::Array3d bottom = (1.0 - x.share) * value_at(picture, x.first, y.second) +
                                x.share * value_at(picture, x.second, y.second);
  return (1.0 - y.share) * top + y.share * bottom;
}

}  // namespace glint
