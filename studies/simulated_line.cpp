// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/simulated_line.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/rng.h"
#include "core/spans.h"
#include "simulator/render/changed_pixels.h"
#include "simulator/render/closed_scan.h"
#include "simulator/render/expected_scan.h"
#include "simulator/sensor/sensor_kernels.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;

/// Numbers of scans are told apart from numbers of parts, and both from the scene's own noise.
enum class ScanOf : std::uint64_t { kFlawless = 1, kPart = 2 };

/// A seed for the sensor's noise, as spread as the sensor's keys can be.
int noise_seed(int seed, ScanOf what, std::int64_t number) {
  Rng rng(static_cast<std::uint64_t>(seed),
          Stream::kAspectNoise,
          (static_cast<std::uint64_t>(what) << 48U) + static_cast<std::uint64_t>(number));
  return static_cast<int>(rng.next_u32() >> 1U);
}

SensorSettings without_noise(SensorSettings settings) {
  settings.full_well_e = settings.read_noise_e = settings.dark_e = 0.0;
  return settings;
}

/// Adds a normal number times the deviation to each pixel: what closed forms leave out.
void scatter(const ImageF& deviation, int seed, ImageF& aspect) {
  namespace kernels = sensor_kernels;
  const int width = aspect.width();
  const int blocks = (width + 3) / 4;
  std::vector<std::uint32_t> words(4 * static_cast<std::size_t>(blocks));
  std::vector<float> normals(words.size());
  for (int y = 0; y < aspect.height(); ++y) {
    const kernels::NoiseAddress address = {
        .key = {static_cast<std::uint32_t>(seed), 0},
        .stream = static_cast<std::uint32_t>(Stream::kAspectNoise),
        .frame = static_cast<std::uint32_t>(y)};
    kernels::philox_words(address, 0, blocks, words.data());
    kernels::normal_quantiles(words.data(), width, normals.data());
    const float* sigma = deviation.row(y);
    float* row = aspect.row(y);
    for (int x = 0; x < width; ++x) {
      row[x] += sigma[x] * normals[static_cast<std::size_t>(x)];
    }
  }
}

void keep_inside(const Mask& mask, ImageF& image) {
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mask.values()[i] == 0) {
      image.values()[i] = 0.0F;
    }
  }
}

/// What the camera's rays meet, however they are traced.
struct SeenSurface {
  std::shared_ptr<const RayCache> sampled;
  std::shared_ptr<const CornerRays> corners;

  const SeenPart& seen() const {
    return sampled ? static_cast<const SeenPart&>(*sampled) : *corners;
  }
};

/// The smallest distance [radii] among the pixels whose centres lie within `reach_px` of a point.
float least_distance(const DefectView& view, double x_px, double y_px, double reach_px) {
  float least = DefectView::kFar;
  const double u = x_px - view.left_px;
  const double v = y_px - view.top_px;
  const auto first = [&](double at) { return static_cast<int>(std::floor(at - reach_px)); };
  const auto last = [&](double at) { return static_cast<int>(std::floor(at + reach_px)); };
  for (int y = std::max(0, first(v)); y <= std::min(view.distance.height() - 1, last(v)); ++y) {
    for (int x = std::max(0, first(u)); x <= std::min(view.distance.width() - 1, last(u)); ++x) {
      if (std::hypot(x + 0.5 - u, y + 0.5 - v) <= reach_px) {
        least = std::min(least, view.distance(x, y));
      }
    }
  }
  return least;
}

/// Whether the pixel nearest to the defect's middle lies outside a region; unseen ones do.
bool is_outside(const DefectView& view, const Mask& region) {
  float least = DefectView::kFar;
  bool is_inside = false;
  for (int y = 0; y < view.distance.height(); ++y) {
    for (int x = 0; x < view.distance.width(); ++x) {
      if (view.distance(x, y) < least) {
        least = view.distance(x, y);
        is_inside = region(x + view.left_px, y + view.top_px) != 0;
      }
    }
  }
  return !is_inside;
}

}  // namespace

struct SimulatedLine::Data {
  Data(SceneStore& scene_store, const SceneSettings& settings)
      : store(scene_store),
        scene(settings),
        bare(without_defects(settings)),
        tunnel(settings.tunnel),
        camera(intrinsics_of(settings)) {}

  static SceneSettings without_defects(SceneSettings scene) {
    scene.defects.clear();
    scene.imprint = {};
    return scene;
  }

  ThreadPool& pool() const { return store.pool(); }

  DefectMaker maker_of(const std::vector<NamedGroup>& defects) const {
    SceneSettings changed = scene;
    changed.defects = defects;
    return defect_maker(changed, traced->part->clean);
  }

