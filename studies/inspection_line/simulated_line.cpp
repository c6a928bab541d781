// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspection_line/simulated_line.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/rng.h"
#include "metrics/inspection/calibration.h"
#include "studies/imaging/line_camera.h"

namespace glint {
namespace {

/// Numbers of scans are told apart from numbers of parts, and both from the scene's own noise.
enum class ScanOf : std::uint64_t { kFlawless = 1, kPart = 2 };

/// A seed for the sensor's noise, as spread as the sensor's keys can be.
int noise_seed(int seed, ScanOf what, std::int64_t number) {
  Rng rng(static_cast<std::uint64_t>(seed),
          Stream::kAspectNoise,
          (static_cast<std::uint64_t>(what) << 48U) + static_cast<std::uint64_t>(number));
  return static_cast<int>(rng.next_u32() >> 1U);
}

void keep_inside(const Mask& mask, ImageF& image) {
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mask.values()[i] == 0) {
      image.values()[i] = 0.0F;
    }
  }
}

/// The smallest distance [radii] among the pixels whose centres lie within `reach_px` of a point.
float min_distance(const DefectView& view, double x_px, double y_px, double reach_px) {
  float minimum = DefectView::kFar;
  const double u = x_px - view.left_px;
  const double v = y_px - view.top_px;
  const auto first = [&](double at) { return static_cast<int>(std::floor(at - reach_px)); };
  const auto last = [&](double at) { return static_cast<int>(std::floor(at + reach_px)); };
  for (int y = std::max(0, first(v)); y <= std::min(view.distance.height() - 1, last(v)); ++y) {
    for (int x = std::max(0, first(u)); x <= std::min(view.distance.width() - 1, last(u)); ++x) {
      if (std::hypot(x + 0.5 - u, y + 0.5 - v) <= reach_px) {
        minimum = std::min(minimum, view.distance(x, y));
      }
    }
  }
  return minimum;
}

/// Whether the pixel nearest to the defect's middle lies outside a region; unseen ones do.
bool is_outside(const DefectView& view, const Mask& region) {
  float minimum = DefectView::kFar;
  bool is_inside = false;
  for (int y = 0; y < view.distance.height(); ++y) {
    for (int x = 0; x < view.distance.width(); ++x) {
      if (view.distance(x, y) < minimum) {
        minimum = view.distance(x, y);
        is_inside = region(x + view.left_px, y + view.top_px) != 0;
      }
    }
  }
  return !is_inside;
}

SceneSettings without_defects(SceneSettings scene) {
  scene.defects.clear();
  scene.imprint = {};
  return scene;
}

