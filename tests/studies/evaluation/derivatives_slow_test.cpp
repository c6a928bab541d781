// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of scores against central differences on 200 random scenes, for every key offered.
// Prints the worst of each key and the share within 0.1 %.
//
// The differences are of scores in double (exact_scores.h), which are the program's to 1e-4 where
// it takes short cuts and to its rounding elsewhere. Both sides hold what the derivative holds and
// names in its remarks: which pixels are made how, the region, the defects' pixels, places of cells
// that are not smooth; the region keeps away from the part's outline by the reach of the blur.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/thread_pool.h"
#include "core/units.h"
#include "metrics/aspect_image/homogeneity.h"
#include "simulator/render/derivative/scan_gradient.h"
#include "studies/evaluation/scene_gradient.h"
#include "studies/imaging/scene_store.h"
#include "tests/studies/evaluation/derivative_scenes.h"
#include "tests/studies/evaluation/exact_scores.h"

namespace glint {
namespace {

constexpr int kScenes = 200;
constexpr double kSigmaFloor = 1e-3;

/// The goal of the derivatives.
constexpr double kTolerance = 1e-3;

/// Derivatives are measured by no less than this share of the key's mean size over the scenes: a
/// sum of terms that cancel is known no better than its terms.
constexpr double kSmallShare = 0.1;

/// Truths count that are known to this share of the tolerance.
constexpr double kSureShare = 0.5;

/// In units of what nothing is compared below: scores of an even picture do not change.
constexpr double kSmallest = 1e-12;

/// No grey value lies closer to full scale: on which side of its bend it is must not be a matter of
/// rounding.
constexpr double kClearance = 1e-6;

/// What is reached, not the goal: of the sure truths this share is met within the tolerance, over
/// all keys, and for each key and score; and so many are sure.
constexpr double kMinShareOfAll = 0.9995;
constexpr double kMinShare = 0.98;
constexpr double kMinSure = 0.999;

const std::vector<std::string>& scores_of_interest() {
  static const std::vector<std::string> names = {
      "homogeneity.h_rms", "homogeneity.mean", "defects.min_cnr"};
  return names;
}

struct Truth {
  double value = 0.0;
  double uncertainty = std::numeric_limits<double>::infinity();
};

/// A scene's scores with everything held that the derivative holds.
class DetachedScores {
 public:
  DetachedScores(const SceneSettings& scene, const TracedScene& traced)
      : scene_(scene),
        traced_(traced),
        tunnel_(scene.tunnel),
        sensor_(scene.sensor, traced.corners.width_px, traced.corners.height_px),
        footprints_(traced.corners, tunnel_, scene.scan, traced.camera_in_world_mm),
        plan_(plan_scan(
            footprints_, sensor_, traced.region, traced.watched, scene.render.reflectance)),
        closed_(scan_closed(footprints_, sensor_, plan_)),
        exact_(scene_, traced_, footprints_, plan_, kSigmaFloor),
        picture_(picture_of(traced.corners)) {}

  const ScanPlan& plan() const { return plan_; }

  const SceneSettings& scene() const { return scene_; }

  double lit_share() const { return uniformity().lit_share; }

  /// As the program computes them.
  ExactValues computed() const {
    const Homogeneity h = uniformity();
    const auto defects = defect_scores(closed_.aspect, traced_.defects, kSigmaFloor);
    return {h.h_rms, h.mean, summarise(defects).min_cnr};
  }

  double clearance() const { return exact_.clearance(scene_, picture_); }

  ExactValues exact() const { return exact_.at(scene_, picture_); }

  Gradients gradients(const std::vector<std::string>& paths, ThreadPool& pool) const {
    const ScanState state = {.traced = traced_,
                             .footprints = footprints_,
                             .sensor = sensor_,
                             .plan = plan_,
                             .aspect = closed_.aspect,
                             .sigma_floor = kSigmaFloor,
                             .slot = {},
                             .deviation = nullptr};
    return gradients_of(scene_, state, {.scores = scores_of_interest(), .paths = paths}, pool);
  }

  /// Derivatives by central differences over steps a third of each other. Long ones miss how
  /// stripes bend, short ones lose digits: the two neighbours count that differ least. The step
  /// before them must bear them out, with the threefold error: of many steps, two agree by chance.
  std::array<Truth, 3> truths(const std::string& path) const {
    constexpr std::array<std::size_t, 8> kFirst = {4, 5, 3, 6, 2, 7, 1, 0};
    constexpr double kGoodEnough = 1e-4;
    Ladder ladder(*this, path);
    std::array<Truth, 3> truths;
    for (const std::size_t first : kFirst) {
      bool is_good = true;
      for (std::size_t s = 0; s < truths.size(); ++s) {
        const Truth truth = ladder.truth(first, s);
        if (truth.uncertainty < truths[s].uncertainty) {
          truths[s] = truth;
        }
        is_good = is_good && truths[s].uncertainty <= kGoodEnough * std::abs(truths[s].value);
      }
      if (is_good) {
        break;
      }
    }
    return truths;
  }

