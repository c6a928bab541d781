// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/calibrate_run.h"

#include <array>
#include <chrono>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/wall_clock.h"
#include "studies/calibrate/calibrate_files.h"
#include "studies/calibrate/calibrate_page.h"
#include "studies/calibrate/corner_file.h"
#include "studies/calibrate/corner_residuals.h"
#include "studies/calibrate/solved_calibration.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

void check_folder(const CalibrateOptions& options, const fs::path& out) {
  const std::array<std::string, 5> names = {
      "calibration.toml", "calibration.json", "corners.csv", "report.html", "run.json"};
  check_result_folder(out, ResultKind::kCalibrate, names);
  std::vector<fs::path> inputs = options.pictures;
  inputs.insert(inputs.end(), options.poses.begin(), options.poses.end());
  inputs.insert(inputs.end(), {options.from, options.board, options.camera});
  check_inputs_kept(inputs, out, names);
}

}  // namespace

Json calibrate_pictures(const CalibrateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::string started = utc_text(std::chrono::system_clock::now());
  const std::vector<fs::path> from = {options.from};
  const fs::path out = options.out.empty()
                           ? folder_of_pictures(options.from.empty() ? options.pictures : from,
                                                ResultKind::kCalibrate)
                           : options.out;
  check_folder(options, out);
  ThreadPool pool(options.threads);
  const CalibrateInput input = read_calibrate_input(options, pool);
  const SolvedCalibration solved = solve_calibration(input, pool);
  const auto residuals_px = corner_residuals_px(input, solved);
  Json result = calibration_json(input, solved, residuals_px);
  ResultWriter writer(out, ResultKind::kCalibrate);
  write_file(writer.path() / "calibration.toml", calibration_toml(input, solved));
  write_file(writer.path() / "calibration.json", result.dump(2) + "\n");
  write_file(writer.path() / "corners.csv", corners_csv(input, solved, residuals_px));
  const std::string when = moment_text(started, seconds_since(start));
  write_file(writer.path() / "report.html",
             calibrate_page(result, input, solved, residuals_px, when));
  writer.finish({{"pictures", input.names.size()}, {"threads", options.threads}}, start);
  result["report"] = (out / "report.html").string();
  result["folder"] = out.string();
  return result;
}

}  // namespace glint
