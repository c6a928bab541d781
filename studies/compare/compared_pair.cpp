// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compared_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/image/spans.h"
#include "metrics/appearance/structure_similarity.h"
#include "metrics/overlap/region_overlap.h"
#include "studies/compare/better_turn.h"

namespace glint {
namespace {

constexpr int kMarginPx = 3;  ///< from the outline, where grey values are compared

void check_sizes(const ComparedPicture& simulated, const ComparedPicture& real) {
  const bool is_same = simulated.width() == real.width() && simulated.height() == real.height();
  if (is_same) {
    return;
  }
  const bool is_turned = simulated.width() == real.height() && simulated.height() == real.width();
  throw ConfigError(fmt::format("{}: is {} x {} pixels, {} is {} x {}: {}",
                                simulated.source.picture.string(),
                                simulated.width(),
                                simulated.height(),
                                real.source.picture.string(),
                                real.width(),
                                real.height(),
                                is_turned ? "one of them is turned by 90 degrees"
                                          : "pictures to compare must have one size"));
}

/// Viewers turn what Glint, like the calibration of its camera, takes as it is stored.
void note_orientation(const ComparedPicture& picture, std::vector<std::string>& notes) {
  if (picture.orientation != 1) {
    notes.push_back(fmt::format(
        "{} is shown turned or mirrored by viewers, as it says of itself (orientation {}): it was "
        "compared as it is stored.",
        picture.source.picture.filename().string(),
        picture.orientation));
  }
}

void note_formats(const ComparedPicture& simulated,
                  const ComparedPicture& real,
                  std::vector<std::string>& notes) {
  if ((simulated.channels >= 3) != (real.channels >= 3)) {
    notes.emplace_back("One picture has colours, the other has not: luminance was compared.");
  }
  if (simulated.is_float != real.is_float) {
    notes.emplace_back(
        "One picture holds floats, the other codes: exposures were matched before greys were "
        "compared.");
  } else if (simulated.bits != real.bits) {
    notes.push_back(
        fmt::format("The pictures have {} and {} bits: both were brought to one full "
                    "scale.",
                    simulated.bits,
                    real.bits));
  }
  if (simulated.is_scaled || real.is_scaled) {
    notes.emplace_back(
        "Floats go beyond full scale: which exposure they have is not known, and no gain is "
        "named.");
  }
}

PairGeometry geometry_of(const ComparedPicture& simulated,
                         const ComparedPicture& real,
                         const std::filesystem::path& real_mask,
                         const PairOptions& options) {
  PairGeometry geometry = {.outlines = find_outlines(simulated, real, real_mask, options.outline)};
  const PartOutline& first = geometry.outlines.simulated;
  const PartOutline& second = geometry.outlines.real;
  if (!first.coverage.empty() && !second.coverage.empty()) {
    const RegionOverlap overlap = overlap_of(first.coverage, second.coverage);
    geometry.iou = overlap.iou;
    geometry.dice = overlap.dice;
  }
  const double reach = kMaxDistanceShare * simulated.width();
  geometry.distance = boundary_distance(first.located, second.located, reach);
  const std::vector<BoundaryGap> gaps = gaps_between(first.located, second.located, reach);
  ListedEdges listed = part_edges(first.rough, first.located, gaps);
  geometry.edges = std::move(listed.edges);
  geometry.unlisted = listed.unlisted;
  for (const BoundaryGap& gap : gaps) {
    geometry.offsets.push_back(
        {.at_px = gap.from.at_px, .normal = gap.from.normal, .offset_px = gap.offset_px});
  }
  geometry.rings =
      ring_offsets(geometry.offsets, {0.5 * simulated.width(), 0.5 * simulated.height()});
  return geometry;
}

Mask shrunk(const Mask& mask, int radius) {
  Mask outside = mask;
  for (unsigned char& pixel : outside.values()) {
    pixel = pixel == 0 ? 1 : 0;
  }
  Mask result = dilated(outside, radius);
  for (unsigned char& pixel : result.values()) {
    pixel = pixel == 0 ? 1 : 0;
  }
  return result;
}

PairAppearance appearance_of(ComparedPair& pair, const PairOptions& options) {
  const ImageF& simulated = pair.simulated.grey;
  const ImageF& real = pair.real.grey;
  PairAppearance look;
  look.exposure = match_exposure(simulated, real, pair.region, options.exposure);
  pair.exposed = exposed(simulated, look.exposure);
  look.residual_rms = look.exposure.rms;
  look.correlation = correlation_of(simulated, real, pair.region);
  pair.similarity = ssim_map(pair.exposed, real);
  look.ssim = mean_in(pair.similarity, pair.region);
  pair.gradient_similarity = gradient_similarity_map(pair.exposed, real);
  look.gmsd = deviation_in(pair.gradient_similarity, pair.region);
  look.histogram_distance = histogram_distance(pair.exposed, real, pair.region, pair.region);
  if (is_plain(simulated) || is_plain(real)) {
    return look;
  }
  look.simulated = texture_in(simulated, pair.region);
  look.real = texture_in(real, pair.region);
  if (look.simulated.windows > 0 && look.real.windows > 0) {
    look.texture = distance_between(look.simulated, look.real);
  }
  return look;
}

constexpr std::array<const char*, 9> kRegionNames = {"top left",
                                                     "top",
                                                     "top right",
                                                     "left",
                                                     "middle",
                                                     "right",
                                                     "bottom left",
                                                     "bottom",
                                                     "bottom right"};
constexpr double kMinRegionPx = 100.0;

/// Columns and rows [x0, x1) x [y0, y1) that hold a region; all where it is empty.
struct Extent {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

Extent extent_of(const Mask& region, const ImageF& picture) {
  if (region.empty()) {
    return {.x1 = picture.width(), .y1 = picture.height()};
  }
  Extent extent = {.x0 = region.width(), .y0 = region.height()};
  for (int y = 0; y < region.height(); ++y) {
    for (int x = 0; x < region.width(); ++x) {
      if (region(x, y) != 0) {
        extent = {.x0 = std::min(extent.x0, x),
                  .y0 = std::min(extent.y0, y),
                  .x1 = std::max(extent.x1, x + 1),
                  .y1 = std::max(extent.y1, y + 1)};
      }
    }
  }
  return extent;
}

/// How often each grey occurs, up to full scale.
class GreyCounts {
 public:
  void add(double grey) {
    const double bin = std::clamp(grey, 0.0, 1.0) * static_cast<double>(kBins);
    ++counts_[std::min(static_cast<std::size_t>(bin), kBins - 1)];
  }

