// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/causes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "metrics/appearance/grey_sums.h"
#include "metrics/overlap/boundary_distance.h"
#include "metrics/overlap/outline_motion.h"
#include "simulator/sensor/sensor.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/compare/refined_scene.h"
#include "studies/compare/roughness_cause.h"
#include "studies/compare/surface/placed_edges.h"
#include "studies/compare/surface/simulated_surface.h"
#include "studies/definition/scene_file.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMinGain = 0.002;  ///< smaller changes of exposure are nobody's concern
constexpr double kSurelySigmas = 4.0;
constexpr double kMinShare = 0.005;      ///< of the misfit of grey values
constexpr double kMinCorrelation = 0.3;  ///< below, one exposure does not make the other picture

SimulatedSurface surface_of(const ComparedPair& pair, const SceneSettings& scene) {
  return {pair.simulated.source.geometry,
          pair.simulated.width(),
          pair.simulated.height(),
          camera_from_world(scene.viewpoint())};
}

/// Edges where the changes have moved them.
std::vector<Boundary> moved_edges(const PlacedEdges& placed,
                                  const PinholeIntrinsics& camera,
                                  const Vector3d& middle_mm,
                                  const CauseVector& changes) {
  std::vector<Boundary> moved = placed.boundaries;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    for (std::size_t k = 0; k < moved[i].points.size(); ++k) {
      const Vector3d& place = placed.in_camera_mm[i][k];
      moved[i].points[k].at_px += changed_pixel(camera, middle_mm, changes, place) -
                                  changed_pixel(camera, middle_mm, CauseVector{}, place);
    }
  }
  return moved;
}

/// Matches edges that were moved with the real ones. What an edge was moved along its normal and
/// what is left then are its offset: near its counterpart the nearest point is the right one.
std::vector<SpaceEdge> matched_edges(const PlacedEdges& placed,
                                     const std::vector<Boundary>& moved,
                                     const std::vector<Boundary>& real,
                                     double reach_px) {
  std::vector<SpaceEdge> edges;
  for (const BoundaryGap& gap : gaps_between(moved, real, reach_px)) {
    const BoundaryPoint& before = placed.boundaries[gap.boundary].points[gap.point];
    edges.push_back(
        {.in_camera_mm = placed.in_camera_mm[gap.boundary][gap.point],
         .normal = before.normal,
         .offset_px = gap.offset_px + before.normal.dot(gap.from.at_px - before.at_px)});
  }
  return edges;
}

/// Edges of a calibrated camera's picture, where another camera in its place has them.
std::vector<Boundary> seen_by(const PinholeCamera& camera,
                              const PinholeCamera& calibrated,
                              std::vector<Boundary> edges) {
  for (Boundary& edge : edges) {
    std::vector<BoundaryPoint> seen;
    for (BoundaryPoint point : edge.points) {
      const auto ray = calibrated.ray_through(point.at_px);
      if (const auto at = ray ? camera.project(*ray) : std::nullopt) {
        point.at_px = *at;
        seen.push_back(point);
      }
    }
    edge.points = std::move(seen);
  }
  std::erase_if(edges, [](const Boundary& edge) { return edge.points.empty(); });
  return edges;
}

void check_size(const ComparedPair& pair, const KnownCamera& known) {
  if (known.calibrated && (known.calibrated->width_px != pair.real.width() ||
                           known.calibrated->height_px != pair.real.height())) {
    throw ConfigError(fmt::format("--calibration: is of pictures of {} x {} pixels, {} is {} x {}",
                                  known.calibrated->width_px,
                                  known.calibrated->height_px,
                                  pair.real.source.picture.string(),
                                  pair.real.width(),
                                  pair.real.height()));
  }
}

constexpr double kMatchedReach_px = 4.0;  ///< when the changes are known about
constexpr int kRounds = 3;
/// Of the picture's width, and at least so many pixels: rms from which on nearest edges may be
/// others, 4 px of 612.
constexpr double kFarShare = 0.0065;
constexpr double kMinFar_px = 2.0;

/// Whether the motion of the simulated outline onto the real one is known.
bool has_motion(const ComparedPair& pair, const KnownCamera& known) {
  return pair.geometry.outlines.motion.has_value() && !known.calibrated;
}

/// Fits causes, matches again with what they explain, and so on.
struct MatchedCauses {
  std::vector<SpaceEdge> edges;
  CauseFit fit;
};