double mean_square_difference(const ImageF& a, const ImageF& b, const Mask& where) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < where.size(); ++i) {
    if (where.values()[i] != 0) {
      const double difference =
          static_cast<double>(a.values()[i]) - static_cast<double>(b.values()[i]);
      sum += difference * difference;
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// Independent noise of the two renderings cancels in their product, not in the square of the mean.
RenderedEnergy energy_of(const std::vector<ImageF>& changes, const DefectView& view, double radii) {
  RenderedEnergy energy;
  if (changes.empty()) {
    return energy;
  }
  for (int y = 0; y < view.distance.height(); ++y) {
    for (int x = 0; x < view.distance.width(); ++x) {
      if (static_cast<double>(view.distance(x, y)) <= radii) {
        const auto a = static_cast<double>(changes[0](x + view.left_px, y + view.top_px));
        const auto b = static_cast<double>(changes[1](x + view.left_px, y + view.top_px));
        energy.total += 0.25 * (a + b) * (a + b);
        energy.noise += 0.25 * (a - b) * (a - b);
      }
    }
  }
  return energy;
}

}  // namespace

struct SimulatedLine::Data {
  Data(SceneStore& scene_store, const SceneSettings& settings)
      : store(scene_store),
        scene(settings),
        projection(intrinsics_of(settings)),
        traced(store.trace(without_defects(settings))),
        inspector(settings.inspection, traced->part_mask),
        region(inspector.region()),
        camera(line_camera_of(store, settings, traced)) {}

  ThreadPool& pool() const { return store.pool(); }

  DefectMaker maker_of(const std::vector<NamedGroup>& defects) const {
    SceneSettings changed = scene;
    changed.defects = defects;
    return defect_maker(changed, traced->part->clean);
  }

  bool has_phases() const { return scene.inspection.filter == InspectionSettings::Filter::kPhase; }

  ImageF response_of(const LineScan& scan) const {
    return has_phases() ? inspector.response(scan.frames, pool())
                        : inspector.response(scan.aspect, pool());
  }

  ScannedPart inspected(LineScan scan) const {
    ScannedPart part;
    part.response = response_of(scan);
    part.aspect = std::move(scan.aspect);
    keep_inside(traced->part_mask, part.aspect);
    keep_inside(region, part.response);
    return part;
  }

  SensorSettings sensor_of(ScanOf what, std::int64_t number) const {
    SensorSettings settings = scene.sensor;
    settings.seed = noise_seed(scene.sensor.seed, what, number);
    return settings;
  }

  std::vector<TrueDefect> truth_of(const DefectivePart& made, const LineScan& scan) const {
    std::vector<TrueDefect> truth;
    std::size_t next = 0;
    for (const RealisedDefect& defect : made.defects) {
      if (!defect.is_made) {
        continue;
      }
      TrueDefect one = {.defect = defect.defect, .outline = made.outlines[next++], .view = {}};
      try {
        one.view = view_defects({&one.outline, 1},
                                *scan.seen,
                                projection,
                                traced->camera_from_world,
                                scene.metrics.ring_outer_radii)
                       .front();
      } catch (const ConfigError&) {
        one.view.label = one.outline.label;  // outside the picture
      }
      one.is_masked = is_outside(one.view, region);
      one.rendering = energy_of(scan.changes, one.view, scene.inspection.trials.hit_radii);
      truth.push_back(std::move(one));
    }
    return truth;
  }

  BuiltDefects built_part(const DefectMaker& making, std::int64_t number) const {
    const auto seed =
        static_cast<std::uint64_t>(scene.imprint.seed) + static_cast<std::uint64_t>(number);
    return build_defects(scene, traced->part->clean, making, seed);
  }

  ScannedPart part(const DefectMaker& making, std::int64_t number) const {
    const BuiltDefects built = built_part(making, number);
    LineScan scan = camera->part(built, sensor_of(ScanOf::kPart, number));
    std::vector<TrueDefect> truth = truth_of(built.made, scan);
    ScannedPart result = inspected(std::move(scan));
    result.defects = std::move(truth);
    return result;
  }

  /// Region and expected picture of the flawless part.
  void learn_flawless() {
    ExpectedLine line = camera->expected();
    ImageF quiet = response_of(line.quiet);
    expected_aspect = std::move(line.aspect);
    keep_inside(traced->part_mask, expected_aspect);
    const double lit = scene.metrics.lit_threshold;
    const double maximum = scene.inspection.trials.mask_grey;
    for (std::size_t i = 0; i < region.size(); ++i) {
      const bool is_even = std::abs(static_cast<double>(quiet.values()[i])) <= maximum;
      const bool is_lit = static_cast<double>(expected_aspect.values()[i]) > lit;
      region.values()[i] = region.values()[i] != 0 && is_lit && is_even ? 1 : 0;
    }
    if (!line.renderings.empty()) {
      rendering_share = share_of_rendering(line, quiet);
    }
  }

  /// Half the difference of two renderings has the variance of their mean.
  double share_of_rendering(const ExpectedLine& line, const ImageF& quiet) const {
    const double rendered =
        0.25 * mean_square_difference(
                   response_of(line.renderings[0]), response_of(line.renderings[1]), region);
    const LineScan noisy = camera->flawless(sensor_of(ScanOf::kFlawless, 0));
    const double sensor = mean_square_difference(response_of(noisy), quiet, region);
    return rendered > 0.0 ? rendered / (rendered + sensor) : 0.0;
  }

  SceneStore& store;
  SceneSettings scene;
  PinholeCamera projection;
  std::shared_ptr<const TracedScene> traced;  ///< of the flawless part
  Inspector inspector;
  Mask region;
  std::unique_ptr<const LineCamera> camera;
  ImageF expected_aspect;  ///< on the part alone
  double rendering_share = 0.0;
  std::optional<DefectMaker> maker;
};

DetectionMatches match_detections(std::span<const FoundDefect> found,
                                  std::span<const TrueDefect> truth,
                                  const TrialSettings& settings) {
  const auto maximum = static_cast<float>(settings.hit_radii);
  const auto distance = [&](const FoundDefect& blob, std::size_t i, double slack_px) {
    const float radii = min_distance(truth[i].view, blob.x_px, blob.y_px, slack_px);
    return radii <= maximum ? std::optional(static_cast<double>(radii)) : std::nullopt;
  };
  DetectionMatches matches = match_detections(found, truth.size(), settings.echo_px, distance);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i].is_masked) {
      matches.blob_of_defect[i] = -1;
    }
  }
  return matches;
}

