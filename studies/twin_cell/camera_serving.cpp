// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/camera_serving.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hardware/gige/packets.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/cable_text.h"

namespace glint {
namespace {

/// Where a camera listens whose cable ends at this address: another one of 127.0.0.0/8 that no
/// client asks.
std::uint32_t behind_cable(std::uint32_t address) {
  constexpr std::uint32_t kNet = 1U << 16;
  return address ^ kNet;
}

}  // namespace

CameraServing::CameraServing(const Cell& cell,
                             const Truth& truth,
                             std::uint32_t address,
                             const TwinCellState& state,
                             bool has_cable,
                             int threads)
    : token_(fresh_token()),
      pool_(threads),
      renderer_(truth, pool_),
      pictures_(renderer_, state),
      camera_({.address = has_cable ? behind_cable(address) : address,
               .serial = "TWIN-" + cell_name(cell.file).substr(0, 10),
               .manufacturer_info = std::to_string(token_),
               .sensor_width_px = renderer_.width_px(),
               .sensor_height_px = renderer_.height_px()},
              pictures_),
      address_(ipv4_text(address)) {
  for (const CellLight& light : cell.lights) {
    if (light.kind == CellLight::Kind::kManual) {
      manual_.insert(light.name);
    }
  }
  if (has_cable) {
    cable_.emplace(behind_cable(address), address);
  }
  side_.emplace(camera_twin_socket(address_),
                [this](const std::string& line) { return answer(line); });
}

nlohmann::ordered_json CameraServing::description() const {
  return {{"kind", "camera"},
          {"address", address_},
          {"port", kGvcpPort},
          {"side_channel", side_->path().string()},
          {"token", token_}};
}

/// "placement N": hands have lifted the part and put it back.
std::string CameraServing::put_down(const std::string& number) {
  int placement = 0;
  const char* const end = number.data() + number.size();
  const auto [rest, error] = std::from_chars(number.data(), end, placement);
  if (error != std::errc() || rest != end || placement < 1) {
    return "error: placement needs a number from 1 on";
  }
  placement_ = placement;
  return "ok";
}

std::vector<std::string> CameraServing::shining(const std::vector<std::string>& lights) const {
  const std::scoped_lock lock(lights_mutex_);
  std::vector<std::string> on;
  std::ranges::copy_if(lights, std::back_inserter(on), [this](const std::string& name) {
    return !off_.contains(name);
  });
  return on;
}

void CameraServing::stay_at(std::function<TwinCellState()> standing) {
  const std::scoped_lock lock(lights_mutex_);
  standing_ = std::move(standing);
}

/// "light NAME on|off": a person has switched it.
std::string CameraServing::switch_light(const std::string& text) {
  const std::size_t blank = std::min(text.rfind(' '), text.size());
  const std::string name = text.substr(0, blank);
  const std::string how = text.substr(std::min(blank + 1, text.size()));
  if (how != "on" && how != "off") {
    return "error: light needs a name and on or off";
  }
  if (!manual_.contains(name)) {
    return fmt::format("error: no person switches a light named {}", name);
  }
  std::function<TwinCellState()> standing;
  {
    const std::scoped_lock lock(lights_mutex_);
    if (how == "on") {
      off_.erase(name);
    } else {
      off_.insert(name);
    }
    standing = standing_;
  }
  if (standing) {
    pictures_.arrive(standing());
  }
  return "ok";
}

std::string CameraServing::set_cable(const std::string& text) {
  const auto faults = parse_cable_faults(text);
  if (!cable_ || !faults) {
    return cable_ ? "error: no such fault of a cable" : "error: served without --cable";
  }
  cable_->set_faults(*faults);
  return "ok";
}

std::string CameraServing::told_state() const {
  const CameraTwinCounts counts = camera_.counts();
  return nlohmann::ordered_json{{"frames", counts.frames},
                                {"refused", counts.refused},
                                {"last_refusal", name_of(counts.last_refusal)},
                                {"resent_packets", counts.resent_packets},
                                {"rendered", pictures_.num_rendered()},
                                {"placement", placement()},
                                {"cable_dropped", cable_ ? cable_->counts().dropped : 0},
                                {"error", pictures_.error()}}
      .dump();
}

std::string CameraServing::answer(const std::string& line) {
  if (line == "token") {
    return std::to_string(token_);
  }
  if (line == "stop") {
    is_stop_asked_ = true;
    return "ok";
  }
  if (line == "state") {
    return told_state();
  }
  constexpr std::string_view kPlacement = "placement ";
  if (line.starts_with(kPlacement)) {
    return put_down(line.substr(kPlacement.size()));
  }
  constexpr std::string_view kLight = "light ";
  if (line.starts_with(kLight)) {
    return switch_light(line.substr(kLight.size()));
  }
  if (line.starts_with("cable")) {
    return set_cable(line.substr(5));
  }
  return "error: there are token, state, placement, light, cable, stop";
}

}  // namespace glint
