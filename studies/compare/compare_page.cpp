// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compare_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ShownColour = std::array<double, 3>;

constexpr int kPictureWidthPx = 900;
constexpr std::size_t kMaxPairs = 12;  ///< with pictures on the page; the folder has all

constexpr ShownColour kRed = {0.86, 0.16, 0.12};
constexpr ShownColour kBlue = {0.10, 0.45, 0.95};
constexpr double kTint = 0.6;  ///< of the simulated part over the photograph

std::uint8_t code_of(double share) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}

std::array<std::uint8_t, 3> codes_of(const ShownColour& colour) {
  return {code_of(colour[0]), code_of(colour[1]), code_of(colour[2])};
}

/// So that the 99.5th percentile of grey is near white: photographs may be dark.
double brightening_of(const ImageF& picture) {
  std::vector<float> values(picture.values().begin(), picture.values().end());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 995 / 1000);
  std::nth_element(values.begin(), at, values.end());
  return 1.0 / std::clamp(static_cast<double>(*at), 0.05, 1.0);
}

void draw(std::span<const Boundary> lines, const ShownColour& colour, ImageRgb& image) {
  for (const Boundary& line : lines) {
    for (const BoundaryPoint& point : line.points) {
      const int x = std::clamp(static_cast<int>(point.at_px.x()), 0, image.width() - 1);
      const int y = std::clamp(static_cast<int>(point.at_px.y()), 0, image.height() - 1);
      image(x, y) = codes_of(colour);
    }
  }
}

/// Mean of blocks of pixels, so that the picture is at most kPictureWidthPx wide.
ImageRgb reduced(const ImageRgb& image) {
  const int factor = (image.width() + kPictureWidthPx - 1) / kPictureWidthPx;
  if (factor <= 1) {
    return image;
  }
  ImageRgb small(image.width() / factor, image.height() / factor);
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      std::array<int, 3> sums = {};
      for (int k = 0; k < factor * factor; ++k) {
        const auto& pixel = image(x * factor + k % factor, y * factor + k / factor);
        for (std::size_t c = 0; c < 3; ++c) {
          sums[c] += pixel[c];
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        small(x, y)[c] = static_cast<std::uint8_t>(sums[c] / (factor * factor));
      }
    }
  }
  return small;
}

/// Blue below 0, white at 0, red above; full colour at the scale.
ImageRgb diverging(const ImageF& difference, double scale) {
  ImageRgb image(difference.width(), difference.height());
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double t = std::clamp(static_cast<double>(difference.values()[i]) / scale, -1.0, 1.0);
    const ShownColour& full = t > 0.0 ? kRed : kBlue;
    ShownColour colour = {};
    for (std::size_t c = 0; c < 3; ++c) {
      colour[c] = 1.0 - std::abs(t) * (1.0 - full[c]);
    }
    image.values()[i] = codes_of(colour);
  }
  return image;
}

/// The 99th percentile of its size, at least a thousandth.
double scale_of(const ImageF& difference) {
  std::vector<float> sizes(difference.size());
  std::ranges::transform(
      difference.values(), sizes.begin(), [](float value) { return std::abs(value); });
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 99 / 100);
  std::nth_element(sizes.begin(), at, sizes.end());
  return std::max(static_cast<double>(*at), 1e-3);
}

std::string grey_png(const ImageF& picture, double brightening) {
  ImageF bright = picture;
  for (float& grey : bright.values()) {
    grey = static_cast<float>(std::clamp(brightening * static_cast<double>(grey), 0.0, 1.0));
  }
  return report_png(bright, kPictureWidthPx);
}

std::vector<std::string> details_of(const Json& result) {
  std::vector<std::string> lines;
  for (const Json& note : result["notes"]) {
    lines.push_back(note.get<std::string>());
  }
  if (result["yardstick"].is_object()) {
    lines.push_back(
        fmt::format("Yardstick: {} photographs of one kind, {} pairs of them; medians of distances "
                    "of grey values and textures.",
                    result["yardstick"]["reals"].get<int>(),
                    result["yardstick"]["pairs"].get<int>()));
  }
  return lines;
}

}  // namespace

ImageRgb overlay_of(const ComparedPair& pair) {
  const ImageF& real = pair.real.grey;
  const ImageF& coverage = pair.geometry.outlines.simulated.coverage;
  const double bright = brightening_of(real);
  ImageRgb image(real.width(), real.height());
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double grey = bright * static_cast<double>(real.values()[i]);
    const double tint = coverage.empty() ? 0.0 : kTint * static_cast<double>(coverage.values()[i]);
    ShownColour colour = {};
    for (std::size_t c = 0; c < 3; ++c) {
      colour[c] = (1.0 - tint) * std::min(grey, 1.0) + tint * kRed[c];
    }
    image.values()[i] = codes_of(colour);
  }
  draw(pair.geometry.outlines.real.located, kBlue, image);
  draw(pair.geometry.outlines.simulated.located, kRed, image);
  return image;
}

PagePair page_pair(const ComparedPair& pair) {
  const ImageF difference = residual_picture(pair.exposed, pair.real.grey);
  const double scale = scale_of(difference);
  const double bright = brightening_of(pair.real.grey);
  return {.pictures = {{"real_image", grey_png(pair.real.grey, bright)},
                       {"simulated_image", grey_png(pair.exposed, bright)},
                       {"overlay", base64(png_bytes(reduced(overlay_of(pair))))},
                       {"difference", base64(png_bytes(reduced(diverging(difference, scale))))},
                       {"difference_scale", scale}}};
}

std::string compare_page(const Json& result, std::span<const PagePair> pairs) {
  Json comparison = result;
  for (std::size_t i = 0; i < std::min(pairs.size(), kMaxPairs); ++i) {
    comparison["pairs"][i].update(pairs[i].pictures);
  }
  return render_report({{"title", "Comparison"},
                        {"verdict",
                         {{"title", "Verdict"},
                          {"sentence", result["verdict"]},
                          {"tone", "neutral"},
                          {"details", details_of(result)}}},
                        {"comparison", comparison},
                        {"provenance", provenance()}});
}

}  // namespace glint
