// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/cell_renderer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/rng.h"
#include "core/text.h"
#include "simulator/render/ray_cache/unseen_part.h"
#include "simulator/sensor/sensor.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

constexpr std::size_t kStoreBytes = std::size_t{512} << 20U;

/// A number that belongs to this state and no other, of 31 bits.
std::uint64_t seed_of(const TwinCellState& state, int seed) {
  const std::string digest = sha256_hex(fmt::format("{} {}", seed, key_of(state)));
  return std::stoull(digest.substr(0, 8), nullptr, 16) & 0x7fffffffU;
}

/// Of the pose alone: lights do not move the arm.
std::uint64_t seed_of_pose(const RigidTransform& base_from_flange, int seed) {
  return seed_of({.base_from_flange = base_from_flange}, seed);
}

/// The flange's error, by a random vector for each of position and rotation.
RigidTransform flange_error(const TruthSettings& truth, const TwinCellState& state) {
  Rng random(seed_of_pose(state.base_from_flange, truth.seed), Stream::kViewpoints, 0);
  std::vector<double> position(3);
  std::vector<double> rotation(3);
  for (std::size_t i = 0; i < 3; ++i) {
    position[i] = truth.position_noise_mm * random.normal();
    rotation[i] = truth.rotation_noise_rad * random.normal();
  }
  return pose_of(position, rotation);
}

std::vector<double> numbers(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Image<std::uint16_t> codes_of(const ImageF& grey, const CaptureSettings& settings) {
  const double largest = static_cast<double>((1 << settings.bits) - 1);
  const double black = settings.black_level / 4095.0 * largest;
  auto codes = Image<std::uint16_t>::uninitialized(grey.width(), grey.height());
  std::ranges::transform(grey.values(), codes.values().begin(), [&](float value) {
    const double code = std::round(static_cast<double>(value) * largest + black);
    return static_cast<std::uint16_t>(std::clamp(code, 0.0, largest));
  });
  return codes;
}

}  // namespace

std::string key_of(const TwinCellState& state) {
  std::string key;
  const auto add = [&](double value) {
    key += fmt::format("{} ", static_cast<long long>(std::llround(value)));
  };
  for (int i = 0; i < 9; ++i) {
    add(1e9 * state.base_from_flange.rotation(i / 3, i % 3));
  }
  for (int i = 0; i < 3; ++i) {
    add(1e6 * state.base_from_flange.translation_mm[i]);
  }
  std::vector<std::string> lights = state.lights;
  std::ranges::sort(lights);
  key += fmt::format("[{}] {}", join(lights, " "), state.stage_position);
  if (state.stage_shift_mm != 0.0) {
    key += fmt::format(" shift {:.4f}", state.stage_shift_mm);
  }
  return state.placement == 1 ? key : fmt::format("{} placement {}", key, state.placement);
}

RigidTransform joint_error_of(const TruthSettings& truth,
                              const Arm& arm,
                              const JointVector& joints_rad,
                              const std::vector<std::string>& lights) {
  if (truth.joint_noise_rad == 0.0) {
    return {};
  }
  const RigidTransform told = transform_of(arm.forward(joints_rad));
  Rng random(
      seed_of({.base_from_flange = told, .lights = lights}, truth.seed), Stream::kRobotErrors, 0);
  JointVector actual_rad = joints_rad;
  for (double& angle : actual_rad) {
    angle += truth.joint_noise_rad * random.normal();
  }
  return inverse(told) * transform_of(arm.forward(actual_rad));
}

RigidTransform scene_from_camera(const Truth& truth, const TwinCellState& state) {
  return truth.scene_from_camera(state.base_from_flange,
                                 state.joint_error * flange_error(truth.settings, state),
                                 state.placement);
}

CellRenderer::CellRenderer(const Truth& truth, ThreadPool& pool)
    : truth_(truth),
      own_store_(std::make_unique<SceneStore>(pool, kStoreBytes)),
      store_(*own_store_) {
  begin();
}

