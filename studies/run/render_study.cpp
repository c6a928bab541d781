// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_study.h"
#include "studies/definition/study_text.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/wall_clock.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/run/check_study.h"
#include "studies/run/design_files.h"
#include "studies/run/run_report.h"

namespace glint {
namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

namespace {

constexpr int kMaxViews = 999;

/// The folders that views are written to.
std::vector<std::string> folders_of_views() {
  std::vector<std::string> names = {"baseline"};
  for (int view = 1; view <= kMaxViews; ++view) {
    names.push_back(fmt::format("view_{:02}", view));
  }
  return names;
}

}  // namespace

void check_render_folder(const Study& study, const fs::path& out) {
  std::vector<std::string> names = folders_of_views();
  for (const char* file : {"result.json",
                           "run.json",
                           "report.html",
                           "preview.png",
                           "contact_sheet.png",
                           "study.resolved.toml"}) {
    names.emplace_back(file);
  }
  check_result_folder(out, ResultKind::kRender, names);
  check_inputs_kept(input_files(study), out, names);
  check_study_of_folder(out, study.name);
}

void remove_other_views(const fs::path& out, const std::vector<std::string>& kept) {
  if (kept.empty()) {
    return;
  }
  std::vector<fs::path> others;
  for (const std::string& name : folders_of_views()) {
    const fs::path folder = out / name;
    if (std::ranges::find(kept, name) == kept.end() &&
        fs::symlink_status(folder).type() == fs::file_type::directory) {
      others.push_back(folder);
    }
  }
  if (kept.size() == 1) {
    others.push_back(out / "contact_sheet.png");
  }
  for (const fs::path& other : others) {
    fs::remove_all(other);
  }
}

Json render_study(const Study& whole_study, const fs::path& out, int threads) {
  const auto start = Clock::now();
  const Study study = scene_study(whole_study);
  check_render_folder(study, out);
  ThreadPool pool(threads);
  SceneStore store(pool);
  check_everything(store, study);
  OutputFolder folder(out);
  remove_unfinished_files(out);
  const std::string source = source_seen_from(out, study.root.place.file);
  mark_result_folder(out, ResultKind::kRender, study.name, source);
  const Json json = write_design(store,
                                 study.scene,
                                 {{"title", study.title}, {"role", "baseline"}},
                                 out / "baseline",
                                 false,
                                 {.fringes = false, .slot = false});
  remove_other_views(out, {"baseline"});
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
  run["verb"] = command_of(ResultKind::kRender);
  run["study"] = study.name;
  run["source"] = source;
  run["threads"] = threads;
  run["timings"] = {{"this_run_s", seconds_since(start)}};
  write_file(out / "run.json", run.dump(2) + "\n");
  folder.keep();
  return result;
}

}  // namespace glint