  SeenSurface see(const BuiltDefects& part) const {
    const RigidTransform& pose = traced->camera_from_world;
    const BuiltPart& built = *part.built;
    SeenSurface surface;
    if (traced->is_sampled()) {
      surface.sampled = std::make_shared<const RayCache>(
          trace_rays(built.part, *built.bvh, part.detail, camera, pose, scene.render, pool()));
    } else if (part.built == part.clean) {
      surface.corners = std::make_shared<const CornerRays>(retrace_detail(traced->corners,
                                                                          built.part,
                                                                          *built.bvh,
                                                                          part.detail,
                                                                          camera,
                                                                          pose,
                                                                          scene.render,
                                                                          pool())
                                                               .rays);
    } else {
      surface.corners = std::make_shared<const CornerRays>(trace_corner_rays(
          built.part, *built.bvh, part.detail, camera, pose, scene.render, pool()));
    }
    return surface;
  }

  std::shared_ptr<const Footprints> footprints_of(const SeenSurface& surface) const {
    return surface.sampled ? nullptr
                           : std::make_shared<const Footprints>(
                                 *surface.corners, tunnel, scene.scan, traced->camera_in_world_mm);
  }

  bool has_phases() const { return scene.inspection.filter == InspectionSettings::Filter::kPhase; }

  /// All frames of one scan.
  ScannedPart scan_frames(const SeenSurface& surface,
                          const Footprints* footprints,
                          const SensorSettings& settings) const {
    const SeenPart& seen = surface.seen();
    const Sensor sensor(settings, seen.width_px, seen.height_px);
    std::vector<ImageF> frames;
    const auto keep = [&](int, const ImageF& grey) { frames.push_back(grey); };
    const FrameConsumer consume = has_phases() ? FrameConsumer(keep) : FrameConsumer();
    ScannedPart part;
    if (footprints == nullptr) {
      const Eigen::Vector3d& camera_mm = traced->camera_in_world_mm;
      part.aspect =
          take_scan(*surface.sampled, tunnel, sensor, scene.scan, camera_mm, consume).aspect;
    } else {
      part.aspect = scan_integrated(*footprints, sensor, consume).aspect;
    }
    part.response = has_phases() ? inspector->response(frames, pool())
                                 : inspector->response(part.aspect, pool());
    return part;
  }

  /// The flawless part's expected scan with the noise of one, and frames rendered only where the
  /// part differs from it.
  ScannedPart scan_changes(const SeenSurface& surface,
                           const Footprints& footprints,
                           const SensorSettings& settings) const {
    ScannedPart part;
    part.aspect = expected.aspect;
    if (settings.full_well_e > 0.0) {
      scatter(expected.deviation, settings.seed, part.aspect);
    }
    if (surface.corners != clean.corners) {
      const Sensor sensor(settings, part.aspect.width(), part.aspect.height());
      ScanPlan plan;
      plan.by_frames =
          dilated(changed_pixels(*clean.corners, *surface.corners), sensor.blur_radius_px());
      const ClosedScan changed = scan_closed(footprints, sensor, plan);
      for (std::size_t i = 0; i < changed.aspect.size(); ++i) {
        if (plan.by_frames.values()[i] != 0) {
          part.aspect.values()[i] = changed.aspect.values()[i];
        }
      }
    }
    part.response = inspector->response(part.aspect, pool());
    return part;
  }

  ScannedPart scan(const SeenSurface& surface,
                   const Footprints* footprints,
                   const SensorSettings& settings) const {
    const bool is_whole =
        surface.sampled != nullptr || has_phases() || scene.render.method == Method::kIntegrated;
    ScannedPart part = is_whole ? scan_frames(surface, footprints, settings)
                                : scan_changes(surface, *footprints, settings);
    keep_inside(traced->part_mask, part.aspect);
    keep_inside(region, part.response);
    return part;
  }

  std::vector<TrueDefect> truth_of(const DefectivePart& made, const SeenPart& seen) const {
    std::vector<TrueDefect> truth;
    std::size_t next = 0;
    for (const MadeDefect& defect : made.defects) {
      if (!defect.is_made) {
        continue;
      }
      TrueDefect one = {.defect = defect.defect, .outline = made.outlines[next++], .view = {}};
      try {
        one.view = view_defects({&one.outline, 1},
                                seen,
                                camera,
                                traced->camera_from_world,
                                scene.metrics.ring_outer_radii)
                       .front();
      } catch (const ConfigError&) {
        one.view.label = one.outline.label;  // outside the picture
      }
      one.is_masked = is_outside(one.view, region);
      truth.push_back(std::move(one));
    }
    return truth;
  }

  ScannedPart part(const DefectMaker& making, std::int64_t number) const {
    const auto seed =
        static_cast<std::uint64_t>(scene.imprint.seed) + static_cast<std::uint64_t>(number);
    const BuiltDefects built = build_defects(scene, traced->part->clean, making, seed);
    const SeenSurface surface = see(built);
    const auto footprints = footprints_of(surface);
    SensorSettings settings = scene.sensor;
    settings.seed = noise_seed(scene.sensor.seed, ScanOf::kPart, number);
    ScannedPart result = scan(surface, footprints.get(), settings);
    result.defects = truth_of(built.made, surface.seen());
    return result;
  }

