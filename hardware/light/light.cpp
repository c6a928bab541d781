// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/light/light.h"

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

bool bit(std::uint64_t bits, int index) {
  return ((bits >> static_cast<unsigned>(index)) & 1U) != 0;
}

const char* word(bool is_on) {
  return is_on ? "on" : "off";
}

}  // namespace

void SimulatedOutputs::set_output(int index, bool is_on) {
  GLINT_CHECK(index >= 0 && index < num_outputs_, "an output is one of those there are");
  if (index == blocked_) {
    return;
  }
  const std::uint64_t mask = std::uint64_t{1} << static_cast<unsigned>(index);
  outputs_ = is_on ? outputs_ | mask : outputs_ & ~mask;
  if (changed_) {
    changed_(outputs_);
  }
}

OutputLight::OutputLight(std::string name, DigitalOutputs& outputs, int index)
    : name_(std::move(name)), outputs_(outputs), index_(index) {
  if (index < 0 || index >= outputs.num_outputs()) {
    throw ConfigError(
        "lights." + name_ + ".output",
        fmt::format("is {}, the device has outputs 0 to {}", index, outputs.num_outputs() - 1));
  }
}

void OutputLight::set(bool is_on) {
  outputs_.set_output(index_, is_on);
  if (bit(outputs_.outputs(), index_) != is_on) {
    throw IoError(
        fmt::format("light {}: output {} was turned {}, and the device reports that it is not",
                    name_,
                    index_,
                    word(is_on)));
  }
}

bool OutputLight::is_on() const {
  return bit(outputs_.outputs(), index_);
}

std::string switch_request(const std::string& light, bool is_on) {
  return fmt::format("turn {} the light {}", word(is_on), light);
}

void PromptedLight::set(bool is_on) {
  if (!confirm_ ||
      !confirm_(is_on, switch_request(name_, is_on) + ", then leave the arm's reach")) {
    throw IoError(
        fmt::format("light {0}: nobody confirms that it is {1}; once it is, the command "
                    "needs --confirmed {0}={1}",
                    name_,
                    word(is_on)));
  }
  is_on_ = is_on;
}

}  // namespace glint
