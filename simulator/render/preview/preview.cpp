// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/preview/preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kImageBackground = 0.93;
constexpr double kSection = 0.5;  ///< where a tile's rays start inside the part
constexpr double kStain = 0.65;   ///< brightness of what has a colour but no height
constexpr double kFar_mm = 1e6;
constexpr double kShadowShare = 0.2;  ///< of a tile: neighbours throw none on what it is about
constexpr double kHalfAngle = 0.2;    ///< tangent of half the view of fitted_view()
constexpr double kMargin = 1.04;      ///< room around the part

/// What a tile shows, in extents of its defect; the nearest that its rays start, in tiles.
constexpr double kFieldAlong = 1.3;
constexpr double kFieldAcross = 1.8;
constexpr double kMinDistance = 0.12;

constexpr int kTilesInRow = 6;
constexpr int kTileGap_px = 6;

constexpr int kSamples = 4;  ///< a pixel; four pixels make a packet

/// Where in a pixel the four rays pass: a turned square, so that no two share a row or column.
constexpr std::array<std::array<double, 2>, kSamples> kOffsets = {
    {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}};

/// Towards the lamp, in the camera frame: from the upper left behind the camera. One for each ray
/// of a pixel, so that shadows have soft edges.
constexpr std::array<std::array<double, 3>, kSamples> kLamps = {
    {{-0.32, -0.60, -0.85}, {-0.20, -0.66, -0.85}, {-0.24, -0.52, -0.95}, {-0.40, -0.56, -0.80}}};

/// Pixels of the four rays of sixteen: two by two.
constexpr int column_of(int lane) {
  return (lane / kSamples) % 2;
}

constexpr int row_of(int lane) {
  return lane / (2 * kSamples);
}

/// The lane's numbers in a packet.
struct Lane {
  Vector3d point_mm = Vector3d::Zero();
  Vector3d normal = Vector3d::UnitZ();  ///< towards the camera
  Vector3d towards = Vector3d::UnitZ();
  bool is_hit = false;
  bool is_section = false;
  bool is_defect = false;
  bool is_stained = false;
};

class Drawing {
 public:
  Drawing(const PreviewSubject& subject, const PreviewView& view)
      : subject_(subject),
        camera_(view.intrinsics),
        pixel_mm_(view.pixel_mm),
        shadow_mm_(view.pixel_mm > 0.0 ? kShadowShare * view.pixel_mm * view.intrinsics.width_px
                                       : kFar_mm),
        world_from_camera_(inverse(view.camera_from_world)) {
    for (const HeightFeature& feature : subject.detail.features()) {
      if (feature.height_mm == 0.0) {
        stains_.insert(feature.id);
      }
    }
    const int width = view.intrinsics.width_px;
    const int height = view.intrinsics.height_px;
    pictures_ = {.image = ImageF(width, height), .map = ImageF(width, height)};
  }

  int num_bands() const { return (pictures_.image.height() + 1) / 2; }

  /// Two rows of pixels.
  void draw_band(int band) {
    for (int x = 0; x < pictures_.image.width(); x += 2) {
      draw_block(x, 2 * band);
    }
  }

  PreviewPictures take() { return std::move(pictures_); }

 private:
  Ray ray_of(const Vector2d& pixel) const {
    if (pixel_mm_ > 0.0) {
      const Vector2d at = (pixel - camera_.intrinsics().center_px) * pixel_mm_;
      return {.origin_mm = world_from_camera_ * Vector3d(at.x(), at.y(), 0.0),
              .direction = world_from_camera_.rotation.col(2)};
    }
    const Vector3d in_camera = camera_.ray_through(pixel).value_or(Vector3d::Zero());
    return {.origin_mm = world_from_camera_.translation_mm,
            .direction = world_from_camera_.rotation * in_camera};
  }

  static void set_ray(
      RayPacket& rays, std::size_t lane, const Ray& ray, double t_min_mm, double t_max_mm) {
    rays.origin_x[lane] = static_cast<float>(ray.origin_mm.x());
    rays.origin_y[lane] = static_cast<float>(ray.origin_mm.y());
    rays.origin_z[lane] = static_cast<float>(ray.origin_mm.z());
    rays.direction_x[lane] = static_cast<float>(ray.direction.x());
    rays.direction_y[lane] = static_cast<float>(ray.direction.y());
    rays.direction_z[lane] = static_cast<float>(ray.direction.z());
    rays.t_min[lane] = static_cast<float>(t_min_mm);
    rays.t_max[lane] = static_cast<float>(t_max_mm);
    rays.valid[lane] = ray.direction.isZero() ? 0 : -1;
  }

