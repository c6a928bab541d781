// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_maps.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "simulator/render/preview/preview.h"

namespace glint {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kBeside = {40, 46, 52};
constexpr Rgb kSound = {206, 212, 217};
constexpr int kGapShare = 60;  ///< the gap's part of a picture's width

Rgb shown(const std::array<double, 3>& colour) {
  Rgb rgb;
  for (std::size_t c = 0; c < 3; ++c) {
    rgb[c] = static_cast<std::uint8_t>(std::lround(std::clamp(colour[c], 0.0, 255.0)));
  }
  return rgb;
}

/// What a screen shows as that colour, in the linear values that Glint's pictures hold.
Rgb linear_code(const Rgb& srgb) {
  std::array<double, 3> linear = {};
  for (std::size_t c = 0; c < 3; ++c) {
    const double v = srgb[c] / 255.0;
    linear[c] = 255.0 * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return shown(linear);
}

/// The pixels of a line that one of a shorter line covers: the first and last in part.
struct Share {
  double from = 0.0;
  double to = 0.0;

  int first() const { return static_cast<int>(from); }

  int last() const { return static_cast<int>(std::ceil(to)) - 1; }

  double weight(int pixel) const {
    return std::min(to, pixel + 1.0) - std::max(from, static_cast<double>(pixel));
  }
};

std::vector<Share> shares(int length, int shorter) {
  std::vector<Share> list;
  for (int i = 0; i < shorter; ++i) {
    const double step = static_cast<double>(length) / shorter;
    list.push_back({.from = i * step, .to = std::min<double>(length, (i + 1) * step)});
  }
  return list;
}

Rgb mean_of(const ImageRgb& image, const Share& columns, const Share& rows) {
  std::array<double, 3> sum = {};
  double all = 0.0;
  for (int y = rows.first(); y <= rows.last(); ++y) {
    for (int x = columns.first(); x <= columns.last(); ++x) {
      const double weight = rows.weight(y) * columns.weight(x);
      all += weight;
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += weight * image(x, y)[c];
      }
    }
  }
  for (double& value : sum) {
    value /= all;
  }
  return shown(sum);
}

/// Colours by id.
std::map<std::int32_t, Rgb> colours_of(const DefectivePart& made) {
  std::map<std::int32_t, Rgb> colours;
  for (const RealisedDefect& defect : made.defects) {
    colours[defect.defect.id] = linear_code(defect_colour(defect.defect.type));
  }
  return colours;
}

/// All images to the size of a tile of the sheet.
std::vector<ImageF> channel_of(std::span<const ImageRgb> tiles, std::size_t channel) {
  std::vector<ImageF> images;
  for (const ImageRgb& tile : tiles) {
    ImageF& image = images.emplace_back(tile.width(), tile.height());
    std::ranges::transform(tile.values(), image.values().begin(), [&](const Rgb& rgb) {
      return static_cast<float>(rgb[channel]) / 255.0F;
    });
  }
  return images;
}

}  // namespace

Rgb defect_colour(DefectType type) {
  switch (type) {
    case DefectType::kDent:
      return {213, 94, 0};
    case DefectType::kBump:
      return {0, 114, 178};
    case DefectType::kScratch:
      return {0, 158, 115};
    case DefectType::kPit:
      return {204, 121, 167};
    case DefectType::kGouge:
      return {230, 159, 0};
    case DefectType::kStain:
      break;
  }
  return {128, 76, 20};
}

std::string defect_colour_css(DefectType type) {
  const Rgb rgb = defect_colour(type);
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

ImageRgb defect_map(const Film& sums, const DefectivePart& made) {
  const std::map<std::int32_t, Rgb> by_id = colours_of(made);
  std::vector<Rgb> colours;
  for (const DefectSums& defect : sums.defects) {
    const auto found = by_id.find(defect.id);
    GLINT_CHECK(found != by_id.end(), "a defect that is seen was made");
    colours.push_back(found->second);
  }
  const Rgb beside = linear_code(kBeside);
  const Rgb on_sound = linear_code(kSound);
  ImageRgb map(sums.width_px, sums.height_px, beside);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const int samples = sums.samples.values()[i];
    int sound = sums.part.values()[i];
    std::array<double, 3> colour = {};
    const auto add = [&](const Rgb& of, int count) {
      for (std::size_t c = 0; c < 3; ++c) {
        colour[c] += static_cast<double>(of[c]) * count / std::max(1, samples);
      }
    };
    add(beside, samples - sound);
    for (std::size_t d = 0; d < colours.size(); ++d) {
      const int count = sums.defects[d].samples.values()[i];
      sound -= count;
      add(colours[d], count);
    }
    add(on_sound, sound);
    map.values()[i] = samples > 0 ? shown(colour) : beside;
  }
  return map;
}

Mask defect_mask(const Film& sums) {
  Mask mask(sums.width_px, sums.height_px);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    int count = 0;
    for (const DefectSums& defect : sums.defects) {
      count += defect.samples.values()[i];
    }
    mask.values()[i] = count > 0 && 2 * count >= sums.samples.values()[i] ? 1 : 0;
  }
  return mask;
}

Mask whole_part_mask(const Film& sums) {
  Mask mask(sums.width_px, sums.height_px);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const int samples = sums.samples.values()[i];
    mask.values()[i] = samples > 0 && sums.part.values()[i] == samples ? 1 : 0;
  }
  return mask;
}

ImageRgb shrunk(const ImageRgb& image, int max_px) {
  const double scale = static_cast<double>(std::max(image.width(), image.height())) / max_px;
  if (scale <= 1.0) {
    return image;
  }
  const auto side = [&](int length) {
    return std::max(1, static_cast<int>(std::lround(length / scale)));
  };
  ImageRgb small(side(image.width()), side(image.height()));
  const std::vector<Share> columns = shares(image.width(), small.width());
  const std::vector<Share> rows = shares(image.height(), small.height());
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      small(x, y) =
          mean_of(image, columns[static_cast<std::size_t>(x)], rows[static_cast<std::size_t>(y)]);
    }
  }
  return small;
}

ImageRgb side_by_side(const ImageRgb& left, const ImageRgb& right, int max_px) {
  GLINT_CHECK(left.width() == right.width() && left.height() == right.height(),
              "pictures side by side have one size");
  const ImageRgb small_left = shrunk(left, max_px);
  const ImageRgb small_right = shrunk(right, max_px);
  const int width = small_left.width();
  const int gap = std::max(4, width / kGapShare);
  ImageRgb both(2 * width + gap, small_left.height(), {255, 255, 255});
  for (int y = 0; y < both.height(); ++y) {
    std::copy_n(small_left.row(y), width, both.row(y));
    std::copy_n(small_right.row(y), width, both.row(y) + width + gap);
  }
  return both;
}

ImageRgb numbered_sheet(std::span<const ImageRgb> pictures) {
  std::vector<ImageRgb> tiles;
  std::vector<int> numbers;
  for (const ImageRgb& picture : pictures) {
    tiles.push_back(shrunk(picture, kTileSide_px));
    numbers.push_back(static_cast<int>(tiles.size()));
  }
  std::vector<ImageF> sheets;
  for (std::size_t c = 0; c < 3; ++c) {
    sheets.push_back(contact_sheet(channel_of(tiles, c), numbers));
  }
  return rgb_of(sheets);
}

}  // namespace glint
