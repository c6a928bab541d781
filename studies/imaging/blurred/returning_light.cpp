// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/blurred/returning_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "simulator/material/conductor.h"
#include "simulator/material/local.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kMaxOfPart = 0.002;
constexpr double kMaxOfDefects = 0.02;

Vector3d vector_at(const RayCache::Floats& x,
                   const RayCache::Floats& y,
                   const RayCache::Floats& z,
                   std::size_t i) {
  return {static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i])};
}

/// Points of an even sequence in the unit cube: Roberts' additive recurrence, whose steps are
/// powers of the root of x^4 = x + 1.
RandomTriple even_triple(std::size_t index) {
  constexpr double kRoot = 1.2207440846057596;
  RandomTriple triple;
  double step = 1.0;
  for (double& value : triple) {
    step /= kRoot;
    const double place = 0.5 + step * static_cast<double>(index);
    value = place - std::floor(place);
  }
  return triple;
}

/// Lobes around kept rays, direction by direction.
class LobeProbe {
 public:
  LobeProbe(const RayCache& cache, const Bvh& bvh, const Vector3d& camera_mm)
      : cache_(cache), bvh_(bvh), camera_mm_(camera_mm) {}

  void probe(std::size_t ray) {
    constexpr std::size_t kDirections = 32;
    const Vector3d point_mm = vector_at(cache_.origin_x, cache_.origin_y, cache_.origin_z, ray);
    const Vector3d mirrored =
        vector_at(cache_.direction_x, cache_.direction_y, cache_.direction_z, ray);
    const Vector3d viewer = (camera_mm_ - point_mm).normalized();
    const Vector3d normal = (viewer + mirrored.normalized()).normalized();
    const ShadingFrame frame = frame_at(normal, normal.unitOrthogonal());
    const LocalDirection to_viewer = frame.to_local(viewer);
    for (std::size_t k = 0; k < kDirections; ++k) {
      const auto sampled = sample(metal_, to_viewer, even_triple(directions_ + k));
      if (sampled) {
        weight_ += 1.0;
        returning_ += is_met(point_mm, frame, sampled->to_light) ? 1.0 : 0.0;
      }
    }
    directions_ += kDirections;
  }

  double share() const { return weight_ > 0.0 ? returning_ / weight_ : 0.0; }

 private:
  bool is_met(const Vector3d& point_mm,
              const ShadingFrame& frame,
              const LocalDirection& to_light) const {
    constexpr double kStart_mm = 0.01;  // beyond what rounding and facets raise
    const Vector3d direction =
        to_light.x * frame.tangent + to_light.y * frame.bitangent + to_light.z * frame.normal;
    return bvh_.occluded(point_mm, direction, kStart_mm, std::numeric_limits<float>::max());
  }

  const RayCache& cache_;
  const Bvh& bvh_;
  Vector3d camera_mm_;
  Conductor metal_ = {.alpha = {.x = 0.1, .y = 0.1}, .fresnel = constant_fresnel(Colour::Ones())};
  std::size_t directions_ = 0;
  double weight_ = 0.0;
  double returning_ = 0.0;
};

void fail(const char* key, double share) {
  throw ConfigError(
      key,
      fmt::format("{:.2g} % of what is reflected meets the part again, which render.method = "
                  "\"blurred\" does not model; allowed are convex parts with shallow defects, or "
                  "render.method = \"paths\"",
                  100.0 * share));
}

}  // namespace

double returning_share(const RayCache& cache,
                       std::span<const std::size_t> rays,
                       const Bvh& bvh,
                       const Vector3d& camera_in_world_mm) {
  constexpr std::size_t kProbes = 1000;
  if (bvh.is_convex()) {
    return 0.0;
  }
  std::vector<std::size_t> seen;
  std::ranges::copy_if(
      rays, std::back_inserter(seen), [&](std::size_t ray) { return cache.weight[ray] > 0.0F; });
  LobeProbe probe(cache, bvh, camera_in_world_mm);
  const std::size_t step = std::max<std::size_t>(1, seen.size() / kProbes);
  for (std::size_t i = 0; i < seen.size(); i += step) {
    probe.probe(seen[i]);
  }
  return probe.share();
}

void check_no_light_returns(const RayCache& cache,
                            std::span<const std::size_t> defects,
                            const Bvh& bvh,
                            const Vector3d& camera_in_world_mm) {
  std::vector<std::size_t> all(static_cast<std::size_t>(cache.num_pixels()));
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto of_rays = static_cast<double>(cache.counts.followed + cache.counts.blocked) /
                       static_cast<double>(std::max<std::int64_t>(1, cache.counts.part));
  const double of_part = std::max(of_rays, returning_share(cache, all, bvh, camera_in_world_mm));
  if (of_part > kMaxOfPart) {
    fail("part", of_part);
  }
  const double of_defects = returning_share(cache, defects, bvh, camera_in_world_mm);
  if (of_defects > kMaxOfDefects) {
    fail("defects", of_defects);
  }
}

}  // namespace glint