  /// First Wasserstein distance of as many greys, to a bin's width.
  double distance_to(const GreyCounts& other, double pixels) const {
    double ahead = 0.0;
    double area = 0.0;
    for (std::size_t i = 0; i < kBins; ++i) {
      ahead += static_cast<double>(counts_[i]) - static_cast<double>(other.counts_[i]);
      area += std::abs(ahead);
    }
    return area / (pixels * static_cast<double>(kBins));
  }

 private:
  static constexpr std::size_t kBins = 2048;
  std::vector<std::uint32_t> counts_ = std::vector<std::uint32_t>(kBins);
};

/// Sums over the pixels of a ninth.
struct RegionSums {
  double pixels = 0.0;
  double real = 0.0;
  double simulated = 0.0;
  double real_squares = 0.0;
  double simulated_squares = 0.0;
  double products = 0.0;
  double similarity = 0.0;
  double gradients = 0.0;  ///< number of reduced pixels, sum and squares of their similarity
  double gradient_sum = 0.0;
  double gradient_squares = 0.0;
  GreyCounts real_greys = {};
  GreyCounts simulated_greys = {};

  void add_gradient(double similar) {
    gradients += 1.0;
    gradient_sum += similar;
    gradient_squares += similar * similar;
  }

  double gradient_deviation() const {
    const double mean = gradient_sum / std::max(gradients, 1.0);
    return std::sqrt(std::max(gradient_squares / std::max(gradients, 1.0) - mean * mean, 0.0));
  }

  void add(double real_grey, double simulated_grey, double similar) {
    pixels += 1.0;
    real += real_grey;
    simulated += simulated_grey;
    real_squares += real_grey * real_grey;
    simulated_squares += simulated_grey * simulated_grey;
    products += real_grey * simulated_grey;
    similarity += similar;
    real_greys.add(real_grey);
    simulated_greys.add(simulated_grey);
  }

