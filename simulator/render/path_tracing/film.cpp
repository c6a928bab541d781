// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint {
namespace {

template <class Function>
ImageF image_of(const Film& sums, const Function& value_at) {
  ImageF image(sums.width_px, sums.height_px);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] = static_cast<float>(value_at(i));
  }
  return image;
}

double samples_at(const Film& sums, std::size_t i) {
  return std::max(1, sums.samples.values()[i]);
}

double total_at(const Film& sums,
                std::span<const double> factors,
                std::size_t channel,
                std::size_t i) {
  double total = 0.0;
  for (std::size_t g = 0; g < sums.groups.size(); ++g) {
    total += factors[g] * static_cast<double>(sums.groups[g].channels[channel].values()[i]);
  }
  return total / samples_at(sums, i);
}

/// Variance of the mean from the sums of n samples and of their squares.
double variance_of_mean(double mean, double squares, double n) {
  if (n < 2.0) {
    return std::numeric_limits<double>::infinity();
  }
  return std::max(0.0, squares / n - mean * mean) / (n - 1.0);
}

ImageF mean_on_part(const Film& sums, const ImageF& of) {
  return image_of(sums, [&](std::size_t i) {
    return static_cast<double>(of.values()[i]) / std::max(1, sums.part.values()[i]);
  });
}

/// 1 - cos(a) = 2 sin^2(a / 2), which stays exact at small angles.
ImageF incidence_image(const Film& sums) {
  const ImageF tilt = mean_on_part(sums, sums.tilt);
  return image_of(sums, [&](std::size_t i) {
    const double half = 0.5 * static_cast<double>(tilt.values()[i]);
    return 2.0 * std::asin(std::sqrt(std::clamp(half, 0.0, 1.0)));
  });
}

void normalise(SurfaceImages& images) {
  for (std::size_t i = 0; i < images.normal_x.size(); ++i) {
    float& x = images.normal_x.values()[i];
    float& y = images.normal_y.values()[i];
    float& z = images.normal_z.values()[i];
    const float length = std::sqrt(x * x + y * y + z * z);
    if (length > 0.0F) {
      x /= length;
      y /= length;
      z /= length;
    }
  }
}

}  // namespace

PathCounts& PathCounts::operator+=(const PathCounts& other) {
  camera += other.camera;
  shadow += other.shadow;
  bounce += other.bounce;
  dropped += other.dropped;
  camera_s += other.camera_s;
  shadow_s += other.shadow_s;
  bounce_s += other.bounce_s;
  return *this;
}

ImageF standard_error_image(const Film& sums, std::span<const double> factors) {
  const std::size_t channels = sums.groups.empty() ? 0 : sums.groups[0].channels.size();
  return image_of(sums, [&](std::size_t i) {
    double grey = 0.0;
    for (std::size_t c = 0; c < channels; ++c) {
      grey += total_at(sums, factors, c, i) / static_cast<double>(channels);
    }
    return std::sqrt(variance_of_mean(
        grey, static_cast<double>(sums.squares.values()[i]), sums.samples.values()[i]));
  });
}

CoverageImages coverage_images(const Film& sums) {
  CoverageImages images;
  images.background = image_of(sums, [&](std::size_t i) {
    return (sums.samples.values()[i] - sums.part.values()[i]) / samples_at(sums, i);
  });
  images.sound = image_of(sums, [&](std::size_t i) {
    int sound = sums.part.values()[i];
    for (const DefectSums& defect : sums.defects) {
      sound -= defect.samples.values()[i];
    }
    return sound / samples_at(sums, i);
  });
  for (const DefectSums& defect : sums.defects) {
    images.ids.push_back(defect.id);
    images.defects.push_back(image_of(
        sums, [&](std::size_t i) { return defect.samples.values()[i] / samples_at(sums, i); }));
  }
  return images;
}

SurfaceImages surface_images(const Film& sums) {
  SurfaceImages images = {.depth_mm = mean_on_part(sums, sums.depth_mm),
                          .normal_x = mean_on_part(sums, sums.normal_x),
                          .normal_y = mean_on_part(sums, sums.normal_y),
                          .normal_z = mean_on_part(sums, sums.normal_z),
                          .x_mm = mean_on_part(sums, sums.x_mm),
                          .y_mm = mean_on_part(sums, sums.y_mm),
                          .z_mm = mean_on_part(sums, sums.z_mm),
                          .incidence_rad = incidence_image(sums)};
  normalise(images);
  return images;
}

}  // namespace glint
