// SPDX-License-Identifier: GPL-3.0-or-later
//
// Path tracing in passes of 4, 4, 8, 16, 32 ... samples. Within a pass tiles are traced in any
// order by any thread, but a tile's sums are added by one thread in the order of its samples, and
// which tiles go on is decided between passes: the same bytes for any number of threads. With a
// relative error wanted, a tile stops as a whole once its root mean square standard error is small
// enough, as a single pixel that has found no light yet seems to have no error.
// docs/theory/path_tracing.md, "Error" and "Passes and threads". Memory: render_paths.h.
#include "simulator/render/path_tracing/render_paths.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/error.h"
#include "simulator/render/path_tracing/tile_tracer.h"

namespace glint {
namespace {

/// Tiles that one call of the thread pool's body renders, one after the other.
constexpr std::size_t kTilesPerJob = 8;
constexpr int kFirstPass = 4;
constexpr int kMaxSamplesWithDefects = 65535;

void check_at_least(const char* key, int value, int minimum) {
  if (value < minimum) {
    throw ConfigError(
        fmt::format("{}: {} given, allowed are whole numbers from {}", key, value, minimum));
  }
}

void check(const PhysicalScene& scene, const PathSettings& settings) {
  check_at_least("samples", settings.samples, 1);
  check_at_least("min_samples", settings.min_samples, 2);
  check_at_least("samples_per_pass", settings.samples_per_pass, 1);
  check_at_least("max_reflections", settings.max_reflections, 1);
  if (settings.channels != 1 && settings.channels != 3) {
    throw ConfigError(fmt::format("channels: {} given, allowed are 1 and 3", settings.channels));
  }
  if (!(settings.relative_error >= 0.0) || !(settings.dark_share >= 0.0)) {
    throw ConfigError("relative_error, dark_share: allowed are numbers from 0");
  }
  if (settings.samples > kMaxSamplesWithDefects) {
    throw ConfigError(fmt::format(
        "samples: {} given, allowed are at most {}", settings.samples, kMaxSamplesWithDefects));
  }
  GLINT_CHECK(
      scene.face_labels.empty() || scene.face_labels.size() == scene.part.mesh.num_triangles(),
      "a label for each triangle");
}

/// Grey radiance of a pixel at the scene's factors, and the variance of that mean.
struct PixelEstimate {
  double mean = 0.0;
  double variance = 0.0;
};

PixelEstimate estimate_at(const Film& sums, const std::vector<double>& factors, int x, int y) {
  double total = 0.0;
  for (std::size_t g = 0; g < sums.groups.size(); ++g) {
    const std::vector<ImageF>& channels = sums.groups[g].channels;
    for (const ImageF& channel : channels) {
      total +=
          factors[g] * static_cast<double>(channel(x, y)) / static_cast<double>(channels.size());
    }
  }
  const double n = sums.samples(x, y);
  const double mean = total / n;
  const double spread = static_cast<double>(sums.squares(x, y)) / n - mean * mean;
  return {.mean = mean, .variance = std::max(0.0, spread) / (n - 1.0)};
}

/// Means over the pixels of a tile.
PixelEstimate tile_estimate(const Film& sums,
                            const std::vector<double>& factors,
                            const Tile& tile) {
  PixelEstimate of_tile;
  for (int y = tile.y_px; y < tile.y_px + tile.height_px; ++y) {
    for (int x = tile.x_px; x < tile.x_px + tile.width_px; ++x) {
      const PixelEstimate pixel = estimate_at(sums, factors, x, y);
      of_tile.mean += pixel.mean;
      of_tile.variance += pixel.variance;
    }
  }
  const double pixels = tile.width_px * tile.height_px;
  return {.mean = of_tile.mean / pixels, .variance = of_tile.variance / pixels};
}

/// The tiles whose root mean square error is still too large.
///
/// Whole tiles are judged, as the spread of a single pixel's few samples says little: a pixel that
/// has found no light yet seems to know it exactly.
std::vector<Tile> unfinished(const std::vector<Tile>& all,
                             const std::vector<Tile>& active,
                             const std::vector<double>& factors,
                             const PathSettings& settings,
                             const Film& sums) {
  double mean = 0.0;
  for (const Tile& tile : all) {
    mean += tile_estimate(sums, factors, tile).mean / static_cast<double>(all.size());
  }
  std::vector<Tile> left;
  for (const Tile& tile : active) {
    const PixelEstimate estimate = tile_estimate(sums, factors, tile);
    const double allowed =
        settings.relative_error * std::max(estimate.mean, settings.dark_share * mean);
    if (estimate.variance > allowed * allowed) {
      left.push_back(tile);
    }
  }
  return left;
}

/// The tiles that touch one of the windows; all without any.
std::vector<Tile> wanted_tiles(std::vector<Tile> tiles, std::span<const PixelWindow> windows) {
  const auto touches = [](const Tile& tile, const PixelWindow& window) {
    return window.left_px < tile.x_px + tile.width_px &&
           tile.x_px < window.left_px + window.width_px &&
           window.top_px < tile.y_px + tile.height_px &&
           tile.y_px < window.top_px + window.height_px;
  };
  if (!windows.empty()) {
    std::erase_if(tiles, [&](const Tile& tile) {
      return std::ranges::none_of(windows,
                                  [&](const PixelWindow& window) { return touches(tile, window); });
    });
  }
  return tiles;
}

int pass_length(int done, const PathSettings& settings) {
  const int wanted = std::min(std::max(kFirstPass, done), settings.samples_per_pass);
  return std::min(wanted, settings.samples - done);
}

/// One pass over the given tiles; counts are added in the order of the jobs.
void render_pass(const PathTask& task,
                 const std::vector<Tile>& tiles,
                 int first,
                 int count,
                 ThreadPool& pool,
                 Film& sums) {
  const std::size_t num_jobs = (tiles.size() + kTilesPerJob - 1) / kTilesPerJob;
  const auto counts =
      pool.map<PathCounts>(static_cast<std::int64_t>(num_jobs), [&](std::int64_t job) {
        const auto tracer = std::make_unique<TileTracer>(task);
        const std::size_t begin = kTilesPerJob * static_cast<std::size_t>(job);
        const std::size_t end = std::min(tiles.size(), begin + kTilesPerJob);
        for (std::size_t i = begin; i < end; ++i) {
          tracer->trace(tiles[i], first, count, sums);
        }
        return tracer->counts();
      });
  for (const PathCounts& of_job : counts) {
    sums.counts += of_job;
  }
}

}  // namespace

Film render_paths(const PhysicalScene& scene,
                  const PathSettings& settings,
                  ThreadPool& pool,
                  const PathPreview& preview) {
  check(scene, settings);
  const PathTask task(scene, settings);
  const PinholeIntrinsics& in = scene.camera.intrinsics();
  const std::vector<Tile> all = wanted_tiles(tiles_of(in.width_px, in.height_px), settings.windows);
  Film sums =
      empty_film(in.width_px, in.height_px, task.factors.size(), settings.channels, task.ids);
  std::vector<Tile> active = all;
  int done = 0;
  for (int pass = 1; done < settings.samples && !active.empty(); ++pass) {
    const int count = pass_length(done, settings);
    render_pass(task, active, done, count, pool, sums);
    done += count;
    if (settings.has_light && settings.relative_error > 0.0 && done >= settings.min_samples) {
      active = unfinished(all, active, task.factors, settings, sums);
    }
    const std::int64_t left =
        done < settings.samples ? static_cast<std::int64_t>(active.size()) : 0;
    const PathProgress progress = {
        .pass = pass, .samples = done, .tiles_left = left, .sums = &sums};
    if (preview && !preview(progress)) {
      break;
    }
  }
  return sums;
}

}  // namespace glint
