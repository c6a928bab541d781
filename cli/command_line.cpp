// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command_line.h"

#include <limits>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace glint {
namespace {

CLI::Validator between(int min, int max) {
  return CLI::Range(min, max).description(fmt::format("{} to {}", min, max));
}

/// A name that is empty is a slip: a variable of the shell that is not set.
CLI::Validator not_empty() {
  return {[](const std::string& text) {
            return text.empty() ? std::string("is empty, must be a name") : std::string();
          },
          ""};
}

constexpr const char* kUnits = "mm|cm|m|inch";

void add_common(CLI::App& app, CommonArguments& common) {
  app.add_flag("--json", common.is_json, "print one JSON object and nothing else on stdout");
  app.add_flag("--quiet", common.is_quiet, "no progress, no text");
  app.add_option("--threads", common.threads, "threads to use")
      ->type_name("N")
      ->capture_default_str()
      ->check(between(1, 1024));
  app.add_option("--log", common.log_file, "also write the log to this file")
      ->type_name("FILE")
      ->check(not_empty());
}

CLI::App* add_verb(CLI::App& app,
                   const std::string& name,
                   const std::string& what,
                   const std::string& example,
                   CommandLine& line,
                   int (*command)(const CommandLine& line)) {
  CLI::App* verb = app.add_subcommand(name, what);
  verb->footer(example);
  verb->callback([&line, command] { line.command = command; });
  add_common(*verb, line.common);
  return verb;
}

/// @param file  what the verb takes, STUDY.toml or SCENE.toml
void add_study(CLI::App& verb, const std::string& file, StudyArguments& study) {
  verb.add_option(file, study.study, "the study or scene")->type_name("FILE")->required();
  verb.add_option("--set", study.sets, "put this value in place of the file's")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

CLI::Option* add_out(CLI::App& verb, std::filesystem::path& out, const std::string& what) {
  return verb.add_option("--out", out, what)->type_name("DIR")->check(not_empty());
}

void add_seed(CLI::App& verb, std::optional<int>& seed, const std::string& what) {
  verb.add_option("--seed", seed, what)
      ->type_name("N")
      ->check(between(0, std::numeric_limits<int>::max()));
}

void add_jobs(CLI::App& verb, int& jobs, const std::string& what) {
  verb.add_option("--jobs", jobs, what)->type_name("N")->check(between(1, 1024));
}

void add_study_verbs(CLI::App& app, CommandLine& line) {
  CLI::App* run =
      add_verb(app,
               "run",
               "run a study, or resume the one in its folder",
               "glint run studies/gallery/tunnel_shape/study.toml --budget 40s",
               line,
               [](const CommandLine& given) { return run_command(given.study, given.common); });
  add_study(*run, "STUDY.toml", line.study);
  add_out(*run, line.study.out, "folder of the run (default out/<study name>/run)");
  add_jobs(*run, line.study.jobs, "candidates at once; results do not depend on it");
  run->add_option("--budget",
                  line.study.budget,
                  "wall clock, like 40s, 30m, 8h; other limits of the study's [budget] hold too")
      ->type_name("TIME");
  add_seed(*run, line.study.seed, "seed of the search");
  CLI::App* check =
      add_verb(app,
               "check",
               "validate a study, evaluate it once, predict its duration",
               "glint check studies/gallery/tunnel_shape/study.toml",
               line,
               [](const CommandLine& given) { return check_command(given.study, given.common); });
  add_study(*check, "STUDY.toml", line.study);
  add_jobs(*check, line.study.jobs, "candidates at once, for the prediction");
  CLI::App* render =
      add_verb(app,
               "render",
               "render a scene: pictures of all viewpoints, masks, geometry, "
               "labels, scores",
               "glint render scene.toml --out out/scene\n"
               "  glint render scene.toml --out out/masks --masks",
               line,
               [](const CommandLine& given) { return render_command(given.study, given.common); });
  add_study(*render, "SCENE.toml", line.study);
  add_out(*render, line.study.out, "folder for the pictures (default out/<study name>/render)");
  render->add_flag(
      "--masks", line.study.is_masks, "masks and geometry only, without sampling any light");
  CLI::App* frontier = add_verb(
      app,
      "frontier",
      "chart error against time of every rendering method",
      "glint frontier studies/gallery/tunnel_shape/study.toml --out out/f",
      line,
      [](const CommandLine& given) { return frontier_command(given.study, given.common); });
  add_study(*frontier, "SCENE.toml", line.study);
  add_out(*frontier,
          line.study.out,
          "folder for chart and numbers (default out/<study name>/frontier)");
}

void add_imprint_verb(CLI::App& app, CommandLine& line) {
  CLI::App* imprint = add_verb(
      app,
      "imprint",
      "put defects on a part: meshes, labels, metadata, previews",
      "glint imprint studies/gallery/gear_defects/scene.toml --out out/gears --count 20 "
      "--seed 7",
      line,
      [](const CommandLine& given) { return imprint_command(given.imprint, given.common); });
  add_study(*imprint, "SCENE.toml", line.imprint.study);
  add_out(
      *imprint, line.imprint.study.out, "folder for the files (default out/<study name>/imprint)");
  imprint
      ->add_option("--count", line.imprint.count, "number of parts, in part_0000, part_0001, ...")
      ->type_name("N")
      ->check(between(1, 1'000'000));
  add_seed(*imprint, line.imprint.study.seed, "instead of imprint.seed");
  imprint->add_flag("--no_previews", line.imprint.is_without_previews, "no pictures");
  imprint->add_flag(
      "--preview_tools", line.imprint.is_preview_of_tools, "draw the tools only, make no part");
}

void add_inspect_verb(CLI::App& app, CommandLine& line) {
  InspectArguments& arguments = line.inspect;
  CLI::App* inspect = add_verb(
      app,
      "inspect",
      "find the defects in pictures of parts, and grade the parts",
      "glint inspect out/tunnel_shape --out out/inspected\n"
      "  glint inspect part/frame_*.png --mask part.png --out out/part "
      "--set inspection.threshold_sigmas=8",
      line,
      [](const CommandLine& given) { return inspect_command(given.inspect, given.common); });
  inspect
      ->add_option(
          "IMAGES|RUN",
          arguments.inputs,
          "pictures of one part, or folders of pictures (one per part), or the folder of a run")
      ->type_name("FILE")
      ->required();
  add_out(*inspect, arguments.out, "folder for the results (default out/<name>/inspect)");
  inspect->add_flag("--each", arguments.is_each, "each picture shows another part");
  inspect->add_option("--mask", arguments.mask, "picture that is bright where the part is")
      ->type_name("FILE");
  inspect
      ->add_option("--reference_mask",
                   arguments.reference_mask,
                   "mask of such a part in any pose: fitted to each part's silhouette")
      ->type_name("FILE");
  inspect->add_option("--settings", arguments.settings, "TOML file with a table [inspection]")
      ->type_name("FILE")
      ->allow_extra_args(false);
  inspect->add_option("--set", arguments.sets, "inspection.key=value: overrides a setting")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  inspect
      ->add_option("--flawless",
                   arguments.flawless,
                   "folders of flawless parts, for the setting threshold = \"false_alarms\"")
      ->type_name("DIR");
  inspect->add_option("--labels", arguments.labels, "CSV file: part,grade as assigned by a person")
      ->type_name("FILE");
  inspect->add_flag("--learn",
                    arguments.is_learning,
                    "learn the limits of the classes from the labels, write grading.toml");
}

void add_calibrate_verb(CLI::App& app, CommandLine& line) {
  CalibrateArguments& arguments = line.calibrate;
  CLI::App* calibrate = add_verb(
      app,
      "calibrate",
      "a real camera from pictures of a board, its place on a robot from poses",
      "glint calibrate board/*.png --board board.toml --out out/camera\n"
      "  glint calibrate board/*.png --board board.toml --poses poses.csv --setup eye_in_hand\n"
      "  glint calibrate --print_board board.toml --out out/board",
      line,
      [](const CommandLine& given) { return calibrate_command(given.calibrate, given.common); });
  calibrate->add_option("PICTURES", arguments.pictures, "pictures of the board, of one camera")
      ->type_name("FILE");
  calibrate->add_option("--board", arguments.board, "the board: board.toml or board.json")
      ->type_name("FILE")
      ->check(not_empty());
  calibrate
      ->add_option("--poses", arguments.poses, "the robot's poses: .csv, .json, .toml, .yaml files")
      ->type_name("FILE");
  calibrate
      ->add_option("--camera",
                   arguments.camera,
                   "intrinsics that are known: TOML, YAML of OpenCV or ROS, XML of ViSP or OpenCV")
      ->type_name("FILE")
      ->check(not_empty());
  add_out(*calibrate, arguments.out, "folder for the results (default out/<folder>/calibrate)");
  calibrate->add_option("--setup", arguments.setup, "the robot carries the camera, or the board")
      ->type_name("eye_in_hand|eye_to_hand");
  calibrate
      ->add_option("--method", arguments.method, "a closed form of OpenCV instead of our solution")
      ->type_name("tsai|park|horaud|andreff|daniilidis|shah|li");
  calibrate
      ->add_option("--set",
                   arguments.sets,
                   "convention.key=value: what the poses' numbers mean; poses.pair_by=order")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  calibrate
      ->add_option("--print_board", arguments.printed, "write this board as SVG and PDF instead")
      ->type_name("FILE")
      ->check(not_empty());
}

void add_cell_twin_options(CLI::App& cell, CellArguments& arguments) {
  cell.add_option("--port", arguments.port, "twin: first port; 0: free ones; else the cell's")
      ->type_name("N")
      ->check(between(0, 65532));
  cell.add_flag("--detach", arguments.is_detached, "twin: go on in the background");
  cell.add_option("--ready_file", arguments.ready_file, "twin: appears when the twins serve")
      ->type_name("FILE")
      ->check(not_empty());
  cell.add_option("--twin", arguments.twin, "ports of this ready file instead of the cell's")
      ->type_name("FILE")
      ->check(not_empty());
}

void add_cell_grab_options(CLI::App& cell, CellArguments& arguments) {
  cell.add_option("--count", arguments.count, "grab: how many pictures")
      ->type_name("N")
      ->capture_default_str()
      ->check(between(1, 1'000'000));
  add_out(cell, arguments.out, "grab: folder of the pictures (default out/<name>/grab)");
}

void add_cell_verb(CLI::App& app, CommandLine& line) {
  CellArguments& arguments = line.cell;
  CLI::App* cell =
      add_verb(app,
               "cell",
               "a real camera and robot, and their twins",
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
                   "the cell's file; of twins before it: camera, robot, both or stop")
      ->type_name("FILE");
  cell->add_flag(
      "--move", arguments.is_move, "let the robot move: type it when nobody is within its reach");
  cell->add_option("--view", arguments.view, "move: name or number of a view; safe: a position")
      ->type_name("NAME");
  cell->add_option("--speed_share", arguments.speed_share, "of the cell's limits of speed")
      ->type_name("SHARE")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 1.0).description("0.01 to 1"));
  cell->add_flag("--off", arguments.is_off, "power: off instead of on");
  cell->add_option("--duration_s", arguments.duration_s, "watch: for so long")
      ->type_name("S")
      ->capture_default_str()
      ->check(CLI::Validator(CLI::PositiveNumber).description("> 0"));
  add_cell_grab_options(*cell, arguments);
  add_cell_twin_options(*cell, arguments);
}

