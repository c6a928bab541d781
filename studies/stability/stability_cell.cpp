// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/stability_cell.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/defect_windows.h"
#include "studies/stability/note_coverage.h"
#include "studies/stability/reference/reference_light.h"
#include "studies/stability/reference/reference_picture.h"

namespace glint::stability {
namespace {

using Eigen::Vector3d;

constexpr int kCoarse = 3;  ///< rays along a side of a film cell; 144 rays a pixel
constexpr int kFine = 6;    ///< 576 rays a pixel, where the coarse ones leave a doubt
constexpr double kDoubtful = 0.5;
constexpr double kStandardErrors = 3.0;
constexpr double kBlack = 1e-6;  ///< of full scale

double score_of(const Evaluation& evaluation, const std::string& name) {
  const auto found = evaluation.scores.find(name);
  return found == evaluation.scores.end() ? 0.0 : found->second;
}

CellError h_error(double measured, double reference, bool is_black, const Bounds& bounds) {
  return {.quantity = "h_points",
          .error = is_black ? 0.0 : 100.0 * std::abs(measured - reference),
          .bound = bounds.h_points,
          .measured = measured,
          .reference = reference};
}

/// Of the mean image over the region. Noise of single pixels is no error: then means are compared.
CellError picture_error(const ImageF& aspect,
                        const std::vector<double>& reference,
                        const std::vector<char>& region,
                        bool is_noisy,
                        const Bounds& bounds) {
  double count = 0.0;
  double square = 0.0;
  CellError error{.quantity = is_noisy ? "mean" : "picture", .bound = bounds.picture};
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] != 0) {
      const double measured = static_cast<double>(aspect.values()[i]);
      count += 1.0;
      square += (measured - reference[i]) * (measured - reference[i]);
      error.measured += measured;
      error.reference += reference[i];
    }
  }
  count = std::max(count, 1.0);
  error.measured /= count;
  error.reference /= count;
  error.error = is_noisy ? std::abs(error.measured - error.reference) : std::sqrt(square / count);
  return error;
}

CellError contrast_error(const Outcome& outcome,
                         const ReferenceScene& scene,
                         const ReferenceScores& scores,
                         const Bounds& bounds) {
  CellError worst{.quantity = "contrast_percent", .error = -1.0, .bound = bounds.contrast_percent};
  for (std::size_t i = 0; i < scene.part.dents.size(); ++i) {
    const auto found = std::ranges::find(
        outcome.evaluation.defects, scene.part.dents[i].label, &DefectScores::label);
    GLINT_CHECK(found != outcome.evaluation.defects.end(), "a dent has no scores");
    const double right = scores.change[i];
    const double error = 100.0 * std::abs(found->change - right) / std::max(right, kMinContrast);
    if (error > worst.error) {
      worst.error = error;
      worst.measured = found->change;
      worst.reference = right;
    }
  }
  return worst;
}

std::vector<CellError> compared(const Outcome& outcome,
                                const ReferenceScene& scene,
                                const RaySampling& sampling,
                                const Bounds& bounds) {
  const ReferenceScores right = reference_scores(scene, sampling);
  const Evaluation& made = outcome.evaluation;
  const bool is_noisy = scene.sensor.full_well_e > 0.0 || frame_method(outcome.scene).is_noisy;
  std::vector<CellError> errors = {
      picture_error(made.aspect, right.aspect.mean, right.region, is_noisy, bounds)};
  const double h = score_of(made, "homogeneity.h_rms");
  const bool is_black = right.mean < kBlack && errors.front().measured < kBlack;
  errors.push_back(h_error(h, right.h_rms, is_black, bounds));
  if (!scene.part.dents.empty()) {
    errors.push_back(contrast_error(outcome, scene, right, bounds));
  }
  return errors;
}

bool is_doubtful(const CellError& error) {
  return error.error > kDoubtful * error.bound;
}

/// Whether the program tells a standard error beside the score that covers the error.
std::string standard_error_told(const Outcome& outcome, const CellError& error) {
  const double told = score_of(outcome.evaluation, "homogeneity.h_rms.error");
  const bool is_covered =
      error.quantity == "h_points" && error.error <= kStandardErrors * 100.0 * told;
  return is_covered ? fmt::format("homogeneity.h_rms.error is {:.2g} points", 100.0 * told)
                    : std::string();
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight:
      return "right";
    case Verdict::kTold:
      return "told";
    case Verdict::kRefused:
      return "refused";
    case Verdict::kWrong:
      return "silently wrong";
  }
  return "";
}

const CellError* worst_of(const Cell& cell) {
  const auto worst = std::ranges::max_element(
      cell.errors, {}, [](const CellError& error) { return error.error / error.bound; });
  return worst == cell.errors.end() ? nullptr : &*worst;
}

