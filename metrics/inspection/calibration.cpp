// SPDX-License-Identifier: GPL-3.0-or-later
//
// The threshold that flawless pictures ask for: from the largest response down, pixels are added
// one by one and the blobs they make are counted, until there are too many.
#include "metrics/inspection/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <vector>

#include "core/error.h"
#include "metrics/inspection/blobs.h"

namespace glint {
namespace {

using Polarity = InspectionSettings::Polarity;

bool is_wanted(float value, Polarity polarity) {
  return polarity == Polarity::kBoth || (value > 0.0F) == (polarity == Polarity::kBright);
}

struct Pixel {
  float size = 0.0F;  ///< |response|
  bool is_bright = true;
  int picture = 0;
  int x = 0;
  int y = 0;
};

/// Counts blobs while pixels are added.
class GrowingBlobs {
 public:
  GrowingBlobs(int width_px, int height_px, int min_area_px)
      : width_px_(width_px), height_px_(height_px), min_area_px_(min_area_px) {}

  std::int64_t count() const { return count_; }

  void add(const Pixel& pixel) {
    const std::size_t added = nodes_.size();
    nodes_.push_back({.parent = added, .area = 1, .is_bright = pixel.is_bright});
    node_at_[key_of(pixel.picture, pixel.x, pixel.y)] = added;
    count_ += min_area_px_ <= 1 ? 1 : 0;
    for (int y = pixel.y - 1; y <= pixel.y + 1; ++y) {
      for (int x = pixel.x - 1; x <= pixel.x + 1; ++x) {
        if (x >= 0 && x < width_px_) {
          join(added, pixel.picture, x, y);
        }
      }
    }
  }

 private:
  struct Node {
    std::size_t parent = 0;
    int area = 0;
    bool is_bright = true;
  };

  std::int64_t key_of(int picture, int x, int y) const {
    // A row of nothing parts the pictures.
    return (static_cast<std::int64_t>(picture) * (height_px_ + 1) + y) * width_px_ + x;
  }

  std::size_t root(std::size_t i) {
    while (nodes_[i].parent != i) {
      nodes_[i].parent = nodes_[nodes_[i].parent].parent;
      i = nodes_[i].parent;
    }
    return i;
  }

  void join(std::size_t added, int picture, int x, int y) {
    const auto found = node_at_.find(key_of(picture, x, y));
    if (found == node_at_.end() || nodes_[found->second].is_bright != nodes_[added].is_bright) {
      return;
    }
    std::size_t a = root(added);
    std::size_t b = root(found->second);
    if (a == b) {
      return;
    }
    if (nodes_[a].area < nodes_[b].area) {
      std::swap(a, b);
    }
    count_ -= is_counted(a) + is_counted(b);
    nodes_[b].parent = a;
    nodes_[a].area += nodes_[b].area;
    count_ += is_counted(a);
  }

  int is_counted(std::size_t node) const { return nodes_[node].area >= min_area_px_ ? 1 : 0; }

  int width_px_;
  int height_px_;
  int min_area_px_;
  std::int64_t count_ = 0;
  std::vector<Node> nodes_;
  std::unordered_map<std::int64_t, std::size_t> node_at_;
};

/// Pixels of at least that size, largest first.
std::vector<Pixel> pixels_from(std::span<const ImageF> responses, double size, Polarity polarity) {
  std::vector<Pixel> pixels;
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const ImageF& image = responses[i];
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const float value = image(x, y);
        if (static_cast<double>(std::abs(value)) >= size && is_wanted(value, polarity)) {
          pixels.push_back({.size = std::abs(value),
                            .is_bright = value > 0.0F,
                            .picture = static_cast<int>(i),
                            .x = x,
                            .y = y});
        }
      }
    }
  }
  std::ranges::stable_sort(pixels, [](const Pixel& a, const Pixel& b) { return a.size > b.size; });
  return pixels;
}

double largest_size(std::span<const ImageF> responses) {
  float largest = 0.0F;
  for (const ImageF& image : responses) {
    for (const float value : image.values()) {
      largest = std::max(largest, std::abs(value));
    }
  }
  return static_cast<double>(largest);
}

std::int64_t count_blobs(const Inspector& inspector,
                         std::span<const ImageF> responses,
                         double threshold,
                         ThreadPool& pool) {
  const auto counts =
      pool.map<std::int64_t>(static_cast<std::int64_t>(responses.size()), [&](std::int64_t i) {
        const ImageF& response = responses[static_cast<std::size_t>(i)];
        return static_cast<std::int64_t>(inspector.blobs(response, threshold, pool).size());
      });
  std::int64_t sum = 0;
  for (const std::int64_t count : counts) {
    sum += count;
  }
  return sum;
}

/// A threshold, found in coarse steps, at which there are too many blobs; the least if none.
double too_low(const Inspector& inspector,
               std::span<const ImageF> responses,
               std::int64_t allowed,
               ThreadPool& pool) {
  constexpr double kStep = 0.9;
  double size = largest_size(responses);
  while (size > inspector.min_threshold()) {
    if (count_blobs(inspector, responses, size, pool) > allowed) {
      return size;
    }
    size *= kStep;
  }
  return inspector.min_threshold();
}

}  // namespace

namespace {

std::int64_t allowed_alarms(double per_picture, std::size_t pictures) {
  constexpr double kCountless = 1e15;
  const double maximum = per_picture * static_cast<double>(pictures);
  return static_cast<std::int64_t>(
      std::floor(std::min(maximum, kCountless) + 1e-9));  // 0.1 * 30 is 3
}

}  // namespace

double threshold_for(const Inspector& inspector,
                     std::span<const ImageF> responses,
                     double false_alarms_per_picture,
                     ThreadPool& pool) {
  if (responses.empty()) {
    throw ConfigError("inspection", "no picture of a flawless part, at least one is needed");
  }
  GLINT_CHECK(false_alarms_per_picture >= 0.0, "a rate is not negative");
  const InspectionSettings& settings = inspector.settings();
  const std::int64_t allowed = allowed_alarms(false_alarms_per_picture, responses.size());
  const double low = too_low(inspector, responses, allowed, pool);
  const std::vector<Pixel> pixels = pixels_from(responses, low, settings.polarity);
  const ImageF& first = responses.front();
  GrowingBlobs blobs(first.width(), first.height(), settings.min_area_px);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    blobs.add(pixels[i]);
    const bool is_last_of_size = i + 1 == pixels.size() || pixels[i + 1].size < pixels[i].size;
    if (is_last_of_size && blobs.count() > allowed) {
      constexpr float kUp = std::numeric_limits<float>::infinity();
      return std::max(inspector.min_threshold(),
                      static_cast<double>(std::nextafter(pixels[i].size, kUp)));
    }
  }
  return inspector.min_threshold();
}

}  // namespace glint
