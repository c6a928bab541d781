// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/places/place_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "simulator/render/path_tracing/surface_point.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/path_picture.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFar_mm = 1e6;
constexpr int kFactor = 4;  ///< by which the picture has fewer pixels

/// A mirror under a tunnel, at the positions of the scan.
class MirrorPlaces {
 public:
  MirrorPlaces(const SceneSettings& scene, const BuiltPart& built, const Viewpoint& viewpoint)
      : scene_(scene),
        built_(built),
        tunnel_(scene.tunnel),
        camera_mm_(inverse(camera_from_world(viewpoint)).translation_mm),
        offset_mm_(start_offset_mm(built.part) + scene.part.chord_tolerance_mm()),
        factor_(scene.sensor.exposure * scene.sensor.gain * scene.render.reflectance) {
    const double step_mm = scan_step_mm(scene.scan, scene.tunnel);
    for (int k = 0; k < scene.scan.positions; ++k) {
      shifts_mm_.push_back(k * step_mm);
      patterns_.push_back(tunnel_.pattern(k * step_mm));
    }
  }

  PlaceLight light(const SeenPlace& place) const {
    const Vector3d start_mm = place.point_mm + offset_mm_ * place.normal;
    const Vector3d to_camera = camera_mm_ - start_mm;
    const double distance_mm = to_camera.norm();
    const Vector3d towards = -to_camera / distance_mm;
    const Ray mirrored = {.origin_mm = start_mm,
                          .direction = towards - 2.0 * towards.dot(place.normal) * place.normal};
    const auto wall = met_wall(mirrored);
    const auto in_the_way = tunnel_.settings().blocks_view
                                ? tunnel_.hit({.origin_mm = start_mm, .direction = -towards})
                                : std::optional<WallHit>();
    const bool is_in_front = in_the_way && in_the_way->t_mm < distance_mm;
    PlaceLight result = {.lit_share = 0.0, .is_hidden = true};
    for (std::size_t k = 0; k < shifts_mm_.size(); ++k) {
      const bool is_blocked = is_in_front && is_between_ends(*in_the_way, k);
      double grey = 0.0;
      result.is_hidden = result.is_hidden && is_blocked;
      if (wall && !is_blocked && is_between_ends(*wall, k)) {
        grey = factor_ * radiance(mirrored, k);
        result.lit_share += 1.0;
      }
      result.mean += grey;
      result.darkest = k == 0 ? grey : std::min(result.darkest, grey);
    }
    const auto positions = static_cast<double>(shifts_mm_.size());
    result.lit_share /= positions;
    const double dark = dark_grey(scene_.sensor);
    result.mean = result.mean / positions + dark;
    result.darkest += dark;
    return result;
  }

 private:
  std::optional<WallHit> met_wall(const Ray& ray) const {
    return built_.bvh->occluded(ray.origin_mm, ray.direction, 0.0, kFar_mm) ? std::nullopt
                                                                            : tunnel_.hit(ray);
  }

  bool is_between_ends(const WallHit& hit, std::size_t position) const {
    return std::abs(hit.point_mm.x() - shifts_mm_[position]) < 0.5 * scene_.tunnel.length_mm;
  }

  double radiance(const Ray& ray, std::size_t position) const {
    const auto floats = [](const Vector3d& v) {
      return std::array{
          static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
    };
    const auto origin = floats(ray.origin_mm);
    const auto direction = floats(ray.direction);
    const RayBlock block = {.origin_x = &origin[0],
                            .origin_y = &origin[1],
                            .origin_z = &origin[2],
                            .direction_x = &direction[0],
                            .direction_y = &direction[1],
                            .direction_z = &direction[2],
                            .count = 1};
    float x_mm = 0.0F;
    float pattern_mm = 0.0F;
    float gain = 0.0F;
    float sum = 0.0F;
    tunnel_.hit_block(block, &x_mm, &pattern_mm, &gain);
    add_stripes(&x_mm, &pattern_mm, &gain, 1, patterns_[position], 1.0F, &sum);
    return static_cast<double>(sum);
  }

  const SceneSettings& scene_;
  const BuiltPart& built_;
  Tunnel tunnel_;
  Vector3d camera_mm_;
  double offset_mm_;
  double factor_;  ///< from radiance to grey values
  std::vector<double> shifts_mm_;
  std::vector<StripePattern> patterns_;
};

/// The scene without defects and from one viewpoint, with fewer and larger pixels. Where
/// reflections are summed around kept rays the material decides: rough metal spreads light, and no
/// ray of a mirror tells what it shows.
SceneSettings coarse(const SceneSettings& whole, const Viewpoint& viewpoint, int samples) {
  SceneSettings scene = without_blurred_method(whole);
  const PinholeIntrinsics in = intrinsics_of(scene);
  CameraSettings& camera = scene.camera;
  camera.width_px = (in.width_px + kFactor - 1) / kFactor;
  camera.height_px = (in.height_px + kFactor - 1) / kFactor;
  camera.pixel_mm *= kFactor;
  camera.object_pixel_mm *= kFactor;
  camera.focal_x_px /= kFactor;
  camera.focal_y_px /= kFactor;
  camera.center_x_px = in.center_px.x() / kFactor;
  camera.center_y_px = in.center_px.y() / kFactor;
  scene.defects.clear();
  scene.viewpoint_set = {};
  scene.viewpoints = {viewpoint};
  scene.paths.samples = samples;
  scene.paths.batches = 1;
  scene.paths.relative_error = 0.0;
  scene.paths.has_light = true;
  return scene;
}

/// A small picture of the part, and what of it belongs to a place.
class PicturedPlaces {
 public:
  /// @param scene  coarse(): with few pixels; view  path_view_of() it
  PicturedPlaces(const SceneSettings& scene, std::unique_ptr<const PathView> view, ThreadPool& pool)
      : camera_from_world_(camera_from_world(scene.viewpoint())),
        sensor_(scene.sensor),
        pixel_px_(intrinsics_of(scene).focal_px.minCoeff()),
        offset_mm_(start_offset_mm(view->physical().part)),
        view_(std::move(view)) {
    PathPicture picture = render_view(*view_, path_settings(scene), pool);
    for (const FrameFactors& factors : picture.frames) {
      frames_.push_back(frame_radiance(picture, factors));
    }
    film_ = std::move(picture.sums);
    film_.groups.clear();
  }

