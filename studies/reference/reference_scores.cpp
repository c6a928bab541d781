// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reference/reference_scores.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "core/image/image_io.h"
#include "core/image/spans.h"
#include "metrics/appearance/grey_match.h"
#include "metrics/appearance/structure_similarity.h"
#include "metrics/aspect_image/roi.h"
#include "metrics/overlap/boundary_distance.h"
#include "metrics/overlap/edge_location.h"
#include "metrics/overlap/inner_edges.h"
#include "metrics/overlap/outline.h"
#include "metrics/overlap/region_overlap.h"
#include "metrics/shape/silhouette.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

/// A picture and where the part is in it.
struct PicturedPart {
  ImageF grey;
  Mask mask;
  std::vector<ImageF> without_batch = {};  ///< `grey` without each batch of its samples; or none
};

/// What a mask's file says of a real picture.
struct GivenMask {
  Mask part;
  Mask ignored;  ///< where nothing is compared
};

std::string size_text(int width, int height) {
  return fmt::format("{} x {} pixels", width, height);
}

/// A picture of read_fitting() in the camera's pixels.
ImageF as_taken_by(const CameraSettings& camera, const ImageF& picture) {
  const int factor = picture.width() / camera.width_px;
  return factor > 1 ? reduce(picture, factor) : picture;
}

/// A picture that is, or can be reduced to, one of the camera. @param key  that names its file
ImageF read_fitting(const std::filesystem::path& file,
                    const std::string& key,
                    const CameraSettings& camera) {
  ImageF picture = linear_values(read_picture(file).pixels);
  const int factor = std::max(1, picture.width() / camera.width_px);
  if (picture.width() != factor * camera.width_px ||
      picture.height() != factor * camera.height_px) {
    throw ConfigError(key,
                      fmt::format("{} has {}; must be as large as the camera's pictures, {}, or a "
                                  "whole number of times as large along both sides",
                                  file.string(),
                                  size_text(picture.width(), picture.height()),
                                  size_text(camera.width_px, camera.height_px)));
  }
  for (const float value : picture.values()) {
    if (!std::isfinite(value)) {
      throw ConfigError(key, file.string() + " holds values that are no finite numbers");
    }
  }
  return picture;
}

/// @param what  for messages
Mask segmented(const ImageF& grey, const std::string& key, const std::string& what) {
  const Silhouette silhouette = find_silhouette(grey, PartPieces::kAll);
  if (!silhouette.mask) {
    throw ConfigError(key,
                      fmt::format("the part is not found in {}: {} Or give its mask in "
                                  "reference.masks",
                                  what,
                                  sentence(*silhouette.fault)));
  }
  return *silhouette.mask;
}

/// The outline of the part, at the edges of the grey values.
std::vector<Boundary> outline_in(const PicturedPart& part) {
  std::vector<Boundary> rough = outlines_of(part.mask, 1);
  const std::vector<LocatedEdge> edges = locate_edges(part.grey, rough);
  return refined(std::move(rough), edges);
}

double mean_square_of(const ImageF& first, const ImageF& second, const Mask& region) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (region.values()[i] != 0) {
      const double difference =
          static_cast<double>(first.values()[i]) - static_cast<double>(second.values()[i]);
      sum += difference * difference;
      count += 1.0;
    }
  }
  return sum / std::max(1.0, count);
}

/// Root of the mean squared difference. Where there are batches the mean square that their noise
/// adds is taken off, exactly, as it is a square: B t - (B - 1) mean of t_b. What is then below 0
/// has the negative root of its size.
double rms_of(const PicturedPart& simulated, const ImageF& real, const Mask& region) {
  double square = mean_square_of(simulated.grey, real, region);
  if (!simulated.without_batch.empty()) {
    const auto count = static_cast<double>(simulated.without_batch.size());
    double mean = 0.0;
    for (const ImageF& grey : simulated.without_batch) {
      mean += mean_square_of(grey, real, region) / count;
    }
    square = count * square - (count - 1.0) * mean;
  }
  return std::copysign(std::sqrt(std::abs(square)), square);
}

/// @param is_kept  of two pixels' values, whether they are set
template <class IsKept>
Mask combined(const Mask& first, const Mask& second, const IsKept& is_kept) {
  Mask mask = first;
  std::ranges::transform(
      first.values(), second.values(), mask.values().begin(), [&](auto a, auto b) {
        return static_cast<unsigned char>(is_kept(a != 0, b != 0) ? 1 : 0);
      });
  return mask;
}

Mask either(const Mask& first, const Mask& second) {
  return combined(first, second, std::logical_or<>());
}

