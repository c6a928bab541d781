// SPDX-License-Identifier: GPL-3.0-or-later
//
// What sums of direct light save ring_geometry: d' of its worst defect by paths of 8 to 512 samples
// and by sums, against 1024 samples whose noise is taken out, and the CPU time of each evaluation.
// The designs are the study's baseline and its dome and bar. Times are printed, not asserted.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/cpu_clock.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_store.h"
#include "tests/studies/gallery/gallery_support.h"

namespace glint::direct_cost_test {
namespace {

constexpr const char* kScore = "defects.min_dprime";
constexpr const char* kErrorOfScore = "defects.min_dprime.error";

struct Row {
  std::string name;
  std::vector<double> errors;  ///< of each design and picture, as a share of the reference
  double cpu_s = 0.0;          ///< of an evaluation, mean of all
};

/// Root of the mean square.
double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) {
    squares += value * value;
  }
  return std::sqrt(squares / static_cast<double>(values.size()));
}

std::vector<SceneSettings> designs_of(const Study& study) {
  std::vector<SceneSettings> designs = {study.scene};
  for (const Prototype& prototype : study.prototypes) {
    designs.push_back(scene_with(study, prototype.overrides));
  }
  return designs;
}

/// Noise lowers d' by a share that falls as 1 / samples: the jackknife takes it out.
double reference_of(SceneSettings scene, ThreadPool& pool) {
  scene.paths.samples = 1024;
  scene.paths.batches = 8;
  scene.paths.seed += 5000011;
  SceneStore store(pool);
  const Evaluation evaluation = evaluate(store, scene, {}, {});
  const auto batches = static_cast<double>(evaluation.without_batch.size());
  double value = batches * evaluation.scores.at(kScore);
  for (const Scores& one : evaluation.without_batch) {
    value -= (batches - 1.0) / batches * one.at(kScore);
  }
  fmt::print("reference: d' {:.2f} +- {:.2f}\n", value, evaluation.scores.at(kErrorOfScore));
  return value;
}

/// Evaluates as a search does, from the part on; the part itself is built before.
void measure(const SceneSettings& scene, double right, ThreadPool& pool, Row& row, int of) {
  SceneStore store(pool);
  store.build_defects(scene);
  const WantedScores wanted = {.fringes = false, .robust = false, .slot = false, .errors = false};
  const double start = process_cpu_s();
  const double value = evaluate(store, scene, {}, wanted).scores.at(kScore);
  row.cpu_s += (process_cpu_s() - start) / of;
  row.errors.push_back(value / right - 1.0);
}

Row measured(const std::string& name,
             const std::vector<SceneSettings>& designs,
             const std::vector<double>& right,
             ThreadPool& pool) {
  Row row = {.name = name};
  for (std::size_t i = 0; i < designs.size(); ++i) {
    measure(designs[i], right[i], pool, row, static_cast<int>(designs.size()));
  }
  fmt::print("{}: rms error of d' {:.4f}, {:.3f} s of CPU\n", name, rms(row.errors), row.cpu_s);
  return row;
}

/// CPU time of paths at an error, along the line through the last two rows in logarithms.
double time_at(double error, const Row& coarse, const Row& fine) {
  const double slope =
      std::log(fine.cpu_s / coarse.cpu_s) / std::log(rms(fine.errors) / rms(coarse.errors));
  return fine.cpu_s * std::pow(error / rms(fine.errors), slope);
}

TEST(DirectCost, OfRingGeometryAtEqualErrorOfDetectability) {
  ThreadPool pool(2);
  const Study study = load_study(gallery::folder_of("ring_geometry") / "study.toml", {});
  std::vector<SceneSettings> designs = designs_of(study);
  std::vector<double> right;
  for (const SceneSettings& scene : designs) {
    right.push_back(reference_of(scene, pool));
  }
  std::vector<Row> paths;
  for (const int samples : {8, 32, 128, 512}) {
    for (SceneSettings& scene : designs) {
      scene.paths.samples = samples;
    }
    paths.push_back(measured(fmt::format("paths, {} samples", samples), designs, right, pool));
  }
  for (SceneSettings& scene : designs) {
    scene.paths.samples = study.scene.paths.samples;
    scene.render.method = RenderSettings::Method::kDirect;
  }
  const Row direct = measured("direct sum, 4 rays", designs, right, pool);
  const double equal_s = time_at(rms(direct.errors), paths[2], paths[3]);
  fmt::print("paths of the same error: {:.2f} s; {:.1f} times the sum's\n",
             equal_s,
             equal_s / direct.cpu_s);
  EXPECT_LT(rms(direct.errors), rms(paths[1].errors)) << "the study's own 32 samples";
}

}  // namespace
}  // namespace glint::direct_cost_test