CellRenderer::CellRenderer(const Truth& truth, SceneStore& store) : truth_(truth), store_(store) {
  begin();
}

void CellRenderer::begin() {
  store_.leave_out_scores();
  const PinholeIntrinsics intrinsics = intrinsics_of(truth_.scene);
  width_px_ = intrinsics.width_px;
  height_px_ = intrinsics.height_px;
}

SceneSettings CellRenderer::scene_of(const TwinCellState& state,
                                     const CaptureSettings& settings) const {
  SceneSettings scene = truth_.scene;
  const RigidTransform pose = scene_from_camera(truth_, state);
  const Viewpoint viewpoint = {.position_mm = numbers(pose.translation_mm),
                               .direction = numbers(pose.rotation.col(2)),
                               .up = numbers(-pose.rotation.col(1))};
  scene.viewpoints = {viewpoint};
  scene.viewpoint_set.source = ViewpointSource::kListed;
  keep_lights(scene, state.lights);
  scene.tunnel.offset_mm += state.stage_shift_mm * std::cos(scene.tunnel.orientation_rad);
  scene.sensor.exposure *= 1e-6 * settings.exposure_us / truth_.settings.exposure_s;
  scene.sensor.gain *= std::pow(10.0, settings.gain_db / 20.0);
  scene.sensor.bits = settings.bits;
  // Frames of a scan have noise of their own by their numbers.
  TwinCellState seeded = state;
  seeded.stage_position = 0;
  scene.sensor.seed = static_cast<int>(seed_of(seeded, truth_.settings.seed));
  return scene;
}

std::vector<Image<std::uint16_t>> CellRenderer::render_all(const TwinCellState& state,
                                                           const CaptureSettings& settings) {
  const SceneSettings scene = scene_of(state, settings);
  // What no light shines on is not rendered: an arm on its way is to wait for nothing.
  if (is_lit(scene) && !state.is_dark()) {
    try {
      return render_lit(scene, settings);
    } catch (const UnseenPart&) {  // dark as well: there is nothing else in the truth
    }
  }
  std::vector<Image<std::uint16_t>> pictures;
  const Sensor sensor(scene.sensor, width_px_, height_px_);
  for (int i = 0; i < num_positions(); ++i) {
    ImageF dark;
    sensor.expose(ImageF(width_px_, height_px_), i, dark);
    pictures.push_back(codes_of(dark, settings));
  }
  return pictures;
}

std::vector<Image<std::uint16_t>> CellRenderer::render_lit(const SceneSettings& scene,
                                                           const CaptureSettings& settings) {
  std::vector<Image<std::uint16_t>> pictures;
  const auto seen = picture_of(store_, scene, {.has_flawless = false});
  seen->mean({.watch =
                  [&](int index, const ImageF& grey) {
                    const auto place = static_cast<std::size_t>(index);
                    pictures.resize(std::max(pictures.size(), place + 1));
                    pictures[place] = codes_of(grey, settings);
                  },
              .has_whole_frames = true});
  return pictures;
}

Image<std::uint16_t> CellRenderer::render(const TwinCellState& state,
                                          const CaptureSettings& settings) {
  const std::vector<Image<std::uint16_t>> all = render_all(state, settings);
  return all.at(std::min(static_cast<std::size_t>(state.stage_position), all.size() - 1));
}

int CellRenderer::num_positions() const {
  return stage_scan(truth_.scene).positions;
}

double CellRenderer::step_mm() const {
  return stage_scan(truth_.scene).step_mm;
}

double CellRenderer::offset_mm() const {
  return stripe_offset_mm(truth_.scene);
}

double CellRenderer::period_mm() const {
  const TunnelSettings& tunnel = truth_.scene.tunnel;
  return step_mm() > 0.0 ? tunnel.period_mm / std::cos(tunnel.orientation_rad) : 0.0;
}

}  // namespace glint
