// SPDX-License-Identifier: GPL-3.0-or-later
//
// Would pictures of half the pixels a side be a rung of [accuracy]? A quarter of the pixels pays
// for four times the samples of each. So three path-traced studies are scored both ways at about
// equal work, and in a third way that takes no more: all pixels, the noise of their batches taken
// out of the scores by the jackknife. Errors are those of twelve designs against many samples whose
// noise is taken out, as they come and after a correction that is known from twelve other designs:
// their mean error (a control variate of coefficient 1), or a line through their scores.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/definition/ladder/larger_pixels.h"
#include "studies/definition/ladder/render_ladder.h"
#include "studies/evaluation/evaluation.h"
#include "studies/frontier/frontier_methods.h"
#include "studies/frontier/pooled_score.h"
#include "studies/imaging/scene_store.h"
#include "tests/studies/gallery/gallery_support.h"
#include "tests/support/temporary_folder.h"

namespace glint::half_resolution_test {
namespace {

constexpr std::size_t kTried = 12;  ///< designs that the corrections are known from
constexpr std::size_t kFresh = 12;  ///< designs that errors are counted over
constexpr int kReferenceSamples = 256;
constexpr int kBatches = 4;
constexpr int kOtherSeed = 5000011;
const std::vector<std::string> kScores = {"homogeneity.mean",
                                          "homogeneity.h_rms",
                                          "homogeneity.clipped_share",
                                          "defects.min_weber",
                                          "defects.min_cnr",
                                          "defects.min_dprime"};

/// How pictures are made.
struct Setting {
  int factor = 1;          ///< of the pixels' size
  int samples = 0;         ///< of each
  bool is_pooled = false;  ///< the jackknife takes the noise of its batches out of the scores

  std::string name() const {
    return fmt::format(
        "{} samples{}{}", samples, factor > 1 ? ", half" : "", is_pooled ? ", jackknife" : "");
  }
};

/// Root of the mean square error as it comes, less the mean error, and off the line.
struct Errors {
  double raw = 0.0;
  double by_mean = 0.0;
  double by_line = 0.0;

  double least() const { return std::min({raw, by_mean, by_line}); }
};

/// Scores of designs, those of one design at the same place in each.
using Values = std::vector<double>;

double mean_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

/// right = offset + slope value by least squares; a slope of 1 where all values are the same.
struct Line {
  double offset = 0.0;
  double slope = 1.0;
};

Line line_through(std::span<const double> values, std::span<const double> right) {
  const double mean = mean_of(values);
  const double mean_right = mean_of(right);
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    square += (values[i] - mean) * (values[i] - mean);
    product += (values[i] - mean) * (right[i] - mean_right);
  }
  const double slope = square > 0.0 ? product / square : 1.0;
  return {.offset = mean_right - slope * mean, .slope = slope};
}

double rms_off(std::span<const double> values, std::span<const double> right, const Line& line) {
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double error = line.offset + line.slope * values[i] - right[i];
    squares += error * error;
  }
  return std::sqrt(squares / static_cast<double>(values.size()));
}

/// @param values, right  of the designs that were tried, then of the others
Errors errors_of(std::span<const double> values, std::span<const double> right) {
  const auto tried = values.first(values.size() - kFresh);
  const auto tried_right = right.first(tried.size());
  const auto fresh = values.last(kFresh);
  const auto fresh_right = right.last(kFresh);
  const Line shift = {.offset = mean_of(tried_right) - mean_of(tried)};
  return {.raw = rms_off(fresh, fresh_right, {}),
          .by_mean = rms_off(fresh, fresh_right, shift),
          .by_line = rms_off(fresh, fresh_right, line_through(tried, tried_right))};
}