Mask without(const Mask& mask, const Mask& left_out) {
  return combined(mask, left_out, [](bool a, bool b) { return a && !b; });
}

/// Pixels of which more than the share have values above `low` and at most `high`.
Mask pixels_between(
    const ImageF& picture, float low, float high, double share, const CameraSettings& camera) {
  ImageF counted(picture.width(), picture.height());
  std::ranges::transform(picture.values(), counted.values().begin(), [&](float value) {
    return value > low && value <= high ? 1.0F : 0.0F;
  });
  counted = as_taken_by(camera, std::move(counted));
  Mask mask(counted.width(), counted.height());
  std::ranges::transform(counted.values(), mask.values().begin(), [&](float value) {
    return static_cast<unsigned char>(static_cast<double>(value) > share ? 1 : 0);
  });
  return mask;
}

/// Pixels in both regions and some pixels within: their outlines are no edges inside the part.
Mask inside_of(const Mask& first, const Mask& second) {
  constexpr int kRimPx = 3;
  return eroded(combined(first, second, std::logical_and<>()), kRimPx);
}

/// Grey that best parts dark and bright of a region; none where all of it is alike.
std::optional<double> middle_grey(const ImageF& picture, const Mask& region) {
  std::vector<float> values;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (region.values()[i] != 0) {
      values.push_back(picture.values()[i]);
    }
  }
  if (values.empty()) {
    return std::nullopt;
  }
  ImageF row(static_cast<int>(values.size()), 1);
  std::ranges::copy(values, row.values().begin());
  const double threshold = find_silhouette(row, PartPieces::kAll).threshold;
  return threshold > 0.0 ? std::optional(threshold) : std::nullopt;
}

/// Mean distance of the edges inside the part, the reach where an edge has no counterpart.
double inner_distance_px(const PicturedPart& simulated, const PicturedPart& real) {
  const Mask inside = inside_of(simulated.mask, real.mask);
  const std::optional<double> level = middle_grey(simulated.grey, inside);
  if (!level) {
    return kInnerReachPx;
  }
  return inner_edges(simulated.grey, real.grey, static_cast<float>(*level), inside).distance_px();
}

/// How far what is ignored reaches: half of SSIM's window, and edges are located within 4 px.
constexpr int kIgnoredReachPx = 5;

/// Lines without their points in a mask, broken there.
std::vector<Boundary> outside_of(const Mask& mask, const std::vector<Boundary>& lines) {
  std::vector<Boundary> rest;
  for (const Boundary& line : lines) {
    const std::size_t first = rest.size();
    bool follows = false;
    for (const BoundaryPoint& point : line.points) {
      const int x = std::clamp(static_cast<int>(point.at_px.x()), 0, mask.width() - 1);
      const int y = std::clamp(static_cast<int>(point.at_px.y()), 0, mask.height() - 1);
      if (mask(x, y) == 0) {
        if (!follows) {
          rest.emplace_back();
        }
        rest.back().points.push_back(point);
      }
      follows = mask(x, y) == 0;
    }
    if (rest.size() == first + 1 && rest.back().points.size() == line.points.size()) {
      rest.back().is_closed = line.is_closed;
    }
  }
  return rest;
}

/// Shares of pixels within outlines; none in a mask.
ImageF filled_outside(const Mask& mask, const std::vector<Boundary>& outlines) {
  ImageF shares = filled(outlines, mask.width(), mask.height());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (mask.values()[i] != 0) {
      shares.values()[i] = 0.0F;
    }
  }
  return shares;
}

/// The picture's diagonal where nothing is left to compare.
double outline_distance_px(const std::vector<Boundary>& first,
                           const std::vector<Boundary>& second,
                           const Mask& ignored) {
  const double diagonal_px = std::hypot(ignored.width(), ignored.height());
  const BoundaryDistance distance =
      boundary_distance(outside_of(ignored, first), outside_of(ignored, second), diagonal_px);
  return distance.points > 0 ? distance.mean_px : diagonal_px;
}

/// Scores of one pair, but for that of the edges inside the part.
/// @param ignored  where nothing is compared
Scores compare(const PicturedPart& simulated, const PicturedPart& real, const Mask& ignored) {
  const std::vector<Boundary> of_simulated = outline_in(simulated);
  const std::vector<Boundary> of_real = outline_in(real);
  const Mask of_part = without(simulated.mask, ignored);
  const Mask region = either(of_part, real.mask);
  const Mask near_ignored = dilated(ignored, kIgnoredReachPx);
  return {
      {"overlap.iou",
       overlap_of(filled_outside(near_ignored, of_simulated), filled_outside(near_ignored, of_real))
           .iou},
      {"overlap.mean_distance_px", outline_distance_px(of_simulated, of_real, near_ignored)},
      {"appearance.ssim", ssim(simulated.grey, real.grey, without(region, near_ignored))},
      {"appearance.rms", rms_of(simulated, real.grey, region)},
      {"appearance.histogram_distance",
       histogram_distance(simulated.grey, real.grey, of_part, real.mask)}};
}

