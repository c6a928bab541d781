// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/confirmed_lights.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"
#include "hardware/light/light.h"

namespace glint {
namespace {

std::vector<std::string> manual_lights(const Cell& cell) {
  std::vector<std::string> names;
  for (const CellLight& light : cell.lights) {
    if (light.kind == CellLight::Kind::kManual) {
      names.push_back(light.name);
    }
  }
  return names;
}

/// What stands behind a light's name on the command line.
std::string state_text(bool is_on) {
  return is_on ? "=on" : "=off";
}

struct ConfirmedLight {
  std::string name;
  std::optional<bool> is_on;
};

ConfirmedLight parse_confirmed(const std::string& text) {
  for (const bool is_on : {true, false}) {
    const std::string state = state_text(is_on);
    if (text.ends_with(state)) {
      return {.name = text.substr(0, text.size() - state.size()), .is_on = is_on};
    }
  }
  return {.name = text, .is_on = std::nullopt};
}

}  // namespace

ConfirmedLights::ConfirmedLights(const std::vector<std::string>& names) {
  for (const std::string& text : names) {
    ConfirmedLight light = parse_confirmed(text);
    named_[light.name] = light.is_on;
  }
}

bool ConfirmedLights::is_set(const std::string& light, bool is_on) const {
  const auto found = named_.find(light);
  return found != named_.end() && found->second.value_or(is_on) == is_on;
}

void ConfirmedLights::note(const std::string& light, bool is_on) {
  const auto found = named_.find(light);
  if (found != named_.end()) {
    found->second = is_on;
  }
}

void check_confirmed(const std::vector<std::string>& names, const Cell& cell) {
  const std::vector<std::string> manual = manual_lights(cell);
  for (const std::string& text : names) {
    if (std::ranges::find(manual, parse_confirmed(text).name) == manual.end()) {
      throw ConfigError(
          fmt::format("--confirmed {}: is no light of {} that a person switches; {}",
                      text,
                      cell.file.string(),
                      manual.empty() ? "it has none" : "these are " + join(manual, ", ")));
    }
  }
}

std::optional<LightWish> light_wish(const ConfirmedLights& confirmed,
                                    const Cell& cell,
                                    const ViewTask& task) {
  LightWish wish;
  std::vector<std::string> requests;
  for (const std::string& name : manual_lights(cell)) {
    const bool is_on = std::ranges::find(task.lights, name) != task.lights.end();
    if (!confirmed.is_set(name, is_on)) {
      wish.lights.push_back(name);
      wish.confirm.push_back(name + state_text(is_on));
      requests.push_back(switch_request(name, is_on));
    }
  }
  if (requests.empty()) {
    return std::nullopt;
  }
  wish.text = join(requests, ", ") + ", then leave the arm's reach";
  return wish;
}

}  // namespace glint
