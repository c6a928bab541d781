// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/physical/cell_tracer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <variant>

#include "core/wall_clock.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A light is not hidden by what lies this share of its distance in front of it: rounding to float.
constexpr double kShortOfLight = 1e-5;

/// So many paths are followed together: their data stay in the second-level cache.
constexpr int kSamplesTogether = 8;

/// The power heuristic: the share of the strategy with density a. Source: E. Veach, L. Guibas,
/// "Optimally combining sampling techniques for Monte Carlo rendering", SIGGRAPH 1995.
double power_share(double a, double b) {
  if (!(b > 0.0)) {
    return 1.0;
  }
  const double ratio = b / a;
  return 1.0 / (1.0 + ratio * ratio);
}

}  // namespace

CellTracer::CellTracer(const PathTask& task)
    : task_(task), cell_sums_(task.factors, task.settings.channels, task.ids) {}

void CellTracer::trace(const Cell& cell, int first, int count, PathSums& sums) {
  cell_sums_.clear();
  for (int done = 0; done < count; done += kSamplesTogether) {
    start(cell, first + done, std::min(kSamplesTogether, count - done));
    look_at_part();
    if (!task_.settings.has_light) {
      continue;
    }
    look_at_lights(true);
    for (int r = 1; r <= task_.settings.max_reflections && !active_.empty(); ++r) {
      reflect_all(r);
      look_at_lights(false);
    }
    for (const Path& path : paths_) {
      cell_sums_.add_square(path.pixel, path.total);
    }
  }
  counts_.dropped += cell_sums_.dropped();
  cell_sums_.add_to(cell, count, sums);
}

/// Camera rays in the order 2 x 2 pixels, samples: those of a packet stay close together.
void CellTracer::start(const Cell& cell, int first, int count) {
  paths_.clear();
  rays_.clear();
  for (int block = 0; block < kCellWidth_px * kCellWidth_px / 4; ++block) {
    for (int i = 0; i < 4; ++i) {
      const int x = 2 * (block % (kCellWidth_px / 2)) + i % 2;
      const int y = 2 * (block / (kCellWidth_px / 2)) + i / 2;
      if (x < cell.width_px && y < cell.height_px) {
        start_pixel(cell, x, y, first, count);
      }
    }
  }
  const auto begin = std::chrono::steady_clock::now();
  rays_.trace(task_.scene.bvh, Coherence::kCoherent);
  counts_.camera_s += seconds_since(begin);
  counts_.camera += static_cast<std::int64_t>(rays_.size());
}

void CellTracer::start_pixel(const Cell& cell, int x, int y, int first, int count) {
  const int width_px = task_.scene.camera.intrinsics().width_px;
  const auto number = static_cast<std::uint32_t>((cell.y_px + y) * width_px + cell.x_px + x);
  const std::uint32_t seed = pixel_seed(number, static_cast<std::uint32_t>(task_.settings.seed));
  for (int sample = first; sample < first + count; ++sample) {
    Path& path = paths_.emplace_back();
    path.numbers = {.seed = seed, .index = static_cast<std::uint32_t>(sample)};
    path.pixel = static_cast<CellPixel>(kCellWidth_px * y + x);
    const auto within = path.numbers.pair(kPixelPair);
    path.ray =
        camera_ray(task_, {cell.x_px + x + within[0], cell.y_px + y + within[1]}, path.numbers);
    rays_.add(path.ray.origin_mm, path.ray.direction, kInfinity);
  }
}

/// What the camera rays met, for the pictures that need no light.
void CellTracer::look_at_part() {
  const Vector3d axis = task_.scene_from_camera.rotation.col(2);
  active_.clear();
  points_.resize(paths_.size());
  for (std::uint32_t i = 0; i < paths_.size(); ++i) {
    Path& path = paths_[i];
    active_.push_back(i);
    path.hit = rays_.hit(i);
    if (path.hit) {
      points_[i] = meet_surface(task_.scene, task_.start_offset_mm, path.ray, path.hit);
      cell_sums_.add_surface(path.pixel, points_[i], path.ray, axis, path.hit.triangle);
    }
  }
}

/// Adds the light that rays met before the part; those that go on to the part stay active.
void CellTracer::look_at_lights(bool is_camera) {
  std::size_t kept = 0;
  for (const std::uint32_t index : active_) {
    Path& path = paths_[index];
    const double reach_mm = path.hit ? static_cast<double>(path.hit.t_mm) : kInfinity;
    const auto light = hit_light(task_.scene.lights, path.ray, reach_mm);
    if (!light) {
      active_[kept] = index;
      kept += path.hit ? 1U : 0U;
      continue;
    }
    if (!(light->cosine > 0.0)) {
      continue;
    }
    const bool has_rival = !is_camera && path.density > 0.0;
    const double share =
        has_rival ? power_share(path.density, light_density(task_.scene.lights, path.ray, *light))
                  : 1.0;
    add_light(path, light->group, share * path.weight * light->radiance.cast<double>());
  }
  active_.resize(kept);
}

void CellTracer::add_light(Path& path, int group, const Colour& radiance) {
  path.total += cell_sums_.add_light(path.pixel, group, radiance);
}

