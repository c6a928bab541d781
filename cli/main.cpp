// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <limits>
#include <new>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "core/log.h"
#include "core/text.h"
#include "core/thread_pool.h"
#include "studies/output/provenance.h"

namespace glint {
namespace {

/// What was asked for on the command line.
struct CommandLine {
  CommonArguments common;
  StudyArguments study;
  ImprintArguments imprint;
  InspectArguments inspect;
  ReportArguments report;
  PartArguments part;
  NewArguments fresh;
  std::string key;
};

void add_common(CLI::App& app, CommonArguments& common) {
  app.add_flag("--json", common.is_json, "print one JSON object and nothing else on stdout");
  app.add_flag("--quiet", common.is_quiet, "no progress, no text");
  app.add_option("--threads", common.threads, "threads to use")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_option("--log", common.log_file, "also write the log to this file");
}

CLI::App* add_verb(CLI::App& app,
                   const std::string& name,
                   const std::string& what,
                   const std::string& example,
                   CommandLine& line) {
  CLI::App* verb = app.add_subcommand(name, what);
  verb->footer("Example:\n  " + example);
  add_common(*verb, line.common);
  return verb;
}

void add_sets(CLI::App& verb, StudyArguments& study) {
  verb.add_option("STUDY.toml", study.study, "the study or scene")->required();
  verb.add_option("--set", study.sets, "key=value: overrides a key of the file")
      ->allow_extra_args(false);
}

void add_study_verbs(CLI::App& app, CommandLine& line) {
  CLI::App* run = add_verb(app,
                           "run",
                           "run a study, or resume the one in its folder",
                           "glint run studies/gallery/tunnel_shape/study.toml --budget 40s",
                           line);
  add_sets(*run, line.study);
  run->add_option("--out", line.study.out, "folder of the run (default out/<study name>/run)");
  run->add_option("--jobs", line.study.jobs, "candidates at once; results do not depend on it")
      ->check(CLI::Range(1, 1024));
  run->add_option("--budget", line.study.budget, "wall clock, like 40s, 30m, 8h");
  run->add_option("--seed", line.study.seed, "seed of the search")
      ->check(CLI::Range(0, std::numeric_limits<int>::max()));
  CLI::App* check = add_verb(app,
                             "check",
                             "validate a study, evaluate it once, predict its duration",
                             "glint check studies/gallery/tunnel_shape/study.toml",
                             line);
  add_sets(*check, line.study);
  check->add_option("--jobs", line.study.jobs, "candidates at once, for the prediction")
      ->check(CLI::Range(1, 1024));
  CLI::App* render = add_verb(app,
                              "render",
                              "render a scene: pictures of all viewpoints, masks, geometry, "
                              "labels, scores",
                              "glint render scene.toml --out out/scene\n"
                              "  glint render scene.toml --out out/masks --masks",
                              line);
  add_sets(*render, line.study);
  render->add_option(
      "--out", line.study.out, "folder for the pictures (default out/<study name>/render)");
  render->add_flag(
      "--masks", line.study.is_masks, "masks and geometry only, without sampling any light");
  CLI::App* frontier =
      add_verb(app,
               "frontier",
               "chart error against time of every rendering method",
               "glint frontier studies/gallery/tunnel_shape/study.toml --out out/f",
               line);
  add_sets(*frontier, line.study);
  frontier->add_option(
      "--out", line.study.out, "folder for chart and numbers (default out/<study name>/frontier)");
}

void add_imprint_verb(CLI::App& app, CommandLine& line) {
  CLI::App* imprint =
      add_verb(app,
               "imprint",
               "put defects on a part: meshes, labels, metadata, previews",
               "glint imprint studies/gallery/gear_defects/scene.toml --out out/gears --count 20 "
               "--seed 7",
               line);
  add_sets(*imprint, line.imprint.study);
  imprint->add_option(
      "--out", line.imprint.study.out, "folder for the files (default out/<study name>/imprint)");
  imprint
      ->add_option("--count", line.imprint.count, "number of parts, in part_0000, part_0001, ...")
      ->check(CLI::Range(1, 1'000'000));
  imprint->add_option("--seed", line.imprint.study.seed, "instead of imprint.seed")
      ->check(CLI::Range(0, std::numeric_limits<int>::max()));
  imprint->add_flag("--no_previews", line.imprint.is_without_previews, "no pictures");
  imprint->add_flag(
      "--preview_tools", line.imprint.is_preview_of_tools, "draw the tools only, make no part");
}

void add_inspect_verb(CLI::App& app, CommandLine& line) {
  InspectArguments& arguments = line.inspect;
  CLI::App* inspect = add_verb(app,
                               "inspect",
                               "find the defects in pictures of parts, and grade the parts",
                               "glint inspect out/tunnel_shape --out out/inspected\n"
                               "  glint inspect part/frame_*.png --mask part.png --out out/part "
                               "--set inspection.threshold_sigmas=8",
                               line);
  inspect
      ->add_option(
          "IMAGES|RUN",
          arguments.inputs,
          "pictures of one part, or folders of pictures (one per part), or the folder of a run")
      ->required();
  inspect->add_option(
      "--out", arguments.out, "folder for the results (default out/<name>/inspect)");
  inspect->add_flag("--each", arguments.is_each, "each picture shows another part");
  inspect->add_option("--mask", arguments.mask, "picture that is bright where the part is");
  inspect->add_option("--reference_mask",
                      arguments.reference_mask,
                      "mask of such a part in any pose: fitted to each part's silhouette");
  inspect->add_option("--settings", arguments.settings, "TOML file with a table [inspection]")
      ->allow_extra_args(false);
  inspect->add_option("--set", arguments.sets, "inspection.key=value: overrides a setting")
      ->allow_extra_args(false);
  inspect->add_option("--flawless",
                      arguments.flawless,
                      "folders of flawless parts, for the setting threshold = \"false_alarms\"");
  inspect->add_option("--labels", arguments.labels, "CSV file: part,grade as assigned by a person");
  inspect->add_flag("--learn",
                    arguments.is_learning,
                    "learn the limits of the classes from the labels, write grading.toml");
}

void add_other_verbs(CLI::App& app, CommandLine& line) {
  CLI::App* report = add_verb(app,
                              "report",
                              "write the report of one run, or compare several",
                              "glint report out/tunnel_shape out/fringe_design --out compare.html",
                              line);
  report->add_option("DIR", line.report.runs, "run directories")->required();
  report->add_option("--out", line.report.out, "HTML file (default DIR/report.html)");
  CLI::App* part = add_verb(app,
                            "part",
                            "inspect a part, convert its file",
                            "glint part gear.stl --unit mm --out gear.ply",
                            line);
  part->add_option("FILE", line.part.file, "STL, PLY, OBJ, OFF, or a TOML file with [part]")
      ->required();
  part->add_option("--out", line.part.out, "write the mesh: .stl .ply .obj .off");
  part->add_option("--unit", line.part.unit, "of the file: mm, cm, m, inch")->capture_default_str();
  part->add_option("--crease_deg", line.part.crease_deg, "edges sharper than this are not smoothed")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 180.0));
  part->add_option("--slope_mrad", line.part.slope_mrad, "smallest slope of interest")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  CLI::App* explain = add_verb(app,
                               "explain",
                               "what a configuration key or a score means",
                               "glint explain lighting.tunnel.radius_mm",
                               line);
  explain->add_option("KEY", line.key, "a key, a score, or a part of a name")->required();
  CLI::App* fresh =
      add_verb(app,
               "new",
               "write a commented study to start from",
               "glint new gear.stl --camera width_px=2448,height_px=2048,pixel_um=3.45,focal_mm=16 "
               "--working_distance_mm 300 --out gear.toml",
               line);
  fresh->add_option("PART", line.fresh.part, "mesh file")->required();
  fresh->add_option("--unit", line.fresh.unit, "of the mesh: mm, cm, m, inch")
      ->capture_default_str();
  fresh->add_option("--camera",
                    line.fresh.camera,
                    "data sheet: a TOML file with [camera] keys, or key=value,key=value");
  fresh->add_option("--working_distance_mm", line.fresh.working_distance_mm, "pinhole to part")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  fresh->add_option("--light", line.fresh.light, "tunnel, ring, dome, bar, or all to compare them")
      ->capture_default_str()
      ->check(CLI::IsMember({"tunnel", "ring", "dome", "bar", "all"}));
  fresh->add_option("--out", line.fresh.out, "study file to write (default: stdout)");
}

