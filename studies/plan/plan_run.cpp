// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/plan_run.h"

#include <array>
#include <chrono>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/wall_clock.h"
#include "studies/cell/cell_copy.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/study_text.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"
#include "studies/output/run_folder.h"
#include "studies/plan/plan_file.h"
#include "studies/plan/plan_page.h"
#include "studies/plan/plan_pictures.h"
#include "studies/plan/scene_plan.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr int kPictureSide_px = 480;
constexpr int kColumns = 3;
const std::array<std::string, 7> result_names = {
    "plan.json", "plan.csv", "scene.toml", "cell.toml", "pictures", "report.html", "run.json"};

class PlanRun {
 public:
  PlanRun(const Study& study, const PlanRunOptions& options)
      : study_(scene_study(study)),
        options_(options),
        pool_(options.threads),
        cell_(read_cell(options.cell)) {}

  Json execute() {
    check_result_folder(options_.out, ResultKind::kViewPlan, result_names);
    check_study_of_folder(options_.out, study_.name);
    std::vector<fs::path> inputs = input_files(study_);
    inputs.push_back(options_.cell);
    check_inputs_kept(inputs, options_.out, result_names);
    made_ = plan();
    const PlanFile file = {.plan = made_.plan,
                           .scene = "scene.toml",
                           .cell = "cell.toml",
                           .origin = origin(),
                           .notes = notes()};
    Json result = plan_json(file);
    ResultWriter writer(options_.out, ResultKind::kViewPlan);
    write(writer.path(), file, result);
    std::error_code ignored;
    fs::remove_all(options_.out / "pictures", ignored);  // of an earlier plan with other views
    writer.finish({{"study", study_.name},
                   {"source", source_seen_from(options_.out, study_.root.place.file)},
                   {"started", utc_text(started_)},
                   {"threads", options_.threads}},
                  start_);
    result["folder"] = options_.out.string();
    result["report"] = (options_.out / "report.html").string();
    return result;
  }

 private:
  ScenePlan plan() const {
    try {
      return plan_scene(study_.scene, cell_);
    } catch (const ConfigError& error) {
      throw with_place(study_.root, error);
    }
  }

  std::vector<std::string> notes() const {
    if (!cell_.planning.settings.camera_size_mm.empty()) {
      return {};
    }
    return {
        "The room that the camera itself takes is in no collision check: the cell has no "
        "planning.camera_size_mm."};
  }

  ImageRgb draw_views(const fs::path& folder) {
    make_folder(folder);
    std::vector<ImageRgb> pictures;
    for (const PlannedView& view : made_.plan.views) {
      if (view.outcome == ViewOutcome::kPlanned) {
        pictures.push_back(draw_cell(made_.cell, view.joints_rad, kPictureSide_px, pool_));
        write_file(folder / (view.name + ".png"), png_bytes(pictures.back()));
      }
    }
    return picture_sheet(pictures, kColumns);
  }

  PlanOrigin origin() const {
    const fs::path given = study_.root.place.file;
    const fs::path scene = given.empty() ? given : fs::absolute(given).lexically_normal();
    const fs::path run = run_above(options_.run.empty() ? scene : options_.run);
    const fs::path led_to = without_links(scene);
    if (const fs::path other = run_above(led_to); run.empty() && !other.empty()) {
      return {.scene = led_to, .run = other};
    }
    return {.scene = scene, .run = run};
  }

  void write(const fs::path& stage, const PlanFile& file, const Json& result) {
    write_plan(file, stage / "plan.json");
    write_file(stage / "plan.csv", plan_csv(made_.plan));
    write_file(stage / "scene.toml", resolved_text(study_));
    write_file(stage / "cell.toml", cell_copy(options_.cell));
    const ImageRgb sheet = draw_views(stage / "pictures");
    write_file(stage / "report.html",
               plan_page({.title = study_.title.empty() ? study_.name : study_.title,
                          .plan = result,
                          .sheet = sheet,
                          .toml = resolved_text(study_),
                          .when = moment_text(utc_text(started_), seconds_since(start_))}));
  }

  Study study_;
  const PlanRunOptions& options_;
  ThreadPool pool_;
  Cell cell_;
  ScenePlan made_ = {.cell = {.arm = {.arm = Arm(ArmModel::kUr3)}}, .plan = {}};
  Clock::time_point start_ = Clock::now();
  std::chrono::system_clock::time_point started_ = std::chrono::system_clock::now();
};

}  // namespace

Json plan_study(const Study& study, const PlanRunOptions& options) {
  return PlanRun(study, options).execute();
}

}  // namespace glint
