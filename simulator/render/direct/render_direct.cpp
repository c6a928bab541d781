// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles of 16 x 16 pixels in any order by any thread, each by itself: the same bytes for any number
// of threads. A tile's pixels begin with the same few rays; those whose rays differ (silhouettes,
// edges, steep defects) are made again with twice as many along either axis, until they agree.
#include "simulator/render/direct/render_direct.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/error.h"
#include "simulator/render/direct/grid_light.h"
#include "simulator/render/path_tracing/render_paths.h"

namespace glint {
namespace {

constexpr int kTile_px = 16;

void check(const PhysicalScene& scene, const DirectSettings& direct) {
  const std::string reason = scene_without_direct_sum(scene);
  if (!reason.empty()) {
    throw ConfigError("render.method", "direct light cannot be summed here: " + reason);
  }
  if (!(direct.tolerance > 0.0) || !(direct.interpolated >= 0.0) || !(direct.spread >= 0.0)) {
    throw ConfigError("tolerances of direct light: allowed are numbers from 0");
  }
  if (direct.rays_per_axis < 1 || direct.rays_per_axis > 4 ||
      direct.max_rays_per_axis < direct.rays_per_axis) {
    throw ConfigError(
        fmt::format("rays_per_axis: {} to {} given, allowed are 1 to 4, and more at most",
                    direct.rays_per_axis,
                    direct.max_rays_per_axis));
  }
}

/// Means over the rays of one pixel.
struct PixelLight {
  std::vector<double> sums;
  double total = 0.0;  ///< at the groups' factors, mean of the channels
  double low = 0.0, high = 0.0;
};

/// A pixel whose rays differ.
struct UnevenPixel {
  int x = 0;
  int y = 0;
  double total = 0.0;
};

/// The pixels of one tile after the other; one a thread.
class TileLight {
 public:
  TileLight(const PathTask& task, const PointLight& light, const DirectSettings& direct)
      : task_(task), direct_(direct), lights_(task, light, direct) {}

  void render(const RayArea& tile, Film& film) {
    trace_pixels(task_, tile, grid_);
    lights_.look_at(grid_, direct_.interpolated > 0.0);
    std::vector<UnevenPixel> again;
    for (int y = 0; y < tile.height_px; ++y) {
      for (int x = 0; x < tile.width_px; ++x) {
        const PixelLight pixel = pixel_of(x, y);
        put(pixel, tile.x_px + x, tile.y_px + y, film);
        if (pixel.high - pixel.low > direct_.spread) {
          again.push_back({tile.x_px + x, tile.y_px + y, pixel.total});
        }
      }
    }
    for (const UnevenPixel& pixel : again) {
      refine(pixel, film);
    }
  }

  const DirectCounts& counts() const { return lights_.counts(); }

 private:
  double total_of(std::span<const float> numbers) const {
    const auto channels = static_cast<std::size_t>(task_.settings.channels);
    double total = 0.0;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      total += task_.factors[k / channels] * static_cast<double>(numbers[k]);
    }
    return total / static_cast<double>(channels);
  }

  PixelLight pixel_of(int x, int y) const {
    const int n = grid_.area.per_axis;
    PixelLight pixel;
    for (int i = 0; i < n * n; ++i) {
      const std::size_t ray = grid_.ray(x * n + i % n, y * n + i / n);
      const std::span<const float> numbers = lights_.of(ray);
      pixel.sums.resize(numbers.size());
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        pixel.sums[k] += static_cast<double>(numbers[k]) / (n * n);
      }
      const double total = total_of(numbers);
      pixel.total += total / (n * n);
      pixel.low = i == 0 ? total : std::min(pixel.low, total);
      pixel.high = i == 0 ? total : std::max(pixel.high, total);
    }
    return pixel;
  }

  /// Until a quarter of the rays would have said the same.
  void refine(const UnevenPixel& uneven, Film& film) {
    double last = uneven.total;
    for (int n = 2 * direct_.rays_per_axis; n <= direct_.max_rays_per_axis; n *= 2) {
      trace_pixels(
          task_,
          {.x_px = uneven.x, .y_px = uneven.y, .width_px = 1, .height_px = 1, .per_axis = n},
          grid_);
      lights_.look_at(grid_, false);
      const PixelLight pixel = pixel_of(0, 0);
      put(pixel, uneven.x, uneven.y, film);
      if (std::abs(pixel.total - last) < 0.05 * direct_.spread) {
        return;
      }
      last = pixel.total;
    }
  }