int dispatch(const CLI::App& app, const CommandLine& line) {
  LogSettings log = {.to_stderr = !line.common.is_quiet};
  if (!line.common.log_file.empty()) {
    check_log_file(line.common.log_file);
    log.files.push_back(line.common.log_file);
  }
  configure_log(log);
  if (app.got_subcommand("run")) {
    return run_command(line.study, line.common);
  }
  if (app.got_subcommand("check")) {
    return check_command(line.study, line.common);
  }
  if (app.got_subcommand("render")) {
    return render_command(line.study, line.common);
  }
  if (app.got_subcommand("frontier")) {
    return frontier_command(line.study, line.common);
  }
  if (app.got_subcommand("imprint")) {
    return imprint_command(line.imprint, line.common);
  }
  if (app.got_subcommand("inspect")) {
    return inspect_command(line.inspect, line.common);
  }
  if (app.got_subcommand("report")) {
    return report_command(line.report, line.common);
  }
  if (app.got_subcommand("part")) {
    return part_command(line.part, line.common);
  }
  if (app.got_subcommand("explain")) {
    return explain_command(line.key, line.common);
  }
  return new_command(line.fresh, line.common);
}

std::vector<std::string> names_of(const std::vector<CLI::App*>& verbs) {
  std::vector<std::string> names;
  for (const CLI::App* verb : verbs) {
    names.push_back(verb->get_name());
  }
  return names;
}

