// SPDX-License-Identifier: GPL-3.0-or-later
//
// The silhouette of a part in the mean of its frames: a threshold (N. Otsu 1979), a flood from the
// border of the picture through what is darker, and the largest piece of the rest, or all pieces
// but crumbs. Dark stripes and holes inside the outline are thereby filled. Pictures without a
// clear silhouette are refused with the reason, by comparing the contrast with the noise of
// neighbouring pixels.
// docs/theory/inspection_masks.md, "Silhouette". Cost: linear in the pixels. Memory: some bytes per
// pixel.
#include "metrics/shape/silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"

namespace glint {
namespace {

constexpr float kBlack = 0.02F;
constexpr float kFull = 0.98F;
constexpr double kMinContrast = 0.02;
constexpr double kContrastOverNoise = 4.0;  // halves of pure noise are 1.6 deviations apart
constexpr double kGaussianOfMedian = 1.4826;
constexpr std::size_t kBins = 1024;
constexpr std::size_t kMinAreaPx = 16;  // a smaller silhouette is none

void check_picture(const ImageF& aspect) {
  if (aspect.empty()) {
    throw ConfigError("silhouette: the picture has no pixel");
  }
  if (!std::ranges::all_of(aspect.values(), [](float grey) { return std::isfinite(grey); })) {
    throw ConfigError("silhouette: the picture holds NaN or infinity");
  }
}

double median_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// Standard deviation of a pixel from differences of neighbours, which edges hardly change.
double noise_of(const ImageF& image) {
  std::vector<float> differences;
  differences.reserve(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 1; x < image.width(); ++x) {
      differences.push_back(std::abs(image(x, y) - image(x - 1, y)));
    }
  }
  return differences.empty() ? 0.0 : kGaussianOfMedian * median_of(differences) / std::sqrt(2.0);
}

struct Range {
  double low = 0.0;
  double high = 0.0;
};

Range range_of(const ImageF& image) {
  const auto [low, high] = std::ranges::minmax_element(image.values());
  return {.low = static_cast<double>(*low), .high = static_cast<double>(*high)};
}

std::array<double, kBins> histogram_of(const ImageF& image, const Range& range) {
  std::array<double, kBins> bins = {};
  const double per_grey = static_cast<double>(kBins) / (range.high - range.low);
  for (const float grey : image.values()) {
    const double at = (static_cast<double>(grey) - range.low) * per_grey;
    bins[std::min(static_cast<std::size_t>(at), kBins - 1)] += 1.0;
  }
  return bins;
}

double moment_of(const std::array<double, kBins>& bins) {
  double moment = 0.0;
  for (std::size_t i = 0; i < kBins; ++i) {
    moment += static_cast<double>(i) * bins[i];
  }
  return moment;
}

/// The border between bins with the largest variance between classes (N. Otsu, "A threshold
/// selection method from gray-level histograms", IEEE Trans. SMC 9, 1979); the middle of equals,
/// which is the middle of an empty valley.
double otsu_threshold(const ImageF& image, const Range& range) {
  const std::array<double, kBins> bins = histogram_of(image, range);
  const double moment = moment_of(bins);
  const auto count = static_cast<double>(image.size());
  double below = 0.0;
  double moment_below = 0.0;
  double best = -1.0;
  std::size_t first = 1;
  std::size_t last = 1;
  for (std::size_t border = 1; border < kBins; ++border) {
    below += bins[border - 1];
    moment_below += static_cast<double>(border - 1) * bins[border - 1];
    const double above = count - below;
    const double apart =
        above > 0.0 && below > 0.0 ? (moment - moment_below) / above - moment_below / below : 0.0;
    const double between = below * above * apart * apart;
    if (between > best) {
      best = between;
      first = border;
    }
    last = between >= best ? border : last;
  }
  const double middle = 0.5 * static_cast<double>(first + last);
  return range.low + (range.high - range.low) * middle / static_cast<double>(kBins);
}

double contrast_at(const ImageF& image, double threshold) {
  double dark = 0.0;
  double bright = 0.0;
  double count_bright = 0.0;
  for (const float grey : image.values()) {
    const auto value = static_cast<double>(grey);
    (value >= threshold ? bright : dark) += value;
    count_bright += value >= threshold ? 1.0 : 0.0;
  }
  const double count_dark = static_cast<double>(image.size()) - count_bright;
  return count_bright > 0.0 && count_dark > 0.0 ? bright / count_bright - dark / count_dark : 0.0;
}

using Pixel = std::pair<int, int>;

/// Marks all pixels of the value `from` that are connected with the seeds as `to`; the seeds are
/// already. @param neighbours  4 or 8 @returns how many were marked
std::size_t flood(
    Mask& mask, std::vector<Pixel> seeds, unsigned char from, unsigned char to, int neighbours) {
  constexpr std::array<Pixel, 8> kSteps = {
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
  std::size_t count = 0;
  while (!seeds.empty()) {
    const Pixel at = seeds.back();
    seeds.pop_back();
    for (int k = 0; k < neighbours; ++k) {
      const Pixel& step = kSteps[static_cast<std::size_t>(k)];
      const int x = at.first + step.first;
      const int y = at.second + step.second;
      const bool is_in_picture = x >= 0 && y >= 0 && x < mask.width() && y < mask.height();
      if (is_in_picture && mask(x, y) == from) {
        mask(x, y) = to;
        ++count;
        seeds.emplace_back(x, y);
      }
    }
  }
  return count;
}

constexpr unsigned char kUnknown = 0;
constexpr unsigned char kLit = 1;
constexpr unsigned char kOutside = 2;
constexpr unsigned char kSeen = 3;
constexpr unsigned char kKept = 4;

template <class Visit>
void for_border(const Mask& mask, const Visit& visit) {
  for (int x = 0; x < mask.width(); ++x) {
    visit(x, 0);
    visit(x, mask.height() - 1);
  }
  for (int y = 0; y < mask.height(); ++y) {
    visit(0, y);
    visit(mask.width() - 1, y);
  }
}

void flood_from_outside(Mask& mask) {
  std::vector<Pixel> seeds;
  for_border(mask, [&](int x, int y) {
    if (mask(x, y) == kUnknown) {
      mask(x, y) = kOutside;
      seeds.emplace_back(x, y);
    }
  });
  flood(mask, std::move(seeds), kUnknown, kOutside, 4);  // 4: no way between diagonal pixels
}

struct Piece {
  Pixel where = {0, 0};  ///< its first pixel
  std::size_t area_px = 0;
};

/// The connected pieces of what is not outside, by their first pixels; marks them as seen.
std::vector<Piece> pieces_of(Mask& mask) {
  for (unsigned char& pixel : mask.values()) {
    pixel = pixel == kOutside ? kUnknown : kLit;
  }
  std::vector<Piece> pieces;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask(x, y) == kLit) {
        mask(x, y) = kSeen;
        pieces.push_back({.where = {x, y}, .area_px = 1 + flood(mask, {{x, y}}, kLit, kSeen, 8)});
      }
    }
  }
  return pieces;
}

