// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/picture_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/renamed_key.h"
#include "hardware/acquisition/edge_spread.h"

namespace glint {
namespace {

using Codes = Image<std::uint16_t>;

constexpr int kOutlineWindow_px = 3;       ///< half of it
constexpr double kOutlineContrast = 0.04;  ///< of the bright level
constexpr int kMaxShift_px = 30;           ///< of the reduced picture

/// Code that a share of all pixels does not exceed.
int code_at_share(const Codes& codes, double share, int largest) {
  std::vector<std::int64_t> counts(static_cast<std::size_t>(largest) + 1);
  for (const std::uint16_t code : codes.values()) {
    ++counts[std::min<std::size_t>(code, counts.size() - 1)];
  }
  const double wanted = share * static_cast<double>(codes.size());
  std::int64_t sum = 0;
  for (std::size_t code = 0; code < counts.size(); ++code) {
    sum += counts[code];
    if (static_cast<double>(sum) >= wanted) {
      return static_cast<int>(code);
    }
  }
  return largest;
}

/// Variance of the noise of one pixel, in codes. The weights of the second difference are 1 -2 1 by
/// 1 -2 1, the sum of their squares 36; the median of |x| is 0.6745 standard deviations.
double noise_variance(const Codes& codes) {
  constexpr int kMaxSamples = 200'000;
  const int step = std::max(1, static_cast<int>(codes.size() / kMaxSamples));
  std::vector<int> differences;
  int skipped = 0;
  for (int y = 1; y + 1 < codes.height(); ++y) {
    for (int x = 1; x + 1 < codes.width(); ++x) {
      if (++skipped < step) {
        continue;
      }
      skipped = 0;
      const auto row = [&](int j) { return codes(x - 1, j) - 2 * codes(x, j) + codes(x + 1, j); };
      differences.push_back(std::abs(row(y - 1) - 2 * row(y) + row(y + 1)));
    }
  }
  if (differences.empty()) {
    return 0.0;
  }
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  const double sigma = *middle / 0.6745 / 6.0;
  return sigma * sigma;
}

double sharpness_of(const Codes& codes, double mean_code) {
  double sum = 0.0;
  std::int64_t count = 0;
  for (int y = 0; y + 1 < codes.height(); ++y) {
    for (int x = 0; x + 1 < codes.width(); ++x) {
      const double right = codes(x + 1, y) - codes(x, y);
      const double down = codes(x, y + 1) - codes(x, y);
      sum += right * right + down * down;
      count += 2;
    }
  }
  if (count == 0 || mean_code <= 0.0) {
    return 0.0;
  }
  const double structure = sum / static_cast<double>(count) - 2.0 * noise_variance(codes);
  return std::max(0.0, structure) / (mean_code * mean_code);
}

bool is_boundary(const Mask& mask, int x, int y) {
  return mask(x, y) != 0 &&
         (mask(x - 1, y) == 0 || mask(x + 1, y) == 0 || mask(x, y - 1) == 0 || mask(x, y + 1) == 0);
}

/// Means of blocks of pixels.
ImageF block_means(const Codes& codes, int factor) {
  ImageF means(codes.width() / factor, codes.height() / factor);
  for (int y = 0; y < means.height(); ++y) {
    for (int x = 0; x < means.width(); ++x) {
      double sum = 0.0;
      for (int k = 0; k < factor * factor; ++k) {
        sum += codes(x * factor + k % factor, y * factor + k / factor);
      }
      means(x, y) = static_cast<float>(sum / (factor * factor));
    }
  }
  return means;
}

/// The outline of a part that is expected, and how it shows where a shift takes it.
class ExpectedOutline {
 public:
  ExpectedOutline(const ImageF& grey, const Mask& mask) : grey_(grey), mask_(mask) {
    for (int y = 1; y + 1 < mask.height(); ++y) {
      for (int x = 1; x + 1 < mask.width(); ++x) {
        if (is_boundary(mask, x, y)) {
          pixels_.emplace_back(x, y);
        }
      }
    }
  }