TEST(HalfResolutionCorrection, IsExactForScoresThatAreOffByALine) {
  Values values(kTried + kFresh);
  Values shifted(values.size());
  Values scaled(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::sin(static_cast<double>(i));
    shifted[i] = values[i] + 0.25;
    scaled[i] = 2.0 * values[i] - 1.0;
  }
  EXPECT_NEAR(errors_of(values, shifted).raw, 0.25, 1e-12);
  EXPECT_NEAR(errors_of(values, shifted).by_mean, 0.0, 1e-12);
  EXPECT_NEAR(errors_of(values, scaled).by_line, 0.0, 1e-12);
  EXPECT_GT(errors_of(values, scaled).by_mean, 0.5) << "a shift mends no factor";
}

/// Those that every picture without a batch has too, and their standard errors.
Scores pooled_scores(const Evaluation& evaluation) {
  Scores pooled;
  for (const std::string& score : kScores) {
    Values without;
    for (const Scores& one : evaluation.without_batch) {
      if (const auto found = one.find(score); found != one.end()) {
        without.push_back(found->second);
      }
    }
    if (without.size() == std::size_t{kBatches}) {
      const ReferenceScore right = pooled_score(score, evaluation.scores.at(score), without);
      pooled[score] = right.value;
      pooled[score + ".error"] = right.standard_error;
    }
  }
  return pooled;
}

class HalfResolution {
 public:
  HalfResolution(const Study& study, int factor)
      : pool_(2), store_(pool_), factor_(factor), study_(study) {
    store_.leave_out_unseen_defects();
    const Sobol sequence(1, static_cast<int>(study.space.variables.size()));
    for (std::uint32_t k = 0; reference_.size() < kTried + kFresh && k < 2 * (kTried + kFresh);
         ++k) {
      const Point point = point_from_unit(study.space, sequence.point(k));
      if (std::optional<Scores> right = reference(point)) {
        designs_.push_back(point);
        reference_.push_back(*right);
      }
    }
  }

  std::size_t designs() const { return designs_.size(); }

  /// Whether every design has it.
  bool has(const std::string& score) const {
    return std::ranges::all_of(reference_,
                               [&](const Scores& scores) { return scores.contains(score); });
  }

  /// In counted work, of an evaluation.
  double work(const Setting& setting) const { return counted_work(scene_of(designs_[0], setting)); }

  std::map<std::string, Errors> errors(const Setting& setting) {
    std::vector<Scores> found;
    for (const Point& point : designs_) {
      const Evaluation evaluation = scores_of(scene_of(point, setting));
      found.push_back(setting.is_pooled ? pooled_scores(evaluation) : evaluation.scores);
    }
    std::map<std::string, Errors> errors;
    for (const std::string& score : kScores) {
      if (has(score)) {
        errors[score] = errors_of(values_of(found, score), values_of(reference_, score));
      }
    }
    return errors;
  }

  /// Standard deviation over the designs that were not tried, and the reference's own error.
  std::pair<double, double> spread(const std::string& score) const {
    const Values right = values_of(reference_, score);
    const auto fresh = std::span(right).last(kFresh);
    const Line none = {.offset = mean_of(fresh), .slope = 0.0};
    return {rms_off(fresh, fresh, none), mean_of(values_of(reference_, score + ".error"))};
  }

 private:
  static Values values_of(const std::vector<Scores>& designs, const std::string& score) {
    Values values;
    for (const Scores& scores : designs) {
      values.push_back(scores.at(score));
    }
    return values;
  }

  SceneSettings scene_of(const Point& point, const Setting& setting) const {
    SceneSettings scene = scene_with(study_, overrides_of(study_, point));
    scene.paths.samples = setting.samples;
    scene.paths.batches = kBatches;
    return with_larger_pixels(std::move(scene), factor_ * setting.factor);
  }

  Evaluation scores_of(const SceneSettings& scene) {
    return evaluate(
        store_, scene, {}, {.fringes = false, .changes = false, .robust = false, .slot = false});
  }

