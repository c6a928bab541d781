// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/stage_serving.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

namespace glint {
namespace {

constexpr int kStageOffset = 4;  // the robot has the ports before it

ScanSteps steps_of(const CellRenderer& renderer) {
  return {.to_first_mm = renderer.offset_mm(), .to_next_mm = renderer.step_mm()};
}

}  // namespace

StagePlace place_along(double along_mm, const StripeScan& scan) {
  constexpr double kTenthsOfUm = 1e4;
  const double rounded_mm = std::round(along_mm * kTenthsOfUm) / kTenthsOfUm;
  const double end_mm = scan.positions * scan.step_mm;
  const bool is_within = rounded_mm >= 0.0 && rounded_mm < end_mm;
  const double from_first_mm =
      is_within ? rounded_mm
                : rounded_mm - scan.period_mm * std::floor(rounded_mm / scan.period_mm);
  constexpr double kRounding = 1e-9;
  const int frame = static_cast<int>(std::floor(from_first_mm / scan.step_mm + kRounding));
  const int position = std::clamp(frame, 0, scan.positions - 1);
  const double shift_mm = from_first_mm - position * scan.step_mm;
  return {.position = position, .shift_mm = std::round(shift_mm * kTenthsOfUm) / kTenthsOfUm};
}

StageServing::StageServing(const CellStage& stage,
                           const CellRenderer& renderer,
                           std::optional<int> port)
    : token_(fresh_token()),
      way_(stage_way_of(stage, renderer.num_positions(), steps_of(renderer))),
      scan_({.positions = renderer.num_positions(),
             .step_mm = renderer.step_mm(),
             .period_mm = renderer.period_mm()}),
      twin_({.port = port ? (*port == 0 ? 0 : *port + kStageOffset) : stage.port,
             .kept_text = std::to_string(token_)}),
      side_(stage_twin_socket(twin_.port()), [this](const std::string& line) {
        return line == "token" ? std::to_string(token_) : "error: there is token";
      }) {}

std::optional<StagePlace> StageServing::place() const {
  if (way_.step_mm == 0.0) {
    return StagePlace{};
  }
  const auto reached_mm = twin_.reached_mm();
  const double at_mm = twin_.position_mm();
  if (!reached_mm && at_mm != 0.0) {
    return std::nullopt;  // it is on its way: before its first move it stands at 0
  }
  const int nearest = static_cast<int>(std::lround((at_mm - way_.first_mm) / way_.step_mm));
  const bool is_there = std::abs(at_mm - way_.at_mm(nearest)) <= way_.tolerance_mm;
  if (is_there && nearest >= 0 && nearest < way_.positions) {
    return StagePlace{.position = nearest};
  }
  if (!reached_mm || scan_.step_mm <= 0.0 || scan_.period_mm <= 0.0) {
    return std::nullopt;
  }
  const double from_first_mm = *reached_mm - way_.first_mm;
  return place_along(way_.step_mm < 0.0 ? -from_first_mm : from_first_mm, scan_);
}

nlohmann::ordered_json StageServing::description() const {
  return {{"kind", "stage"},
          {"address", "127.0.0.1"},
          {"port", twin_.port()},
          {"side_channel", side_.path().string()},
          {"token", token_}};
}

}  // namespace glint
