// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibration_trial/trial_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/cpu_clock.h"
#include "core/csv.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/text.h"
#include "core/units.h"
#include "core/wall_clock.h"
#include "hardware/board/find_board.h"
#include "studies/calibrate/calibrate_files.h"
#include "studies/calibrate/calibrate_run.h"
#include "studies/calibration_trial/trial_errors.h"
#include "studies/calibration_trial/trial_page.h"
#include "studies/calibration_trial/trial_poses.h"
#include "studies/calibration_trial/trial_renderer.h"
#include "studies/definition/study_text.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/read_json.h"
#include "studies/output/result_folder.h"
#include "studies/output/scratch_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kFirstNewPose = 1'000'000;  ///< index of poses that are not calibrated with
constexpr int kNewPoses = 20;
constexpr int kCheckedPictures = 2;
constexpr std::array<const char*, 9> kFiles = {"pictures",
                                               "calibration",
                                               "board.toml",
                                               "ink.png",
                                               "poses.csv",
                                               "study.resolved.toml",
                                               "result.json",
                                               "report.html",
                                               "run.json"};

bool is_in_hand(const SceneSettings& scene) {
  return scene.calibration->setup == CalibrationSetup::kEyeInHand;
}

/// "picture_0007.png,r11,r12,r13,tx,...,0,0,0,1"
std::string pose_line(const std::string& name, const RigidTransform& pose) {
  std::vector<std::string> texts = {csv_plain_text(name)};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      texts.push_back(shortest(pose.rotation(row, column)));
    }
    texts.push_back(shortest(pose.translation_mm[row]));
  }
  texts.insert(texts.end(), {"0", "0", "0", "1"});
  return csv_row(texts);
}

class TrialRun {
 public:
  TrialRun(const Study& study, const TrialOptions& options)
      : study_(study),
        settings_(*study.calibration_trial),
        options_(options),
        renderer_(study, options.out / "ink.png", options.threads) {}

  /// Renders some pictures and looks for the board in them.
  Json check() {
    draw_poses();
    write_inputs();
    Json views = Json::array();
    const int looked_at = std::min(settings_.pictures, kCheckedPictures);
    const double start_s = process_cpu_s();
    for (int i = 0; i < looked_at; ++i) {
      render(i);
      views.push_back(checked_view(i));
    }
    const double all_s = (process_cpu_s() - start_s) / looked_at * settings_.pictures;
    return {{"schema", 1},
            {"status", "sound"},
            {"study", study_.name},
            {"pictures", settings_.pictures},
            {"views", std::move(views)},
            {"predicted_cpu_s", all_s},
            {"predicted_s", all_s / options_.threads}};
  }

  Json execute() {
    const auto start = std::chrono::steady_clock::now();
    check_folder();
    draw_poses();
    check_poses();
    OutputFolder folder(options_.out);
    remove_unfinished_files(options_.out);
    mark_result_folder(options_.out, ResultKind::kRun);
    write_inputs();
    Json result = {{"schema", 1}, {"status", "interrupted"}, {"study", study_.name}};
    if (render_all(folder)) {
      result = compared(calibrated());
      write_file(options_.out / "result.json", result.dump(2) + "\n");
      write_report(result);
    }
    write_run_json(seconds_since(start));
    folder.keep();
    result["report"] = (options_.out / "report.html").string();
    return result;
  }

 private:
  void check_folder() const {
    const std::vector<std::string> names(kFiles.begin(), kFiles.end());
    check_result_folder(options_.out, ResultKind::kRun, names);
    check_inputs_kept(input_files(study_), options_.out, names);
    const fs::path begun = options_.out / "study.resolved.toml";
    std::error_code ignored;
    if (fs::exists(begun, ignored) && (read_file(begun) != resolved_text(study_) ||
                                       read_file(options_.out / "board.toml") != board_text())) {
      throw_others();
    }
  }

  /// An earlier program may have drawn other poses for the same study.
  void check_poses() const {
    const fs::path begun = options_.out / "poses.csv";
    if (is_there(begun) && has_pictures() && read_file(begun) != poses_text()) {
      throw_others();
    }
  }

  [[noreturn]] void throw_others() const {
    throw ConfigError(
        fmt::format("{}: holds pictures of another study or board: give another folder with --out",
                    options_.out.string()));
  }

  bool has_pictures() const {
    for (int i = 0; i < settings_.pictures; ++i) {
      if (is_there(picture_file(i))) {
        return true;
      }
    }
    return false;
  }

  /// poses.csv: what the robot tells of each picture.
  std::string poses_text() const {
    std::string lines;
    for (int i = 0; i < settings_.pictures; ++i) {
      lines += pose_line(picture_file(i).filename().string(), pose(i).told);
    }
    return lines;
  }

  std::string board_text() const { return board_toml(renderer_.board()); }

  void draw_poses() {
    for (int i = 0; i < settings_.pictures; ++i) {
      poses_.push_back(renderer_.pose(static_cast<std::uint64_t>(i)));
    }
    for (int i = 0; i < kNewPoses; ++i) {
      new_poses_.push_back(renderer_.pose(kFirstNewPose + static_cast<std::uint64_t>(i)).told);
    }
  }