void add_part_verb(CLI::App& app, CommandLine& line) {
  CLI::App* part =
      add_verb(app,
               "part",
               "inspect a part, convert its file",
               "glint part gear.stl --unit mm --out gear.ply",
               line,
               [](const CommandLine& given) { return part_command(given.part, given.common); });
  part->add_option("FILE", line.part.file, "STL, PLY, OBJ, OFF, or a TOML file with [part]")
      ->type_name("FILE")
      ->required();
  part->add_option("--out", line.part.out, "write the mesh: .stl .ply .obj .off")
      ->type_name("FILE")
      ->check(not_empty());
  part->add_option("--unit", line.part.unit, "of the file")
      ->type_name(kUnits)
      ->capture_default_str();
  part->add_option("--crease_deg", line.part.crease_deg, "edges sharper than this are not smoothed")
      ->type_name("DEG")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 180.0).description("0 to 180"));
  part->add_option("--slope_mrad", line.part.slope_mrad, "smallest slope of interest")
      ->type_name("MRAD")
      ->capture_default_str()
      ->check(CLI::Validator(CLI::PositiveNumber).description("> 0"));
}

void add_new_verb(CLI::App& app, CommandLine& line) {
  CLI::App* fresh =
      add_verb(app,
               "new",
               "write a commented study to start from",
               "glint new gear.stl --camera width_px=2448,height_px=2048,pixel_um=3.45,focal_mm=16 "
               "--working_distance_mm 300 --out gear.toml",
               line,
               [](const CommandLine& given) { return new_command(given.fresh, given.common); });
  fresh->add_option("PART", line.fresh.part, "mesh file")->type_name("FILE")->required();
  fresh->add_option("--unit", line.fresh.unit, "of the mesh")
      ->type_name(kUnits)
      ->capture_default_str();
  fresh
      ->add_option("--camera",
                   line.fresh.camera,
                   "data sheet: a TOML file with [camera] keys, or key=value,key=value")
      ->type_name("FILE|KEYS");
  fresh->add_option("--working_distance_mm", line.fresh.working_distance_mm, "pinhole to part")
      ->type_name("MM")
      ->capture_default_str()
      ->check(CLI::Validator(CLI::PositiveNumber).description("> 0"));
  fresh->add_option("--light", line.fresh.light, "tunnel, ring, dome, bar, or all to compare them")
      ->type_name("KIND")
      ->capture_default_str()
      ->check(CLI::IsMember({"tunnel", "ring", "dome", "bar", "all"}));
  fresh->add_option("--out", line.fresh.out, "study file to write (default: stdout)")
      ->type_name("FILE")
      ->check(not_empty());
}

