// SPDX-License-Identifier: GPL-3.0-or-later
//
// One function per subcommand. Each gets its arguments as plain values, prints its result on stdout
// and returns the exit code; wrong input is thrown.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "cli/acquire/acquire.h"
#include "cli/shell/exit_codes.h"
#include "core/progress.h"
#include "studies/definition/study.h"
#include "studies/output/result_folder.h"

namespace glint {

struct CommonArguments {
  bool is_json = false;
  bool is_quiet = false;
  int threads = 1;
  std::filesystem::path log_file;

  Progress::Style progress() const {
    return is_quiet ? Progress::Style::kNone : Progress::Style::kAuto;
  }
};

struct StudyArguments {
  std::filesystem::path study;
  std::filesystem::path out;
  std::vector<std::string> sets;  ///< "key=value"
  int jobs = 0;                   ///< 0: as many as threads
  std::string budget;             ///< wall clock, empty: as the study says
  std::optional<int> seed;
  std::filesystem::path from;  ///< run: an earlier run to begin with
  bool verify_replay = false;  ///< run: compute every recorded question again when resuming
  bool is_masks = false;       ///< render: masks and geometry alone
};

/// @param given  with its cell and --move, the robot validates what [validate] names
int run_command(const StudyArguments& arguments,
                const AcquireArguments& given,
                const CommonArguments& common);
int check_command(const StudyArguments& arguments, const CommonArguments& common);
int render_command(const StudyArguments& arguments, const CommonArguments& common);
int frontier_command(const StudyArguments& arguments, const CommonArguments& common);

struct StabilityArguments {
  StudyArguments study;       ///< without one the built-in scene
  std::filesystem::path run;  ///< whose winner is disturbed; empty: none
  std::vector<std::string> sweeps;
  bool is_list = false;
  double budget_min = 0.0;  ///< wall clock; 0: none
  double h_points = 0.5;
  double contrast_percent = 5.0;
  double picture = 0.01;
};

int stability_command(const StabilityArguments& arguments, const CommonArguments& common);

struct ImprintArguments {
  StudyArguments study;
  int count = 0;  ///< 0: one part, in the folder itself
  bool is_without_previews = false;
  bool is_preview_of_tools = false;
};

int imprint_command(const ImprintArguments& arguments, const CommonArguments& common);

struct InspectArguments {
  std::vector<std::filesystem::path> inputs;  ///< pictures of one part, folders, run directories
  std::filesystem::path out;
  bool is_each = false;
  std::filesystem::path mask;
  std::filesystem::path reference_mask;
  std::vector<std::filesystem::path> settings;
  std::vector<std::string> sets;  ///< "inspection.key=value"
  std::vector<std::filesystem::path> flawless;
  std::filesystem::path labels;
  bool is_learning = false;
};

int inspect_command(const InspectArguments& arguments, const CommonArguments& common);

struct CompareArguments {
  std::vector<std::filesystem::path> pictures;  ///< the simulated side, then the real ones
  std::filesystem::path out;
  std::filesystem::path pairs;  ///< CSV; empty: by name or order
  std::filesystem::path mask;   ///< of the real part; empty: it is found
  std::filesystem::path scene;  ///< of simulated pictures that come without one
  std::string outline = "auto";
  bool has_offset = false;
  bool is_lens_known = false;
  std::filesystem::path calibration;  ///< of the real camera
  bool has_roughness = false;
  bool is_refining = false;
};

int compare_command(const CompareArguments& arguments, const CommonArguments& common);

struct CalibrateArguments {
  std::vector<std::filesystem::path> pictures;
  std::filesystem::path from;  ///< corners.csv, or its folder, instead of pictures
  std::filesystem::path board;
  std::vector<std::filesystem::path> poses;
  std::filesystem::path camera;
  std::filesystem::path out;
  std::string setup;              ///< empty: as the board's file says
  std::string method;             ///< empty: our own
  std::vector<std::string> sets;  ///< "convention.key=value"
  std::filesystem::path printed;  ///< a board to print instead
  std::filesystem::path checked;  ///< a calibration to check instead
  std::filesystem::path sensor;   ///< a folder of pictures of even light instead
  std::optional<int> bits;        ///< of their codes
  std::optional<int> planned;     ///< so many poses to photograph the board from instead
  std::filesystem::path points;   ///< points of the cell to draw into the pictures instead
  std::vector<std::filesystem::path> placed;  ///< what tells where the part is, instead
  std::vector<std::string> given;             ///< names of all options that were given
};

struct CommandLine;

/// By a cell or from files, in the mode that was asked for.
/// @throws ConfigError naming an option that the mode does not take
int calibrate_command(const CommandLine& given);

struct CoverArguments {
  StudyArguments study;
  std::filesystem::path pod;  ///< folder of a run; empty: none
};

int cover_command(const CoverArguments& arguments, const CommonArguments& common);

struct ViewPlanArguments {
  StudyArguments study;
  std::filesystem::path cell;
};

/// The modes of `glint calibrate` that are no calibration from a board.
int check_calibration_command(const CalibrateArguments& arguments, const CommonArguments& common);
int sensor_command(const CalibrateArguments& arguments, const CommonArguments& common);
int plan_command(const CalibrateArguments& arguments, const CommonArguments& common);
int points_command(const CalibrateArguments& arguments, const CommonArguments& common);
int place_command(const CalibrateArguments& arguments, const CommonArguments& common);

struct UndistortArguments {
  std::vector<std::filesystem::path> pictures;
  std::filesystem::path camera;
  std::filesystem::path out;
};

int undistort_command(const UndistortArguments& arguments, const CommonArguments& common);

struct CellArguments {
  std::string action;                ///< of cell_actions()
  std::vector<std::string> words;    ///< what follows it: the cell's file, of twins their kind too
  bool is_move = false;              ///< --move: a person in front of the robot lets it move
  std::string view;                  ///< name or number of a view, or name of a safe position
  double speed_share = 0.5;          ///< of the cell's limits of speed
  bool is_line = false;              ///< move, safe: the TCP goes straight
  bool is_off = false;               ///< power: off
  double duration_s = 10.0;          ///< watch
  int count = 1;                     ///< grab: how many pictures
  std::filesystem::path out;         ///< grab
  std::filesystem::path twin;        ///< ready file whose ports take the place of the cell's
  std::optional<int> port;           ///< twin
  bool has_cable = false;            ///< twin: the camera's can be made bad
  bool is_detached = false;          ///< twin
  std::filesystem::path ready_file;  ///< twin
};

int cell_command(const CellArguments& arguments, const CommonArguments& common);

struct ReportArguments {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path out;
  std::filesystem::path optuna;  ///< a journal file for Optuna; empty: none
  bool is_analysed = false;      ///< with what the scores owe to each variable
  int evaluate = 0;              ///< designs that are added for it, in all; 0: none
};

int report_command(const ReportArguments& arguments, const CommonArguments& common);

struct PartArguments {
  std::filesystem::path file;  ///< a mesh, or a TOML file with a [part] table
  std::filesystem::path out;
  std::string unit = "mm";
  double crease_deg = 30.0;
  double slope_mrad = 2.0;
};

int part_command(const PartArguments& arguments, const CommonArguments& common);

struct ExplainArguments {
  std::string key;  ///< empty: the groups of keys
  bool is_all = false;
  bool is_schema = false;  ///< the JSON schema of study files
};

int explain_command(const ExplainArguments& arguments, const CommonArguments& common);

struct ProgramUsage;

struct HelpArguments {
  std::string verb;  ///< empty: of the program
  bool is_man = false;
  std::string shell;  ///< whose completion is asked for; empty: none
};

/// @throws ConfigError for a verb or a shell that there is none of
int help_command(const ProgramUsage& program, const HelpArguments& arguments);

struct NewArguments {
  std::filesystem::path part;
  std::string unit = "mm";
  std::string camera;  ///< a TOML file with [camera] keys, or "width_px=2448,height_px=2048,..."
  double working_distance_mm = 600.0;
  std::string light = "tunnel";  ///< kind: "tunnel", "ring", "dome", "bar", or "all" of them
  std::filesystem::path out;     ///< empty: stdout
};

int new_command(const NewArguments& arguments, const CommonArguments& common);

/// --set arguments in two. @throws ConfigError for one without "="
std::vector<KeyValue> key_values(const std::vector<std::string>& sets);

/// An error of a part whose file and unit stand on the command line: says --unit, not part.unit.
ConfigError with_option_names(const ConfigError& error);

/// Reads a study as the arguments say.
Study load_study(const StudyArguments& arguments, SceneUse use = SceneUse::kPictures);

/// --out, or the verb's own folder.
/// @throws ConfigError when that holds results of another study's file of the same name
std::filesystem::path out_folder(const StudyArguments& arguments,
                                 const Study& study,
                                 ResultKind kind);

/// Prints the JSON object, or the text when --json was not given.
void print_result(const CommonArguments& common,
                  const nlohmann::ordered_json& json,
                  const std::string& text);

}  // namespace glint
