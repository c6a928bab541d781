// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cover/cover_run.h"

#include <array>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/wall_clock.h"
#include "simulator/camera/lens_settings.h"
#include "studies/cover/cover_json.h"
#include "studies/cover/cover_page.h"
#include "studies/cover/cover_pictures.h"
#include "studies/definition/study_text.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

const std::array<std::string, 6> result_names = {
    "coverage.ply", "views.csv", "result.json", "report.html", "run.json", "study.resolved.toml"};

class CoverRun {
 public:
  CoverRun(const Study& study, const CoverOptions& options)
      : study_(scene_study(study)), options_(options), pool_(options.threads), store_(pool_) {}

  Json execute() {
    check_result_folder(options_.out, ResultKind::kCover, result_names);
    check_study_of_folder(options_.out, study_.name);
    check_inputs_kept(input_files(study_), options_.out, result_names);
    const std::optional<PodReference> pod = reference();
    const SceneCoverage covered = cover();
    Json result = coverage_json(covered, study_.scene.coverage, pod);
    OutputFolder folder(options_.out);
    remove_stale_stages(options_.out);
    StagedFolder stage(options_.out, "");
    write(stage.path(), covered, pod, result);
    stage.commit();
    folder.keep();
    result["folder"] = options_.out.string();
    result["report"] = (options_.out / "report.html").string();
    return result;
  }

 private:
  /// How finely the camera of the study of detection saw its part stands in what that run kept.
  std::optional<PodReference> reference() const {
    if (options_.pod.empty()) {
      return std::nullopt;
    }
    PodReference pod = read_pod(options_.pod);
    // The best one may be a prototype with a camera of its own.
    const fs::path own = options_.pod / pod.design / "scene.toml";
    const SceneSettings seen =
        load_study(fs::exists(own) ? own : options_.pod / "study.resolved.toml", {}).scene;
    pod.pixel_mm = lens_geometry(seen.camera, seen.lens).object_pixel_mm;
    return pod;
  }

  SceneCoverage cover() {
    constexpr std::int64_t kSteps = 1000;
    Progress bar(study_.name, kSteps, options_.progress);
    try {
      return cover_scene(store_, study_.scene, [&](std::size_t done, std::size_t all) {
        bar.update(kSteps * static_cast<std::int64_t>(done) / static_cast<std::int64_t>(all),
                   fmt::format("view {} of {}", done + 1, all));
      });
    } catch (const ConfigError& error) {
      throw with_place(study_.root, error);
    }
  }

  void write(const fs::path& stage,
             const SceneCoverage& covered,
             const std::optional<PodReference>& pod,
             const Json& result) {
    write_file(stage / "coverage.ply",
               coverage_ply(covered, smallest_defects_um(covered, study_.scene.coverage, pod)));
    write_file(stage / "views.csv", views_csv(covered));
    write_file(stage / "result.json", result.dump(2) + "\n");
    write_file(stage / "study.resolved.toml", resolved_text(study_));
    write_file(stage / "report.html",
               cover_page({.title = study_.title.empty() ? study_.name : study_.title,
                           .result = result,
                           .legend = coverage_legend(covered),
                           .pictures = draw_coverage(covered, pool_),
                           .toml = resolved_text(study_),
                           .when = moment_text(utc_text(started_), seconds_since(start_))}));
    Json run = provenance();
    run["verb"] = command_of(ResultKind::kCover);
    run["study"] = study_.name;
    run["source"] = source_seen_from(options_.out, study_.root.place.file);
    run["started"] = utc_text(started_);
    run["rays"] = covered.rays;
    run["threads"] = options_.threads;
    run["timings"] = {{"this_run_s", seconds_since(start_)}};
    write_file(stage / "run.json", run.dump(2) + "\n");
  }

  Study study_;
  const CoverOptions& options_;
  ThreadPool pool_;
  SceneStore store_;
  Clock::time_point start_ = Clock::now();
  std::chrono::system_clock::time_point started_ = std::chrono::system_clock::now();
};

}  // namespace

Json cover_study(const Study& study, const CoverOptions& options) {
  return CoverRun(study, options).execute();
}

}  // namespace glint
