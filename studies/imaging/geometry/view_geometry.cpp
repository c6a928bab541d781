// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/geometry/view_geometry.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/image/exr_layers.h"
#include "core/units.h"
#include "studies/imaging/path_picture.h"

namespace glint {
namespace {

ExrChannel number_channel(std::string name, const Image<std::int32_t>& numbers) {
  return {.name = std::move(name), .fill = [&numbers](int y, float* row) {
            std::ranges::transform(
                numbers.row(y), numbers.row(y) + numbers.width(), row, [](std::int32_t number) {
                  return static_cast<float>(number);
                });
          }};
}

}  // namespace

void write_geometry(const Film& sums, const std::filesystem::path& file) {
  const SurfaceImages surface = surface_images(sums);
  const auto degrees = [&](int y, float* row) {
    std::ranges::transform(surface.incidence_rad.row(y),
                           surface.incidence_rad.row(y) + sums.width_px,
                           row,
                           [](float angle) { return angle * static_cast<float>(kDegPerRad); });
  };
  const std::vector<ExrChannel> channels = {exr_channel("depth_mm", surface.depth_mm),
                                            exr_channel("normal.x", surface.normal_x),
                                            exr_channel("normal.y", surface.normal_y),
                                            exr_channel("normal.z", surface.normal_z),
                                            exr_channel("position_mm.x", surface.x_mm),
                                            exr_channel("position_mm.y", surface.y_mm),
                                            exr_channel("position_mm.z", surface.z_mm),
                                            {.name = "incidence_deg", .fill = degrees},
                                            number_channel("triangle", sums.triangle),
                                            number_channel("defect", sums.defect)};
  write_exr_channels(file, sums.width_px, sums.height_px, channels);
}

Film render_geometry(SceneStore& store, SceneSettings scene, int samples) {
  scene.paths.has_light = false;
  scene.paths.samples = samples;
  scene.paths.batches = 1;
  const PathView view(scene, store.build_defects(scene), scene.viewpoint());
  return render_view(view, path_settings(scene), store.pool()).sums;
}

}  // namespace glint