/// What is wrong with the command line, on one line; CLI11 itself does not name the nearest.
std::string usage_problem(CLI::App& app, const CLI::Error& error, int argc, char** argv) {
  const std::vector<std::string> verbs =
      names_of(app.get_subcommands([](CLI::App*) { return true; }));
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  if (chosen.empty()) {
    const std::string first = argc > 1 ? argv[1] : "";
    return first.empty() || first.starts_with("-")
               ? fmt::format("glint: a verb is needed: {}", fmt::join(verbs, ", "))
               : fmt::format(
                     "glint {}: no such verb, the nearest is {}", first, nearest(first, verbs));
  }
  const CLI::App& verb = *chosen.front();
  for (const std::string& extra : app.remaining(true)) {
    std::vector<std::string> names;
    for (const CLI::Option* option : verb.get_options()) {
      names.push_back(option->get_name());
    }
    if (extra.starts_with("-")) {
      return fmt::format("glint {}: {}: no such option, the nearest is {}",
                         verb.get_name(),
                         extra,
                         nearest(extra, names));
    }
  }
  return fmt::format("glint {}: {}", verb.get_name(), error.what());
}

int run_program(int argc, char** argv) {
  CLI::App app("Glint finds the lighting under which surface defects show.", "glint");
  app.set_version_flag("--version", program_version());
  app.require_subcommand(1);
  app.footer("glint VERB --help shows the options of a verb and an example.");
  CommandLine line;
  line.common.threads = hardware_threads();
  add_study_verbs(app, line);
  add_imprint_verb(app, line);
  add_inspect_verb(app, line);
  add_other_verbs(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      return app.exit(error) == 0 ? kExitDone : kExitUsage;
    }
    std::cerr << usage_problem(app, error, argc, argv) << "\n";
    return kExitUsage;
  }
  try {
    return dispatch(app, line);
  } catch (const ConfigError& error) {
    std::cerr << error.what() << "\n";
    return kExitUsage;
  } catch (const IoError& error) {
    std::string text = error.what();  // one problem; what SQLite says may have several lines
    std::ranges::replace(text, '\n', ' ');
    std::cerr << text << "\n";
    return kExitIo;
  } catch (const std::bad_alloc&) {
    std::cerr
        << "out of memory: this takes more than the machine, or a limit on this program, has; "
           "fewer pixels, --jobs or --threads need less\n";
    return kExitIo;
  } catch (const std::exception& error) {
    std::cerr << "internal error: " << error.what() << "\n";
    return kExitInternal;
  }
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  // A file beyond the system's limit shall be an error that names it, not the program's death.
  std::signal(SIGXFSZ, SIG_IGN);
  // Every candidate makes pictures of the same sizes: kept by the process instead of given back to
  // the system and cleared anew, which would take as long as evaluating the candidate.
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  return glint::run_program(argc, argv);
}
