// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/exr_layers.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/unreadable_picture.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// Rows that are interleaved at a time; OpenEXR packs 16 of them together.
constexpr int kRows = 64;

/// Rows that are read at a time.
constexpr int kReadRows = 256;

constexpr float kLargestCode = 65535.0F;

ImageSpec stable_spec(int width, int height, std::size_t channels, const TypeDesc& type) {
  ImageSpec spec(width, height, static_cast<int>(channels), type);
  spec.attribute("DateTime", "2000:01:01 00:00:00");
  spec.attribute("capDate", "2000:01:01 00:00:00");
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip");
  return spec;
}

/// An open file, or why there is none.
void check_written(bool is_written, const ImageOutput& output, const fs::path& path) {
  if (!is_written) {
    throw IoError(fmt::format("{}: cannot be written: {}", path.string(), output.geterror()));
  }
}

void check_channels(std::span<const ImageF> channels) {
  GLINT_CHECK(channels.size() == 1 || channels.size() == 3, "pictures have 1 or 3 channels");
  GLINT_CHECK(std::ranges::all_of(channels,
                                  [&](const ImageF& channel) {
                                    return channel.width() == channels[0].width() &&
                                           channel.height() == channels[0].height();
                                  }),
              "channels have one size");
}

/// NaN becomes 0.
float clamped(float value) {
  return value > 0.0F ? std::min(value, 1.0F) : 0.0F;
}

/// One linear value, clamped to [0, 1], as code of 8 bits; no number becomes 0.
std::uint8_t code_of(float value) {
  return static_cast<std::uint8_t>(std::lround(clamped(value) * 255.0F));
}

/// Some rows at a time. @param path  for what is said when it fails
void write_rows(ImageOutput& output,
                int width_px,
                int height_px,
                std::span<const ExrChannel> channels,
                const fs::path& path) {
  const std::size_t count = channels.size();
  std::vector<float> row(static_cast<std::size_t>(width_px));
  std::vector<float> rows(row.size() * kRows * count);
  for (int top = 0; top < height_px; top += kRows) {
    const int bottom = std::min(height_px, top + kRows);
    for (std::size_t c = 0; c < count; ++c) {
      float* to = rows.data() + c;
      for (int y = top; y < bottom; ++y) {
        channels[c].fill(y, row.data());
        for (const float value : row) {
          *to = value;
          to += count;
        }
      }
    }
    check_written(
        output.write_scanlines(top, bottom, 0, TypeDesc::FLOAT, rows.data()), output, path);
  }
}

/// Values of consecutive channels, pixel by pixel, of some rows. Tiles are read as a whole.
/// @returns whether they could be read
bool read_strip(ImageInput& input,
                const ImageSpec& spec,
                int top,
                int bottom,
                int first,
                int last,
                float* values) {
  return spec.tile_width > 0 ? input.read_image(0, 0, first, last + 1, TypeDesc::FLOAT, values)
                             : input.read_scanlines(0,
                                                    0,
                                                    spec.y + top,
                                                    spec.y + bottom,
                                                    0,
                                                    first,
                                                    last + 1,
                                                    TypeDesc::FLOAT,
                                                    values);
}

/// Every so many values one of the image, from a row on.
void unpack(std::span<const float> values, std::size_t count, int top, ImageF& image) {
  float* to = image.row(top);
  for (std::size_t i = 0; i < values.size(); i += count) {
    *to++ = values[i];
  }
}

/// All channels in one pass over the file, which packs them together: to read them one by one would
/// unpack it as often as there are channels.
/// @param channels  numbers in the file, at least one
std::vector<ImageF> read_rows(ImageInput& input,
                              const ImageSpec& spec,
                              std::span<const int> channels,
                              const fs::path& path) {
  const auto [first, last] = std::ranges::minmax(channels);
  const auto count = static_cast<std::size_t>(last - first + 1);
  const auto row = static_cast<std::size_t>(spec.width) * count;
  const int rows = spec.tile_width > 0 ? spec.height : std::min(kReadRows, spec.height);
  std::vector<float> strip(row * static_cast<std::size_t>(rows));
  std::vector<ImageF> images(channels.size(), ImageF(spec.width, spec.height));
  for (int top = 0; top < spec.height; top += rows) {
    const int bottom = std::min(spec.height, top + rows);
    if (!read_strip(input, spec, top, bottom, first, last, strip.data())) {
      throw_unreadable_picture(path, input.geterror());
    }
    const auto values = std::span(strip).first(row * static_cast<std::size_t>(bottom - top));
    for (std::size_t c = 0; c < channels.size(); ++c) {
      unpack(values.subspan(static_cast<std::size_t>(channels[c] - first)), count, top, images[c]);
    }
  }
  return images;
}

}  // namespace

