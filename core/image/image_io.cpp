// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/image_io.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>

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

/// What OpenImageIO says may have several lines.
std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) {
    text.pop_back();
  }
  std::ranges::replace(text, '\n', ' ');
  return text;
}

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
ImageSpec stable_spec(int width, int height, const TypeDesc& type, int channels = 1) {
  ImageSpec spec(width, height, channels, type);
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

/// What read_picture() knows, by the first bytes of a file; no other reader shall see it. BMP is
/// left out: OpenImageIO 2.4 crashes on damaged files.
struct Format {
  std::string_view first_bytes;
  const char* reader;
};

using namespace std::string_view_literals;

constexpr std::array<Format, 13> kFormats = {{{"\x89PNG\r\n\x1a\n"sv, "png"},
                                              {"\xff\xd8\xff"sv, "jpeg"},
                                              {"II*\0"sv, "tiff"},
                                              {"MM\0*"sv, "tiff"},
                                              {"II+\0"sv, "tiff"},
                                              {"MM\0+"sv, "tiff"},
                                              {"P1"sv, "pnm"},
                                              {"P2"sv, "pnm"},
                                              {"P3"sv, "pnm"},
                                              {"P4"sv, "pnm"},
                                              {"P5"sv, "pnm"},
                                              {"P6"sv, "pnm"},
                                              {"\x76\x2f\x31\x01"sv, "openexr"}}};

/// OpenImageIO takes memory for 64 whole rows at once.
constexpr int kMaxSide = 1 << 17;

/// Deflate packs a thousand bytes into one, and a byte may be eight pixels of one bit.
constexpr double kMaxValuesPerByte = 10000.0;

std::string first_bytes_of(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    throw IoError(path.string() + ": is a folder, not a picture");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string bytes(8, '\0');
  if (!file) {
    throw IoError(
        fmt::format("{}: the picture cannot be read: {}", path.string(), last_system_error()));
  }
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

std::unique_ptr<ImageInput> open_picture(const fs::path& path) {
  const std::string bytes = first_bytes_of(path);
  const auto* const format = std::ranges::find_if(
      kFormats, [&](const Format& known) { return bytes.starts_with(known.first_bytes); });
  if (format == kFormats.end()) {
    throw ConfigError(path.string() +
                      ": is no picture; allowed are PNG, JPEG, TIFF, PNM and OpenEXR");
  }
  std::unique_ptr<ImageInput> input = ImageInput::create(format->reader);
  GLINT_CHECK(input != nullptr, "OpenImageIO has a reader of each format");
  ImageSpec wish;
  wish.attribute("oiio:UnassociatedAlpha", 1);  // colours stay as they are under alpha
  ImageSpec spec;
  if (!input->open(path.string(), spec, wish)) {
    throw ConfigError(
        fmt::format("{}: the picture is damaged: {}", path.string(), one_line(input->geterror())));
  }
  return input;
}

void check_size(const ImageSpec& spec, const fs::path& path) {
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) {
    throw ConfigError(path.string() + ": the picture holds no pixel");
  }
  const std::int64_t pixels = static_cast<std::int64_t>(spec.width) * spec.height;
  const bool is_large = std::max(spec.width, spec.height) > kMaxSide || pixels > kMaxPixels;
  if (spec.depth > 1 || is_large || pixels * spec.nchannels > 4 * kMaxPixels) {
    throw ConfigError(fmt::format("{}: {} x {} pixels with {} channels are more than is allowed",
                                  path.string(),
                                  spec.width,
                                  spec.height,
                                  spec.nchannels));
  }
  // Whatever a damaged head promises, memory is asked for only where the file may hold that much.
  std::error_code ignored;
  const auto file_bytes = static_cast<double>(fs::file_size(path, ignored));
  const double values = static_cast<double>(pixels) * spec.nchannels;
  if (values > kMaxValuesPerByte * file_bytes + 65536.0) {
    throw ConfigError(fmt::format("{}: the picture is damaged: {} bytes cannot hold {} x {} pixels",
                                  path.string(),
                                  file_bytes,
                                  spec.width,
                                  spec.height));
  }
}

/// Weights of the file's channels in the one that is kept.
std::vector<float> channel_weights(const ImageSpec& spec, int& colours) {
  std::vector<std::size_t> kept;
  for (int i = 0; i < spec.nchannels; ++i) {
    if (i != spec.alpha_channel && i != spec.z_channel) {
      kept.push_back(static_cast<std::size_t>(i));
    }
  }
  colours = static_cast<int>(kept.size());
  std::vector<float> weights(static_cast<std::size_t>(spec.nchannels), 0.0F);
  if (kept.size() >= 3) {
    weights[kept[0]] = 0.2126F;
    weights[kept[1]] = 0.7152F;
    weights[kept[2]] = 0.0722F;
  } else {
    weights[kept.empty() ? 0 : kept[0]] = 1.0F;
  }
  return weights;
}

/// All channels of the first picture, interleaved.
template <class Value>
std::vector<Value> read_values(ImageInput& input, const TypeDesc& type, const fs::path& path) {
  const ImageSpec& spec = input.spec();
  std::vector<Value> values(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
  if (!input.read_image(0, 0, 0, spec.nchannels, type, values.data())) {
    throw ConfigError(fmt::format(
        "{}: the picture is damaged or cut short: {}", path.string(), one_line(input.geterror())));
  }
  return values;
}

template <class Code>
Image<Code> read_codes(ImageInput& input, const TypeDesc& type, const fs::path& path) {
  const ImageSpec spec = input.spec();
  Image<Code> image(spec.width, spec.height);
  const std::vector<Code> values = read_values<Code>(input, type, path);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] = values[i * static_cast<std::size_t>(spec.nchannels)];
  }
  return image;
}