  Lane intersect(const Ray& ray, const HitPacket& hits, std::size_t lane) const {
    Lane met;
    const Hit hit = {.t_mm = hits.t_mm[lane],
                     .triangle = hits.triangle[lane],
                     .u = hits.u[lane],
                     .v = hits.v[lane]};
    met.is_hit = static_cast<bool>(hit);
    if (!met.is_hit) {
      return met;
    }
    const auto triangle = static_cast<std::size_t>(hit.triangle);
    met.point_mm = hit_point(subject_.mesh, hit);
    met.towards = ray.direction;
    met.normal = shading_normal(subject_.mesh, hit);
    met.is_defect = !subject_.labels.empty() && subject_.labels[triangle] != 0;
    if (!subject_.detail.empty()) {
      const SurfaceDetail::Sample sample = subject_.detail.sample(met.point_mm, met.normal);
      met.normal = detailed_normal(met.normal, sample.gradient, ray.direction);
      const bool is_inside = sample.feature >= 0 && sample.normalised_distance <= 1.0;
      met.is_defect = met.is_defect || is_inside;
      met.is_stained = is_inside && stains_.contains(sample.feature);
    }
    met.is_section =
        pixel_mm_ > 0.0 && geometric_normal(subject_.mesh, hit).dot(ray.direction) > 0.0;
    if (met.normal.dot(ray.direction) > 0.0) {
      met.normal = -met.normal;  // the inside of an open part
    }
    return met;
  }

  Vector3d lamp_of(int lane) const {
    const auto& lamp = kLamps[static_cast<std::size_t>(lane % kSamples)];
    return world_from_camera_.rotation * Vector3d(lamp[0], lamp[1], lamp[2]).normalized();
  }

  /// Lambert's lamp with its shadow, a sky, and soft stripes in the mirrored direction: a slope of
  /// a few degrees shows.
  double shade(const Lane& lane, const Vector3d& lamp, bool is_shadowed) const {
    const Vector3d up = -world_from_camera_.rotation.col(1);
    const Vector3d mirrored = lane.towards - 2.0 * lane.towards.dot(lane.normal) * lane.normal;
    const bool is_tile = pixel_mm_ > 0.0;  // small slopes are to show here
    const double stripes = 0.5 + 0.5 * std::sin((is_tile ? 14.0 : 9.0) * mirrored.dot(up));
    const double sky = 0.5 + 0.5 * lane.normal.dot(up);
    const double lit = is_shadowed ? 0.0 : std::max(0.0, lane.normal.dot(lamp));
    const double facing = std::max(0.0, -lane.normal.dot(lane.towards));
    const double grey = 0.06 + 0.08 * sky + 0.24 * facing + 0.42 * lit +
                        (is_tile ? 0.22 : 0.16) * stripes * (is_shadowed ? 0.4 : 1.0);
    return lane.is_stained ? kStain * grey : grey;
  }

  void draw_block(int x, int y) {
    std::array<Ray, kPacketSize> rays;
    RayPacket packet;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const auto& offset = kOffsets[static_cast<std::size_t>(lane % kSamples)];
      const auto i = static_cast<std::size_t>(lane);
      rays[i] = ray_of(Vector2d(x + column_of(lane) + offset[0], y + row_of(lane) + offset[1]));
      set_ray(packet, i, rays[i], 0.0, kFar_mm);
    }
    HitPacket hits;
    subject_.bvh.intersect16(packet, hits, Coherence::kCoherent);
    std::array<Lane, kPacketSize> lanes;
    RayPacket shadows;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      lanes[i] = intersect(rays[i], hits, i);
      const double off_mm = 1e-5 * (rays[i].origin_mm - lanes[i].point_mm).norm() + 1e-4;
      set_ray(shadows,
              i,
              {.origin_mm = lanes[i].point_mm + off_mm * lanes[i].normal,
               .direction = lanes[i].is_hit ? lamp_of(lane) : Vector3d::Zero()},
              off_mm,
              shadow_mm_);
    }
    HitPacket shadowed;
    subject_.bvh.intersect16(shadows, shadowed, Coherence::kIncoherent);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      add(x + column_of(lane),
          y + row_of(lane),
          lanes[static_cast<std::size_t>(lane)],
          lamp_of(lane),
          shadowed.triangle[static_cast<std::size_t>(lane)] >= 0);
    }
  }

  void add(int x, int y, const Lane& lane, const Vector3d& lamp, bool is_shadowed) {
    if (x >= pictures_.image.width() || y >= pictures_.image.height()) {
      return;
    }
    double grey = kImageBackground;
    if (lane.is_hit) {
      grey = lane.is_section ? kSection : shade(lane, lamp, is_shadowed);
    }
    const float part = lane.is_defect ? 1.0F : 0.0F;
    pictures_.image(x, y) += static_cast<float>(grey / kSamples);
    pictures_.map(x, y) += (lane.is_hit ? part : kMapBackground) / kSamples;
  }

  PreviewSubject subject_;
  PinholeCamera camera_;
  double pixel_mm_;
  double shadow_mm_;
  RigidTransform world_from_camera_;
  std::set<int> stains_;
  PreviewPictures pictures_;
};