  void write_inputs() const {
    write_file(options_.out / "study.resolved.toml", resolved_text(study_));
    write_file(options_.out / "board.toml", board_text());
    renderer_.write_ink();
    write_file(options_.out / "poses.csv", poses_text());
    fs::create_directories(options_.out / "pictures");
  }

  const TrialPose& pose(int i) const { return poses_[static_cast<std::size_t>(i)]; }

  fs::path picture_file(int i) const { return options_.out / "pictures" / trial_picture_name(i); }

  bool is_interrupted() const { return options_.interrupt != nullptr && *options_.interrupt > 0; }

  Json checked_view(int i) const {
    const BoardView view = find_board(read_picture(picture_file(i)).pixels, renderer_.board());
    std::vector<double> blur_px = view.blur_px;
    std::ranges::sort(blur_px);
    return {{"accepted", view.is_accepted()},
            {"reason", view.is_accepted() ? std::string() : reason_of_view(view)},
            {"corners", view.picture_px.size()},
            {"blur_px", blur_px.empty() ? Json(nullptr) : Json(blur_px[blur_px.size() / 2])},
            {"contrast", view.is_accepted() ? Json(view.contrast) : Json(nullptr)}};
  }

  /// @return false when interrupted
  bool render_all(OutputFolder& folder) {
    Progress bar(study_.name, settings_.pictures, options_.progress);
    for (int i = 0; i < settings_.pictures && !is_interrupted(); ++i) {
      std::error_code ignored;
      if (!fs::exists(picture_file(i), ignored)) {
        render(i);
      }
      folder.keep();  // what is rendered is not thrown away
      bar.update(i + 1, fmt::format("picture {} of {}", i + 1, settings_.pictures));
    }
    return !is_interrupted();
  }

  /// A picture that is interrupted is not written.
  void render(int i) {
    const auto picture = renderer_.render(pose(i).real, i, [this] { return !is_interrupted(); });
    if (picture) {
      write_png(picture_file(i), *picture, PixelDepth::k8Bit);
    }
  }

  Json calibrated() const {
    CalibrateOptions options = {.board = options_.out / "board.toml",
                                .poses = {options_.out / "poses.csv"},
                                .out = options_.out / "calibration",
                                .setup = is_in_hand(study_.scene) ? "eye_in_hand" : "eye_to_hand",
                                .sets = {{"convention.unit", "mm"},
                                         {"convention.direction", "base_from_flange"},
                                         {"convention.rotation", "matrix"},
                                         {"poses.pair_by", "name"}},
                                .threads = options_.threads};
    options.sets.insert(options.sets.end(), options_.sets.begin(), options_.sets.end());
    for (int i = 0; i < settings_.pictures; ++i) {
      options.pictures.push_back(picture_file(i));
    }
    return calibrate_pictures(options);
  }

  Json compared(const Json& calibration) const {
    const CameraOnRobot estimate = estimate_of(calibration);
    const TrialErrors errors = trial_errors(renderer_.truth(), estimate, new_poses_);
    Json result = {{"schema", 1}, {"status", "done"}, {"study", study_.name}};
    const auto accepted = std::ranges::count_if(calibration["pictures"], [](const Json& picture) {
      return picture["accepted"].get<bool>();
    });
    result["pictures"] = {{"rendered", settings_.pictures}, {"accepted", accepted}};
    result["setup"] = calibration["setup"];
    result["intrinsics"] = intrinsics_rows(renderer_.truth().intrinsics, calibration["intrinsics"]);
    result["hand_eye"] = hand_eye_json(calibration["hand_eye"], errors);
    result["noise"] = {
        {"robot_mm", number_row(settings_.robot_sigma_mm, calibration["noise"]["robot_mm"])},
        {"robot_deg",
         number_row(settings_.robot_sigma_rad * kDegPerRad, calibration["noise"]["robot_deg"])}};
    result["is_board_upright"] = errors.is_board_upright;
    result["overlap_px"] = {{"rms", errors.overlap.rms_px},
                            {"center", errors.overlap.center_px},
                            {"edge", errors.overlap.edge_px}};
    result["rms_px"] = calibration["rms_px"];
    result["prediction_rms_px"] = calibration["prediction_rms_px"];
    result["goals"] = Json::array();
    for (const TrialGoal& goal : trial_goals(errors)) {
      result["goals"].push_back({{"name", goal.name},
                                 {"unit", goal.unit},
                                 {"found", goal.found},
                                 {"goal", goal.goal},
                                 {"is_met", goal.found <= goal.goal}});
    }
    result["methods"] = calibration["methods"];
    result["calibration"] = "calibration/calibration.json";
    result["report"] = "report.html";
    return result;
  }

  static Json number_row(double truth, const Json& estimate) {
    return {{"truth", truth}, {"estimate", estimate}};
  }