class References {
 public:
  References(SceneStore& store, const SceneSettings& scene, InnerEdgeScore inner)
      : store_(store), scene_(scene), inner_(inner) {}

  Scores scores() const {
    const auto count = scene_.reference ? scene_.reference->pictures.size() : std::size_t{0};
    if (count == 0) {
      throw ConfigError("reference.pictures",
                        "names no real picture; overlap and appearance need at least one");
    }
    const std::vector<Viewpoint> viewpoints = viewpoints_of(scene_, store_.build(scene_)->part);
    if (count > viewpoints.size()) {
      throw ConfigError("reference.pictures",
                        fmt::format("are {}, the scene has {} viewpoint{}; must be one for each "
                                    "viewpoint, or fewer",
                                    count,
                                    viewpoints.size(),
                                    viewpoints.size() == 1 ? "" : "s"));
    }
    Scores means;
    for (std::size_t i = 0; i < count; ++i) {
      for (const auto& [name, value] : pair_scores(i, viewpoints[i])) {
        means[name] += value / static_cast<double>(count);
      }
    }
    return means;
  }

 private:
  Scores pair_scores(std::size_t i, const Viewpoint& viewpoint) const {
    const ReferenceSettings& reference = *scene_.reference;
    const std::string key = fmt::format("reference.pictures.{}", i);
    PicturedPart real = {
        .grey =
            as_taken_by(scene_.camera, read_fitting(reference.pictures[i], key, scene_.camera))};
    PicturedPart simulated = render(viewpoint);
    if (!reference.masks.empty()) {
      GivenMask given = mask_of(i);
      real.mask = std::move(given.part);
      return compared(simulated, real, given.ignored);
    }
    real.mask = segmented(real.grey, key, reference.pictures[i].string());
    simulated.mask = segmented(simulated.grey, key, "the simulated picture");
    return compared(simulated, real, Mask(real.grey.width(), real.grey.height()));
  }

  Scores compared(const PicturedPart& simulated,
                  const PicturedPart& real,
                  const Mask& ignored) const {
    Scores scores = compare(simulated, real, ignored);
    if (inner_ == InnerEdgeScore::kMeasured) {
      scores["overlap.edge_distance_px"] = inner_distance_px(simulated, real);
    }
    return scores;
  }

  GivenMask mask_of(std::size_t i) const {
    constexpr float kGrey = 0.25F;
    constexpr float kBright = 0.75F;
    constexpr float kNoLimit = std::numeric_limits<float>::max();
    const std::filesystem::path& file = scene_.reference->masks[i];
    const std::string key = fmt::format("reference.masks.{}", i);
    const ImageF picture = read_fitting(file, key, scene_.camera);
    GivenMask given = {.part = pixels_between(picture, kBright, kNoLimit, 0.5, scene_.camera),
                       .ignored = pixels_between(picture, kGrey, kBright, 0.0, scene_.camera)};
    given.part = without(given.part, given.ignored);
    if (std::ranges::none_of(given.part.values(), [](unsigned char value) { return value != 0; })) {
      throw ConfigError(key,
                        file.string() +
                            " is nowhere brighter than three quarters of full scale, which it must "
                            "be on the part; what is brighter than a quarter is ignored");
    }
    return given;
  }

  PicturedPart render(const Viewpoint& viewpoint) const {
    SceneSettings scene = scene_;
    scene.viewpoint_set = {};
    scene.viewpoints = {viewpoint};
    const auto picture = picture_of(store_, scene, {.has_flawless = false});
    PicturedPart part = {.grey = picture->mean({.has_whole_frames = true}).aspect,
                         .mask = picture->traced()->part_mask};
    const std::size_t batches = scene.paths.has_bias_taken_off ? picture->batches() : 0;
    for (std::size_t batch = 0; batch < batches; ++batch) {
      part.without_batch.push_back(
          picture->mean({.has_whole_frames = true, .without = batch}).aspect);
    }
    return part;
  }

  SceneStore& store_;
  const SceneSettings& scene_;
  InnerEdgeScore inner_;
};

}  // namespace

Scores reference_scores(SceneStore& store, const SceneSettings& scene, InnerEdgeScore inner) {
  return References(store, scene, inner).scores();
}

}  // namespace glint