  PlaceLight light(const SeenPlace& place) const {
    PlaceLight result = {.is_hidden = is_hidden(place)};
    const std::vector<std::size_t> pixels = pixels_of(place);
    for (const ImageF& frame : frames_) {
      double sum = 0.0;
      for (const std::size_t pixel : pixels) {
        sum += static_cast<double>(frame.values()[pixel]);
      }
      const double grey =
          sensor_.exposure * sensor_.gain * sum / static_cast<double>(pixels.size());
      result.mean += grey / static_cast<double>(frames_.size());
      result.darkest = &frame == frames_.data() ? grey : std::min(result.darkest, grey);
    }
    const double dark = dark_grey(sensor_);
    result.mean += dark;
    result.darkest += dark;
    return result;
  }

 private:
  bool is_hidden(const SeenPlace& place) const {
    const Vector3d camera_mm = inverse(camera_from_world_).translation_mm;
    const Vector3d start_mm = place.point_mm + offset_mm_ * place.normal;
    const Vector3d to_camera = camera_mm - start_mm;
    const double distance_mm = to_camera.norm();
    return hit_light(view_->physical().lights,
                     {.origin_mm = camera_mm, .direction = -to_camera / distance_mm},
                     distance_mm)
        .has_value();
  }

  /// Of 3 x 3 pixels those that show that surface alone; the nearest where none does.
  std::vector<std::size_t> pixels_of(const SeenPlace& place) const {
    constexpr double kReach_px = 4.0;
    const int width = film_.width_px;
    const int height = film_.height_px;
    const int x = std::clamp(static_cast<int>(place.pixel_px.x() / kFactor), 0, width - 1);
    const int y = std::clamp(static_cast<int>(place.pixel_px.y() / kFactor), 0, height - 1);
    const double reach_mm = kReach_px * (camera_from_world_ * place.point_mm).z() / pixel_px_;
    const auto index = [&](int column, int row) {
      return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(column);
    };
    std::vector<std::size_t> pixels;
    for (int row = std::max(0, y - 1); row <= std::min(height - 1, y + 1); ++row) {
      for (int column = std::max(0, x - 1); column <= std::min(width - 1, x + 1); ++column) {
        if (shows(index(column, row), place, reach_mm)) {
          pixels.push_back(index(column, row));
        }
      }
    }
    if (pixels.empty()) {
      pixels.push_back(index(x, y));
    }
    return pixels;
  }

  bool shows(std::size_t pixel, const SeenPlace& place, double reach_mm) const {
    const std::int32_t on_part = film_.part.values()[pixel];
    if (on_part == 0 || on_part < film_.samples.values()[pixel]) {
      return false;
    }
    const Vector3d mean_mm =
        vector_of(
            film_.x_mm.values()[pixel], film_.y_mm.values()[pixel], film_.z_mm.values()[pixel]) /
        on_part;
    const Vector3d normal = vector_of(film_.normal_x.values()[pixel],
                                      film_.normal_y.values()[pixel],
                                      film_.normal_z.values()[pixel]) /
                            on_part;
    constexpr double kMinCosine = 0.9;
    return (mean_mm - place.point_mm).norm() < reach_mm && normal.dot(place.normal) > kMinCosine;
  }

  RigidTransform camera_from_world_;
  SensorSettings sensor_;
  double pixel_px_;  ///< focal length in small pixels
  double offset_mm_;
  std::unique_ptr<const PathView> view_;
  Film film_;
  std::vector<ImageF> frames_;
};

template <class Places>
std::vector<PlaceLight> light_of_each(const Places& lit,
                                      std::span<const SeenPlace> places,
                                      ThreadPool& pool) {
  constexpr std::size_t kChunk = 1024;
  std::vector<PlaceLight> lights(places.size());
  pool.for_each(static_cast<std::int64_t>((places.size() + kChunk - 1) / kChunk),
                [&](std::int64_t chunk) {
                  const std::size_t begin = static_cast<std::size_t>(chunk) * kChunk;
                  for (std::size_t i = begin; i < std::min(places.size(), begin + kChunk); ++i) {
                    lights[i] = lit.light(places[i]);
                  }
                });
  return lights;
}

}  // namespace

std::vector<PlaceLight> light_of_places(SceneStore& store,
                                        const SceneSettings& scene,
                                        const Viewpoint& viewpoint,
                                        std::span<const SeenPlace> places,
                                        int samples) {
  const SceneSettings small = coarse(scene, viewpoint, samples);
  if (auto view = path_view_of(small, store.build_defects(small))) {
    return light_of_each(
        PicturedPlaces(small, std::move(view), store.pool()), places, store.pool());
  }
  const auto built = store.build(scene);
  return light_of_each(MirrorPlaces(scene, *built, viewpoint), places, store.pool());
}

}  // namespace glint
