// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/plan_run.h"

#include <array>
#include <chrono>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/wall_clock.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/definition/study_text.h"
#include "studies/imaging/built_part.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"
#include "studies/plan/plan_file.h"
#include "studies/plan/plan_page.h"
#include "studies/plan/plan_pictures.h"
#include "studies/reach/scene_cell.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr int kPictureSide_px = 480;
constexpr int kColumns = 3;
const std::array<std::string, 7> kFiles = {
    "plan.json", "plan.csv", "scene.toml", "cell.toml", "pictures", "report.html", "run.json"};

/// The cell's file with full paths, so that it may be read from anywhere.
std::string cell_text(const fs::path& file) {
  ConfigNode root = load_toml(file);
  const auto make_full = [&](const std::string& path) {
    const ConfigNode* node = root.at_path(path);
    if (node != nullptr && node->kind == ConfigNode::Kind::kText && !node->text.empty()) {
      const fs::path full = fs::absolute(file.parent_path() / node->text).lexically_normal();
      set_path(root, path, ConfigNode::from_text(full.string()));
    }
  };
  for (const char* path : {"robot.arm_deltas", "calibration.file", "twin.truth"}) {
    make_full(path);
  }
  const ConfigNode* obstacles = root.find("obstacle");
  const std::size_t count = obstacles == nullptr ? 0 : obstacles->items.size();
  for (std::size_t i = 0; i < count; ++i) {
    make_full(fmt::format("obstacle.{}.file", i));
  }
  return to_toml(root);
}

class PlanRun {
 public:
  PlanRun(const Study& study, const PlanRunOptions& options)
      : study_(scene_study(study)),
        options_(options),
        pool_(options.threads),
        cell_(read_cell(options.cell)) {}

  Json execute() {
    check_result_folder(options_.out, ResultKind::kViewPlan, kFiles);
    std::vector<fs::path> inputs = input_files(study_.scene);
    inputs.emplace_back(study_.root.place.file);
    inputs.push_back(options_.cell);
    check_inputs_kept(inputs, options_.out, kFiles);
    prepare();
    plan_ = plan_views(planned_, requests_);
    Json result = plan_json(plan_, "scene.toml", "cell.toml");
    OutputFolder folder(options_.out);
    remove_stale_stages(options_.out);
    StagedFolder stage(options_.out, "");
    write(stage.path(), result);
    std::error_code ignored;
    fs::remove_all(options_.out / "pictures", ignored);  // of an earlier plan with other views
    stage.commit();
    folder.keep();
    result["folder"] = options_.out.string();
    result["report"] = (options_.out / "report.html").string();
    return result;
  }

 private:
  void prepare() {
    try {
      const BuiltPart built = build_part_with_bvh(study_.scene.part);
      planned_ = planning_cell(cell_, study_.scene, built.part.mesh);
      requests_ = view_requests(study_.scene, viewpoints_of(study_.scene, built.part));
    } catch (const ConfigError& error) {
      throw with_place(study_.root, error);
    }
  }

  ImageRgb draw_views(const fs::path& folder) {
    make_folder(folder);
    std::vector<ImageRgb> pictures;
    for (const PlannedView& view : plan_.views) {
      if (view.outcome == ViewOutcome::kPlanned) {
        pictures.push_back(draw_cell(planned_, view.joints_rad, kPictureSide_px, pool_));
        write_file(folder / (view.name + ".png"), png_bytes(pictures.back()));
      }
    }
    return picture_sheet(pictures, kColumns);
  }

  void write(const fs::path& stage, const Json& result) {
    write_plan({.plan = plan_, .scene = "scene.toml", .cell = "cell.toml"}, stage / "plan.json");
    write_file(stage / "plan.csv", plan_csv(plan_));
    write_file(stage / "scene.toml", resolved_text(study_));
    write_file(stage / "cell.toml", cell_text(options_.cell));
    const ImageRgb sheet = draw_views(stage / "pictures");
    write_file(stage / "report.html",
               plan_page({.title = study_.title.empty() ? study_.name : study_.title,
                          .plan = result,
                          .sheet = sheet,
                          .toml = resolved_text(study_),
                          .when = moment_text(utc_text(started_), seconds_since(start_))}));
    Json run = provenance();
    run["verb"] = command_of(ResultKind::kViewPlan);
    run["study"] = study_.name;
    run["started"] = utc_text(started_);
    run["threads"] = options_.threads;
    run["timings"] = {{"this_run_s", seconds_since(start_)}};
    write_file(stage / "run.json", run.dump(2) + "\n");
  }

  Study study_;
  const PlanRunOptions& options_;
  ThreadPool pool_;
  Cell cell_;
  PlanningCell planned_ = {.arm = {.arm = Arm(ArmModel::kUr3)}};
  std::vector<ViewRequest> requests_;
  ViewPlan plan_;
  Clock::time_point start_ = Clock::now();
  std::chrono::system_clock::time_point started_ = std::chrono::system_clock::now();
};

}  // namespace

Json plan_study(const Study& study, const PlanRunOptions& options) {
  return PlanRun(study, options).execute();
}

}  // namespace glint