void CellTracer::reflect_all(int reflection) {
  pending_.clear();
  shadows_.clear();
  std::size_t kept = 0;
  for (const std::uint32_t index : active_) {
    active_[kept] = index;
    kept += reflect(index, reflection) ? 1U : 0U;
  }
  active_.resize(kept);
  trace_shadows();
  trace_bounces();
}

/// @return whether the path goes on
bool CellTracer::reflect(std::uint32_t index, int reflection) {
  Path& path = paths_[index];
  const PhysicalScene& scene = task_.scene;
  ShadingPoint& point = points_[index];
  if (reflection > 1) {  // the first is known from look_at_part()
    point = meet_surface(scene, task_.start_offset_mm, path.ray, path.hit);
  }
  path.weight *= point.reflectance;
  const std::uint32_t pair =
      kFirstReflectionPair + kPairsPerReflection * static_cast<std::uint32_t>(reflection - 1);
  const auto reflect_by = [&](const Material& material) {
    ask_light(index, point, material, path.numbers.pair(pair));
    return leave(path, point, material, reflection, path.numbers.pair(pair + 1));
  };
  if (!scene.material.has_pattern()) {
    return reflect_by(scene.material.plain());
  }
  const RigidTransform& pose = scene.part.scene_from_part;
  return reflect_by(
      scene.material.at(pose.rotation.transpose() * (point.point_mm - pose.translation_mm)));
}

/// Light by a direction drawn towards the lights.
void CellTracer::ask_light(std::uint32_t index,
                           const ShadingPoint& point,
                           const Material& material,
                           const std::array<double, 2>& random) {
  if (std::holds_alternative<Mirror>(material)) {
    return;
  }
  const Lights& lights = task_.scene.lights;
  const auto light = sample_light(lights, point.start_mm, random[0], random[1]);
  if (!light || !(point.side.dot(light->direction) > 0.0)) {
    return;
  }
  const Reflection reflection =
      evaluate(material, point.to_viewer, point.frame.to_local(light->direction));
  const Colour radiance = paths_[index].weight * reflection.value * light->radiance.cast<double>() *
                          (power_share(light->density, reflection.density) / light->density);
  if (!(strength(radiance) > 0.0) || is_hidden(lights, point.start_mm, *light)) {
    return;
  }
  if (task_.scene.bvh.is_convex()) {
    add_light(paths_[index], light->group, radiance);
    return;
  }
  pending_.push_back({.path = index, .group = light->group, .radiance = radiance});
  shadows_.add(point.start_mm, light->direction, light->distance_mm * (1.0 - kShortOfLight));
}

/// Light by a direction drawn from the material. @return whether there is such a direction
bool CellTracer::leave(Path& path,
                       const ShadingPoint& point,
                       const Material& material,
                       int reflection,
                       const std::array<double, 2>& direction) {
  const std::uint32_t pair =
      kFirstReflectionPair + kPairsPerReflection * static_cast<std::uint32_t>(reflection - 1);
  const auto more = path.numbers.pair(pair + 2);
  const auto sampled = sample(material, point.to_viewer, {direction[0], direction[1], more[0]});
  if (!sampled) {
    return false;
  }
  path.ray = {.origin_mm = point.start_mm, .direction = point.frame.from_local(sampled->to_light)};
  path.weight *= sampled->weight;
  path.density = sampled->is_mirror ? 0.0 : sampled->density;
  if (!(point.side.dot(path.ray.direction) > 0.0) || !(strength(path.weight) > 0.0)) {
    return false;
  }
  if (reflection < task_.settings.roulette_from) {
    return true;
  }
  const double survival = std::min(1.0, strength(path.weight));
  path.weight /= survival;
  return more[1] < survival;
}

void CellTracer::trace_shadows() {
  const auto begin = std::chrono::steady_clock::now();
  shadows_.trace(task_.scene.bvh, Coherence::kCoherentOnce);
  counts_.shadow_s += seconds_since(begin);
  counts_.shadow += static_cast<std::int64_t>(shadows_.size());
  for (std::size_t i = 0; i < pending_.size(); ++i) {
    if (!shadows_.hit(i)) {
      add_light(paths_[pending_[i].path], pending_[i].group, pending_[i].radiance);
    }
  }
}

void CellTracer::trace_bounces() {
  if (task_.scene.bvh.is_convex()) {
    for (const std::uint32_t index : active_) {
      paths_[index].hit = {};
    }
    return;
  }
  rays_.clear();
  for (const std::uint32_t index : active_) {
    rays_.add(paths_[index].ray.origin_mm, paths_[index].ray.direction, kInfinity);
  }
  const auto begin = std::chrono::steady_clock::now();
  rays_.trace(task_.scene.bvh, task_.bounces);
  counts_.bounce_s += seconds_since(begin);
  counts_.bounce += static_cast<std::int64_t>(rays_.size());
  for (std::size_t i = 0; i < active_.size(); ++i) {
    paths_[active_[i]].hit = rays_.hit(i);
  }
}

}  // namespace glint
