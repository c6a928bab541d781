// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/starter/starter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "core/thread_pool.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/definition/render_methods.h"
#include "studies/definition/scene.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/illuminated_place.h"
#include "studies/report/report_wording.h"
#include "studies/report/score_words.h"
#include "studies/starter/starter_text.h"

namespace glint {
namespace {

using report_detail::measured;

/// A defect's background reaches five radii; half a diameter is left for blur.
constexpr double kBackgroundDiameters = 3.0;

constexpr std::size_t kPlaces = 12;

/// Lightings of the study's variables that are tried where the start shows no dent.
constexpr std::uint32_t kTries = 8;

/// Dents get steeper by this factor until one shows.
constexpr double kSteeper = 2.0;
constexpr int kSlopes = 3;

/// What kept scenes and walls may take. Each scene is asked for in a row and then hardly again; of
/// a bumpy mesh one has up to a gigabyte of rays.
constexpr std::size_t kKeptBytes = std::size_t{1} << 30U;

/// Below this share of lit surface a user should know.
constexpr double kWellLit = 0.9;

class StarterMaker {
 public:
  explicit StarterMaker(const StarterRequest& request)
      : request_(request), pool_(request.threads), store_(pool_, kKeptBytes) {
    plan_.light = request.light;
    plan_.part_file = request.part_file;
    plan_.unit = request.unit;
    plan_.study_file = request.study_file;
    plan_.camera_keys = request.camera_keys;
    plan_.slope_rad = is_mirror(request.light) ? 0.02 : 0.1;
  }

  Starter make() {
    choose_tilt();
    fill_pictures();
    choose_place();
    set_limits();
    if (lit_share_ < kWellLit) {
      starter_.notes.push_back(
          fmt::format("Light reaches {:.0f} % of what the camera sees of the part; defects on the "
                      "rest do not show. Other poses show other sides.",
                      100.0 * lit_share_));
    }
    starter_.text = starter_text(plan_);
    return std::move(starter_);
  }

 private:
  using Values = std::vector<std::pair<std::string, double>>;

  /// A scene of the plan, from its text, so that what is tried is what is written.
  SceneSettings scene_of(const std::string& text, const Values& values) const {
    ConfigNode root = parse_toml(text, "new study");
    // Written relative to the folder of the file to come, which need not be there yet.
    set_path(root,
             "part.file",
             ConfigNode::from_text(std::filesystem::absolute(request_.part.file).string()));
    for (const auto& [path, value] : values) {
      set_path(root, path, ConfigNode::from_number(value));
    }
    std::vector<Problem> errors;
    SceneSettings scene = read_scene(root, errors);
    throw_if_any(errors);
    scene.part.file = request_.part.file;
    return scene;
  }

  SceneSettings scene_of(const StarterPlan& plan, const Values& values = {}) const {
    const StarterLight kind = plan.light == StarterLight::kAll ? StarterLight::kRing : plan.light;
    return scene_of(starter_text(plan, kind), values);
  }

  /// The part under a mirror's tunnel: where its light goes, any light can be placed.
  SceneSettings tunnel_scene(const StarterPlan& plan) const {
    StarterPlan mirror = plan;
    mirror.light = StarterLight::kTunnel;
    mirror.places_mm.clear();
    SceneSettings scene = scene_of(starter_text(mirror, StarterLight::kTunnel), {});
    scene.defects.clear();
    if (!is_mirror(plan.light)) {
      scene.tunnel.radius_mm = 2.0 * plan.sizes.working_distance_mm;
      scene.tunnel.length_mm = 10.0 * scene.tunnel.radius_mm;
      scene.tunnel.slot_mm = 0.0;
      scene.tunnel.blocks_view = false;
    }
    return scene;
  }

