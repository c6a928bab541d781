// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/driving_options.h"

#include <CLI/CLI.hpp>

#include "cli/shell/options.h"

namespace glint {
namespace {

void add_targets(CLI::App& calibrate, CellCalibrationArguments& arguments) {
  calibrate
      .add_option("--target_px",
                  arguments.target_px,
                  "with --cell: stop when the predicted standard deviation of a computed point is "
                  "at most this")
      ->type_name("PX")
      ->capture_default_str()
      ->check(positive());
  calibrate
      .add_option("--target_mm",
                  arguments.target_mm,
                  "with --cell: also require this standard deviation of the camera's position on "
                  "the flange")
      ->type_name("MM")
      ->check(positive());
  calibrate
      .add_option("--target_deg",
                  arguments.target_deg,
                  "with --cell: also require this standard deviation of the camera's rotation on "
                  "the flange")
      ->type_name("DEG")
      ->check(positive());
  calibrate
      .add_option("--max_rounds",
                  arguments.max_rounds,
                  "with --cell: take at most this many rounds of pictures")
      ->type_name("N")
      ->capture_default_str()
      ->check(between(1, 20));
}

void add_part_options(CLI::App& calibrate, CellCalibrationArguments& arguments) {
  calibrate
      .add_option("--part",
                  arguments.part,
                  "with --cell: find the part of this scene by its edges, after calibrating with "
                  "--board or with the calibration in the folder --camera")
      ->type_name("FILE")
      ->check(not_empty());
  calibrate
      .add_option(
          "--placements",
          arguments.placements,
          "with --part: put the part down this many times, to measure the spread of its place")
      ->type_name("N")
      ->capture_default_str()
      ->check(between(1, 100));
  calibrate
      .add_option(
          "--placed",
          arguments.placed,
          "with --part: confirm that it has been put down for the Nth time; otherwise you are "
          "asked at the terminal")
      ->type_name("N")
      ->check(between(1, 100));
}

}  // namespace

void add_driving_options(CLI::App& verb, AcquireArguments& arguments, const std::string& when) {
  verb.add_flag("--move",
                arguments.is_move,
                when + "let the robot move: only when nobody is within reach of the arm");
  verb.add_option(
          "--twin", arguments.twin, when + "drive the twins of this ready file and nothing else")
      ->type_name("FILE")
      ->check(not_empty());
  verb.add_option("--speed_share",
                  arguments.speed_share,
                  when + "fraction of the cell's speed limits to use")
      ->type_name("SHARE")
      ->capture_default_str()
      ->check(between(0.01, 1.0));
  verb.add_option("--confirmed",
                  arguments.confirmed,
                  when +
                      "manual light that is on or off already; NAME alone: as its first picture "
                      "needs it; you are asked for others, and later changes, at the terminal")
      ->type_name("NAME[=on|off]")
      ->allow_extra_args(false);
}

void add_mounted_option(CLI::App& verb, AcquireArguments& arguments, const std::string& when) {
  CLI::Option* mounted =
      verb.add_option("--mounted",
                      arguments.mounted,
                      when +
                          "design of the run whose prototype is in the cell; you are asked for the "
                          "others at the terminal")
          ->type_name("NAME")
          ->allow_extra_args(false);
  if (!when.empty()) {
    mounted->needs(verb.get_option("--cell"));
  }
}

void add_cell_calibration(CLI::App& calibrate, CellCalibrationArguments& arguments) {
  calibrate
      .add_option("--cell",
                  arguments.acquire.cell,
                  "drive the robot of this cell and photograph --board instead")
      ->type_name("FILE")
      ->check(not_empty());
  add_driving_options(calibrate, arguments.acquire, "with --cell: ");
  add_mounted_option(calibrate, arguments.acquire, "with --part: ");
  add_targets(calibrate, arguments);
  add_part_options(calibrate, arguments);
}

}  // namespace glint