Outcome evaluated(SceneStore& store, const ConfigNode& root) {
  std::vector<Problem> problems;
  const SceneSettings read = read_scene(root, problems);
  if (!problems.empty()) {
    throw ConfigError(problems);
  }
  const SceneSettings scene = first_view(store, read);
  check_cameras_outside_part(store, scene);
  check_part_in_tunnel(store, scene);
  Outcome outcome{.evaluation = evaluate(store, scene), .scene = scene};
  outcome.notes = scene_notes(scene, outcome.evaluation.scores);
  const TracedScene& traced = *outcome.evaluation.traced;
  for (const SceneNote& note :
       {SceneNote{NoteKind::kNarrowDefect, narrow_defects_note(traced, scene)},
        SceneNote{NoteKind::kDefectStripes, defect_stripes_note(traced, scene)}}) {
    if (!note.text.empty()) {
      outcome.notes.push_back(note);
    }
  }
  return outcome;
}

std::vector<SceneNote> notes_beside(const Outcome& outcome, const Outcome* harmless) {
  std::vector<SceneNote> notes;
  for (const SceneNote& note : outcome.notes) {
    if (harmless != nullptr &&
        std::ranges::find(harmless->notes, note.kind, &SceneNote::kind) == harmless->notes.end()) {
      notes.push_back(note);
    }
  }
  return notes;
}

std::vector<CellError> errors_of_tunnel(const Outcome& outcome, const Bounds& bounds) {
  ReferenceScene scene = reference_scene(outcome.scene);
  for (const DefectPixels& dent : outcome.evaluation.traced->defects) {
    scene.dent_pixels.push_back(dent.inside);  // which pixels count is a definition, not a kernel
  }
  std::vector<CellError> errors = compared(outcome, scene, {.samples = kCoarse, .seed = 1}, bounds);
  if (std::ranges::none_of(errors, is_doubtful)) {
    return errors;
  }
  std::vector<CellError> finer = compared(outcome, scene, {.samples = kFine, .seed = 2}, bounds);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double difference = std::abs(finer[i].reference - errors[i].reference);
    finer[i].uncertainty = difference * finer[i].error /
                           std::max(1e-12, std::abs(finer[i].measured - finer[i].reference));
  }
  return finer;
}

std::vector<CellError> errors_of_bar(const Outcome& outcome, const Bounds& bounds) {
  const SceneSettings& scene = outcome.scene;
  const auto& bar = std::get<BarSettings>(scene.lights.front().settings);
  const Vector3d middle(
      bar.placement.position_mm[0], bar.placement.position_mm[1], bar.placement.position_mm[2]);
  const Vector3d u(0.5 * bar.length_mm, 0.0, 0.0);
  const Vector3d v(0.0, 0.0, 0.5 * bar.width_mm);
  const std::array<Vector3d, 4> corners = {
      middle - u - v, middle + u - v, middle + u + v, middle - u + v};
  const double top_mm = 0.5 * scene.part.thickness_mm;
  const double pixel_mm = scene.camera.object_pixel_mm *
                          (scene.camera.working_distance_mm - top_mm) /
                          scene.camera.working_distance_mm;
  constexpr int kSub = 8;
  std::vector<double> right;
  std::vector<char> region;
  for (int i = 0; i < scene.camera.width_px * scene.camera.height_px; ++i) {
    const int row = i / scene.camera.width_px;
    const double left = i % scene.camera.width_px - 0.5 * scene.camera.width_px;
    const double up = 0.5 * scene.camera.height_px - row;
    double sum = 0.0;
    for (int s = 0; s < kSub * kSub; ++s) {
      const int sub_row = s / kSub;
      const Vector3d place((left + (s % kSub + 0.5) / kSub) * pixel_mm,
                           (up - (sub_row + 0.5) / kSub) * pixel_mm,
                           top_mm);
      sum += polygon_irradiance(corners, place, Vector3d::UnitZ(), bar.emission.radiance.front());
    }
    right.push_back(scene.material.reflectance.front() / kPi * sum / (kSub * kSub));
    const double rim = (scene.metrics.erosion_px + 1.0) * pixel_mm;
    region.push_back(std::abs((left + 0.5) * pixel_mm) < 0.5 * scene.part.length_mm - rim &&
                             std::abs((up - 0.5) * pixel_mm) < 0.5 * scene.part.width_mm - rim
                         ? 1
                         : 0);
  }
  return {picture_error(outcome.evaluation.aspect, right, region, false, bounds)};
}

void judge(const Outcome& outcome, const Outcome* harmless, Cell& cell) {
  const std::vector<SceneNote> notes = notes_beside(outcome, harmless);
  cell.verdict = Verdict::kRight;
  std::vector<std::string> messages;  // each once
  for (const CellError& error : cell.errors) {
    if (error.error - error.uncertainty <= error.bound) {
      continue;
    }
    std::vector<std::string> told = told_of(error.quantity, notes);
    if (std::string own = standard_error_told(outcome, error); told.empty() && !own.empty()) {
      told.push_back(std::move(own));
    }
    if (told.empty()) {
      cell.verdict = Verdict::kWrong;
      cell.message.clear();
      return;
    }
    cell.verdict = Verdict::kTold;
    std::ranges::copy_if(told, std::back_inserter(messages), [&](const std::string& text) {
      return std::ranges::find(messages, text) == messages.end();
    });
  }
  cell.message = join(messages, " ");
}

}  // namespace glint::stability
