// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/line_store.h"

namespace glint {
namespace {

template <class Pixel>
std::size_t size_of(const Image<Pixel>& image) {
  return image.size() * sizeof(Pixel);
}

}  // namespace

std::string digest_of(const SurfaceDetail& detail) {
  std::string key;
  const auto add = [&key](double value) {
    key.append(reinterpret_cast<const char*>(&value), sizeof(value));  // NOLINT(*-reinterpret-cast)
  };
  for (const HeightFeature& feature : detail.features()) {
    for (const Eigen::Vector3d* vector :
         {&feature.centre_mm, &feature.u_axis, &feature.v_axis, &feature.normal}) {
      add(vector->x());
      add(vector->y());
      add(vector->z());
    }
    for (const double value : {static_cast<double>(feature.kind),
                               static_cast<double>(feature.id),
                               feature.height_mm,
                               feature.sigma_mm,
                               feature.length_mm,
                               feature.width_mm,
                               feature.moves_position ? 1.0 : 0.0,
                               feature.reflectance,
                               feature.roughness_rad}) {
      add(value);
    }
  }
  return key;
}

std::size_t FlawlessRendering::bytes() const {
  constexpr std::size_t kSurfaceImages = 8;
  std::size_t all = size_of(coverage.background) + size_of(coverage.sound);
  all += kSurfaceImages * size_of(surface.depth_mm);
  for (const PathBatch& half : halves) {
    all += size_of(half.samples);
    for (const GroupSums& group : half.groups) {
      all += group.channels.size() * size_of(half.samples);
    }
  }
  return all;
}

std::size_t RenderedChanges::bytes() const {
  return pixels.size() * sizeof(std::size_t) + 2 * values[0].size() * sizeof(float);
}

}  // namespace glint