void add_other_verbs(CLI::App& app, CommandLine& line) {
  CLI::App* report =
      add_verb(app,
               "report",
               "write the report of one run, or compare several",
               "glint report out/tunnel_shape out/fringe_design --out compare.html",
               line,
               [](const CommandLine& given) { return report_command(given.report, given.common); });
  report->add_option("DIR", line.report.runs, "run directories")->type_name("DIR")->required();
  report->add_option("--out", line.report.out, "HTML file (default DIR/report.html)")
      ->type_name("FILE")
      ->check(not_empty());
  CLI::App* explain = add_verb(
      app,
      "explain",
      "what a configuration key or a score means",
      "glint explain lighting.tunnel.radius_mm\n"
      "  glint explain scratch\n"
      "  glint explain --schema > study.schema.json",
      line,
      [](const CommandLine& given) { return explain_command(given.explain, given.common); });
  explain
      ->add_option("KEY",
                   line.explain.key,
                   "a key, a table, a score, a kind of defect or light, or a part of a name; "
                   "without it the tables are listed")
      ->type_name("KEY");
  explain->add_flag("--all", line.explain.is_all, "every key and every score");
  explain->add_flag(
      "--schema", line.explain.is_schema, "the JSON schema of study files, for editors");
}

}  // namespace

void add_verbs(CLI::App& app, CommandLine& line) {
  add_study_verbs(app, line);
  add_imprint_verb(app, line);
  add_inspect_verb(app, line);
  add_calibrate_verb(app, line);
  add_cell_verb(app, line);
  add_part_verb(app, line);
  add_new_verb(app, line);
  add_other_verbs(app, line);
}

}  // namespace glint