/// Digits of three by five pixels, a bit each, row by row.
constexpr std::array<std::uint16_t, 10> kDigits = {0b111101101101111,
                                                   0b010110010010111,
                                                   0b111001111100111,
                                                   0b111001111001111,
                                                   0b101101111001001,
                                                   0b111100111001111,
                                                   0b111100111101111,
                                                   0b111001001001001,
                                                   0b111101111101111,
                                                   0b111101111001111};
constexpr int kDigitScale = 3;

void draw_digit(ImageF& image, int digit, int left, int top) {
  for (int row = -1; row <= 5; ++row) {
    for (int column = -1; column <= 3; ++column) {
      const bool is_inside = row >= 0 && row < 5 && column >= 0 && column < 3;
      const unsigned bits = kDigits[static_cast<std::size_t>(digit)];
      const bool is_ink = is_inside && ((bits >> (14 - 3 * row - column)) & 1U) != 0;
      for (int i = 0; i < kDigitScale * kDigitScale; ++i) {
        const int x = left + kDigitScale * column + i % kDigitScale;
        const int y = top + kDigitScale * row + i / kDigitScale;
        image(x, y) = is_ink ? 1.0F : 0.0F;
      }
    }
  }
}

void draw_number(ImageF& image, int number, int left, int top) {
  for (const char digit : std::to_string(number)) {
    draw_digit(image, digit - '0', left + kDigitScale, top + kDigitScale);
    left += 4 * kDigitScale;
  }
}

/// Looking along a direction, the world's z axis upwards in the picture.
RigidTransform looking(const Vector3d& from_mm, const Vector3d& towards) {
  return camera_from_world({.position_mm = {from_mm.x(), from_mm.y(), from_mm.z()},
                            .direction = {towards.x(), towards.y(), towards.z()},
                            .up = {0.0, 0.0, 1.0}});
}

}  // namespace

PreviewPictures draw_preview(const PreviewSubject& subject,
                             const PreviewView& view,
                             ThreadPool& pool) {
  Drawing drawing(subject, view);
  pool.for_each(drawing.num_bands(),
                [&](std::int64_t band) { drawing.draw_band(static_cast<int>(band)); });
  return drawing.take();
}

PreviewView camera_view(const CameraSettings& camera, const Viewpoint& viewpoint) {
  PinholeIntrinsics intrinsics = intrinsics_of(camera);
  const double scale =
      static_cast<double>(kPreviewSide_px) / std::max(intrinsics.width_px, intrinsics.height_px);
  const auto scaled = [&](int size) {
    return std::max(1, static_cast<int>(std::lround(scale * size)));
  };
  intrinsics.width_px = scaled(intrinsics.width_px);
  intrinsics.height_px = scaled(intrinsics.height_px);
  intrinsics.focal_px *= scale;
  intrinsics.center_px *= scale;
  return {.camera_from_world = camera_from_world(viewpoint), .intrinsics = intrinsics};
}