ExrChannel exr_channel(std::string name, const ImageF& image) {
  return {.name = std::move(name),
          .fill = [&image](int y, float* row) { std::copy_n(image.row(y), image.width(), row); }};
}

void write_exr_channels(const fs::path& path,
                        int width_px,
                        int height_px,
                        std::span<const ExrChannel> channels) {
  ImageSpec spec = stable_spec(width_px, height_px, channels.size(), TypeDesc::FLOAT);
  spec.channelnames.clear();
  for (const ExrChannel& channel : channels) {
    spec.channelnames.push_back(channel.name);
  }
  const std::set<std::string> names(spec.channelnames.begin(), spec.channelnames.end());
  GLINT_CHECK(!channels.empty() && names.size() == channels.size(), "channels have own names");
  // Encoded in memory first: writing the file ourselves gives the system's own error message when
  // the disk is full.
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = ImageOutput::create("memory.exr");
  GLINT_CHECK(output && output->supports("ioproxy") && output->set_ioproxy(&memory),
              "OpenImageIO writes OpenEXR to memory");
  check_written(output->open("memory.exr", spec), *output, path);
  write_rows(*output, width_px, height_px, channels, path);
  check_written(output->close(), *output, path);
  // As bytes that lie there already: pictures of many channels fill much memory.
  write_file(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::vector<ImageF> read_exr_channels(const fs::path& path, std::span<const std::string> names) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) {
    throw_unreadable_picture(path, OIIO::geterror());
  }
  const ImageSpec spec = input->spec();
  std::vector<int> channels;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(spec.channelnames, name);
    if (found == spec.channelnames.end()) {
      throw ConfigError(fmt::format("{}: has no channel {}", path.string(), name));
    }
    channels.push_back(static_cast<int>(found - spec.channelnames.begin()));
  }
  return channels.empty() ? std::vector<ImageF>() : read_rows(*input, spec, channels, path);
}

std::vector<ImageF> read_colours(const fs::path& path) {
  ImageSpec wish;
  wish.attribute("oiio:UnassociatedAlpha", 1);  // colours stay as they are under alpha
  const auto input = OIIO::ImageInput::open(path.string(), &wish);
  if (!input) {
    throw_unreadable_picture(path, OIIO::geterror());
  }
  const ImageSpec spec = input->spec();
  std::vector<ImageF> colours;
  for (int channel = 0; channel < spec.nchannels && colours.size() < 3; ++channel) {
    if (channel == spec.alpha_channel || channel == spec.z_channel) {
      continue;
    }
    ImageF image(spec.width, spec.height);
    if (!input->read_image(0, 0, channel, channel + 1, TypeDesc::FLOAT, image.values().data())) {
      throw_unreadable_picture(path, input->geterror());
    }
    colours.push_back(std::move(image));
  }
  if (colours.size() < 3) {
    throw ConfigError(path.string() + ": has no three colours");
  }
  return colours;
}

void write_tiff(const fs::path& path, std::span<const ImageF> channels) {
  check_channels(channels);
  const ImageF& first = channels[0];
  std::vector<std::uint16_t> codes(first.size() * channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    for (std::size_t i = 0; i < first.size(); ++i) {
      codes[channels.size() * i + c] =
          static_cast<std::uint16_t>(std::lround(clamped(channels[c].values()[i]) * kLargestCode));
    }
  }
  AtomicFile file(path);
  const auto output = ImageOutput::create("tiff");
  GLINT_CHECK(output != nullptr, "OpenImageIO writes TIFF");
  const ImageSpec spec =
      stable_spec(first.width(), first.height(), channels.size(), TypeDesc::UINT16);
  check_written(output->open(file.temporary_path().string(), spec), *output, path);
  check_written(output->write_image(TypeDesc::UINT16, codes.data()), *output, path);
  check_written(output->close(), *output, path);
  file.commit();
}

ImageRgb rgb_of(std::span<const ImageF> channels) {
  check_channels(channels);
  ImageRgb rgb(channels[0].width(), channels[0].height());
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      rgb.values()[i][c] = code_of(channels[std::min(c, channels.size() - 1)].values()[i]);
    }
  }
  return rgb;
}

void write_png(const fs::path& path, const ImageRgb& image) {
  write_file(path, png_bytes(image));
}

}  // namespace glint
