// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/prepared_acquisition.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <system_error>

#include "core/file.h"
#include "studies/acquire/acquired.h"
#include "studies/acquire/confirmed_lights.h"
#include "studies/acquire/journal.h"
#include "studies/acquire/plan_digest.h"
#include "studies/acquire/source_files.h"
#include "studies/cell/ready_file.h"
#include "studies/output/result_folder.h"

namespace glint::acquire_detail {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

const std::array<std::string, 9> kResultNames = {"acquired.json",
                                                 "poses.csv",
                                                 "views",
                                                 "rejected",
                                                 "scene.toml",
                                                 "cell.toml",
                                                 "calibration.toml",
                                                 "journal.sqlite",
                                                 "run.json"};

/// What is read before anything is connected, and has to lie elsewhere than what is written.
std::vector<fs::path> files_read(const Prepared& ready, const fs::path& source) {
  const SourceFiles named = files_of(source);
  std::vector<fs::path> files = {ready.cell.file, ready.cell.calibration, named.plan, named.scene};
  if (ready.source.scene) {
    std::ranges::copy(input_files(*ready.source.scene), std::back_inserter(files));
  }
  return files;
}

/// What the default folder is called after: the folder that is named, or that of the file.
std::string name_of_folder(const fs::path& named) {
  const fs::path path = fs::absolute(named).lexically_normal();
  const bool is_folder = fs::is_directory(named) && path.has_filename();
  return (is_folder ? path : path.parent_path()).filename().string();
}

/// Whether acquired.json was written after the last picture was taken, and each view has its mean.
bool tells_all(const Prepared& ready) {
  const Acquired acquired = read_acquired(ready.folder);
  return std::ranges::all_of(ready.work.plan.tasks, [&](const ViewTask& task) {
    const fs::path mean = acquired.aspect_of(task.name);
    std::error_code none;
    return std::ranges::all_of(
               task.positions,
               [&](int position) { return has_picture(acquired.pictures, task, position); }) &&
           fs::exists(mean) && fs::file_size(mean, none) > 0;
  });
}

}  // namespace

Prepared prepare(const AcquireOptions& options) {
  Prepared ready = {.cell = read_cell(options.cell)};
  if (!options.twin.empty()) {
    ready.cell = with_ports(std::move(ready.cell), options.twin, DrivenDevices::kAll);
  }
  if (!options.views.empty()) {
    ready.cell.views = options.views;
  }
  check_confirmed(options.confirmed, ready.cell);
  ready.source = read_source(options.source);
  if (options.plan) {
    ready.source.plan = options.plan;
    ready.source.is_plan_free = true;
  }
  ready.work = work_of(ready.source, ready.cell, options.speed_share);
  const fs::path named = options.source.empty() ? options.cell : options.source;
  ready.folder = options.out.empty()
                     ? default_result_folder(name_of_folder(named), ResultKind::kAcquire)
                     : options.out;
  check_result_folder(ready.folder, ResultKind::kAcquire, kResultNames);
  check_inputs_kept(files_read(ready, options.source), ready.folder, kResultNames);
  ready.digest = digest_in(ready.folder, ready.work, ready.source, ready.cell);
  return ready;
}

bool has_picture(const std::vector<AcquiredPicture>& pictures, const ViewTask& task, int position) {
  return std::ranges::any_of(pictures, [&](const AcquiredPicture& picture) {
    return picture.is_accepted && picture.view == task.name && picture.position == position;
  });
}

const ViewTask* next_task(const Prepared& ready) {
  const std::vector<AcquiredPicture> there =
      whole_pictures(ready.folder, ready.digest, ready.work.grounds);
  const std::vector<ViewTask>& tasks = ready.work.plan.tasks;
  const auto next = std::ranges::find_if(tasks, [&there](const ViewTask& task) {
    return !std::ranges::all_of(task.positions,
                                [&](int position) { return has_picture(there, task, position); });
  });
  return next == tasks.end() ? nullptr : &*next;
}

bool is_whole(const Prepared& ready) {
  return next_task(ready) == nullptr;
}

std::optional<Json> nothing_to_take(const Prepared& ready) {
  const fs::path file = ready.folder / "acquired.json";
  if (!fs::exists(file) || !is_whole(ready)) {
    return std::nullopt;
  }
  Json told = Json::parse(read_file(file), nullptr, false);
  if (!told.is_object() || told.value("status", "stopped") == "stopped" || !tells_all(ready)) {
    return std::nullopt;
  }
  told["counts"]["resumed"] = told["counts"]["accepted"];
  told["counts"]["taken_now"] = told["counts"]["rejected_now"] = 0;
  return told;
}

}  // namespace glint::acquire_detail
