// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/acquire_run.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/wall_clock.h"
#include "hardware/robot/path_check.h"
#include "studies/acquire/acquire_files.h"
#include "studies/acquire/acquired.h"
#include "studies/acquire/cell_devices.h"
#include "studies/acquire/prepared_acquisition.h"
#include "studies/cell/cell_copy.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace {

using acquire_detail::has_picture;
using acquire_detail::is_whole;
using acquire_detail::next_task;
using acquire_detail::nothing_to_take;
using acquire_detail::prepare;
using acquire_detail::Prepared;
using Json = nlohmann::ordered_json;

Json unplanned(const ViewPlan& views) {
  Json list = Json::array();
  for (const PlannedView& view : views.views) {
    if (view.outcome != ViewOutcome::kPlanned) {
      list.push_back(
          {{"view", view.name}, {"outcome", name_of(view.outcome)}, {"reason", view.reason}});
    }
  }
  return list;
}

double duration_of(const Tour& tour, const Cell& cell, double share) {
  const ArmWithTool arm = arm_with_tool(robot_of(cell), cell.limits);
  double seconds = 0.0;
  for (std::size_t i = 0; i + 1 < tour.size(); ++i) {
    seconds +=
        check_joint_motion(arm, tour[i].joints_rad, tour[i + 1].joints_rad, share).duration_s;
  }
  return seconds;
}

/// Copies that make the folder whole.
void write_inputs(const Prepared& ready, Json& head) {
  write_file_durably(ready.folder / "cell.toml", cell_copy(ready.cell.file));
  head["scene"] = nullptr;
  head["cell"] = "cell.toml";
  head["calibration"] = nullptr;
  if (ready.source.scene) {
    write_file_durably(ready.folder / "scene.toml", to_toml(write_scene(*ready.source.scene)));
    head["scene"] = "scene.toml";
  }
  if (!ready.cell.calibration.empty()) {
    write_file_durably(ready.folder / "calibration.toml", read_file(ready.cell.calibration));
    head["calibration"] = "calibration.toml";
  }
}

/// Pictures that are there need no lights any more.
void check_lights(const Prepared& ready) {
  const std::vector<Problem> problems = shared_outputs(ready.cell);
  if (!problems.empty() && !is_whole(ready)) {
    throw_if_any(problems);
  }
}

/// What a person has to do next, and which names of --mounted that takes the place of.
Json mounting_step(const std::string& design,
                   const std::string& wish,
                   const std::vector<std::string>& mounted) {
  return {{"design", design}, {"text", wish}, {"in_place_of", mounted}};
}

/// Manual lights that a person has to set for a view; null: none.
Json light_step(const ConfirmedLights& lights, const Cell& cell, const ViewTask& task) {
  const std::optional<LightWish> wish = light_wish(lights, cell, task);
  return wish ? Json{{"lights", wish->lights}, {"confirm", wish->confirm}, {"text", wish->text}}
              : Json(nullptr);
}

/// What a person has to do first, and has not confirmed; null: nothing. Lights are asked for on the
/// way where somebody is there.
Json open_step(const Prepared& ready,
               const AcquireOptions& options,
               MountedPrototypes& prototypes,
               const ConfirmedLights& lights) {
  const ViewTask* task = next_task(ready);  // first: a folder of another plan is refused, not asked
  const std::string design = prototypes.design_in(options.source);
  const std::optional<std::string> wish = prototypes.wish(design);
  if (task == nullptr) {
    return nullptr;
  }
  if (wish) {
    if (!options.confirm || !options.confirm(*wish)) {
      return mounting_step(design, *wish, options.mounted);
    }
    prototypes.mount(design);
  }
  return options.confirm ? Json(nullptr) : light_step(lights, ready.cell, *task);
}

Json ended(const Prepared& ready, Json told) {
  told["ok"] = told["status"] == "complete";
  told["folder"] = ready.folder.string();
  return told;
}

Json waiting(const Prepared& ready, const AcquireOptions& options, const Json& next) {
  return {{"schema", 1},
          {"status", "waiting"},
          {"ok", false},
          {"folder", ready.folder.string()},
          {"next", next},
          {"end", interrupted_end(options)}};
}

MountedPrototypes prototypes_of(const AcquireOptions& options) {
  return MountedPrototypes::beside(options.source, options.mounted, options.made_from);
}

/// What a person would be asked for first; null: nothing.
Json described_step(const Prepared& ready, const AcquireOptions& options) {
  const MountedPrototypes prototypes = prototypes_of(options);
  const std::string design = prototypes.design_in(options.source);
  const ViewTask* task = next_task(ready);
  const auto wish = prototypes.wish(design);
  if (task == nullptr) {
    return nullptr;
  }
  return wish ? mounting_step(design, *wish, options.mounted)
              : light_step(ConfirmedLights(options.confirmed), ready.cell, *task);
}

/// @param there  pictures that the folder has already
Json described_tasks(const std::vector<ViewTask>& tasks,
                     const std::vector<AcquiredPicture>& there) {
  Json views = Json::array();
  for (const ViewTask& task : tasks) {
    const auto missing = std::ranges::count_if(
        task.positions, [&](int position) { return !has_picture(there, task, position); });
    views.push_back({{"view", task.name},
                     {"lights", task.lights},
                     {"exposure_us", task.exposure_us},
                     {"pictures", missing}});
  }
  return views;
}

/// One session: what is missing is taken.
class Session {
 public:
  Session(const Prepared& ready, const AcquireOptions& options, CellDevices& devices)
      : ready_(ready),
        options_(options),
        devices_(devices),
        journal_(ready.folder, ready.work.digest, ready.digest, ready.work.grounds),
        files_(ready.folder, journal_, ready.work, ready.cell) {
    head_ = {{"schema", 1}, {"kind", "acquired"}, {"status", "partial"}};
    write_inputs(ready, head_);
    head_["twin"] = devices.is_twin();
  }