void check_inspected_region(SceneStore& store, const SceneSettings& scene) {
  const auto traced = store.trace(without_defects(first_view(store, scene)));
  const Inspector inspector(scene.inspection, traced->part_mask);
}

SimulatedLine::SimulatedLine(SceneStore& store, const SceneSettings& scene) {
  check_part_in_tunnel(store, scene);
  data_ = std::make_unique<Data>(store, first_view(store, scene));
  data_->learn_flawless();
  data_->maker.emplace(data_->maker_of(scene.defects));
}

SimulatedLine::~SimulatedLine() = default;

const SceneSettings& SimulatedLine::scene() const {
  return data_->scene;
}

const Inspector& SimulatedLine::inspector() const {
  return data_->inspector;
}

const Mask& SimulatedLine::region() const {
  return data_->region;
}

double SimulatedLine::region_share() const {
  return static_cast<double>(count_inside(data_->region)) /
         static_cast<double>(count_inside(data_->inspector.region()));
}

double SimulatedLine::rendering_share() const {
  return data_->rendering_share;
}

const ImageF& SimulatedLine::expected_aspect() const {
  return data_->expected_aspect;
}

ScannedPart SimulatedLine::flawless(std::int64_t number) const {
  return data_->inspected(data_->camera->flawless(data_->sensor_of(ScanOf::kFlawless, number)));
}

ScannedPart SimulatedLine::part(std::int64_t number) const {
  return data_->part(*data_->maker, number);
}

ScannedPart SimulatedLine::part_with(const std::vector<NamedGroup>& defects,
                                     std::int64_t number) const {
  return data_->part(data_->maker_of(defects), number);
}

std::vector<double> SimulatedLine::slopes_rad(const std::vector<NamedGroup>& defects,
                                              std::int64_t number) const {
  return defect_slopes_rad(data_->built_part(data_->maker_of(defects), number));
}

std::vector<FoundDefect> SimulatedLine::inspect(const ScannedPart& part, double threshold) const {
  return data_->inspector.blobs(part.response, threshold, data_->pool());
}

double SimulatedLine::threshold() const {
  const InspectionSettings& settings = data_->scene.inspection;
  if (settings.threshold == InspectionSettings::Threshold::kFixed) {
    return settings.threshold_grey;
  }
  if (settings.threshold == InspectionSettings::Threshold::kNoise) {
    return data_->inspector.threshold(flawless(0).response);
  }
  const auto responses = data_->pool().map<ImageF>(
      settings.trials.flawless, [&](std::int64_t number) { return flawless(number).response; });
  return threshold_for(
      data_->inspector, responses, settings.false_alarms_per_picture, data_->pool());
}

}  // namespace glint