  RegionAppearance appearance() const {
    const double varied = (real_squares - real * real / pixels) *
                          (simulated_squares - simulated * simulated / pixels);
    const double squares = real_squares - 2.0 * products + simulated_squares;
    return {.pixels = static_cast<std::size_t>(pixels),
            .grey = real / pixels,
            .difference = (real - simulated) / pixels,
            .residual_rms = std::sqrt(std::max(squares, 0.0) / pixels),
            .correlation =
                varied > 0.0 ? (products - real * simulated / pixels) / std::sqrt(varied) : 0.0,
            .ssim = similarity / pixels,
            .gmsd = gradient_deviation(),
            .histogram_distance = real_greys.distance_to(simulated_greys, pixels)};
  }
};

/// Whether a pixel begins one of the gradients' reduced pixels that is wholly in the region.
bool begins_gradient(const ComparedPair& pair, int x, int y) {
  const bool is_first = x % 2 == 0 && y % 2 == 0 && x / 2 < pair.gradient_similarity.width() &&
                        y / 2 < pair.gradient_similarity.height();
  const Mask& region = pair.region;
  return is_first && (region.empty() || (region(x, y) != 0 && region(x + 1, y) != 0 &&
                                         region(x, y + 1) != 0 && region(x + 1, y + 1) != 0));
}

std::array<RegionSums, 9> ninths_of(const ComparedPair& pair) {
  const Extent extent = extent_of(pair.region, pair.real.grey);
  std::array<RegionSums, 9> ninths;
  for (int y = extent.y0; y < extent.y1; ++y) {
    const int row = 3 * (y - extent.y0) / (extent.y1 - extent.y0);
    for (int x = extent.x0; x < extent.x1; ++x) {
      if (pair.region.empty() || pair.region(x, y) != 0) {
        const int column = 3 * (x - extent.x0) / (extent.x1 - extent.x0);
        RegionSums& ninth = ninths[static_cast<std::size_t>(3 * row + column)];
        ninth.add(static_cast<double>(pair.real.grey(x, y)),
                  static_cast<double>(pair.exposed(x, y)),
                  static_cast<double>(pair.similarity(x, y)));
        if (begins_gradient(pair, x, y)) {
          ninth.add_gradient(static_cast<double>(pair.gradient_similarity(x / 2, y / 2)));
        }
      }
    }
  }
  return ninths;
}

std::vector<RegionAppearance> regions_of(const ComparedPair& pair) {
  std::vector<RegionAppearance> regions;
  const std::array<RegionSums, 9> ninths = ninths_of(pair);
  for (std::size_t i = 0; i < ninths.size(); ++i) {
    if (ninths[i].pixels >= kMinRegionPx) {
      regions.push_back(ninths[i].appearance());
      regions.back().name = kRegionNames[i];
    }
  }
  return regions;
}

std::string sentence_of(const BetterTurn& turn) {
  return fmt::format(
      "The real picture seems to be {}: so {} correlates by {:.2f} with the simulated one, as it "
      "is "
      "by {:.2f}.",
      turn.name,
      turn.is_inside ? "what is on the part" : "it",
      turn.correlation,
      turn.correlation_as_is);
}

/// @return whether one of the pictures shows nothing
bool note_plain(ComparedPair& pair) {
  bool is_any = false;
  for (const ComparedPicture* picture : {&pair.simulated, &pair.real}) {
    if (is_plain(picture->grey)) {
      pair.notes.push_back(fmt::format("{} has one grey value all over: no edges are looked for.",
                                       picture->source.picture.filename().string()));
      is_any = true;
    }
  }
  return is_any;
}

/// How the real part lies, and where it is compared.
void add_geometry(const ComparePair& pair, const PairOptions& options, ComparedPair& result) {
  result.better_turn = find_better_turn(result.simulated.grey, result.real.grey);
  if (result.better_turn) {
    result.notes.push_back(sentence_of(*result.better_turn));
  }
  result.geometry = geometry_of(result.simulated,
                                result.real,
                                pair.real_mask.empty() ? options.real_mask : pair.real_mask,
                                options);
  const OutlinePair& outlines = result.geometry.outlines;
  result.notes.insert(result.notes.end(), outlines.notes.begin(), outlines.notes.end());
  result.region = pixels_on_both(outlines.simulated.coverage, outlines.real.coverage);
}

}  // namespace

SurfaceTexture texture_in(const ImageF& picture, const Mask& region, int window_px) {
  return texture_of(
      picture, region.empty() ? region : shrunk(region, kMarginPx), {.window_px = window_px});
}

ComparedPair compare_pair(const ComparePair& pair, const PairOptions& options) {
  ComparedPair result;
  result.simulated = read_compared(pair.simulated, options.may_be_plain);
  result.real = read_compared(pair.real, options.may_be_plain);
  check_sizes(result.simulated, result.real);
  note_formats(result.simulated, result.real, result.notes);
  note_orientation(result.simulated, result.notes);
  note_orientation(result.real, result.notes);
  if (result.simulated.grey.values() == result.real.grey.values()) {
    result.notes.emplace_back("Both pictures are equal in every pixel.");
  }
  if (!note_plain(result)) {
    add_geometry(pair, options, result);
  }
  result.appearance = appearance_of(result, options);
  result.regions = regions_of(result);
  return result;
}

void check_shows_part(const ComparedPair& pair) {
  constexpr double kUnlike = 0.1;
  if (correlation_of(pair.simulated.grey, pair.real.grey) >= kUnlike) {
    return;
  }
  for (const ComparedPicture* picture : {&pair.simulated, &pair.real}) {
    if (is_dark_noise(picture->grey)) {
      throw ConfigError(picture->source.picture.string() +
                        ": shows no part: it is dark, and what varies in it is noise alone");
    }
    if (is_bright_noise(picture->grey)) {
      throw ConfigError(picture->source.picture.string() +
                        ": shows no part: it is at full scale nearly all over, and what varies in "
                        "it is noise alone");
    }
  }
}

}  // namespace glint
