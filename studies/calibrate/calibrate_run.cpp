// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/calibrate_run.h"

#include <array>
#include <chrono>
#include <system_error>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/wall_clock.h"
#include "studies/calibrate/calibrate_files.h"
#include "studies/calibrate/solved_calibration.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

/// out/<folder of the pictures>/calibrate
fs::path default_folder(const CalibrateOptions& options) {
  std::error_code ignored;
  const fs::path first = options.pictures.empty() ? fs::path() : options.pictures.front();
  const fs::path folder =
      fs::weakly_canonical(fs::absolute(first, ignored), ignored).parent_path().filename();
  return default_result_folder(folder.empty() ? "camera" : folder.string(), ResultKind::kCalibrate);
}

void check_folder(const CalibrateOptions& options, const fs::path& out) {
  const std::array<std::string, 3> names = {"calibration.toml", "calibration.json", "run.json"};
  check_result_folder(out, ResultKind::kCalibrate, names);
  std::vector<fs::path> inputs = options.pictures;
  inputs.insert(inputs.end(), options.poses.begin(), options.poses.end());
  inputs.insert(inputs.end(), {options.board, options.camera});
  check_inputs_kept(inputs, out, names);
}

}  // namespace

Json calibrate_pictures(const CalibrateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const fs::path out = options.out.empty() ? default_folder(options) : options.out;
  check_folder(options, out);
  ThreadPool pool(options.threads);
  const CalibrateInput input = read_calibrate_input(options, pool);
  const SolvedCalibration solved = solve_calibration(input, pool);
  Json result = calibration_json(input, solved);
  OutputFolder folder(out);
  remove_stale_stages(out);
  StagedFolder stage(out, "");
  write_file(stage.path() / "calibration.toml", calibration_toml(input, solved));
  write_file(stage.path() / "calibration.json", result.dump(2) + "\n");
  Json run = provenance();
  run["verb"] = command_of(ResultKind::kCalibrate);
  run["pictures"] = input.names.size();
  run["threads"] = options.threads;
  run["timings"] = {{"this_run_s", seconds_since(start)}};
  write_file(stage.path() / "run.json", run.dump(2) + "\n");
  stage.commit();
  folder.keep();
  result["folder"] = out.string();
  return result;
}

}  // namespace glint
