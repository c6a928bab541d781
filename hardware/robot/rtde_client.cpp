// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/rtde_client.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr std::size_t kMaxTexts = 20;

RtdeKind expected_kind(int step) {
  constexpr std::array<RtdeKind, 6> kKinds = {RtdeKind::kProtocolVersion,
                                              RtdeKind::kControllerVersion,
                                              RtdeKind::kOutputs,
                                              RtdeKind::kInputs,
                                              RtdeKind::kStart,
                                              RtdeKind::kData};
  return kKinds.at(static_cast<std::size_t>(step));
}

/// @throws ProtocolError  the controller says no
void demand(std::string_view payload, const char* refusal) {
  if (!parse_flag(payload)) {
    throw ProtocolError(fmt::format("RTDE: {}", refusal));
  }
}

/// Values of another type would be read, or written, as other numbers.
/// @param known  by the controllers' table; none: the name is not in it
/// @throws ProtocolError  the controller gives the name another type
void check_type(const std::string& name, RtdeType type, std::optional<RtdeType> known) {
  if (known && type != *known) {
    throw ProtocolError(
        fmt::format("RTDE: {} is {}, must be {}", name, name_of(type), name_of(*known)));
  }
}

}  // namespace

RtdeClient::RtdeClient(RtdeRequest request) : request_(std::move(request)) {
  output_ = version_request();
}

std::string RtdeClient::take_output() {
  return std::exchange(output_, {});
}

void RtdeClient::feed(std::string_view bytes, const std::function<void()>& on_package) {
  splitter_.append(bytes);
  while (const auto frame = splitter_.next()) {
    take(*frame, on_package);
  }
}

bool RtdeClient::has(std::string_view output) const {
  return std::ranges::find(recipe_.names, output) != recipe_.names.end();
}

void RtdeClient::send_inputs(const std::vector<RtdeValue>& values) {
  GLINT_CHECK(step_ == Step::kData && values.size() == request_.inputs.size(),
              "inputs are sent while data flow");
  output_ += data_package(input_recipe_, values);
}

const RtdeValue& RtdeClient::value(std::string_view output) const {
  const auto found = std::ranges::find(recipe_.names, output);
  GLINT_CHECK(found != recipe_.names.end() && is_streaming(), "the output was asked for");
  return values_[static_cast<std::size_t>(found - recipe_.names.begin())];
}

void RtdeClient::take_text(std::string_view payload) {
  const RtdeText text = parse_text(payload);
  if (text.level > 2) {
    return;
  }
  texts_.push_back(text.message);
  if (texts_.size() > kMaxTexts) {
    texts_.erase(texts_.begin());
  }
}

void RtdeClient::take(const FrameSplitter::Frame& frame, const std::function<void()>& on_package) {
  const auto kind = static_cast<RtdeKind>(frame.kind);
  if (kind == RtdeKind::kText) {
    take_text(frame.payload);
    return;
  }
  if (const RtdeKind expected = expected_kind(static_cast<int>(step_)); kind != expected) {
    throw ProtocolError(fmt::format(
        "RTDE: a package of kind {}, expected was {}", frame.kind, static_cast<int>(expected)));
  }
  switch (step_) {
    case Step::kVersion:
      demand(frame.payload, "the controller does not know version 2 of the protocol");
      output_ += controller_version_request();
      step_ = Step::kController;
      break;
    case Step::kController:
      controller_ = parse_controller_version(frame.payload);
      ask_outputs();
      break;
    case Step::kOutputs:
      take_outputs(frame.payload);
      break;
    case Step::kInputs:
      take_inputs(frame.payload);
      break;
    case Step::kStart:
      demand(frame.payload, "the controller does not start to send");
      step_ = Step::kData;
      break;
    case Step::kData:
      values_ = parse_data(frame.payload, recipe_);
      ++num_packages_;
      on_package();
      break;
  }
}

void RtdeClient::ask_outputs() {
  recipe_.names = request_.outputs;
  recipe_.names.insert(recipe_.names.end(), request_.newer.begin(), request_.newer.end());
  output_ += outputs_request(request_.rate_hz > 0.0 ? request_.rate_hz : rate_hz(), recipe_.names);
  step_ = Step::kOutputs;
}

void RtdeClient::take_outputs(std::string_view payload) {
  const RecipeReply reply = parse_recipe_reply(payload);
  if (reply.types.size() != recipe_.names.size()) {
    throw ProtocolError(fmt::format(
        "RTDE: types of {} outputs, asked was for {}", reply.types.size(), recipe_.names.size()));
  }
  recipe_.types.clear();
  bool is_complete = true;
  for (std::size_t i = 0; i < reply.types.size(); ++i) {
    const auto type = rtde_type(reply.types[i]);
    if (!type && i < request_.outputs.size()) {
      throw ProtocolError(fmt::format("RTDE: the controller does not know {}", recipe_.names[i]));
    }
    if (type) {
      check_type(recipe_.names[i], *type, output_type(recipe_.names[i]));
    }
    is_complete = is_complete && type.has_value();
    recipe_.types.push_back(type.value_or(RtdeType::kDouble));
  }
  if (!is_complete) {
    std::erase_if(request_.newer, [&](const std::string& name) {
      const auto at = std::ranges::find(recipe_.names, name) - recipe_.names.begin();
      return !rtde_type(reply.types[static_cast<std::size_t>(at)]);
    });
    ask_outputs();
    return;
  }
  recipe_.id = reply.id;
  output_ += request_.inputs.empty() ? start_request() : inputs_request(request_.inputs);
  step_ = request_.inputs.empty() ? Step::kStart : Step::kInputs;
}

void RtdeClient::take_inputs(std::string_view payload) {
  const RecipeReply reply = parse_recipe_reply(payload);
  if (reply.types.size() != request_.inputs.size()) {
    throw ProtocolError(fmt::format(
        "RTDE: types of {} inputs, asked was for {}", reply.types.size(), request_.inputs.size()));
  }
  for (std::size_t i = 0; i < reply.types.size(); ++i) {
    const std::string& name = request_.inputs[i];
    const auto type = rtde_type(reply.types[i]);
    if (!type) {
      throw ProtocolError(
          fmt::format("RTDE: input {}: {}",
                      name,
                      reply.types[i] == "IN_USE" ? "is held by another client" : "is not known"));
    }
    check_type(name, *type, input_type(name));
  }
  input_recipe_ = reply.id;
  output_ += start_request();
  step_ = Step::kStart;
}

}  // namespace glint
