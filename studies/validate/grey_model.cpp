// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/grey_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/image/image_io.h"
#include "hardware/calibration/lens_vector.h"
#include "simulator/sensor/rounding.h"
#include "simulator/sensor/sensor.h"
#include "studies/compare/camera/reduced_scene.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/imaging/path_warnings.h"
#include "studies/run/render_files.h"
#include "studies/validate/even_sums.h"
#include "studies/validate/geometry_fit.h"
#include "studies/validate/real_pictures.h"
#include "studies/validate/validated_scene.h"

namespace glint::validate_detail {
namespace {

constexpr int kWidthPx = 96;      ///< of the small pictures, about
constexpr int kMarginPx = 1;      ///< from the part's edge
constexpr float kBright = 0.98F;  ///< at least: clipped
constexpr int kMinSamples = 48;
constexpr int kFiner = 6;  ///< times the samples of fine pictures
constexpr double kNoiseSigmas = 2.0;
constexpr double kRounded =
    100.0;  ///< times what rounding may do: a design that is darker counts less
constexpr double kSamePosePx = 0.15;  ///< of these pictures: less is not seen

void change_camera(SceneSettings& scene, const CameraChange& change, int factor) {
  if (!change.motion.isZero()) {
    const RigidTransform pose = camera_from_world(scene.viewpoint());
    scene.viewpoints = {viewpoint_of_pose(inverse(moved_by(change.motion)) * pose)};
  }
  if (!change.lens.isZero()) {
    const PinholeIntrinsics in = intrinsics_of(scene);
    LensVector lens = lens_vector(in) + change.lens;
    lens.head<4>() -= (1.0 - 1.0 / factor) * change.lens.head<4>();
    put_intrinsics(intrinsics_from(lens, in.width_px, in.height_px), scene);
  }
}

}  // namespace

GreyModel::GreyModel(SceneStore& store, std::span<const GreyDesign> designs) : store_(store) {
  for (std::size_t d = 0; d < designs.size(); ++d) {
    designs_.push_back(designs[d].name);
    add_views(d, designs[d]);
  }
  choose_pixels();
  use_shares();
  keep_rounding();
}

void GreyModel::add_views(std::size_t design, const GreyDesign& views) {
  for (const GreyView& view : views.views) {
    const int factor = std::max(1, (view.real.width() + kWidthPx / 2) / kWidthPx);
    SmallView small = {
        .design = design,
        .scene = reduced_scene(with_separate_segments(view.scene), factor, kMinSamples),
        .real = reduce(view.real, factor),
        .sensor = view.scene.sensor,
        .step = view.step > 0.0 ? view.step : camera_step(view.real, view.scene.sensor.bits),
        .factor = factor,
        .pose = view.pose};
    take_shared_pose(small);
    for (const LitLight& light : lights_with_bodies(small.scene)) {
      if (std::ranges::find(lights_, light.name, &LitLight::name) == lights_.end()) {
        lights_.push_back(light);
      }
    }
    views_.push_back(std::move(small));
  }
}

/// Views of designs that differ in nothing but what shines are one rendering, where their poses
/// differ by less than these small pictures show.
void GreyModel::take_shared_pose(SmallView& view) const {
  const RigidTransform pose = camera_from_world(view.scene.viewpoint());
  const double focal_px = intrinsics_of(view.scene).focal_px.x();
  const double distance_mm = std::max(pose.translation_mm.norm(), 1.0);
  for (const SmallView& other : views_) {
    const RigidTransform apart = pose * inverse(camera_from_world(other.scene.viewpoint()));
    const double turn_rad = Eigen::AngleAxisd(apart.rotation).angle();
    const double shift_mm = (inverse(pose).translation_mm -
                             inverse(camera_from_world(other.scene.viewpoint())).translation_mm)
                                .norm();
    if (other.design != view.design && turn_rad * focal_px < kSamePosePx &&
        shift_mm * focal_px / distance_mm < kSamePosePx) {
      view.scene.viewpoints = other.scene.viewpoints;
      return;
    }
  }
}

void GreyModel::choose_pixels() {
  std::vector<double> real;
  rows_.resize(designs_.size());
  for (SmallView& view : views_) {
    view.used = sound_part(store_.picture(view.scene)->sums, kMarginPx);
    view.groups = SceneLamps(view.scene, store_.build_defects(view.scene)).group_names();
    ++renders_;
    for (std::size_t i = 0; i < view.used.size(); ++i) {
      const float grey = view.real.values()[i];
      view.used.values()[i] = view.used.values()[i] != 0 && grey < kBright ? 1 : 0;
      if (view.used.values()[i] != 0) {
        real.push_back(static_cast<double>(grey));
        ++rows_[view.design].count;
      }
    }
  }
  real_ = Eigen::Map<const Eigen::VectorXd>(real.data(), static_cast<Eigen::Index>(real.size()));
}

/// By which rounding may change grey values of that size.
double GreyModel::largest_rounding(std::size_t design, double grey) const {
  double largest = 0.0;
  for (const SmallView& view : views_) {
    if (view.design == design) {
      largest = std::max(largest, largest_rounding_bias(grey_noise(view.sensor, grey), view.step));
    }
  }
  return largest;
}

/// Bright and dark designs count alike, as far as rounding leaves their grey values.
void GreyModel::use_shares() {
  Eigen::Index first = 0;
  for (std::size_t d = 0; d < rows_.size(); ++d) {
    GreyRows& rows = rows_[d];
    rows.first = first;
    first += rows.count;
    auto values = real_.segment(rows.first, rows.count);
    means_.push_back(rows.count > 0 ? std::max(values.mean(), 1e-6) : 1.0);
    units_.push_back(std::max(means_.back(), kRounded * largest_rounding(d, means_.back())));
    values /= units_.back();
  }
}

bool GreyModel::can_change_roughness() const {
  return std::ranges::any_of(
      views_, [](const SmallView& view) { return view.scene.material.roughness > 0.0; });
}

Eigen::Index GreyModel::first_segment(std::size_t light) const {
  Eigen::Index first = 0;
  for (std::size_t l = 0; l < light; ++l) {
    first += lights_[l].segments > 1 ? lights_[l].segments : 0;
  }
  return first;
}

/// "ring.0" of each segment; lights of one segment have none.
std::vector<std::string> GreyModel::column_names() const {
  std::vector<std::string> names;
  for (const LitLight& light : lights_) {
    for (int i = 0; light.segments > 1 && i < light.segments; ++i) {
      names.push_back(fmt::format("{}.{}", light.name, i));
    }
  }
  return names;
}

/// Grey of each of these groups, and last of all together, without the other half of the samples.
std::vector<ImageF> GreyModel::group_pictures(const SmallView& view,
                                              const SceneSettings& scene,
                                              const std::vector<std::string>& names,
                                              std::size_t half) {
  const auto picture = store_.picture(scene);
  const auto without = picture->batches.empty() ? std::nullopt : std::optional(1 - half);
  const std::vector<FrameFactors> frames = frame_factors(scene, picture->unit_power_w);
  const FrameFactors whole = mean_factors(frames);
  const Sensor sensor(scene.sensor, picture->sums.width_px, picture->sums.height_px);
  const auto shown = [&](const FrameFactors& factors) {
    ImageF grey;
    sensor.expose(frame_radiance(*picture, factors, without), 0, grey);
    return grey;
  };
  std::vector<ImageF> pictures;
  for (const std::string& name : names) {
    FrameFactors one = whole;
    for (std::size_t g = 0; g < view.groups.size(); ++g) {
      if (view.groups[g] != name) {
        one[g] = Colour::Zero();
      }
    }
    pictures.push_back(shown(one));
  }
  pictures.push_back(shown(whole));
  return pictures;
}

void GreyModel::put_columns(const SmallView& view,
                            const std::vector<ImageF>& pictures,
                            Eigen::Index first,
                            GreyColumns& columns) const {
  const double unit = units_[view.design];
  Eigen::Index row = first;
  for (std::size_t i = 0; i < view.used.size(); ++i) {
    if (view.used.values()[i] == 0) {
      continue;
    }
    for (std::size_t g = 0; g + 1 < pictures.size(); ++g) {
      columns.segments(row, static_cast<Eigen::Index>(g)) =
          static_cast<double>(pictures[g].values()[i]) / unit;
    }
    columns.sum[row] = static_cast<double>(pictures.back().values()[i]) / unit;
    ++row;
  }
}

Halves<GreyColumns> GreyModel::render(const SceneChange& change,
                                      bool is_fine,
                                      const CameraChange& camera) {
  const std::vector<std::string> names = column_names();
  Halves<GreyColumns> columns;
  for (GreyColumns& half : columns) {
    half.sum.resize(real_.size());
    half.segments.resize(real_.size(), static_cast<Eigen::Index>(names.size()));
  }
  Eigen::Index row = 0;
  for (const SmallView& view : views_) {
    SceneSettings scene = changed_scene(view.scene, change);
    change_camera(scene, camera, view.factor);
    if (is_fine) {
      scene.paths.samples *= kFiner;
      ++scene.paths.seed;
    }
    for (std::size_t half = 0; half < 2; ++half) {
      put_columns(view, group_pictures(view, scene, names, half), row, columns[half]);
    }
    row += std::ranges::count_if(view.used.values(), [](unsigned char used) { return used != 0; });
    ++renders_;
  }
  return columns;
}

SceneChange GreyModel::change_of(const std::vector<Eigen::Vector3d>& places_mm,
                                 double roughness) const {
  SceneChange change = {.roughness = roughness};
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    change.lights.push_back({.name = lights_[i].name, .moved_mm = places_mm[i]});
  }
  return change;
}