MatchedCauses matched_causes(const ComparedPair& pair,
                             const SimulatedSurface& surface,
                             const PinholeIntrinsics& intrinsics,
                             const Vector3d& middle_mm,
                             const KnownCamera& known) {
  const OutlinePair& outlines = pair.geometry.outlines;
  const PinholeCamera camera(intrinsics);
  const std::vector<Boundary> real =
      known.calibrated ? seen_by(camera, PinholeCamera(*known.calibrated), outlines.real.located)
                       : outlines.real.located;
  const bool is_lens_known = known.is_lens_known || known.calibrated.has_value();
  const PlacedEdges placed = placed_edges(surface, camera, outlines.simulated.located);
  MatchedCauses result;
  // Where the outline's motion as a whole is known, its edges are first matched where that takes
  // them.
  const bool is_led = has_motion(pair, known);
  double reach_px = is_led ? kMatchedReach_px : kMaxDistanceShare * pair.simulated.width();
  for (int round = 0; round <= kRounds; ++round) {
    const std::vector<Boundary> moved =
        round == 0 && is_led ? moved_outlines(placed.boundaries, *outlines.motion)
                             : moved_edges(placed, intrinsics, middle_mm, result.fit.changes);
    result.edges = matched_edges(placed, moved, real, reach_px);
    // Before the last round edges may be matched with wrong neighbours: they need not agree yet.
    const double agreeing = round < kRounds ? 0.0 : kMinAgreeing;
    result.fit = fit_causes(
        result.edges, intrinsics, middle_mm, is_lens_known, agreeing, result.fit.changes);
    if (result.fit.causes.empty()) {
      break;
    }
    reach_px = std::min(reach_px, kMatchedReach_px);
  }
  return result;
}

ToldCause told(const FoundCause& found) {
  const double per = told_per_inner(found.parameter);
  ToldCause cause = {.name = name_of(found.parameter),
                     .value = per * found.value,
                     .unit = unit_of(found.parameter),
                     .sigma = per * found.sigma,
                     .share = found.share,
                     .of = "edges"};
  if (!found.not_separable.empty()) {
    cause.group.push_back(cause.name);
    for (const CauseParameter partner : found.not_separable) {
      cause.group.push_back(name_of(partner));
    }
  }
  return cause;
}

/// Whether no gain can be told: radiances of any unit have none.
bool has_unknown_exposure(const ComparedPair& pair) {
  return pair.simulated.is_scaled || pair.real.is_scaled;
}

/// Grey of the dark signal, where the simulated picture's scene is known.
double dark_of(const ComparedPair& pair) {
  const std::filesystem::path& scene = pair.simulated.source.scene;
  return scene.empty() ? 0.0 : dark_grey(load_scene(scene).sensor);
}

/// Over pixels whose mean in both exposures is so far below full scale that noise clips neither:
/// where each picture chose, those brighter by their noise would be missing.
/// @param dark  grey of the sensor's dark signal, which is taken off: a gain is one of light
GreySums grey_sums(const ComparedPair& pair, double dark) {
  constexpr double kClearOfNoise = 2.0;  // four deviations of one picture, noise alike in both
  const ExposureMatch& match = pair.appearance.exposure;
  const double limit = std::min(1.0, match.gain + match.offset) - kClearOfNoise * match.rms;
  GreySums sums;
  for (std::size_t i = 0; i < pair.simulated.grey.size(); ++i) {
    const auto simulated = static_cast<double>(pair.simulated.grey.values()[i]);
    const auto real = static_cast<double>(pair.real.grey.values()[i]);
    const double mean = 0.5 * (match.gain * simulated + match.offset + real);
    if ((pair.region.empty() || pair.region.values()[i] != 0) && std::min(simulated, real) > 0.0 &&
        std::max(simulated, real) < 1.0 && mean < limit) {
      sums.add(simulated - dark, real - dark);
    }
  }
  return sums;
}

