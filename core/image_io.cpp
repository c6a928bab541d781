// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/file.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

template <class Code>
std::vector<Code> to_codes(const ImageF& image) {
  constexpr auto kMax = static_cast<float>(std::numeric_limits<Code>::max());
  std::vector<Code> codes(image.size());
  std::ranges::transform(image.values(), codes.begin(), [](float value) {
    const float clamped = value > 0.0F ? std::min(value, 1.0F) : 0.0F;  // NaN becomes 0
    return static_cast<Code>(std::lround(clamped * kMax));
  });
  return codes;
}

/// A specification without time stamps: equal pixels give equal bytes.
ImageSpec stable_spec(int width, int height, const TypeDesc& type) {
  ImageSpec spec(width, height, 1, type);
  spec.attribute("DateTime", "2000:01:01 00:00:00");
  spec.attribute("oiio:ColorSpace", "Linear");
  return spec;
}

/// PNG is packed in memory and written by us: OpenImageIO does not notice a full disk.
std::string packed_png(const ImageSpec& spec, const void* pixels) {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = ImageOutput::create("memory.png");
  GLINT_CHECK(output && output->set_ioproxy(&memory), "PNG can be written to memory");
  if (!output->open("memory.png", spec) || !output->write_image(spec.format, pixels) ||
      !output->close()) {
    throw IoError("a picture cannot be packed as PNG: " + output->geterror());
  }
  return {bytes.begin(), bytes.end()};
}

template <class Code>
std::string packed_png(const ImageF& image, const TypeDesc& type) {
  return packed_png(stable_spec(image.width(), image.height(), type), to_codes<Code>(image).data());
}

}  // namespace

void write_png(const fs::path& path, const ImageF& image, PixelDepth depth) {
  write_file(path,
             depth == PixelDepth::k16Bit ? packed_png<std::uint16_t>(image, TypeDesc::UINT16)
                                         : packed_png<std::uint8_t>(image, TypeDesc::UINT8));
}

void write_mask_png(const fs::path& path, const Mask& mask) {
  std::vector<std::uint8_t> codes(mask.size());
  std::ranges::transform(mask.values(), codes.begin(), [](unsigned char inside) {
    return static_cast<std::uint8_t>(inside != 0 ? 255 : 0);
  });
  write_file(path,
             packed_png(stable_spec(mask.width(), mask.height(), TypeDesc::UINT8), codes.data()));
}

void write_exr(const fs::path& path, const ImageF& image) {
  ImageSpec spec = stable_spec(image.width(), image.height(), TypeDesc::FLOAT);
  spec.attribute("compression", "zip");
  spec.attribute("capDate", "2000:01:01 00:00:00");
  // Through memory, so that the disk's own words are told when it is full.
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = ImageOutput::create("memory.exr");
  GLINT_CHECK(output && output->supports("ioproxy") && output->set_ioproxy(&memory),
              "OpenImageIO writes OpenEXR to memory");
  if (!output->open("memory.exr", spec) ||
      !output->write_image(spec.format, image.values().data()) || !output->close()) {
    throw IoError(fmt::format("{}: cannot be written: {}", path.string(), output->geterror()));
  }
  write_file(path, std::string(bytes.begin(), bytes.end()));
}

ImageF read_image(const fs::path& path) {
  const auto input = ImageInput::open(path.string());
  if (!input) {
    throw IoError(
        fmt::format("{}: cannot be read as a picture: {}", path.string(), OIIO::geterror()));
  }
  const ImageSpec& spec = input->spec();
  if (spec.width <= 0 || spec.height <= 0) {
    throw IoError(path.string() + ": the picture holds no pixel");
  }
  ImageF image(spec.width, spec.height);
  if (!input->read_image(0, 0, 0, 1, TypeDesc::FLOAT, image.values().data())) {
    throw IoError(
        fmt::format("{}: cannot be read as a picture: {}", path.string(), input->geterror()));
  }
  return image;
}

std::string png_bytes(const ImageF& image) {
  ImageSpec spec = stable_spec(image.width(), image.height(), TypeDesc::UINT8);
  spec.attribute("png:compressionLevel", 6);
  return packed_png(spec, to_codes<std::uint8_t>(image).data());
}

std::string base64(const std::string& bytes) {
  static constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8) | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kAlphabet[(group >> (18 - 6 * k)) & 63U] : '=';
    }
  }
  return text;
}

ImageF reduce(const ImageF& image, int factor) {
  GLINT_CHECK(factor >= 1, "a reduction factor counts pixels");
  ImageF small(image.width() / factor, image.height() / factor);
  const float weight = 1.0F / static_cast<float>(factor * factor);
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      float sum = 0.0F;
      for (int dy = 0; dy < factor; ++dy) {
        for (int dx = 0; dx < factor; ++dx) {
          sum += image(x * factor + dx, y * factor + dy);
        }
      }
      small(x, y) = sum * weight;
    }
  }
  return small;
}

}  // namespace glint
