// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_changes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulator/render/path_tracing/smooth_picture.h"

namespace glint {
namespace {

/// Whether two pictures differ in a pixel that both were rendered in.
bool differs(const PathBatch& a, const PathBatch& b, std::size_t pixel) {
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    for (std::size_t c = 0; c < a.groups[g].channels.size(); ++c) {
      if (a.groups[g].channels[c].values()[pixel] != b.groups[g].channels[c].values()[pixel]) {
        return true;
      }
    }
  }
  return false;
}

/// What two halves tell about the changes around a pixel.
struct Agreement {
  double product = 0.0;
  double square = 0.0;
  double count = 0.0;

  void add(const Agreement& other) {
    product += other.product;
    square += other.square;
    count += other.count;
  }
};

/// Root of the share of squared change around each pixel that both halves agree on: with it as a
/// factor, noise of the rendering adds nothing to the squared change on average.
std::vector<float> gains_of(const FrameChanges& changes, int width_px, int height_px) {
  constexpr int kAround = 4;
  Image<Agreement> at(width_px, height_px);
  for (std::size_t i = 0; i < changes.values.size(); ++i) {
    const auto a = static_cast<double>(changes.values[i][0]);
    const auto b = static_cast<double>(changes.values[i][1]);
    at.values()[changes.pixels[i % changes.pixels.size()]].add(
        {.product = a * b,
         .square = 0.25 * (a + b) * (a + b),
         .count = a != 0.0 || b != 0.0 ? 1.0 : 0.0});
  }
  std::vector<float> gains;
  for (const std::size_t pixel : changes.pixels) {
    const int x = static_cast<int>(pixel % static_cast<std::size_t>(at.width()));
    const int y = static_cast<int>(pixel / static_cast<std::size_t>(at.width()));
    Agreement all;
    for (int v = std::max(0, y - kAround); v <= std::min(at.height() - 1, y + kAround); ++v) {
      for (int u = std::max(0, x - kAround); u <= std::min(at.width() - 1, x + kAround); ++u) {
        all.add(at(u, v));
      }
    }
    gains.push_back(
        static_cast<float>(std::sqrt(agreed_share(all.product, all.square, all.count))));
  }
  return gains;
}

}  // namespace

RenderedChanges changes_between(const Halves& without, const Halves& with) {
  RenderedChanges changes;
  for (std::size_t i = 0; i < with[0].samples.size(); ++i) {
    if (with[0].samples.values()[i] > 0 &&
        (differs(with[0], without[0], i) || differs(with[1], without[1], i))) {
      changes.pixels.push_back(i);
    }
  }
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t g = 0; g < with[half].groups.size(); ++g) {
      for (std::size_t c = 0; c < with[half].groups[g].channels.size(); ++c) {
        for (const std::size_t i : changes.pixels) {
          changes.values[half].push_back((with[half].groups[g].channels[c].values()[i] -
                                          without[half].groups[g].channels[c].values()[i]) /
                                         static_cast<float>(with[half].samples.values()[i]));
        }
      }
    }
  }
  return changes;
}

FrameChanges frame_changes(const RenderedChanges& rendered,
                           const std::vector<std::vector<float>>& channel_weights,
                           int width_px,
                           int height_px) {
  FrameChanges changes;
  changes.pixels = rendered.pixels;
  const std::size_t count = rendered.pixels.size();
  for (const std::vector<float>& weights : channel_weights) {
    for (std::size_t i = 0; i < count; ++i) {
      std::array<float, 2> sums = {};
      for (std::size_t s = 0; s < weights.size(); ++s) {
        sums[0] += weights[s] * rendered.values[0][s * count + i];
        sums[1] += weights[s] * rendered.values[1][s * count + i];
      }
      changes.values.push_back(sums);
    }
  }
  changes.gains = gains_of(changes, width_px, height_px);
  return changes;
}

void add_changes(const FrameChanges& changes, std::size_t index, ImageF& radiance) {
  const std::size_t first = index * changes.pixels.size();
  for (std::size_t i = 0; i < changes.pixels.size(); ++i) {
    float& value = radiance.values()[changes.pixels[i]];
    const std::array<float, 2>& halves = changes.values[first + i];
    value = std::max(0.0F, value + 0.5F * changes.gains[i] * (halves[0] + halves[1]));
  }
}

std::vector<ImageF> mean_changes(const FrameChanges& changes, int width_px, int height_px) {
  std::vector<ImageF> means;
  const std::size_t count = changes.pixels.size();
  const std::size_t channels = count > 0 ? changes.values.size() / count : 0;
  for (std::size_t half = 0; half < 2 && count > 0; ++half) {
    ImageF mean(width_px, height_px);
    for (std::size_t i = 0; i < changes.values.size(); ++i) {
      mean.values()[changes.pixels[i % count]] +=
          changes.values[i][half] / static_cast<float>(channels);
    }
    means.push_back(std::move(mean));
  }
  return means;
}

}  // namespace glint