  /// Region and expected picture of the flawless part.
  void learn_flawless() {
    traced = store.trace(bare);
    clean = traced->is_sampled()
                ? SeenSurface{.sampled = {traced, &traced->rays}, .corners = {}}
                : SeenSurface{.sampled = {}, .corners = {traced, &traced->corners}};
    clean_footprints = footprints_of(clean);
    inspector.emplace(scene.inspection, traced->part_mask);
    region = inspector->region();
    if (clean_footprints) {
      expected = expected_scan(*clean_footprints, scene.sensor);
    }
    const ScannedPart quiet =
        scan_frames(clean, clean_footprints.get(), without_noise(scene.sensor));
    expected_aspect = clean_footprints ? expected.aspect : quiet.aspect;
    keep_inside(traced->part_mask, expected_aspect);
    const double lit = scene.metrics.lit_threshold;
    const double most = scene.inspection.trials.mask_grey;
    for (std::size_t i = 0; i < region.size(); ++i) {
      const bool is_even = std::abs(static_cast<double>(quiet.response.values()[i])) <= most;
      const bool is_lit = static_cast<double>(expected_aspect.values()[i]) > lit;
      region.values()[i] = region.values()[i] != 0 && is_lit && is_even ? 1 : 0;
    }
  }

  SceneStore& store;
  SceneSettings scene;
  SceneSettings bare;  ///< without defects
  Tunnel tunnel;
  PinholeCamera camera;
  std::shared_ptr<const TracedScene> traced;  ///< of the flawless part
  SeenSurface clean;
  std::shared_ptr<const Footprints> clean_footprints;
  std::optional<Inspector> inspector;
  Mask region;
  ExpectedScan expected;   ///< of the flawless part; empty: sampled
  ImageF expected_aspect;  ///< the same on the part alone
  std::optional<DefectMaker> maker;
};

Verdict judge(std::span<const FoundDefect> found,
              std::span<const TrueDefect> truth,
              const TrialSettings& settings) {
  constexpr double kReach_px = 1.5;
  Verdict verdict;
  verdict.is_found.assign(truth.size(), 0);
  const auto nearest_to = [&](const FoundDefect& blob, double reach_px) {
    auto least = static_cast<float>(settings.hit_radii);
    int nearest = -1;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const float distance = least_distance(truth[i].view, blob.x_px, blob.y_px, reach_px);
      if (distance <= least) {
        least = distance;
        nearest = static_cast<int>(i);
      }
    }
    return nearest;
  };
  for (const FoundDefect& blob : found) {
    const int hit = nearest_to(blob, kReach_px);
    verdict.defect_of_blob.push_back(hit >= 0 ? hit
                                              : nearest_to(blob, kReach_px + settings.echo_px));
    verdict.false_alarms += verdict.defect_of_blob.back() < 0 ? 1 : 0;
    if (hit >= 0 && !truth[static_cast<std::size_t>(hit)].is_masked) {
      verdict.is_found[static_cast<std::size_t>(hit)] = 1;
    }
  }
  return verdict;
}

SimulatedLine::SimulatedLine(SceneStore& store, const SceneSettings& scene)
    : data_(std::make_unique<Data>(store, scene)) {
  check_part_in_tunnel(*store.build(scene), data_->tunnel, scene.scan, scene.tunnel_name);
  data_->learn_flawless();
  data_->maker.emplace(data_->maker_of(scene.defects));
}

SimulatedLine::~SimulatedLine() = default;

const SceneSettings& SimulatedLine::scene() const {
  return data_->scene;
}

const Inspector& SimulatedLine::inspector() const {
  return *data_->inspector;
}

const Mask& SimulatedLine::region() const {
  return data_->region;
}

double SimulatedLine::region_share() const {
  return static_cast<double>(count_inside(data_->region)) /
         static_cast<double>(count_inside(data_->inspector->region()));
}

const ImageF& SimulatedLine::expected_aspect() const {
  return data_->expected_aspect;
}

ScannedPart SimulatedLine::flawless(std::int64_t number) const {
  SensorSettings settings = data_->scene.sensor;
  settings.seed = noise_seed(settings.seed, ScanOf::kFlawless, number);
  return data_->scan(data_->clean, data_->clean_footprints.get(), settings);
}

ScannedPart SimulatedLine::part(std::int64_t number) const {
  return data_->part(*data_->maker, number);
}

ScannedPart SimulatedLine::part_with(const std::vector<NamedGroup>& defects,
                                     std::int64_t number) const {
  return data_->part(data_->maker_of(defects), number);
}

std::vector<FoundDefect> SimulatedLine::inspect(const ScannedPart& part, double threshold) const {
  return data_->inspector->blobs(part.response, threshold, data_->pool());
}

double SimulatedLine::threshold() const {
  const InspectionSettings& settings = data_->scene.inspection;
  if (settings.threshold == InspectionSettings::Threshold::kFixed) {
    return settings.threshold_grey;
  }
  if (settings.threshold == InspectionSettings::Threshold::kNoise) {
    return data_->inspector->threshold(flawless(0).response);
  }
  const auto responses = data_->pool().map<ImageF>(
      settings.trials.flawless, [&](std::int64_t number) { return flawless(number).response; });
  return threshold_for(
      *data_->inspector, responses, settings.false_alarms_per_picture, data_->pool());
}

}  // namespace glint