/// The gain between both exposures, where it is beyond what noise makes of it. Noise of the
/// simulated picture, and edges that are elsewhere, make the regression of the real one on it too
/// flat; that of the simulated on the real one is too steep. It is taken halfway, where noise is
/// alike in both; between both is what is not known.
std::optional<ToldCause> gain_cause(const ComparedPair& pair) {
  if (has_unknown_exposure(pair) || pair.appearance.correlation < kMinCorrelation) {
    return std::nullopt;
  }
  const GreySums all = grey_sums(pair, dark_of(pair));
  if (all.pixels < 1.0) {
    return std::nullopt;
  }
  const GreySums sums = pair.appearance.exposure.offset != 0.0 ? all.centred() : all;
  if (!(sums.products > 0.0) || !(sums.simulated_squares > 0.0) || !(sums.differences > 0.0)) {
    return std::nullopt;
  }
  const double flat = sums.products / sums.simulated_squares;
  const double steep = sums.real_squares / sums.products;
  const double gain = std::sqrt(flat * steep);
  const double rest = std::max(0.0, 2.0 * (sums.real_squares - gain * sums.products));
  const double sigma = std::hypot(std::sqrt(rest / (sums.pixels * sums.simulated_squares)),
                                  (steep - flat) / std::sqrt(12.0));
  if (!(std::abs(gain - 1.0) >= std::max(kMinGain, kSurelySigmas * sigma))) {
    return std::nullopt;
  }
  return ToldCause{.name = "gain",
                   .value = gain,
                   .unit = "",
                   .sigma = sigma,
                   .share = std::clamp(1.0 - rest / sums.differences, 0.0, 1.0),
                   .of = "grey"};
}

void note_contradiction(const CauseFit& fit, std::vector<std::string>& notes) {
  if (fit.before_px > 0.0 && fit.agreeing < kMinAgreeing) {
    notes.push_back(fmt::format(
        "Only {:.0f} % of the edges are where one change of pose, lens or camera would have them: "
        "no cause is named. Either outlines are not the part's (see the overlay) or its shape is "
        "another.",
        100.0 * fit.agreeing));
  }
}

/// Edges that lie far apart were matched rightly where most of the outline was found in the real
/// picture; nearest edges of another tooth or corner can agree with a change that is none.
void withhold_doubtful(const OutlinePair& outlines, int width_px, PairCauses& causes) {
  CauseFit& fit = *causes.edges;
  const double far_px = std::max(kFarShare * width_px, kMinFar_px);
  const bool is_guided = outlines.motion.has_value();
  const bool is_found = is_guided && outlines.shown >= kMostlyShown;
  if (fit.causes.empty() || fit.before_px < far_px || is_found) {
    return;
  }
  causes.notes.push_back(fmt::format(
      "Edges lie {:.1f} px apart (rms), and {}: which belong together is not sure, and no cause is "
      "named for them.",
      fit.before_px,
      is_guided ? "too little of the outline was found in the real picture"
                : "they were not looked for along the simulated outline"));
  fit.causes.clear();
  fit.changes = {};
}

/// Edges of a picture that is mirrored or turned belong to other edges of the part.
void withhold_turned(const ComparedPair& pair, PairCauses& causes) {
  if (pair.better_turn) {
    causes.notes.push_back(fmt::format(
        "No cause is named for edges of a picture that seems to be {}.", pair.better_turn->name));
    causes.edges->causes.clear();
    causes.edges->changes = {};
  }
}

/// Why roughness is not looked for; empty: it is.
std::string reason_against_roughness(const ComparedPair& pair, const PairCauses& causes) {
  if (pair.better_turn || causes.is_pose_doubtful) {
    return "it is not sure where the part lies in the real picture.";
  }
  if (pair.appearance.correlation < kMinCorrelation) {
    return fmt::format("the grey values of both pictures correlate by {:.2f} only, less than {}.",
                       pair.appearance.correlation,
                       kMinCorrelation);
  }
  return "";
}

/// Where grey values show another roughness, and leave open which.
std::string open_roughness(double roughness, double change) {
  return fmt::format(
      "The metal seems to be {} than simulated (material.roughness = {:.3g}), but three renderings "
      "leave open by how much: neither roughness nor gain is told. Simulate it at a roughness near "
      "{:.2g} and compare again.",
      change > 0.0 ? "rougher" : "smoother",
      roughness,
      roughness + change);
}

/// The roughness, and the gain beside it in the place of the one that was told without it.
void tell_roughness(const ComparedPair& pair,
                    const compare_detail::RoughnessFit& fit,
                    PairCauses& causes) {
  causes.roughness_change = fit.change;
  causes.roughness_bound = fit.bound;
  causes.told.push_back({.name = "roughness",
                         .value = fit.change,
                         .sigma = fit.sigma,
                         .share = fit.share,
                         .of = "grey"});
  if (!has_unknown_exposure(pair) &&
      std::abs(fit.gain - 1.0) > std::max(kMinGain, kSurelySigmas * fit.gain_sigma)) {
    causes.gain = fit.gain;
    causes.told.push_back({.name = "gain",
                           .value = fit.gain,
                           .sigma = fit.gain_sigma,
                           .share = fit.gain_share,
                           .of = "grey"});
  }
}

}  // namespace

