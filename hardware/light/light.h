// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lights that can be turned on and off, and what turns them: a digital output of the robot, or a
// person.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace glint {

/// Digital outputs of a device, numbered from 0. A robot is one.
class DigitalOutputs {
 public:
  DigitalOutputs() = default;
  virtual ~DigitalOutputs() = default;
  DigitalOutputs(const DigitalOutputs&) = delete;
  DigitalOutputs& operator=(const DigitalOutputs&) = delete;

  /// How many there are.
  virtual int num_outputs() const = 0;

  /// Sets one, and returns when the device tells that it is so.
  /// @throws IoError when the device does not
  virtual void set_output(int index, bool is_on) = 0;

  /// As the device tells them: bit i is output i. @throws IoError
  virtual std::uint64_t outputs() const = 0;
};

/// Outputs that are nothing but a memory: the twin of a controller's.
class SimulatedOutputs final : public DigitalOutputs {
 public:
  /// @param num_outputs  1 to 64
  /// @param changed      sees all outputs after each change; may be empty
  explicit SimulatedOutputs(int num_outputs, std::function<void(std::uint64_t)> changed = {})
      : num_outputs_(num_outputs), changed_(std::move(changed)) {}

  int num_outputs() const override { return num_outputs_; }

  void set_output(int index, bool is_on) override;

  std::uint64_t outputs() const override { return outputs_; }

  /// An output that no longer follows, until it is told -1: for tests of lights that are broken.
  void block(int index) { blocked_ = index; }

 private:
  int num_outputs_ = 0;
  int blocked_ = -1;
  std::uint64_t outputs_ = 0;
  std::function<void(std::uint64_t)> changed_;
};

/// Asks a person to do something and waits. True: the person says that it is done. Nobody there, or
/// any other answer: false.
using Confirm = std::function<bool(const std::string& what)>;

/// Asks a person to switch one light, as Confirm does. @param what  switch_request(), and to leave
/// the arm's reach
using ConfirmSwitch = std::function<bool(bool is_on, const std::string& what)>;

/// "turn on the light ring"
std::string switch_request(const std::string& light, bool is_on);

/// One light of a cell.
class Light {
 public:
  Light() = default;
  virtual ~Light() = default;
  Light(const Light&) = delete;
  Light& operator=(const Light&) = delete;

  virtual const std::string& name() const = 0;

  /// @throws IoError when it is not known to be so afterwards
  virtual void set(bool is_on) = 0;

  virtual bool is_on() const = 0;
};

/// A light behind a digital output.
class OutputLight final : public Light {
 public:
  /// @param outputs  must outlive the light
  /// @throws ConfigError when there is no such output
  OutputLight(std::string name, DigitalOutputs& outputs, int index);

  const std::string& name() const override { return name_; }

  /// Checks that the device tells the output as it was set.
  void set(bool is_on) override;

  bool is_on() const override;

 private:
  std::string name_;
  DigitalOutputs& outputs_;
  int index_ = 0;
};

/// A light that a person turns on and off.
class PromptedLight final : public Light {
 public:
  PromptedLight(std::string name, ConfirmSwitch confirm)
      : name_(std::move(name)), confirm_(std::move(confirm)) {}

  const std::string& name() const override { return name_; }

  /// Asks, also when it should be as it is: nobody has looked since. @throws IoError when the
  /// person does not confirm
  void set(bool is_on) override;

  bool is_on() const override { return is_on_; }

 private:
  std::string name_;
  ConfirmSwitch confirm_;
  bool is_on_ = false;
};

}  // namespace glint