  /// The part upright or tilted: what most of the light reaches.
  void choose_tilt() {
    const auto built = store_.build({.part = request_.part});
    plan_.name = built->part.name;
    const Eigen::Vector3d size_mm = built->part.box_in_part_mm.size_mm();
    for (const double tilt_deg : {0.0, 15.0, 30.0}) {
      StarterPlan plan = plan_;
      plan.sizes = starter_sizes(size_mm, tilt_deg, request_.working_distance_mm, request_.light);
      const IlluminatedPlaces places = illuminated_places(
          store_, tunnel_scene(plan), kBackgroundDiameters * plan.sizes.diameter_mm, kPlaces);
      if (!places.places_mm.empty() && places.lit_share > lit_share_) {
        lit_share_ = places.lit_share;
        plan_ = plan;
        candidates_ = places.places_mm;
      }
      if (!is_mirror(request_.light)) {
        break;  // no slot to look past
      }
    }
    if (candidates_.empty()) {
      throw ConfigError(fmt::format(
          "{}: no place of the part is both seen by the camera and lit; another side may be, turn "
          "the part before it is saved",
          request_.part.file.string()));
    }
  }

  /// Exposures at which each light fills the picture without clipping; a tunnel over a mirror does
  /// as it is.
  void fill_pictures() {
    if (is_mirror(request_.light)) {
      return;
    }
    for (const StarterLight kind :
         {StarterLight::kRing, StarterLight::kDome, StarterLight::kBar, StarterLight::kTunnel}) {
      if (request_.light == kind || request_.light == StarterLight::kAll) {
        plan_.exposures[kind] = filling_exposure(kind);
      }
    }
  }

  double filling_exposure(StarterLight kind) {
    constexpr int kSteps = 16;
    constexpr double kMean = 0.4;
    SceneSettings scene = scene_of(starter_text(plan_, kind), {});
    scene.defects.clear();
    const WantedScores wanted = {
        .fringes = false, .defects = false, .robust = false, .slot = false, .errors = false};
    bool has_clipped = false;
    for (int step = 0; step < kSteps; ++step) {
      const Scores scores = evaluate(store_, scene, {}, wanted).scores;
      const double mean = scores.at("homogeneity.mean");
      if (scores.at("homogeneity.clipped_share") > 0.5 * plan_.max_clipped || mean > 1.5 * kMean) {
        has_clipped = true;
        scene.sensor.exposure *= 0.7;
      } else if (!has_clipped && mean < 0.8 * kMean) {
        scene.sensor.exposure *= std::clamp(kMean / std::max(mean, 1e-6), 1.2, 8.0);
      } else {
        break;
      }
    }
    return scene.sensor.exposure;
  }

  /// The worst score of each candidate's dent under one lighting; 0 where it cannot be scored.
  std::vector<double> dents_shown(const Values& values) {
    StarterPlan plan = plan_;
    plan.places_mm = candidates_;
    const WantedScores wanted = {.fringes = false, .robust = false, .slot = false, .errors = false};
    try {
      const Evaluation found = evaluate(store_, scene_of(plan, values), {}, wanted);
      std::vector<double> scores;
      for (const DefectScores& defect : found.defects) {
        scores.push_back(is_mirror(plan.light) ? defect.cnr : defect.dprime);
      }
      scores.resize(candidates_.size());
      return scores;
    } catch (const ConfigError&) {  // a lighting that cannot be built
      std::vector<double> zeros(candidates_.size(), 0.0);
      return zeros;
    }
  }

  SceneSettings scene_at(const std::vector<Eigen::Vector2d>& places) const {
    StarterPlan plan = plan_;
    plan.places_mm = places;
    return scene_of(plan);
  }

  /// Whether each of the scene's dents has a pixel and a background of its own.
  bool can_be_scored(const SceneSettings& scene) {
    try {
      store_.trace(scene);
      return true;
    } catch (const ConfigError&) {
      return false;
    }
  }

  /// Leaves the candidates that can be scored. Coarse rays tell nearly as much, in a hundredth of
  /// the time where facets are many.
  void drop_unscored() {
    std::erase_if(candidates_, [&](const Eigen::Vector2d& place) {
      return !can_be_scored(coarse_settings(scene_at({place})));
    });
    if (!candidates_.empty() && !can_be_scored(scene_at(candidates_))) {
      std::erase_if(candidates_, [&](const Eigen::Vector2d& place) {
        return !can_be_scored(scene_at({place}));
      });
    }
    if (candidates_.empty()) {
      throw ConfigError(
          fmt::format("{}: no place of the part has room for a dent and its "
                      "background; a camera with more pixels may show one",
                      request_.part.file.string()));
    }
  }