Halves<GreyColumns> GreyModel::columns_by(const CameraChange& camera,
                                          const std::vector<Eigen::Vector3d>& places_mm,
                                          double roughness) {
  return render(change_of(places_mm, roughness), false, camera);
}

std::vector<ViewRows> GreyModel::view_rows() const {
  std::vector<ViewRows> all;
  Eigen::Index first = 0;
  for (const SmallView& view : views_) {
    const Eigen::Index count =
        std::ranges::count_if(view.used.values(), [](unsigned char used) { return used != 0; });
    all.push_back({.rows = {.first = first, .count = count}, .pose = view.pose});
    first += count;
  }
  return all;
}

GreyModel::ColumnsPointer GreyModel::columns(const std::vector<Eigen::Vector3d>& places_mm,
                                             double roughness,
                                             bool is_fine) {
  const SceneChange change = change_of(places_mm, roughness);
  std::string key = fmt::format("{:.6f}{}", roughness, is_fine ? " fine" : "");
  for (const Eigen::Vector3d& place : places_mm) {
    key += fmt::format(" {:.4f} {:.4f} {:.4f}", place.x(), place.y(), place.z());
  }
  return kept_.get(key, [&] { return render(change, is_fine); });
}

/// Half a step in units of a design, where rounding may hide as much of it; else 0.
double GreyModel::hidden_share(std::size_t design) const {
  double step = 0.0;
  for (const SmallView& view : views_) {
    step = std::max(step, view.design == design ? view.step : 0.0);
  }
  return rounding_[design] > kMaxRounding ? 0.5 * step / units_[design] : 0.0;
}

