// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_study.h"

#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/wall_clock.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/run/check_study.h"
#include "studies/run/design_files.h"
#include "studies/run/run_report.h"

namespace glint {
namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

Json render_study(const Study& whole_study, const fs::path& out, int threads) {
  const auto start = Clock::now();
  const Study study = scene_study(whole_study);
  ThreadPool pool(threads);
  SceneStore store(pool);
  check_everything(store, study);
  if (std::error_code ignored; fs::exists(out / "study.sqlite", ignored)) {
    throw ConfigError(fmt::format(
        "{}: holds the run of a study; choose another output folder for pictures", out.string()));
  }
  OutputFolder folder(out);
  remove_unfinished_files(out);
  const Json json = write_design(store,
                                 study.scene,
                                 {{"title", study.title}, {"role", "baseline"}},
                                 out / "baseline",
                                 false,
                                 {.fringes = false, .slot = false});
  write_file(out / "study.resolved.toml", resolved_text(study));
  Json result = {{"schema", 1},
                 {"status", "done"},
                 {"scores", json["scores"]},
                 {"rendering", json["rendering"]},
                 {"notes", json["notes"]},
                 {"report", "report.html"}};
  write_file(out / "result.json", result.dump(2) + "\n");
  write_file(out / "report.html", report_html({out}));
  result["folder"] = (out / "baseline").string();
  result["report"] = (out / "report.html").string();
  Json run = provenance();
  run["threads"] = threads;
  run["timings"] = {{"this_run_s", seconds_since(start)}};
  write_file(out / "run.json", run.dump(2) + "\n");
  folder.keep();
  return result;
}

}  // namespace glint
