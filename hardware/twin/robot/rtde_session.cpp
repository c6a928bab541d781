// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/rtde_session.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr std::size_t kMaxInputRecipes = 20;
constexpr std::uint16_t kVersion = 2;

std::string warning(const std::string& text) {
  return text_package({.message = text, .source = "RTDE", .level = 2});
}

}  // namespace

RtdeSession::~RtdeSession() {
  std::erase_if(held_, [this](const auto& input) { return input.second == this; });
}

std::string RtdeSession::on_bytes(std::string_view bytes) {
  splitter_.append(bytes);
  std::string replies;
  while (const auto frame = splitter_.next()) {
    replies += reply_to(*frame);
  }
  return replies;
}

std::string RtdeSession::reply_to(const FrameSplitter::Frame& frame) {
  switch (static_cast<RtdeKind>(frame.kind)) {
    case RtdeKind::kProtocolVersion: {
      ByteReader reader(frame.payload);
      const bool is_known = reader.take<std::uint16_t>() == kVersion && reader.is_exact();
      return flag_reply(RtdeKind::kProtocolVersion, is_known);
    }
    case RtdeKind::kControllerVersion:
      return controller_version_reply(twin_.version());
    case RtdeKind::kOutputs:
      return set_up_outputs(frame.payload);
    case RtdeKind::kInputs:
      return set_up_inputs(frame.payload);
    case RtdeKind::kStart:
      has_started_ = has_outputs_;
      waited_cycles_ = every_cycles_ - 1.0;  // the first one comes with the next cycle
      return flag_reply(RtdeKind::kStart, has_started_);
    case RtdeKind::kPause:
      has_started_ = false;
      return flag_reply(RtdeKind::kPause, true);
    case RtdeKind::kData:
      return take_data(frame.payload);
    case RtdeKind::kText:
      return {};
  }
  throw ProtocolError(fmt::format("RTDE: a package of unknown kind {}", frame.kind));
}

/// Ids begin again after 255 recipes: 0 stands for none, and those of inputs stay theirs.
std::uint8_t RtdeSession::next_id() {
  const auto is_taken = [this](std::uint8_t id) {
    return id == 0 || std::ranges::any_of(
                          inputs_, [id](const Inputs& inputs) { return inputs.recipe.id == id; });
  };
  do {
    ++newest_id_;
  } while (is_taken(newest_id_));
  return newest_id_;
}

std::string RtdeSession::set_up_outputs(std::string_view payload) {
  ByteReader reader(payload);
  const double rate_hz = reader.take_double();
  const std::vector<std::string> names = reader.rest().size() > kMaxRecipeBytes
                                             ? std::vector<std::string>{}
                                             : split_names(reader.rest());
  has_started_ = false;
  has_outputs_ = !names.empty();
  outputs_ = {};
  RecipeReply reply;
  for (const std::string& name : names) {
    const auto type = twin_.outputs().type_of(name);
    reply.types.emplace_back(type ? name_of(*type) : "NOT_FOUND");
    has_outputs_ = has_outputs_ && type.has_value();
    outputs_.names.push_back(name);
    outputs_.types.push_back(type.value_or(RtdeType::kDouble));
  }
  if (reply.types.empty()) {
    reply.types.emplace_back("NOT_FOUND");
  }
  // A rate that does not divide the controller's is met on average.
  const double wanted_hz =
      std::isfinite(rate_hz) ? std::clamp(rate_hz, 1.0, twin_.rate_hz()) : twin_.rate_hz();
  every_cycles_ = twin_.rate_hz() / wanted_hz;
  if (has_outputs_) {
    outputs_.id = next_id();
    reply.id = outputs_.id;
  }
  return recipe_reply(RtdeKind::kOutputs, reply);
}

std::string RtdeSession::set_up_inputs(std::string_view payload) {
  const std::vector<std::string> names =
      payload.size() > kMaxRecipeBytes || inputs_.size() == kMaxInputRecipes
          ? std::vector<std::string>{}
          : split_names(payload);
  Inputs inputs = {.names = names, .recipe = {}};
  RecipeReply reply;
  bool is_granted = !names.empty();
  for (const std::string& name : names) {
    const auto type = input_type(name);
    const bool is_held = held_.contains(name);
    reply.types.emplace_back(!type ? "NOT_FOUND" : is_held ? "IN_USE" : name_of(*type));
    is_granted = is_granted && type && !is_held;
    inputs.recipe.types.push_back(type.value_or(RtdeType::kDouble));
  }
  if (reply.types.empty()) {
    reply.types.emplace_back("NOT_FOUND");
  }
  if (is_granted) {
    for (const std::string& name : names) {
      held_.emplace(name, this);
    }
    inputs.recipe.id = next_id();
    reply.id = inputs.recipe.id;
    inputs_.push_back(std::move(inputs));
  }
  return recipe_reply(RtdeKind::kInputs, reply);
}

std::string RtdeSession::take_data(std::string_view payload) {
  const auto found = std::ranges::find_if(inputs_, [payload](const Inputs& inputs) {
    return !payload.empty() && static_cast<std::uint8_t>(payload[0]) == inputs.recipe.id;
  });
  if (found == inputs_.end()) {
    return warning("data of an input recipe that was not set up");
  }
  try {
    twin_.set_inputs(found->names, parse_data(payload, found->recipe));
  } catch (const ProtocolError& error) {
    return warning(error.what());
  }
  return {};
}

std::string RtdeSession::on_cycle() {
  if (!has_started_) {
    return {};
  }
  waited_cycles_ += 1.0;
  if (waited_cycles_ < every_cycles_ || twin_.is_silent()) {
    return {};
  }
  waited_cycles_ = std::fmod(waited_cycles_, every_cycles_);
  if (!twin_.has_old_stamps() || newest_.empty()) {
    std::vector<RtdeValue> values;
    values.reserve(outputs_.names.size());
    for (const std::string& name : outputs_.names) {
      values.push_back(*twin_.outputs().value_of(name));
    }
    newest_ = data_package(outputs_.id, values);
  }
  return newest_;
}

}  // namespace glint
