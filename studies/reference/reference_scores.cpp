// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reference/reference_scores.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/image/image_io.h"
#include "metrics/appearance/grey_match.h"
#include "metrics/appearance/structure_similarity.h"
#include "metrics/overlap/boundary_distance.h"
#include "metrics/overlap/edge_location.h"
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
};

std::string size_text(int width, int height) {
  return fmt::format("{} x {} pixels", width, height);
}

/// A picture of the camera's size. @param key  that names its file
ImageF read_sized(const std::filesystem::path& file,
                  const std::string& key,
                  const CameraSettings& camera) {
  ImageF picture = linear_values(read_picture(file).pixels);
  if (picture.width() != camera.width_px || picture.height() != camera.height_px) {
    throw ConfigError(key,
                      fmt::format("{} has {}; must be as large as the camera's pictures, {}",
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

/// Root of the mean squared difference.
double rms_of(const ImageF& first, const ImageF& second, const Mask& region) {
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
  return std::sqrt(sum / std::max(1.0, count));
}

Mask either(const Mask& first, const Mask& second) {
  Mask both = first;
  std::ranges::transform(
      first.values(), second.values(), both.values().begin(), [](auto a, auto b) {
        return static_cast<unsigned char>(a != 0 || b != 0 ? 1 : 0);
      });
  return both;
}

/// Scores of one pair.
Scores compare(const PicturedPart& simulated, const PicturedPart& real) {
  const std::vector<Boundary> of_simulated = outline_in(simulated);
  const std::vector<Boundary> of_real = outline_in(real);
  const Mask region = either(simulated.mask, real.mask);
  const int width = real.grey.width();
  const int height = real.grey.height();
  return {{"overlap.iou",
           overlap_of(filled(of_simulated, width, height), filled(of_real, width, height)).iou},
          {"overlap.mean_distance_px",
           boundary_distance(of_simulated, of_real, std::hypot(width, height)).mean_px},
          {"appearance.ssim", ssim(simulated.grey, real.grey, region)},
          {"appearance.rms", rms_of(simulated.grey, real.grey, region)},
          {"appearance.histogram_distance",
           histogram_distance(simulated.grey, real.grey, simulated.mask, real.mask)}};
}

class References {
 public:
  References(SceneStore& store, const SceneSettings& scene) : store_(store), scene_(scene) {}

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
    PicturedPart real = {.grey = read_sized(reference.pictures[i], key, scene_.camera)};
    PicturedPart simulated = render(viewpoint);
    if (reference.masks.empty()) {
      real.mask = segmented(real.grey, key, reference.pictures[i].string());
      simulated.mask = segmented(simulated.grey, key, "the simulated picture");
    } else {
      real.mask = mask_of(i);
    }
    return compare(simulated, real);
  }

  Mask mask_of(std::size_t i) const {
    const std::filesystem::path& file = scene_.reference->masks[i];
    const std::string key = fmt::format("reference.masks.{}", i);
    const ImageF picture = read_sized(file, key, scene_.camera);
    Mask mask(picture.width(), picture.height());
    std::ranges::transform(picture.values(), mask.values().begin(), [](float value) {
      return static_cast<unsigned char>(value > 0.5F ? 1 : 0);
    });
    if (std::ranges::none_of(mask.values(), [](unsigned char value) { return value != 0; })) {
      throw ConfigError(key, file.string() + " is dark everywhere; it must be bright on the part");
    }
    return mask;
  }

  PicturedPart render(const Viewpoint& viewpoint) const {
    SceneSettings scene = scene_;
    scene.viewpoint_set = {};
    scene.viewpoints = {viewpoint};
    const auto picture = picture_of(store_, scene, {.has_flawless = false});
    return {.grey = picture->mean({.has_whole_frames = true}).aspect,
            .mask = picture->traced()->part_mask};
  }

  SceneStore& store_;
  const SceneSettings& scene_;
};

}  // namespace

Scores reference_scores(SceneStore& store, const SceneSettings& scene) {
  return References(store, scene).scores();
}

}  // namespace glint