  /// Values of the variables, evenly spread over their ranges.
  std::vector<Values> tried_lightings() const {
    std::vector<Values> lightings;
    const SearchSpace space = starter_space(plan_);
    if (space.variables.empty()) {
      return lightings;
    }
    const Sobol sobol(1, static_cast<int>(space.variables.size()));
    for (std::uint32_t i = 0; i < kTries; ++i) {
      const Point point = point_from_unit(space, sobol.point(i));
      Values values;
      for (std::size_t v = 0; v < point.size(); ++v) {
        values.emplace_back(space.variables[v].name, point[v]);
      }
      lightings.push_back(std::move(values));
    }
    return lightings;
  }

  /// The first candidate that shows at the start, else the one that shows most under any lighting
  /// that is tried. @return whether it is visible in one of them
  bool choose_among_candidates() {
    const double wanted = visible_score(request_.light);
    const std::vector<double> start = dents_shown({});
    const auto first = std::ranges::find_if(start, [&](double score) { return score >= wanted; });
    if (first != start.end()) {
      take(static_cast<std::size_t>(first - start.begin()), *first);
      return true;
    }
    std::vector<double> best = start;
    for (const Values& lighting : tried_lightings()) {
      const std::vector<double> shown = dents_shown(lighting);
      std::ranges::transform(
          best, shown, best.begin(), [](double a, double b) { return std::max(a, b); });
    }
    const auto most = std::ranges::max_element(best);
    const auto index = static_cast<std::size_t>(most - best.begin());
    take(index, start[index]);
    best_score_ = *most;
    return *most >= wanted;
  }

  void take(std::size_t index, double start_score) {
    plan_.places_mm = {candidates_[index]};
    starter_.start_score = start_score;
    best_score_ = start_score;
  }

  void choose_place() {
    drop_unscored();
    const double first_slope_rad = plan_.slope_rad;
    for (int step = 0; step < kSlopes; ++step) {
      plan_.slope_rad = first_slope_rad * std::pow(kSteeper, step);
      starter_.is_dent_visible = choose_among_candidates();
      if (starter_.is_dent_visible) {
        break;
      }
    }
    tell_about_dent(first_slope_rad);
  }

  void tell_about_dent(double first_slope_rad) {
    const std::string score = report_detail::score_label(std::string(objective_of(request_.light)));
    const auto tell = [&](const std::string& text) {
      plan_.remarks.push_back(text);
      starter_.notes.push_back(text);
    };
    if (plan_.slope_rad > first_slope_rad && starter_.is_dent_visible) {
      tell(fmt::format("A dent of {:g} mrad showed nowhere, so this one is steeper.",
                       500.0 * plan_.slope_rad));
    }
    if (!starter_.is_dent_visible) {
      tell(
          fmt::format("No lighting that was tried shows it: {} is {} at most, visible from "
                      "{:g} on. Take a deeper dent, another pose or another light.",
                      score,
                      measured(best_score_),
                      visible_score(request_.light)));
    } else if (starter_.start_score < visible_score(request_.light)) {
      tell(
          fmt::format("The start does not show it ({} {}), other values of the variables do "
                      "({}).",
                      score,
                      measured(starter_.start_score),
                      measured(best_score_)));
    }
  }

  /// Uniformity five points below the start's, whatever it is; clipping as little as the start
  /// allows.
  void set_limits() {
    constexpr double kLess = 0.05;
    const Scores scores = evaluate(store_, scene_of(plan_)).scores;
    plan_.min_h = std::floor(100.0 * (scores.at("homogeneity.h_rms") - kLess)) / 100.0;
    plan_.max_clipped = std::max(is_mirror(request_.light) ? 0.01 : 0.02,
                                 std::ceil(100.0 * scores.at("homogeneity.clipped_share")) / 100.0);
    starter_.start_score = scores.at(std::string(objective_of(request_.light)));
  }

  const StarterRequest& request_;
  ThreadPool pool_;
  SceneStore store_;
  StarterPlan plan_;
  std::vector<Eigen::Vector2d> candidates_;
  double lit_share_ = -1.0;
  double best_score_ = 0.0;
  Starter starter_;
};

}  // namespace

double visible_score(StarterLight light) {
  return is_mirror(light) ? 3.0 : 5.0;
}

Starter make_starter(const StarterRequest& request) {
  return StarterMaker(request).make();
}

}  // namespace glint