  /// True within the outline's own window, where a shift takes it.
  Mask band(int dx, int dy) const {
    Mask band(mask_.width(), mask_.height());
    for (const auto& [x, y] : pixels_) {
      for (int j = y + dy - kOutlineWindow_px; j <= y + dy + kOutlineWindow_px; ++j) {
        for (int i = x + dx - kOutlineWindow_px; i <= x + dx + kOutlineWindow_px; ++i) {
          if (i >= 0 && j >= 0 && i < band.width() && j < band.height()) {
            band(i, j) = 1;
          }
        }
      }
    }
    return band;
  }

  /// Of the outline's pixels; those that leave the picture do not show.
  double seen_share(int dx, int dy, double min_step) const {
    std::size_t seen = 0;
    for (const auto& [x, y] : pixels_) {
      seen += step_at(x, y, dx, dy) >= min_step ? 1U : 0U;
    }
    return pixels_.empty() ? 1.0 : static_cast<double>(seen) / static_cast<double>(pixels_.size());
  }

 private:
  /// How much the mean levels on both sides of the outline differ about one of its pixels.
  double step_at(int x, int y, int dx, int dy) const {
    std::array<double, 2> sums = {};
    std::array<int, 2> counts = {};
    for (int j = std::max(0, y - kOutlineWindow_px);
         j <= std::min(mask_.height() - 1, y + kOutlineWindow_px);
         ++j) {
      for (int i = std::max(0, x - kOutlineWindow_px);
           i <= std::min(mask_.width() - 1, x + kOutlineWindow_px);
           ++i) {
        if (i + dx < 0 || j + dy < 0 || i + dx >= grey_.width() || j + dy >= grey_.height()) {
          continue;
        }
        const std::size_t side = mask_(i, j) != 0 ? 1 : 0;
        sums.at(side) += static_cast<double>(grey_(i + dx, j + dy));
        ++counts.at(side);
      }
    }
    return counts[0] == 0 || counts[1] == 0 ? 0.0
                                            : std::abs(sums[1] / counts[1] - sums[0] / counts[0]);
  }

  const ImageF& grey_;
  const Mask& mask_;
  std::vector<std::pair<int, int>> pixels_;
};

struct FoundOutline {
  double share = 0.0;  ///< the largest one over all shifts within the tolerance
  Mask band;           ///< ExpectedOutline::band() there
};

FoundOutline find_outline(const Codes& codes, const ExpectedPicture& expected, double bright_code) {
  const int factor = codes.width() / expected.part.width();
  const ImageF grey = block_means(codes, factor);
  const ExpectedOutline outline(grey, expected.part);
  const int reach =
      std::min(static_cast<int>(std::ceil(expected.tolerance_px / factor)), kMaxShift_px);
  double best = 0.0;
  std::pair<int, int> shift;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const double share = outline.seen_share(dx, dy, kOutlineContrast * bright_code);
      if (share > best) {
        best = share;
        shift = {dx, dy};
      }
    }
  }
  return {.share = best, .band = outline.band(shift.first, shift.second)};
}

/// Whether a mask is of a picture's size, or of that divided by a whole number.
bool is_of_picture(const Mask& mask, const Codes& codes) {
  if (mask.empty() || mask.width() > codes.width()) {
    return false;
  }
  const int factor = codes.width() / mask.width();
  return codes.width() / factor == mask.width() && codes.height() / factor == mask.height();
}

/// Why a picture is not sharp enough; empty when it is.
std::string blur_fault(const PictureFigures& figures,
                       const PictureLimits& limits,
                       double sharpest) {
  if (figures.sharpness < limits.min_sharpness) {
    return fmt::format(
        "blurred: sharpness {:.3g}, {:.3g} is needed", figures.sharpness, limits.min_sharpness);
  }
  if (figures.sharpness < limits.min_sharpness_share * sharpest) {
    return fmt::format("blurred: sharpness {:.3g}, the sharpest of its sequence has {:.3g}",
                       figures.sharpness,
                       sharpest);
  }
  return {};
}

/// Why a picture is too dark or too bright; empty when it is neither.
std::string exposure_fault(const PictureFigures& figures, const PictureLimits& limits) {
  if (figures.bright < limits.min_bright) {
    return fmt::format(
        "too dark: its brightest pixels are at {:.3f} of the range, {:.3f} is needed",
        figures.bright,
        limits.min_bright);
  }
  if (figures.clipped_share > limits.max_clipped_share) {
    return fmt::format("too bright: {:.1f} % of the pixels are clipped, {:.1f} % may be",
                       100.0 * figures.clipped_share,
                       100.0 * limits.max_clipped_share);
  }
  return {};
}

}  // namespace