ImageF read_weighted(ImageInput& input, std::span<const float> weights, const fs::path& path) {
  ImageF image(input.spec().width, input.spec().height);
  const std::vector<float> values = read_values<float>(input, TypeDesc::FLOAT, path);
  const float* at = values.data();
  for (float& grey : image.values()) {
    float sum = 0.0F;
    for (const float weight : weights) {
      // A channel that is left out may hold anything.
      sum += weight != 0.0F ? weight * *at : 0.0F;
      ++at;
    }
    grey = sum;
  }
  return image;
}

/// What a file of that format ends with; empty where its reader tells by itself. JPEG readers fill
/// up what is missing, the PNG reader prints what it thinks of it.
std::string_view end_mark(std::string_view format) {
  return format == "jpeg" ? "\xff\xd9"sv : format == "png" ? "IEND"sv : ""sv;
}

void check_end(const fs::path& path, std::string_view mark) {
  if (!mark.empty() && read_file(path).rfind(mark) == std::string::npos) {
    throw ConfigError(path.string() + ": the picture is cut short: its end is missing");
  }
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
  // Encoded in memory first: writing the file ourselves gives the system's own error message when
  // the disk is full.
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

Picture read_picture(const fs::path& path) {
  const std::unique_ptr<ImageInput> input = open_picture(path);
  const ImageSpec spec = input->spec();
  check_size(spec, path);
  check_end(path, end_mark(input->format_name()));
  Picture picture;
  const std::vector<float> weights = channel_weights(spec, picture.channels);
  picture.is_float = spec.format.is_floating_point();
  picture.bits = picture.is_float ? 32 : static_cast<int>(8 * spec.format.basesize());
  const bool is_first_channel = weights[0] == 1.0F;
  if (is_first_channel && spec.format == TypeDesc::UINT8) {
    picture.pixels = read_codes<std::uint8_t>(*input, TypeDesc::UINT8, path);
  } else if (is_first_channel && spec.format == TypeDesc::UINT16) {
    picture.pixels = read_codes<std::uint16_t>(*input, TypeDesc::UINT16, path);
  } else {
    picture.pixels = read_weighted(*input, weights, path);
  }
  picture.has_more = input->seek_subimage(1, 0);
  return picture;
}

ImageF linear_values(const Pixels& pixels) {
  return std::visit(
      [](const auto& image) {
        using Value = std::decay_t<decltype(image(0, 0))>;
        ImageF linear(image.width(), image.height());
        std::ranges::transform(image.values(), linear.values().begin(), [](Value value) {
          if constexpr (std::is_integral_v<Value>) {
            constexpr auto kMax = static_cast<float>(std::numeric_limits<Value>::max());
            return static_cast<float>(value) / kMax;
          } else {
            return value;
          }
        });
        return linear;
      },
      pixels);
}

std::string png_bytes(const ImageRgb& image) {
  ImageSpec spec = stable_spec(image.width(), image.height(), TypeDesc::UINT8, 3);
  spec.attribute("png:compressionLevel", 6);
  return packed_png(spec, image.values().data());
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