  Json run() {
    files_.write_means();  // of views that were whole when an earlier session was killed
    tell("begins");
    const AcquisitionPlan plan = files_.open_work();
    AcquisitionOptions acquisition = {.speed_share = options_.speed_share,
                                      .limits = ready_.cell.acquisition,
                                      .interrupt = options_.interrupt};
    result_ = acquire(plan, devices_.devices(), acquisition, [this](const TakenPicture& picture) {
      files_.keep(picture);
      files_.write_means();
      tell(ready_.work.plan.tasks[picture.task].name);
    });
    try {
      journal_.end_session();
      return written();
    } catch (const IoError& error) {
      throw IoError(fmt::format("{}; {}", error.what(), end_text()));
    }
  }

 private:
  void tell(const std::string& note) const {
    if (options_.progress) {
      options_.progress(files_.num_accepted(), files_.num_wanted(), note);
    }
  }

  std::string status(const Json& unplanned_views) const {
    if (result_.cause != AcquisitionCause::kNone) {
      return "stopped";
    }
    return result_.is_complete() && unplanned_views.empty() ? "complete" : "partial";
  }

  /// Where the arm is and why, which nobody would know without a file that tells it.
  std::string end_text() const {
    return fmt::format("the arm is at {} ({}{}{})",
                       result_.where,
                       name_of(result_.end),
                       result_.text.empty() ? "" : ": ",
                       result_.text);
  }

  Json written() {
    const Json unplanned_views = unplanned(ready_.work.views);
    head_["status"] = status(unplanned_views);
    head_["counts"] = {{"wanted", files_.num_wanted()},
                       {"accepted", files_.num_accepted()},
                       {"taken_now", result_.accepted},
                       {"rejected_now", result_.rejected},
                       {"resumed", journal_.num_resumed()}};
    head_["unplanned"] = unplanned_views;
    head_["end"] = {{"where", result_.where},
                    {"how", name_of(result_.end)},
                    {"cause", name_of(result_.cause)},
                    {"text", result_.text}};
    return files_.write(head_);
  }

  const Prepared& ready_;
  const AcquireOptions& options_;
  CellDevices& devices_;
  AcquireJournal journal_;
  AcquireFiles files_;
  AcquisitionResult result_;
  Json head_;
};

}  // namespace

Json describe_acquisition(const AcquireOptions& options) {
  const Prepared ready = prepare(options);
  check_lights(ready);
  const Json next = described_step(ready, options);
  const Json views = described_tasks(
      ready.work.plan.tasks, whole_pictures(ready.folder, ready.digest, ready.work.grounds));
  int pictures = 0;
  for (const Json& view : views) {
    pictures += view["pictures"].get<int>();
  }
  Json legs = Json::array();
  const Tour& tour = ready.work.plan.tour;
  for (std::size_t i = 0; i + 1 < tour.size(); ++i) {
    legs.push_back(place_text(tour, {.leg = i, .is_point = false}));
  }
  return {{"schema", 1},
          {"status", "dry_run"},
          {"ok", unplanned(ready.work.views).empty()},
          {"folder", ready.folder.string()},
          {"pictures", pictures},
          {"views", views},
          {"unplanned", unplanned(ready.work.views)},
          {"legs", legs},
          {"next", next},
          {"motion_s", duration_of(tour, ready.cell, options.speed_share)}};
}

Json interrupted_end(const AcquireOptions& options) {
  const bool is_interrupted = options.interrupt != nullptr && *options.interrupt > 0;
  return is_interrupted ? Json{{"where", nullptr},
                               {"how", name_of(AcquisitionEnd::kStopped)},
                               {"cause", name_of(AcquisitionCause::kInterrupted)},
                               {"text", "interrupted by the user at a question"}}
                        : Json(nullptr);
}

Json acquire_pictures(const AcquireOptions& options, const MotionPermit& permit) {
  MountedPrototypes prototypes = prototypes_of(options);
  return acquire_pictures(options, prototypes, permit);
}

Json acquire_pictures(const AcquireOptions& options,
                      MountedPrototypes& prototypes,
                      const MotionPermit& permit) {
  const auto start = std::chrono::steady_clock::now();
  const Prepared ready = prepare(options);
  check_lights(ready);
  ConfirmedLights own(options.confirmed);
  ConfirmedLights& lights = options.lights != nullptr ? *options.lights : own;
  if (const Json step = open_step(ready, options, prototypes, lights); !step.is_null()) {
    return waiting(ready, options, step);
  }
  if (std::optional<Json> told = nothing_to_take(ready)) {
    return ended(ready, std::move(*told));
  }
  const auto confirm = [&](const std::string& light, bool is_on, const std::string& what) {
    const bool is_so = lights.is_set(light, is_on) || (options.confirm && options.confirm(what));
    if (is_so) {
      lights.note(light, is_on);
    }
    return is_so;
  };
  CellDevices devices(ready.cell, permit, confirm, ready.work.num_positions, ready.work.steps);
  OutputFolder output(ready.folder);
  mark_result_folder(ready.folder, ResultKind::kAcquire);
  output.keep();
  Json json = Session(ready, options, devices).run();
  Json run = provenance();
  run["verb"] = command_of(ResultKind::kAcquire);
  run["seconds"] = seconds_since(start);
  write_file_durably(ready.folder / "run.json", run.dump(2) + "\n");
  return ended(ready, std::move(json));
}

}  // namespace glint