/// The largest piece, the first of equals, or all but crumbs.
std::vector<Piece> kept_of(std::vector<Piece> pieces, PartPieces wanted) {
  const auto largest = std::ranges::max_element(pieces, {}, &Piece::area_px);
  if (largest == pieces.end() || largest->area_px < kMinAreaPx) {
    return {};
  }
  if (wanted == PartPieces::kLargest) {
    return {*largest};
  }
  const double least = kCrumb * static_cast<double>(largest->area_px);
  std::erase_if(pieces, [&](const Piece& piece) {
    return piece.area_px < kMinAreaPx || static_cast<double>(piece.area_px) < least;
  });
  return pieces;
}

/// The mask of these pieces alone: 1 and 0.
void keep(const std::vector<Piece>& pieces, Mask& mask) {
  for (const Piece& piece : pieces) {
    mask(piece.where.first, piece.where.second) = kKept;
    flood(mask, {piece.where}, kSeen, kKept, 8);
  }
  for (unsigned char& pixel : mask.values()) {
    pixel = pixel == kKept ? 1 : 0;
  }
}

Mask lit_pixels(const ImageF& image, double threshold) {
  Mask mask(image.width(), image.height());
  std::ranges::transform(image.values(), mask.values().begin(), [&](float grey) {
    return static_cast<double>(grey) >= threshold ? kLit : kUnknown;
  });
  return mask;
}

/// What can be told before any threshold.
std::optional<NoSilhouette> fault_of(const Range& range) {
  if (range.high < static_cast<double>(kBlack)) {
    return NoSilhouette::kDark;
  }
  if (range.low > static_cast<double>(kFull)) {
    return NoSilhouette::kSaturated;
  }
  if (range.high - range.low < kMinContrast) {
    return NoSilhouette::kNoContrast;
  }
  return std::nullopt;
}

/// Fills the mask in or says why not.
std::optional<NoSilhouette> outline(const ImageF& aspect, PartPieces wanted, Silhouette& result) {
  Mask mask = lit_pixels(aspect, result.threshold);
  flood_from_outside(mask);
  const std::vector<Piece> pieces = kept_of(pieces_of(mask), wanted);
  if (pieces.empty()) {
    return NoSilhouette::kTooSmall;
  }
  if (pieces.front().area_px == mask.size()) {
    return NoSilhouette::kFillsPicture;
  }
  keep(pieces, mask);
  for_border(mask, [&](int x, int y) { result.touches_border |= mask(x, y) != 0; });
  result.pieces = static_cast<int>(pieces.size());
  result.mask = std::move(mask);
  return std::nullopt;
}

}  // namespace

std::string_view sentence(NoSilhouette reason) {
  switch (reason) {
    case NoSilhouette::kDark:
      return "the pictures are black: no part is seen; check light, exposure and order of files";
    case NoSilhouette::kSaturated:
      return "the pictures are saturated all over: no outline is left; lower gain or exposure";
    case NoSilhouette::kNoContrast:
      return "nothing in the pictures is brighter than the rest by more than noise; give a mask";
    case NoSilhouette::kTooSmall:
      return "nothing large enough is brighter than the rest; give a mask";
    case NoSilhouette::kFillsPicture:
      return "no background is left around the part: it must be darker than the part; give a mask";
  }
  return "";
}

Silhouette find_silhouette(const ImageF& aspect, PartPieces pieces) {
  check_picture(aspect);
  const Range range = range_of(aspect);
  Silhouette result;
  result.fault = fault_of(range);
  if (result.fault.has_value()) {
    return result;
  }
  result.threshold = otsu_threshold(aspect, range);
  result.contrast = contrast_at(aspect, result.threshold);
  const double minimum = std::max(kMinContrast, kContrastOverNoise * noise_of(aspect));
  result.fault =
      result.contrast < minimum ? NoSilhouette::kNoContrast : outline(aspect, pieces, result);
  return result;
}

}  // namespace glint