  static Json intrinsics_rows(const PinholeIntrinsics& in, const Json& estimate) {
    const std::array<std::tuple<const char*, const char*, std::size_t, double>, 9> terms = {
        {{"fx", "focal_px", 0, in.focal_px.x()},
         {"fy", "focal_px", 1, in.focal_px.y()},
         {"cx", "center_px", 0, in.center_px.x()},
         {"cy", "center_px", 1, in.center_px.y()},
         {"k1", "radial", 0, in.radial[0]},
         {"k2", "radial", 1, in.radial[1]},
         {"k3", "radial", 2, in.radial[2]},
         {"p1", "tangential", 0, in.tangential[0]},
         {"p2", "tangential", 1, in.tangential[1]}}};
    Json rows = Json::object();
    for (const auto& [name, key, index, truth] : terms) {
      rows[name] = number_row(truth, estimate[key][index]);
      rows[name]["sigma"] = estimate["sigma"][key][index];
    }
    return rows;
  }

  Json hand_eye_json(const Json& estimate, const TrialErrors& errors) const {
    const PoseSettings truth = pose_settings(renderer_.truth().hand_eye);
    return {{"truth",
             {{"rotation_vector_rad", truth.rotation_vector_rad},
              {"translation_mm", truth.translation_mm}}},
            {"estimate",
             {{"rotation_vector_rad", estimate["rotation_vector_rad"]},
              {"translation_mm", estimate["translation_mm"]}}},
            {"error_deg", errors.rotation_rad * kDegPerRad},
            {"error_mm", errors.translation_mm},
            {"sigma_deg", estimate["sigma_deg"]},
            {"sigma_mm", estimate["sigma_mm"]}};
  }

  void write_report(const Json& result) const {
    write_file(options_.out / "report.html",
               trial_page(result, study_.title, shown_pictures(options_.out), shown_text(study_)));
  }

  void write_run_json(double seconds) const {
    Json run = provenance();
    run["verb"] = command_of(ResultKind::kRun);
    run["study"] = study_.name;
    run["source"] = source_seen_from(options_.out, study_.root.place.file);
    run["threads"] = options_.threads;
    run["timings"] = {{"this_run_s", seconds}};
    run["configuration"] = resolved_text(study_);
    write_file(options_.out / "run.json", run.dump(2) + "\n");
  }

  const Study& study_;
  const CalibrationTrialSettings& settings_;
  const TrialOptions& options_;
  TrialRenderer renderer_;
  std::vector<TrialPose> poses_;
  std::vector<RigidTransform> new_poses_;
};

}  // namespace

Json run_calibration_trial(const Study& study, const TrialOptions& options) {
  return TrialRun(study, options).execute();
}

Json check_calibration_trial(const Study& study, int threads) {
  const ScratchFolder folder("the first pictures of the trial");
  const TrialOptions options = {
      .out = folder.path(), .threads = threads, .progress = Progress::Style::kNone};
  return TrialRun(study, options).check();
}

std::string trial_check_text(const Json& result) {
  std::string text = fmt::format("{}: the study is sound, {} pictures of a board\n",
                                 result["study"].get<std::string>(),
                                 result["pictures"].get<int>());
  for (const Json& view : result["views"]) {
    text += view["accepted"].get<bool>()
                ? fmt::format("  {} corners found; blur {:.2g} px, contrast {:.2g} of full scale\n",
                              view["corners"].get<int>(),
                              view["blur_px"].get<double>(),
                              view["contrast"].get<double>())
                : fmt::format("  warning: a picture would be rejected: {}\n",
                              view["reason"].get<std::string>());
  }
  return text + fmt::format("about {} of CPU time, {} on this machine when it is idle\n",
                            duration_text(result["predicted_cpu_s"].get<double>()),
                            duration_text(result["predicted_s"].get<double>()));
}

bool is_calibration_trial(const fs::path& folder) {
  std::error_code ignored;
  const fs::path file = folder / "study.resolved.toml";
  return fs::exists(folder / "result.json", ignored) && fs::is_regular_file(file, ignored) &&
         load_toml(file).find("calibration_trial") != nullptr;
}

std::string calibration_trial_report(const fs::path& folder) {
  const std::string resolved = read_file(folder / "study.resolved.toml");
  const ConfigNode root = parse_toml(resolved, (folder / "study.resolved.toml").string());
  const ConfigNode* title = root.find("title");
  return trial_page(read_json(folder / "result.json"),
                    title != nullptr ? title->text : "",
                    shown_pictures(folder),
                    resolved);
}

std::string trial_summary(const Json& result) {
  if (result["status"] != "done") {
    return "interrupted; the pictures are kept, the same command resumes\n";
  }
  std::string text = fmt::format("done: {} of {} pictures accepted\n",
                                 result["pictures"]["accepted"].get<int>(),
                                 result["pictures"]["rendered"].get<int>());
  for (const Json& goal : result["goals"]) {
    text += fmt::format("  {:<42} {:>8.4f} {}, goal {:.3f}\n",
                        goal["name"].get<std::string>(),
                        goal["found"].get<double>(),
                        goal["unit"].get<std::string>(),
                        goal["goal"].get<double>());
  }
  return text + fmt::format("report: {}\n", result["report"].get<std::string>());
}

}  // namespace glint