  /// Of a design that can be built; without the reference's noise.
  std::optional<Scores> reference(const Point& point) {
    SceneSettings scene = scene_of(point, {.samples = kReferenceSamples});
    scene.paths.seed += kOtherSeed;
    try {
      return pooled_scores(scores_of(scene));
    } catch (const ConfigError& error) {
      fmt::print("left out: {}\n", error.what());
      return std::nullopt;
    }
  }

  ThreadPool pool_;
  SceneStore store_;
  int factor_;
  const Study& study_;
  std::vector<Point> designs_;
  std::vector<Scores> reference_;
};

struct Measured {
  Setting setting;
  double work = 0.0;
  std::map<std::string, Errors> errors;
};

/// Whether nothing that takes no more work is closer, with whatever correction.
bool is_on_front(const Measured& row, const std::vector<Measured>& rows, const std::string& score) {
  return std::ranges::none_of(rows, [&](const Measured& other) {
    return other.work <= row.work && other.errors.at(score).least() < row.errors.at(score).least();
  });
}

std::vector<Setting> settings() {
  std::vector<Setting> settings;
  for (const int samples : {4, 16, 64}) {
    settings.push_back({.samples = samples});
    settings.push_back({.samples = samples, .is_pooled = true});
    settings.push_back({.factor = 2, .samples = 4 * samples});
  }
  return settings;
}

/// @return whether half resolution is on the front
bool print_rows(const std::vector<Measured>& rows, const std::string& score) {
  bool has_half = false;
  for (const Measured& row : rows) {
    const Errors& errors = row.errors.at(score);
    const bool is_best = is_on_front(row, rows, score);
    fmt::print("| {} | {:.3f} | {:.2g} | {:.2g} | {:.2g} |{}\n",
               row.setting.name(),
               row.work,
               errors.raw,
               errors.by_mean,
               errors.by_line,
               is_best ? " front" : "");
    has_half = has_half || (is_best && row.setting.factor > 1);
  }
  return has_half;
}

/// Prints for each score that differs between designs what each setting makes of it.
void compare(const std::string& name, const Study& study, int factor) {
  HalfResolution half(study, factor);
  ASSERT_EQ(half.designs(), kTried + kFresh);
  std::vector<Measured> rows;
  for (const Setting& setting : settings()) {
    rows.push_back({setting, half.work(setting), half.errors(setting)});
  }
  std::ranges::sort(rows, {}, &Measured::work);
  for (const auto& [score, unused] : rows.front().errors) {
    const auto [spread, noise] = half.spread(score);
    if (spread > 0.0) {
      fmt::print("\n{}, {}: spread {:.2g}, reference +- {:.2g}\n", name, score, spread, noise);
      fmt::print("half resolution is {}on the front\n", print_rows(rows, score) ? "" : "not ");
    }
  }
}

TEST(HalfResolution, OfRingGeometry) {
  const Study study = load_study(gallery::folder_of("ring_geometry") / "study.toml", {});
  compare("ring_geometry", study, 3);
}

TEST(HalfResolution, OfWhichLight) {
  const Study study = load_study(gallery::folder_of("which_light") / "study.toml", {});
  compare("which_light", study, 1);
}

TEST(HalfResolution, OfAGearUnderARing) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             fmt::format("schema = 1\ninclude = [\"{}\"]\n"
                         "[render.paths]\nmax_reflections = 4\n[variables]\n"
                         "\"lighting.ring.inner_radius_mm\" = {{ min = 20, max = 60 }}\n"
                         "\"lighting.ring.height_mm\" = {{ min = 0, max = 80 }}\n"
                         "\"lighting.ring.radiance.0\" = {{ min = 20, max = 60 }}\n"
                         "[objective]\nmaximise = \"homogeneity.h_rms\"\n",
                         (gallery::folder_of("gear_ring") / "scene.toml").string()));
  compare("gear", load_study(folder / "study.toml", {}), 24);
}

}  // namespace
}  // namespace glint::half_resolution_test