std::vector<SpaceEdge> space_edges(const ComparedPair& pair, const SceneSettings& scene) {
  constexpr double kMaxFree_px = 20.0;
  const SimulatedSurface surface = surface_of(pair, scene);
  const PinholeCamera camera(intrinsics_of(scene));
  std::vector<SpaceEdge> edges =
      matched_causes(pair, surface, camera.intrinsics(), surface.middle_mm(), {}).edges;
  for (SpaceEdge& edge : edges) {
    if (const auto at_px = camera.project(edge.in_camera_mm)) {
      edge.free_px = surface.free_px(*at_px, edge.normal, kMaxFree_px);
    }
  }
  return edges;
}

PairCauses find_causes(const ComparedPair& pair, const KnownCamera& known) {
  check_size(pair, known);
  PairCauses causes = {.calibrated = known.calibrated};
  const CompareSource& source = pair.simulated.source;
  if (!source.scene.empty() && !source.geometry.empty()) {
    const SceneSettings scene = load_scene(source.scene);
    const SimulatedSurface surface = surface_of(pair, scene);
    causes.middle_mm = surface.middle_mm();
    MatchedCauses matched =
        matched_causes(pair, surface, intrinsics_of(scene), causes.middle_mm, known);
    causes.edges = std::move(matched.fit);
    withhold_turned(pair, causes);
    withhold_doubtful(pair.geometry.outlines, pair.simulated.width(), causes);
    for (const FoundCause& found : causes.edges->causes) {
      causes.told.push_back(told(found));
    }
    note_contradiction(*causes.edges, causes.notes);
    causes.is_pose_doubtful = !causes.notes.empty();
    if (!causes.is_pose_doubtful) {
      causes.space_edges = std::move(matched.edges);
    }
  }
  if (const auto gain = gain_cause(pair)) {
    causes.gain = gain->value;
    causes.told.push_back(*gain);
  }
  return causes;
}

void add_roughness(const ComparedPair& pair, SceneStore& store, PairCauses& causes) {
  const CompareSource& source = pair.simulated.source;
  if (source.scene.empty() || !compare_detail::tells_roughness(load_scene(source.scene))) {
    return;
  }
  if (const std::string reason = reason_against_roughness(pair, causes); !reason.empty()) {
    causes.notes.push_back("Roughness was not looked for: " + reason);
    return;
  }
  PairCauses but_gain = causes;
  but_gain.gain = 1.0;
  // At the exposure of the simulated picture, wherever the part has moved since.
  const SceneSettings scene = with_equal_exposure(store, read_exposed_scene(source));
  const auto fit = compare_detail::fit_roughness(pair, refined_scene(scene, but_gain), store);
  if (!fit) {
    causes.notes.emplace_back(
        "Roughness could not be fitted: too few pixels of the sound part are within full scale, or "
        "their grey values do not tell it from the gain.");
    return;
  }
  if (std::abs(fit->change) < kSurelySigmas * fit->noise_sigma ||
      fit->share < kMinShare * (1.0 - fit->gain_share)) {
    return;
  }
  std::erase_if(causes.told, [](const ToldCause& cause) { return cause.name == "gain"; });
  causes.gain = 1.0;
  if (!fit->is_within_reach || std::abs(fit->change) < kSurelySigmas * fit->sigma) {
    causes.is_roughness_open = true;
    causes.notes.push_back(open_roughness(scene.material.roughness, fit->change));
    return;
  }
  tell_roughness(pair, *fit, causes);
}

void note_unsought_roughness(const ComparedPair& pair, PairCauses& causes) {
  const CompareSource& source = pair.simulated.source;
  if (source.scene.empty() || std::ranges::count(causes.told, "gain", &ToldCause::name) == 0 ||
      !compare_detail::tells_roughness(load_scene(source.scene))) {
    return;
  }
  causes.notes.emplace_back(
      "Roughness was not looked for (--roughness): the metal may be rougher or smoother than "
      "simulated, beside the gain or instead of it.");
}

}  // namespace glint