 private:
  Homogeneity uniformity() const {
    return homogeneity(closed_.aspect, {}, scene_.scan.positions, traced_.region);
  }

  /// Central differences over ever shorter steps, each once.
  class Ladder {
   public:
    Ladder(const DetachedScores& scores, const std::string& path) : scores_(scores), path_(path) {}

    /// Of score s, from the steps first, first + 1 and first + 2.
    Truth truth(std::size_t first, std::size_t s) {
      const double wide = at(first)[s];
      const double middle = at(first + 1)[s];
      const double narrow = at(first + 2)[s];
      if (wide == 0.0 && middle == 0.0 && narrow == 0.0) {
        return {.value = 0.0, .uncertainty = 0.0};
      }
      const double change = narrow - middle;
      const double rounding = kRounding / step(first + 2) / (s == 2 ? kSigmaFloor : 1.0);
      return {.value = narrow + change / 8.0,
              .uncertainty = std::max(std::abs(change), std::abs(middle - wide) / 3.0) + rounding};
    }

   private:
    const ExactValues& at(std::size_t rung) {
      if (!differences_[rung]) {
        differences_[rung] = scores_.difference(path_, step(rung));
      }
      return *differences_[rung];
    }

    double step(std::size_t rung) const {
      const double longest = is_of_pose(path_) ? kLongestOfPose : kLongest;
      return longest * std::pow(3.0, -static_cast<double>(rung)) * step_of(scores_.scene_, path_);
    }

    static constexpr double kLongest = 30.0;
    static constexpr double kLongestOfPose = 1.0;  // rays cross dents' feet and the ridge of a roof
    static constexpr double kRounding = 1e-15;     // of a mean of grey values

    const DetachedScores& scores_;
    const std::string& path_;
    std::array<std::optional<ExactValues>, 10> differences_;
  };

  ExactValues difference(const std::string& path, double step) const {
    ExactValues analytic = at(path, step);
    const ExactValues low = at(path, -step);
    for (std::size_t s = 0; s < 3; ++s) {
      analytic[s] = (analytic[s] - low[s]) / (2.0 * step);
    }
    return analytic;
  }

  /// The scores with one number changed.
  ExactValues at(const std::string& path, double change) const {
    const SceneSettings scene = with_value(scene_, path, change);
    if (!is_of_pose(path)) {
      return exact_.at(scene, picture_);
    }
    return exact_.at(scene, picture_from(traced_, scene, camera_from_world(scene.viewpoint())));
  }

