// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command_line.h"

#include <string>

#include <CLI/CLI.hpp>

#include "cli/acquire/driving_options.h"
#include "cli/hardware_verbs.h"
#include "cli/shell/options.h"

namespace glint {
namespace {

constexpr const char* kUnits = "mm|cm|m|inch";

void add_common(CLI::App& app, CommonArguments& common) {
  app.add_flag("--json", common.is_json, "print one JSON object and nothing else on stdout");
  app.add_flag("--quiet", common.is_quiet, "print no progress and no text");
  app.add_option("--threads", common.threads, "threads to use")
      ->type_name("N")
      ->capture_default_str()
      ->check(between(1, 1024));
  app.add_option("--log", common.log_file, "also write the log to this file")
      ->type_name("FILE")
      ->check(not_empty());
}

}  // namespace

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

void add_study(CLI::App& verb, const std::string& file, StudyArguments& study) {
  verb.add_option(file, study.study, "the study or scene")->type_name("FILE")->required();
  verb.add_option("--set", study.sets, "use this value instead of the file's")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

namespace {

void add_from(CLI::App& run, std::filesystem::path& from) {
  run.add_option("--from",
                 from,
                 "an earlier run whose trials the search begins with, where they mean the same")
      ->type_name("DIR")
      ->check(not_empty());
}

void add_frontier_charts(CLI::App& frontier, FrontierArguments& chart) {
  CLI::Option* inspector =
      frontier.add_flag("--inspector",
                        chart.is_inspector,
                        "instead: defects found against false reports, by filters of the "
                        "inspection on simulated parts");
  CLI::Option* search = frontier.add_flag("--search",
                                          chart.is_search,
                                          "instead: evaluations of the study's search against "
                                          "its winner; resumes what --budget cut");
  search->excludes(inspector);
  frontier.add_option("--seeds", chart.seeds, "with --search: runs of each algorithm")
      ->type_name("N")
      ->capture_default_str()
      ->check(between(1, 1000))
      ->needs(search);
  frontier
      .add_option("--methods",
                  chart.methods,
                  "with --search: algorithms, like auto,sbplx (default: the study's own)")
      ->type_name("LIST")
      ->delimiter(',')
      ->needs(search);
}

void add_frontier_verb(CLI::App& app, CommandLine& line) {
  CLI::App* frontier = add_verb(
      app,
      "frontier",
      "chart error against time of every rendering method",
      "glint frontier studies/gallery/tunnel_shape/study.toml --out out/f\n"
      "  glint frontier studies/gallery/tunnel_shape/study.toml --inspector\n"
      "  glint frontier studies/gallery/tunnel_shape/study.toml --search --seeds 5 --methods "
      "sbplx,auto",
      line,
      [](const CommandLine& given) {
        return frontier_chart_command(given.study, given.frontier, given.common);
      });
  add_study(*frontier, "SCENE.toml", line.study);
  add_out(*frontier,
          line.study.out,
          "folder for chart and numbers (default out/<study name>/frontier)");
  frontier
      ->add_option("--budget",
                   line.study.budget,
                   "wall clock, like 40s, 30m; methods beyond it are left out (default 10m)")
      ->type_name("TIME");
  add_frontier_charts(*frontier, line.frontier);
}

void add_verify_replay(CLI::App& run, bool& verify_replay) {
  run.add_flag("--verify_replay",
               verify_replay,
               "when resuming: compute every recorded proposal of the search again and compare it");
}

void add_study_verbs(CLI::App& app, CommandLine& line) {
  CLI::App* run = add_verb(app,
                           "run",
                           "run a study, or resume the one in its folder",
                           "glint run studies/gallery/tunnel_shape/study.toml --budget 40s",
                           line,
                           [](const CommandLine& given) {
                             return run_command(given.study, given.driven_run, given.common);
                           });
  add_study(*run, "STUDY.toml", line.study);
  add_out(*run, line.study.out, "folder of the run (default out/<study name>/run)");
  add_jobs(*run, line.study.jobs, "candidates evaluated at once; results do not depend on it");
  run->add_option("--budget",
                  line.study.budget,
                  "wall clock, like 40s, 30m, 8h; other limits of the study's [budget] hold too")
      ->type_name("TIME");
  add_seed(*run, line.study.seed, "seed of the search");
  add_from(*run, line.study.from);
  add_verify_replay(*run, line.study.verify_replay);
  run->add_option(
         "--cell",
         line.driven_run.cell,
         "for a study with [validate]: plan its views for this cell; with --move the robot "
         "takes real pictures, which are compared with the simulated ones")
      ->type_name("FILE")
      ->check(not_empty());
  add_driving_options(*run, line.driven_run, "with --cell: ");
  CLI::App* check =
      add_verb(app,
               "check",
               "validate a study, evaluate it once, predict its duration",
               "glint check studies/gallery/tunnel_shape/study.toml",
               line,
               [](const CommandLine& given) { return check_command(given.study, given.common); });
  add_study(*check, "STUDY.toml", line.study);
  add_jobs(*check, line.study.jobs, "candidates evaluated at once, for the prediction");
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
      "--masks", line.study.is_masks, "write masks and geometry only, without sampling any light");
  add_frontier_verb(app, line);
}

void add_stability_verb(CLI::App& app, CommandLine& line) {
  CLI::App* verb = add_verb(
      app,
      "stability",
      "find where methods fail: sweeps from harmless to hopeless",
      "glint stability --out out/stability --sweep gain --sweep slot",
      line,
      [](const CommandLine& given) { return stability_command(given.stability, given.common); });
  StabilityArguments& arguments = line.stability;
  add_study(*verb, "STUDY.toml", arguments.study);
  verb->get_option("STUDY.toml")
      ->required(false)
      ->description("study whose scene replaces the built-in one (default: none)");
  add_out(*verb,
          arguments.study.out,
          "folder for page and numbers (default out/<study name>/stability, with --run "
          "out/<study name>/stability_winner, without a study out/stability)");
  verb->add_option("--run",
                   arguments.run,
                   "ask instead whether the winner of this run still wins when disturbed")
      ->type_name("DIR");
  verb->add_option("--sweep", arguments.sweeps, "measure only this sweep")
      ->type_name("NAME")
      ->allow_extra_args(false);
  verb->add_flag("--list", arguments.is_list, "list the sweeps and measure none");
  verb->add_option("--budget", arguments.budget_min, "limit of wall clock time in minutes")
      ->type_name("MINUTES")
      ->check(positive(""));
  verb->add_option("--h_points", arguments.h_points, "allowed error of h in points (default 0.5)")
      ->type_name("NUMBER")
      ->check(positive(""));
  verb->add_option("--contrast_percent",
                   arguments.contrast_percent,
                   "allowed error of a dent's contrast in per cent (default 5)")
      ->type_name("PERCENT")
      ->check(positive(""));
  verb->add_option("--picture",
                   arguments.picture,
                   "allowed error of the mean image, share of full scale (default 0.01)")
      ->type_name("SHARE")
      ->check(positive(""));
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
  add_seed(*imprint, line.imprint.study.seed, "seed that replaces imprint.seed");
  imprint->add_flag("--no_previews", line.imprint.is_without_previews, "write no pictures");
  imprint->add_flag(
      "--preview_tools", line.imprint.is_preview_of_tools, "draw the tools only, make no part");
}

void add_inspect_verb(CLI::App& app, CommandLine& line) {
  InspectArguments& arguments = line.inspect;
  CLI::App* inspect = add_verb(
      app,
      "inspect",
      "find the defects in pictures of parts, and grade the parts",
      "glint inspect out/tunnel_shape/run --out out/inspected\n"
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
                   "mask of such a part in any pose, fitted to each part's silhouette")
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

void add_part_verb(CLI::App& app, CommandLine& line) {
  CLI::App* part =
      add_verb(app,
               "part",
               "inspect a part, convert its file",
               "glint part gear.stl --unit mm --out gear.ply",
               line,
               [](const CommandLine& given) { return part_command(given.part, given.common); });
  part->add_option("FILE", line.part.file, "STL, PLY, OBJ, OFF, CAO, or a TOML file with [part]")
      ->type_name("FILE")
      ->required();
  part->add_option("--out", line.part.out, "write the mesh: .stl .ply .obj .off")
      ->type_name("FILE")
      ->check(not_empty());
  part->add_option("--unit", line.part.unit, "unit of the file")
      ->type_name(kUnits)
      ->capture_default_str();
  part->add_option("--crease_deg", line.part.crease_deg, "edges sharper than this are not smoothed")
      ->type_name("DEG")
      ->capture_default_str()
      ->check(between(0.0, 180.0));
  part->add_option("--slope_mrad", line.part.slope_mrad, "smallest slope of interest")
      ->type_name("MRAD")
      ->capture_default_str()
      ->check(positive());
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
  fresh->add_option("--unit", line.fresh.unit, "unit of the mesh")
      ->type_name(kUnits)
      ->capture_default_str();
  fresh
      ->add_option("--camera",
                   line.fresh.camera,
                   "data sheet: a TOML file with [camera] keys, or key=value,key=value")
      ->type_name("FILE|KEYS");
  fresh
      ->add_option("--working_distance_mm",
                   line.fresh.working_distance_mm,
                   "distance from the pinhole to the part")
      ->type_name("MM")
      ->capture_default_str()
      ->check(between(1.0, 100000.0));
  fresh->add_option("--light", line.fresh.light, "kind of light, or all to compare them")
      ->type_name("tunnel|ring|dome|bar|all")
      ->capture_default_str()
      ->check(CLI::IsMember({"tunnel", "ring", "dome", "bar", "all"}).description(""));
  fresh->add_option("--out", line.fresh.out, "study file to write (default: stdout)")
      ->type_name("FILE")
      ->check(not_empty());
}

void add_other_verbs(CLI::App& app, CommandLine& line) {
  CLI::App* report =
      add_verb(app,
               "report",
               "write the report of one run, or compare several",
               "glint report out/tunnel_shape/run out/fringe_design/run --out compare.html",
               line,
               [](const CommandLine& given) { return report_command(given.report, given.common); });
  report->add_option("DIR", line.report.runs, "run directories")->type_name("DIR")->required();
  report->add_option("--out", line.report.out, "HTML file (default DIR/report.html)")
      ->type_name("FILE")
      ->check(not_empty());
  report
      ->add_option("--optuna", line.report.optuna, "journal file for Optuna 3.1, instead of a page")
      ->type_name("FILE")
      ->check(not_empty())
      ->excludes("--out");
  CLI::Option* analyse =
      report->add_flag("--analyse",
                       line.report.is_analysed,
                       "analyse how much each variable matters to the scores of one run");
  report
      ->add_option("--evaluate",
                   line.report.evaluate,
                   "evaluate space-filling designs until the analysis has N of them")
      ->type_name("N")
      ->check(between(1, 1000000))
      ->needs(analyse);
  analyse->excludes("--optuna");
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
  explain->add_flag("--all", line.explain.is_all, "print every key and every score");
  explain->add_flag(
      "--schema", line.explain.is_schema, "print the JSON schema of study files, for editors");
}

}  // namespace

void add_verbs(CLI::App& app, CommandLine& line) {
  add_study_verbs(app, line);
  add_stability_verb(app, line);
  add_imprint_verb(app, line);
  add_inspect_verb(app, line);
  add_hardware_verbs(app, line);
  add_part_verb(app, line);
  add_new_verb(app, line);
  add_other_verbs(app, line);
}

}  // namespace glint
