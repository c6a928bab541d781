// SPDX-License-Identifier: GPL-3.0-or-later
//
// The client's side of RTDE without a network: bytes in, bytes out. It asks for outputs only; of
// inputs it asks when it was told names of some.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hardware/robot/protocol/rtde_package.h"

namespace glint {

struct RtdeRequest {
  std::vector<std::string> outputs;  ///< the controller must know them
  std::vector<std::string> newer;    ///< left out where it does not
  std::vector<std::string> inputs;   ///< empty: none is asked for
  double rate_hz = 0.0;              ///< 0: the controller's own, 125 or 500
};

class RtdeClient {
 public:
  explicit RtdeClient(RtdeRequest request);

  /// What is to be sent; empty: nothing. It is taken away.
  std::string take_output();

  /// @param on_package  called after each package of data
  /// @throws ProtocolError when the peer speaks no RTDE, does not know version 2 or an output
  void feed(std::string_view bytes, const std::function<void()>& on_package);

  bool is_streaming() const { return num_packages_ > 0; }

  std::uint64_t num_packages() const { return num_packages_; }

  const ControllerVersion& controller() const { return controller_; }

  /// The controller's own rate.
  double rate_hz() const { return controller_.major >= 5 ? 500.0 : 125.0; }

  /// The controller knows that output.
  bool has(std::string_view output) const;

  /// Value of the newest package. The output was asked for.
  /// @throws ProtocolError when the controller sends it as another type
  template <class Value>
  Value get(std::string_view output) const {
    const auto* held = std::get_if<Value>(&value(output));
    if (held == nullptr) {
      throw ProtocolError("RTDE: " + std::string(output) + " is of another type than it must be");
    }
    return *held;
  }

  /// Sends values of the inputs, in the order of the request. Only while streaming.
  void send_inputs(const std::vector<RtdeValue>& values);

  /// Warnings and errors of the controller; at most the newest 20.
  const std::vector<std::string>& texts() const { return texts_; }

 private:
  enum class Step { kVersion, kController, kOutputs, kInputs, kStart, kData };

  void take(const FrameSplitter::Frame& frame, const std::function<void()>& on_package);
  void take_text(std::string_view payload);
  void take_outputs(std::string_view payload);
  void take_inputs(std::string_view payload);
  void ask_outputs();
  const RtdeValue& value(std::string_view output) const;

  RtdeRequest request_;
  Step step_ = Step::kVersion;
  FrameSplitter splitter_ = FrameSplitter::of_rtde();
  std::string output_;
  ControllerVersion controller_;
  RtdeRecipe recipe_;
  std::uint8_t input_recipe_ = 0;
  std::vector<RtdeValue> values_;
  std::uint64_t num_packages_ = 0;
  std::vector<std::string> texts_;
};

}  // namespace glint
