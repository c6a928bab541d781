// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is done beside calibrating a camera: checking a calibration, straight pictures, the sensor,
// a plan of poses, points drawn into pictures.
#include <initializer_list>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "studies/calibrate/undistort_run.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

int undistort_command(const UndistortArguments& arguments, const CommonArguments& common) {
  const Json result = undistort_pictures({.pictures = arguments.pictures,
                                          .camera = arguments.camera,
                                          .out = arguments.out,
                                          .threads = common.threads});
  print_result(common,
               result,
               fmt::format("{} picture{}; {:.2g} % of their pixels show nothing\n"
                           "their camera: {}/camera.toml\n",
                           result["pictures"].size(),
                           result["pictures"].size() == 1 ? "" : "s",
                           100.0 * result["outside_share"].get<double>(),
                           result["folder"].get<std::string>()));
  return kExitDone;
}

}  // namespace glint