  void put(const PixelLight& pixel, int x, int y, Film& film) const {
    const auto channels = static_cast<std::size_t>(task_.settings.channels);
    const double samples = film.samples(x, y);
    for (std::size_t k = 0; k < pixel.sums.size(); ++k) {
      film.groups[k / channels].channels[k % channels](x, y) =
          static_cast<float>(samples * pixel.sums[k]);
    }
    film.squares(x, y) = static_cast<float>(samples * pixel.total * pixel.total);
  }

  const PathTask& task_;
  const DirectSettings& direct_;
  GridLight lights_;
  PixelRays grid_;
};

bool touches(const RayArea& tile, const std::vector<PixelWindow>& windows) {
  return windows.empty() || std::ranges::any_of(windows, [&](const PixelWindow& w) {
           return w.left_px < tile.x_px + tile.width_px && tile.x_px < w.left_px + w.width_px &&
                  w.top_px < tile.y_px + tile.height_px && tile.y_px < w.top_px + w.height_px;
         });
}

std::vector<RayArea> tiles_of(const Film& film, const PathSettings& settings, int per_axis) {
  std::vector<RayArea> tiles;
  for (int y = 0; y < film.height_px; y += kTile_px) {
    for (int x = 0; x < film.width_px; x += kTile_px) {
      const RayArea tile = {.x_px = x,
                            .y_px = y,
                            .width_px = std::min(kTile_px, film.width_px - x),
                            .height_px = std::min(kTile_px, film.height_px - y),
                            .per_axis = per_axis};
      if (touches(tile, settings.windows)) {
        tiles.push_back(tile);
      }
    }
  }
  return tiles;
}

DirectCounts add_light(const PathTask& task,
                       const DirectSettings& direct,
                       ThreadPool& pool,
                       Film& film) {
  const auto channels = static_cast<std::size_t>(task.settings.channels);
  const ImageF black(film.width_px, film.height_px);
  film.groups.assign(task.factors.size(), {std::vector<ImageF>(channels, black)});
  film.squares = black;
  const PointLight light(task, direct);
  const std::vector<RayArea> tiles = tiles_of(film, task.settings, direct.rays_per_axis);
  const auto counted =
      pool.map<DirectCounts>(static_cast<std::int64_t>(tiles.size()), [&](std::int64_t i) {
        const auto tile = std::make_unique<TileLight>(task, light, direct);
        tile->render(tiles[static_cast<std::size_t>(i)], film);
        return tile->counts();
      });
  DirectCounts all;
  for (const DirectCounts& of_tile : counted) {
    all += of_tile;
  }
  return all;
}

}  // namespace

DirectCounts& DirectCounts::operator+=(const DirectCounts& other) {
  rays += other.rays;
  points += other.points;
  places += other.places;
  return *this;
}

std::string scene_without_direct_sum(const PhysicalScene& scene) {
  if (scene.lens.aperture_mm > 0.0) {
    return "the camera has depth of field";
  }
  if (scene.material.varies_roughness()) {
    return "the metal's roughness varies from place to place";
  }
  if (!conductor_numbers(scene.material.plain())) {
    return "the part is no rough metal";
  }
  return lights_without_direct_sum(scene.lights);
}

Film render_direct(const PhysicalScene& scene,
                   const PathSettings& settings,
                   const DirectSettings& direct,
                   ThreadPool& pool,
                   DirectCounts* counts) {
  check(scene, direct);
  PathSettings dark = settings;
  dark.has_light = false;
  dark.max_reflections = 1;
  Film film = render_paths(scene, dark, pool);
  PathSettings lit = dark;
  lit.has_light = true;
  const DirectCounts counted = add_light(PathTask(scene, lit), direct, pool, film);
  if (counts != nullptr) {
    *counts += counted;
  }
  return film;
}

}  // namespace glint