void visit_keys(KeyVisitor& keys, PictureLimits& limits) {
  keys.number("min_bright",
              limits.min_bright,
              Range::between(0, 1),
              "level of the brightest pixels below which a picture is too dark");
  keys.number("max_clipped_share",
              limits.max_clipped_share,
              Range::between(0, 1),
              "of pixels at the largest code above which it is too bright");
  keys.number("min_sharpness_share",
              limits.min_sharpness_share,
              Range::between(0, 1),
              "of the sharpest picture of its sequence below which it is blurred");
  keys.number("min_sharpness",
              limits.min_sharpness,
              Range::at_least(0),
              "below which it is blurred, whatever the others are");
  keys.number("max_blur_px",
              limits.max_blur_px,
              Range::between(0, 1000),
              "sigma of its edges above which a picture is blurred; 0: by what the scene's camera "
              "blurs");
  keys.number("min_outline_share",
              limits.min_outline_share,
              Range::between(0, 1),
              "of the part's expected outline that must be seen");
  keys.integer(name_in_table(keys, "max_retakes", "most_retakes"),
               limits.max_retakes,
               Range::between(0, 20),
               "of one picture");
}

double blur_limit_px(const PictureLimits& limits, double expected_blur_px) {
  constexpr double kMoreTimes = 2.0;
  constexpr double kMore_px = 0.5;
  if (limits.max_blur_px > 0.0) {
    return limits.max_blur_px;
  }
  return expected_blur_px > 0.0 ? kMoreTimes * expected_blur_px + kMore_px : 0.0;
}

PictureFigures figures_of(const Frame& frame, const ExpectedPicture& expected, bool has_spread) {
  GLINT_CHECK(frame.is_complete() && frame.codes.size() > 0, "only pictures have figures");
  const int largest = (1 << bits_of(frame.format)) - 1;
  double sum = 0.0;
  std::int64_t clipped = 0;
  for (const std::uint16_t code : frame.codes.values()) {
    sum += code;
    clipped += code >= largest ? 1 : 0;
  }
  const auto pixels = static_cast<double>(frame.codes.size());
  constexpr double kBrightShare = 0.995;
  const double bright_code = code_at_share(frame.codes, kBrightShare, largest);
  PictureFigures figures = {.mean = sum / pixels / largest,
                            .bright = bright_code / largest,
                            .clipped_share = static_cast<double>(clipped) / pixels,
                            .sharpness = sharpness_of(frame.codes, sum / pixels)};
  FoundOutline outline = {.band = Mask(1, 1)};
  outline.band(0, 0) = 1;  // the whole picture
  if (is_of_picture(expected.part, frame.codes)) {
    outline = find_outline(frame.codes, expected, bright_code);
    figures.outline_share = outline.share;
  }
  if (has_spread) {
    const int factor = outline.band.width() == 1
                           ? std::max(frame.codes.width(), frame.codes.height())
                           : frame.codes.width() / outline.band.width();
    figures.edge_px = acquisition_detail::edge_spread_px(frame.codes, outline.band, factor);
  }
  return figures;
}

std::string rejection_of(const PictureFigures& figures,
                         const PictureLimits& limits,
                         double sharpest,
                         double max_blur_px) {
  if (std::string fault = exposure_fault(figures, limits); !fault.empty()) {
    return fault;
  }
  if (std::string fault = blur_fault(figures, limits, sharpest); !fault.empty()) {
    return fault;
  }
  if (figures.outline_share < limits.min_outline_share) {
    return fmt::format("the part is not in view: {:.0f} % of its outline is seen, {:.0f} % must be",
                       100.0 * figures.outline_share,
                       100.0 * limits.min_outline_share);
  }
  // Last: edges beside a part that is not there are none of its outline.
  if (max_blur_px > 0.0 && figures.edge_px && *figures.edge_px > max_blur_px) {
    return fmt::format("blurred: its edges have a sigma of {:.1f} px, {:.1f} px is the most",
                       *figures.edge_px,
                       max_blur_px);
  }
  return {};
}

}  // namespace glint