PreviewView fitted_view(const TriangleMesh& mesh, const Vector3d& towards, int longest_side_px) {
  const BoundingBox box = bounding_box(mesh);
  const Vector3d view = towards.normalized();
  const double distance_mm = 0.5 * box.size_mm().norm() / kHalfAngle;
  const RigidTransform pose = looking(box.centre_mm() - distance_mm * view, view);
  Vector2d low = Vector2d::Constant(1e300);
  Vector2d high = -low;
  for (const Vector3d& vertex_mm : mesh.vertices_mm) {
    const Vector3d p = pose * vertex_mm;
    const Vector2d at = p.head<2>() / p.z();
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  const Vector2d size = kMargin * (high - low).cwiseMax(1e-9);
  const double focal_px = longest_side_px / size.maxCoeff();
  const auto pixels = [&](double length) {
    return std::max(1, static_cast<int>(std::lround(focal_px * length)));
  };
  const int width = pixels(size.x());
  const int height = pixels(size.y());
  return {.camera_from_world = pose,
          .intrinsics = {
              .width_px = width,
              .height_px = height,
              .focal_px = {focal_px, focal_px},
              .center_px = Vector2d(0.5 * width, 0.5 * height) - 0.5 * focal_px * (low + high)}};
}

std::vector<PreviewView> automatic_views(const TriangleMesh& mesh) {
  return {fitted_view(mesh, {-0.62, 0.58, -0.53}), fitted_view(mesh, {0.62, -0.58, 0.53})};
}

PreviewView place_view(const Bvh& bvh, const SurfacePlace& place, const PlaceExtent& extent) {
  const double field_mm = std::max(kFieldAlong * extent.along_mm, kFieldAcross * extent.across_mm);
  const double over_mm = 1.1 * extent.height_mm + 0.01 * field_mm;
  double distance_mm = field_mm;
  constexpr int kHalf = 3;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int j = -kHalf; j <= kHalf; ++j) {
      const Vector3d from_mm = place.centre_mm + over_mm * place.normal +
                               0.5 * i / kHalf * extent.along_mm * place.u_axis +
                               0.5 * j / kHalf * extent.across_mm * place.v_axis;
      if (const Hit roof = bvh.intersect(from_mm, place.normal, 0.0, distance_mm)) {
        distance_mm = static_cast<double>(roof.t_mm);
      }
    }
  }
  distance_mm = over_mm + std::max(0.9 * distance_mm, kMinDistance * field_mm);
  RigidTransform world_from_camera;
  world_from_camera.rotation.col(0) = place.u_axis;
  world_from_camera.rotation.col(1) = -place.v_axis;
  world_from_camera.rotation.col(2) = -place.normal;
  world_from_camera.translation_mm = place.centre_mm + distance_mm * place.normal;
  const double half_px = 0.5 * kTileSide_px;
  return {.camera_from_world = inverse(world_from_camera),
          .intrinsics = {.width_px = kTileSide_px,
                         .height_px = kTileSide_px,
                         .focal_px = {half_px, half_px},
                         .center_px = {half_px, half_px}},
          .pixel_mm = field_mm / kTileSide_px};
}

ImageF contact_sheet(const std::vector<ImageF>& tiles, const std::vector<int>& numbers) {
  const int count = static_cast<int>(tiles.size());
  const int columns = std::clamp(count, 1, kTilesInRow);
  const int rows = std::max(1, (count + kTilesInRow - 1) / kTilesInRow);
  const int step = kTileSide_px + kTileGap_px;
  ImageF sheet(columns * step + kTileGap_px, rows * step + kTileGap_px, 1.0F);
  for (int i = 0; i < count; ++i) {
    const ImageF& tile = tiles[static_cast<std::size_t>(i)];
    const int left = kTileGap_px + (i % kTilesInRow) * step;
    const int top = kTileGap_px + (i / kTilesInRow) * step;
    const int indent_x = std::max(0, (kTileSide_px - tile.width()) / 2);
    const int indent_y = std::max(0, (kTileSide_px - tile.height()) / 2);
    for (int y = 0; y < kTileSide_px; ++y) {
      std::fill_n(sheet.row(top + y) + left, kTileSide_px, static_cast<float>(kImageBackground));
    }
    for (int y = 0; y < std::min(tile.height(), kTileSide_px); ++y) {
      std::copy_n(tile.row(y),
                  std::min(tile.width(), kTileSide_px),
                  sheet.row(top + indent_y + y) + left + indent_x);
    }
    if (const int number = numbers[static_cast<std::size_t>(i)]; number > 0) {
      draw_number(sheet, number, left, top);
    }
  }
  return sheet;
}

}  // namespace glint