  SceneSettings scene_;
  const TracedScene& traced_;
  Tunnel tunnel_;
  Sensor sensor_;
  Footprints footprints_;
  ScanPlan plan_;
  ClosedScan closed_;
  ExactScores exact_;
  ExactPicture picture_;
};

/// One derivative and its truth.
struct Comparison {
  std::string score;
  std::string path;
  std::string scene;
  double derivative = 0.0;
  Truth truth;
};

std::string describe(std::uint64_t index, const SceneSettings& s, const ScanPlan& plan) {
  return fmt::format(
      "{:3} part {} {} {} slot {:.1f} period {:.1f} duty {:.3f} N {} gain {:.2f} "
      "blur {:.2f} dark {:.2f} frames {} table {}",
      index,
      index % 4,
      shape_name(s.tunnel.shape),
      form_name(plan.form.kind),
      s.tunnel.slot_mm,
      s.tunnel.period_mm,
      s.tunnel.duty,
      s.scan.positions,
      s.sensor.gain,
      s.sensor.blur_px,
      s.tunnel.dark_reflectance,
      plan.form.frame_pixels,
      plan.form.table_pixels);
}

/// The scene with a gain that leaves no grey value at the very edge of clipping.
std::unique_ptr<DetachedScores> scores_off_the_edge(SceneSettings scene,
                                                    const TracedScene& traced) {
  constexpr int kMaxTries = 50;
  constexpr double kMoreGain = 1e-5;
  auto scores = std::make_unique<DetachedScores>(scene, traced);
  for (int i = 0; i < kMaxTries && scores->clearance() < kClearance; ++i) {
    scene.sensor.gain *= 1.0 + kMoreGain;
    scores = std::make_unique<DetachedScores>(scene, traced);
  }
  return scores;
}

void expect_same_scores(const DetachedScores& scores) {
  const ExactValues computed = scores.computed();
  const ExactValues exact = scores.exact();
  EXPECT_NEAR(computed[0], exact[0], 1e-4);
  EXPECT_NEAR(computed[1], exact[1], 1e-4);
  EXPECT_NEAR(computed[2], exact[2], 1e-4 + 1e-4 * exact[2]);
}

std::vector<Comparison> compare(std::uint64_t index,
                                const SceneSettings& random,
                                const TracedScene& traced) {
  const std::unique_ptr<DetachedScores> scores = scores_off_the_edge(random, traced);
  if (scores->lit_share() < 0.3) {
    return {};  // a part that hardly mirrors the light is no lighting
  }
  expect_same_scores(*scores);
  ThreadPool pool(1);
  const SceneSettings& scene = scores->scene();
  const std::vector<std::string> paths = keys_offered(scene);
  const Gradients gradients = scores->gradients(paths, pool);
  std::vector<Comparison> all;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    EXPECT_EQ(without_derivative(scene, paths[p]), "") << paths[p];
    const std::array<Truth, 3> truths = scores->truths(paths[p]);
    for (std::size_t s = 0; s < 3; ++s) {
      const std::string& score = scores_of_interest()[s];
      all.push_back({.score = score,
                     .path = paths[p],
                     .scene = describe(index, scene, scores->plan()),
                     .derivative = gradients.by_score.at(score)[p],
                     .truth = truths[s]});
    }
  }
  return all;
}

/// "lighting.tunnel.control_mm.2" -> "control_mm", "viewpoint.0.direction.1" -> "direction".
std::string group_of(const std::string& path) {
  std::string name = path;
  while (name.back() >= '0' && name.back() <= '9') {
    name.resize(name.rfind('.'));
  }
  return name.substr(name.rfind('.') + 1);
}

/// Mean size of a group's derivatives.
double typical_size(const std::vector<const Comparison*>& group) {
  double sum = 0.0;
  for (const Comparison* c : group) {
    sum += std::abs(c->truth.value);
  }
  return sum / static_cast<double>(group.size());
}

struct Agreement {
  int sure = 0;    ///< comparisons whose truth is known well enough
  int within = 0;  ///< of these, within the tolerance
  int unsure = 0;
  double worst = 0.0;  ///< of the sure ones
  const Comparison* at = nullptr;
};

/// @param typical  size of such derivatives
Agreement agreement_of(const std::vector<const Comparison*>& group, double typical) {
  Agreement result;
  for (const Comparison* c : group) {
    const double size = std::max({kSmallShare * typical, std::abs(c->truth.value), kSmallest});
    if (c->truth.uncertainty > kSureShare * kTolerance * size) {
      ++result.unsure;
      continue;
    }
    const double error = std::abs(c->derivative - c->truth.value) / size;
    ++result.sure;
    result.within += error <= kTolerance ? 1 : 0;
    if (error >= result.worst) {
      result.worst = error;
      result.at = c;
    }
  }
  return result;
}

std::vector<Comparison> compare_all(ThreadPool& pool) {
  SceneStore store(pool);
  const std::vector<SceneSettings> parts = derivative_parts();
  std::vector<std::shared_ptr<const TracedScene>> traced;
  for (const SceneSettings& part : parts) {
    traced.push_back(store.trace(part));
  }
  const auto by_scene = pool.map<std::vector<Comparison>>(kScenes, [&](std::int64_t i) {
    const auto index = static_cast<std::uint64_t>(i);
    return compare(index, derivative_scene(parts, index), *traced[index % parts.size()]);
  });
  std::vector<Comparison> all;
  for (const std::vector<Comparison>& scene : by_scene) {
    all.insert(all.end(), scene.begin(), scene.end());
  }
  return all;
}

TEST(Derivatives, AgreeWithCentralDifferencesOnTwoHundredRandomScenes) {
  ThreadPool pool(2);
  const std::vector<Comparison> all = compare_all(pool);
  std::map<std::string, std::vector<const Comparison*>> groups;
  for (const Comparison& c : all) {
    groups[c.score + " by " + group_of(c.path)].push_back(&c);
  }
  int sure = 0;
  int within = 0;
  for (const auto& [name, group] : groups) {
    // The offset acts through the ripple alone: nothing, next to other shifts by a millimetre.
    const bool is_offset = name.ends_with("offset_mm");
    const std::string scale = group.front()->score + " by base_mm";
    const Agreement a = agreement_of(group, typical_size(is_offset ? groups.at(scale) : group));
    fmt::print("{:36} {:3} of {:3} within 0.1 %, {:3} unsure, worst {:.1e} {}\n",
               name,
               a.within,
               a.sure,
               a.unsure,
               a.worst,
               a.at != nullptr ? a.at->path + " " + a.at->scene : "");
    EXPECT_GE(a.within, kMinShare * a.sure) << name;
    sure += a.sure;
    within += a.within;
  }
  fmt::print("{} of {} sure ones within 0.1 %, {} in all\n", within, sure, all.size());
  EXPECT_GE(within, kMinShareOfAll * sure);
  EXPECT_GE(sure, kMinSure * static_cast<double>(all.size()));
}

}  // namespace
}  // namespace glint