double GreyModel::even_rms(const Eigen::VectorXd& difference, std::size_t design) const {
  const double unit = units_[design];
  EvenSums sums;
  EvenSums rounding;
  Eigen::Index row = rows_[design].first;
  for (const SmallView& view : views_) {
    if (view.design != design) {
      continue;
    }
    ImageF values(view.used.width(), view.used.height());
    ImageF biases(view.used.width(), view.used.height());
    for (std::size_t i = 0; i < view.used.size(); ++i) {
      if (view.used.values()[i] != 0) {
        const double grey = unit * (real_[row] - difference[row]);
        const double bias = rounding_bias(grey, grey_noise(view.sensor, grey), view.step);
        values.values()[i] = static_cast<float>(difference[row++]);
        biases.values()[i] = static_cast<float>(bias / unit);
      }
    }
    sums.add(values, view.used);
    rounding.add(biases, view.used);
  }
  const double even = sums.rms(kNoiseSigmas);
  const double rounded = std::max(rounding.rms(0.0), hidden_share(design));
  return unit / means_[design] * std::sqrt(std::max(0.0, even * even - rounded * rounded));
}

double GreyModel::even_cover(std::size_t design) const {
  EvenCover cover;
  for (const SmallView& view : views_) {
    if (view.design == design) {
      cover.add(view.used);
    }
  }
  return cover.share();
}

/// Costs the first rendering of columns(), which is kept.
void GreyModel::keep_rounding() {
  rounding_.assign(designs_.size(), std::numeric_limits<double>::infinity());
  if (lights_.empty() || real_.size() == 0) {
    return;
  }
  const std::vector<Eigen::Vector3d> unmoved(lights_.size(), Eigen::Vector3d::Zero());
  const ColumnsPointer designed = columns(unmoved, 1.0);
  const auto& [first, second] = *designed;
  const Eigen::VectorXd expected = 0.5 * (first.sum + second.sum);
  for (std::size_t d = 0; d < designs_.size(); ++d) {
    rounding_[d] = rounding_of(d, expected);
  }
}

/// @param expected  grey values as designed, in the units of columns()
double GreyModel::rounding_of(std::size_t design, const Eigen::VectorXd& expected) const {
  double biases = 0.0;
  double squares = 0.0;
  Eigen::Index row = rows_[design].first;
  for (const SmallView& view : views_) {
    if (view.design != design) {
      continue;
    }
    const auto count =
        std::ranges::count_if(view.used.values(), [](auto used) { return used != 0; });
    for (const Eigen::Index end = row + count; row < end; ++row) {
      const double grey = std::max(0.0, units_[design] * expected[row]);
      const double noise = grey_noise(view.sensor, grey);
      biases += grey * std::max(std::abs(rounding_bias(grey, noise, view.step)),
                                largest_rounding_bias(noise, view.step));
      squares += grey * grey;
    }
  }
  return squares > 0.0 ? biases / squares : std::numeric_limits<double>::infinity();
}

}  // namespace glint::validate_detail
