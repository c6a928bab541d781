// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/hardware_verbs.h"

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/acquire/driving_options.h"
#include "cli/plan/plan_text.h"
#include "cli/shell/mode_options.h"
#include "cli/shell/options.h"
#include "studies/plan/plan_run.h"

namespace glint {
namespace {

void add_calibrate_modes(CLI::App& calibrate, CalibrateArguments& arguments) {
  calibrate
      .add_option("--check",
                  arguments.checked,
                  "instead: check whether this calibration (file or folder) holds for PICTURES")
      ->type_name("FILE")
      ->check(not_empty());
  calibrate
      .add_option("--sensor",
                  arguments.sensor,
                  "instead: sensor gain and noise from this folder's pictures of uniform light")
      ->type_name("DIR")
      ->check(not_empty());
  calibrate
      .add_option("--bits",
                  arguments.bits,
                  "with --sensor: depth of the codes in bits (default: what the largest needs)")
      ->type_name("8|10|12|16")
      ->check(CLI::IsMember({8, 10, 12, 16}).description("8, 10, 12 or 16"));
  calibrate
      .add_option(
          "--plan",
          arguments.planned,
          "instead: plan this many poses to photograph --board from, given a rough --camera")
      ->type_name("N")
      ->check(between(1, 1000));
  calibrate
      .add_option("--points",
                  arguments.points,
                  "instead: draw this CSV's points, in the robot's base, into PICTURES by --camera")
      ->type_name("FILE")
      ->check(not_empty());
}

void add_place_mode(CLI::App& calibrate, CalibrateArguments& arguments) {
  calibrate
      .add_option("--place",
                  arguments.placed,
                  "instead: find where the part is from a CSV of points that the robot touched or "
                  "that pictures show, or a TOML of a board on the part; once for each time the "
                  "part was put down")
      ->type_name("FILE")
      ->allow_extra_args(false);
}

void add_compare_verb(CLI::App& app, CommandLine& line) {
  CompareArguments& arguments = line.compare;
  CLI::App* compare = add_verb(
      app,
      "compare",
      "how far simulated pictures and photographs agree",
      "glint compare out/scene photo.png --out out/compare\n"
      "  glint compare out/scene photos/*.png --pairs pairs.csv",
      line,
      [](const CommandLine& given) { return compare_command(given.compare, given.common); });
  compare
      ->add_option("SIMULATED REAL",
                   arguments.pictures,
                   "pictures, folders of pictures, folders of runs or their views: first the "
                   "simulated side, then the real ones")
      ->type_name("FILE")
      ->required();
  add_out(*compare, arguments.out, "folder for the results (default out/<name>/compare)");
  compare
      ->add_option("--pairs",
                   arguments.pairs,
                   "CSV of pairs: simulated,real[,mask] (default: paired by name, else by order)")
      ->type_name("FILE")
      ->check(not_empty());
  compare->add_option("--mask", arguments.mask, "picture that is bright where the real part is")
      ->type_name("FILE")
      ->check(not_empty());
  compare
      ->add_option("--scene",
                   arguments.scene,
                   "scene of a simulated picture that comes without one, to name edges and causes")
      ->type_name("FILE.toml")
      ->check(not_empty());
  compare
      ->add_option("--outline",
                   arguments.outline,
                   "find the real part by brightness, by a graph cut, or use edges inside it")
      ->type_name("auto|threshold|grab_cut|inner")
      ->capture_default_str();
  compare->add_flag(
      "--offset", arguments.has_offset, "let exposures differ by an offset as well as a gain");
  compare->add_flag("--calibrated",
                    arguments.is_lens_known,
                    "take the scene's camera as calibrated: only pose and gain may differ");
  compare
      ->add_option("--calibration",
                   arguments.calibration,
                   "calibration.toml of the real camera, to correct its lens before causes")
      ->type_name("FILE")
      ->check(not_empty());
  compare->add_flag("--roughness",
                    arguments.has_roughness,
                    "let the metal's roughness differ: renders up to three times more");
  compare->add_flag(
      "--refine", arguments.is_refining, "write the scene corrected by the causes found");
}

int validate_command(const CommandLine& given) {
  ValidationArguments arguments = given.validate;
  arguments.threads = given.common.threads;
  const AcquireAnswer answer = run_validation(arguments, given.common.progress());
  print_result(given.common, answer.json, answer.text);
  return answer.exit_code;
}

void add_validate_verb(CLI::App& app, CommandLine& line) {
  ValidationArguments& arguments = line.validate;
  CLI::App* validate = add_verb(
      app,
      "validate",
      "whether a run's designs and real pictures of them agree, and the ranking holds",
      "glint validate out/ring/run --pictures photos --out out/validate\n"
      "  glint validate out/ring/run --pictures photos --calibration calibration.toml --refit\n"
      "  glint validate out/ring/run --cell cell.toml --move",
      line,
      validate_command);
  validate->add_option("RUN", arguments.run, "folder of a glint run")
      ->type_name("DIR")
      ->required()
      ->check(not_empty());
  validate
      ->add_option("--pictures",
                   arguments.pictures,
                   "real pictures: a folder for each design, from glint acquire or with pictures "
                   "named view_01, view_02, ...; with --cell: where they are written (default: "
                   "beside RUN)")
      ->type_name("DIR")
      ->check(not_empty());
  validate
      ->add_option("--designs",
                   arguments.designs,
                   "names, separated by commas (default: those of [validate], else all)")
      ->type_name("NAMES");
  validate
      ->add_option("--calibration",
                   arguments.calibration,
                   "calibration.toml of the camera (default: as in acquired.json or the scene)")
      ->type_name("FILE")
      ->check(not_empty());
  validate->add_flag("--refit",
                     arguments.is_refitting,
                     "fit exposure, lights, roughness and pose, and score all designs again");
  validate
      ->add_option(
          "--cell", arguments.acquire.cell, "drive the robot of this cell to take the pictures")
      ->type_name("FILE")
      ->check(not_empty());
  add_driving_options(*validate, arguments.acquire, "with --cell: ");
  for (const char* driving : {"--move", "--twin", "--speed_share", "--confirmed"}) {
    validate->get_option(driving)->needs(validate->get_option("--cell"));
  }
  add_mounted_option(*validate, arguments.acquire, "with --cell: ");
  add_out(*validate, arguments.acquire.out, "folder for the results (default out/<name>/validate)");
}

/// Beside the command the names of the options that were given.
void remember_options(CLI::App& calibrate, CommandLine& line) {
  calibrate.callback([&line, &calibrate] {
    line.calibrate.given = given_options(calibrate);
    line.command = calibrate_command;
  });
}

void add_calibrate_verb(CLI::App& app, CommandLine& line) {
  CalibrateArguments& arguments = line.calibrate;
  CLI::App* calibrate = add_verb(
      app,
      "calibrate",
      "calibrate a camera from pictures of a board, and its place on a robot from poses",
      "glint calibrate board/*.png --board board.toml --out out/camera\n"
      "  glint calibrate board/*.png --board board.toml --poses poses.csv --setup eye_in_hand\n"
      "  glint calibrate --print_board board.toml --out out/board\n"
      "  glint calibrate --check out/camera new/*.png\n"
      "  glint calibrate --place touched.csv --out out/place\n"
      "  glint calibrate --sensor flat_pictures --out out/sensor\n"
      "  glint calibrate --cell cell.toml --board board.toml --out out/calibration --move\n"
      "  glint calibrate --cell cell.toml --part scene.toml --camera out/calibration/calibration "
      "--out out/part --move",
      line,
      calibrate_command);
  calibrate->add_option("PICTURES", arguments.pictures, "pictures of the board, of one camera")
      ->type_name("FILE");
  calibrate
      ->add_option("--from",
                   arguments.from,
                   "an earlier calibration's folder, or its corners.csv, instead of pictures")
      ->type_name("FILE")
      ->check(not_empty());
  calibrate->add_option("--board", arguments.board, "the board: board.toml or board.json")
      ->type_name("FILE")
      ->check(not_empty());
  calibrate
      ->add_option("--poses", arguments.poses, "the robot's poses: .csv, .json, .toml, .yaml files")
      ->type_name("FILE");
  calibrate
      ->add_option("--camera",
                   arguments.camera,
                   "known intrinsics: TOML, YAML of OpenCV or ROS, XML of ViSP or OpenCV")
      ->type_name("FILE")
      ->check(not_empty());
  add_out(*calibrate, arguments.out, "folder for the results (default out/<folder>/calibrate)");
  calibrate->add_option("--setup", arguments.setup, "what the robot carries: camera or board")
      ->type_name("eye_in_hand|eye_to_hand");
  calibrate->add_option("--method", arguments.method, "use this closed form of OpenCV instead")
      ->type_name("tsai|park|horaud|andreff|daniilidis|shah|li");
  calibrate
      ->add_option("--set",
                   arguments.sets,
                   "convention.key=value: what the poses' numbers mean; poses.pair_by=order; "
                   "prior.focal_px=5: --camera is known to 5 px; prediction.splits=20")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  calibrate
      ->add_option("--print_board", arguments.printed, "instead: write this board as SVG and PDF")
      ->type_name("FILE")
      ->check(not_empty());
  add_calibrate_modes(*calibrate, arguments);
  add_place_mode(*calibrate, arguments);
  add_cell_calibration(*calibrate, line.cell_calibration);
  remember_options(*calibrate, line);
}

void add_undistort_verb(CLI::App& app, CommandLine& line) {
  UndistortArguments& arguments = line.undistort;
  CLI::App* undistort = add_verb(
      app,
      "undistort",
      "redraw pictures as a camera without distortion would have taken them",
      "glint undistort photos/*.png --camera out/camera/calibration.toml --out out/straight",
      line,
      [](const CommandLine& given) { return undistort_command(given.undistort, given.common); });
  undistort->add_option("PICTURES", arguments.pictures, "pictures of one camera")
      ->type_name("FILE");
  undistort
      ->add_option("--camera",
                   arguments.camera,
                   "calibration.toml; YAML of OpenCV or ROS, XML of ViSP or OpenCV")
      ->type_name("FILE")
      ->check(not_empty());
  add_out(*undistort, arguments.out, "folder for the pictures (default out/<folder>/undistort)");
}

void add_cover_verb(CLI::App& app, CommandLine& line) {
  CLI::App* cover =
      add_verb(app,
               "cover",
               "which surface the views of a scene inspect, and which views to choose",
               "glint cover studies/gallery/viewpoints/scene.toml --out out/cover\n"
               "  glint cover scene.toml --set viewpoints.source=surface --set coverage.choose=6",
               line,
               [](const CommandLine& given) { return cover_command(given.cover, given.common); });
  add_study(*cover, "SCENE.toml", line.cover.study);
  add_out(*cover, line.cover.study.out, "folder for the results (default out/<study name>/cover)");
  cover
      ->add_option("--pod",
                   line.cover.pod,
                   "folder of a run with [pod]: a defect must also be as large as that study's a90")
      ->type_name("DIR")
      ->check(not_empty());
}

int run_plan(const CommandLine& given) {
  const Study study = load_study(given.plan.study);
  const nlohmann::ordered_json result =
      plan_study(study,
                 {.cell = given.plan.cell,
                  .out = out_folder(given.plan.study, study, ResultKind::kViewPlan),
                  .threads = given.common.threads});
  print_result(given.common, result, plan_text(result));
  return plan_exit_code(result);
}

void add_plan_verb(CLI::App& app, CommandLine& line) {
  CLI::App* plan = add_verb(app,
                            "plan",
                            "plan which views of a scene a cell's arm can take and how",
                            "glint plan scene.toml --cell cell.toml --out out/plan\n"
                            "  glint plan study.toml --cell cell.toml --json",
                            line,
                            &run_plan);
  add_study(*plan, "SCENE.toml", line.plan.study);
  plan->add_option("--cell", line.plan.cell, "the cell's file; no device in it is connected to")
      ->type_name("FILE")
      ->required()
      ->check(not_empty());
  add_out(*plan, line.plan.study.out, "folder for the results (default out/<study name>/plan)");
}

void add_cell_twin_options(CLI::App& cell, CellArguments& arguments) {
  cell.add_option("--port",
                  arguments.port,
                  "twin: first of five ports, 0 for free ones (default: the cell's ports)")
      ->type_name("N")
      ->check(between(0, 65531));
  cell.add_flag("--cable", arguments.has_cable, "twin: let the camera's cable be made faulty");
  cell.add_flag("--detach", arguments.is_detached, "twin: keep running in the background");
  const auto add_file = [&cell](const char* name, auto& file, const char* doc) {
    cell.add_option(name, file, doc)->type_name("FILE")->check(not_empty());
  };
  add_file("--ready_file",
           arguments.ready_file,
           "twin: file that is written once the twins are serving");
  add_file("--twin", arguments.twin, "drive the twins of this ready file and nothing else");
}

void add_cell_grab_options(CLI::App& cell, CellArguments& arguments) {
  cell.add_option("--count", arguments.count, "grab: number of pictures")
      ->type_name("N")
      ->capture_default_str()
      ->check(between(1, 1'000'000));
  add_out(cell, arguments.out, "grab: folder for the pictures (default out/<name>/grab)");
}

void add_cell_verb(CLI::App& app, CommandLine& line) {
  CellArguments& arguments = line.cell;
  CLI::App* cell =
      add_verb(app,
               "cell",
               "drive a real camera and robot, or their twins",
               "glint cell list\n"
               "  glint cell status cell.toml\n"
               "  glint cell grab cell.toml --count 20 --out out/grab\n"
               "  glint cell move cell.toml --view 3 --move\n"
               "  glint cell twin robot cell.toml --detach --ready_file out/twin.json\n"
               "  glint cell twin stop out/twin.json",
               line,
               [](const CommandLine& given) { return cell_command(given.cell, given.common); });
  cell->add_option("ACTION", arguments.action, "what to do")
      ->type_name("list|status|grab|watch|move|safe|unlock|power|twin")
      ->required();
  cell->add_option("CELL",
                   arguments.words,
                   "the cell's file; with twin after camera, robot, both, stop, place or light")
      ->type_name("FILE");
  cell->add_flag("--move",
                 arguments.is_move,
                 "let the robot move: only when nobody is within reach of the arm");
  cell->add_option(
          "--view", arguments.view, "move: name or number of a view; safe: name of a safe position")
      ->type_name("NAME");
  cell->add_option(
          "--speed_share", arguments.speed_share, "fraction of the cell's speed limits to use")
      ->type_name("SHARE")
      ->capture_default_str()
      ->check(between(0.01, 1.0));
  cell->add_flag("--line",
                 arguments.is_line,
                 "move, safe: take the TCP there in a straight line (movel, not movej)");
  cell->add_flag("--off", arguments.is_off, "power: switch off instead of on");
  cell->add_option("--duration_s", arguments.duration_s, "watch: duration in seconds")
      ->type_name("S")
      ->capture_default_str()
      ->check(positive());
  add_cell_grab_options(*cell, arguments);
  add_cell_twin_options(*cell, arguments);
}

int acquire_command(const AcquireArguments& arguments, const CommonArguments& common) {
  const AcquireAnswer answer = run_acquire(arguments, common.is_json || common.is_quiet);
  print_result(common, answer.json, answer.text);
  return answer.exit_code;
}

void add_acquire_verb(CLI::App& app, CommandLine& line) {
  AcquireArguments& arguments = line.acquire;
  CLI::App* acquire = add_verb(
      app,
      "acquire",
      "take real pictures from planned views: the robot moves",
      "glint acquire out/run/winner/scene.toml --cell cell.toml --out out/acquired --move\n"
      "  glint acquire out/plan --cell cell.toml --dry_run",
      line,
      [](const CommandLine& given) { return acquire_command(given.acquire, given.common); });
  acquire
      ->add_option("SCENE|PLAN",
                   arguments.source,
                   "a scene, plan.json, or a folder with one (default: the cell's own views)")
      ->type_name("FILE");
  acquire->add_option("--cell", arguments.cell, "the cell's file")
      ->type_name("FILE")
      ->required()
      ->check(not_empty());
  add_out(*acquire, arguments.out, "folder for the pictures (default out/<folder>/acquire)");
  acquire->add_flag(
      "--dry_run", arguments.is_dry_run, "print what would be done, connect to nothing");
  add_driving_options(*acquire, arguments, "");
  add_mounted_option(*acquire, arguments, "");
}

}  // namespace

void add_hardware_verbs(CLI::App& app, CommandLine& line) {
  add_calibrate_verb(app, line);
  add_undistort_verb(app, line);
  add_compare_verb(app, line);
  add_validate_verb(app, line);
  add_cover_verb(app, line);
  add_cell_verb(app, line);
  add_plan_verb(app, line);
  add_acquire_verb(app, line);
}

}  // namespace glint
