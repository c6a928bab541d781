// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/ur_robot.h"

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "core/wall_clock.h"
#include "hardware/robot/dashboard.h"
#include "hardware/robot/program_drop.h"
#include "hardware/robot/protocol/dashboard_text.h"
#include "hardware/robot/tcp_link.h"

namespace glint {
namespace {

constexpr double kReadS = 0.005;  ///< how long the reader waits for one connection
constexpr double kWriteS = 0.5;
constexpr double kDashboardS = 2.0;
/// A motion begins so soon or never, also when this process is killed while a cable is out. A stop
/// may come as late as it gets there.
constexpr double kMotionDeliveryS = 2.0;
/// What arrived is acknowledged by then: machines may wait 40 ms with that.
constexpr double kAcknowledgedS = 0.06;
constexpr auto kPoll = std::chrono::milliseconds(20);

/// What failed, behind the peer's address: connections name it themselves, protocols do not.
std::string failure_text(const std::string& peer, const std::exception& error) {
  const bool names_peer = dynamic_cast<const IoError*>(&error) != nullptr &&
                          dynamic_cast<const ProtocolError*>(&error) == nullptr;
  return names_peer ? error.what() : fmt::format("{}: {}", peer, error.what());
}

/// A motion that still waits to be sent would come with the stop behind it, as late as the stop
/// may.
/// @throws IoError  the stop must go out on another connection
void check_nothing_waits(const TcpLink& link) {
  const auto begin = std::chrono::steady_clock::now();
  while (link.has_undelivered()) {
    if (seconds_since(begin) > kAcknowledgedS) {
      throw IoError(fmt::format("{}: what was sent before the stop has not arrived", link.peer()));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

struct UrRobot::Impl {
  Impl(const UrSettings& settings, const ArmWithTool& arm, double timeout_s)
      : driver(settings, arm), rtde(settings.host, settings.rtde_port, timeout_s) {}

  double now_s() const { return seconds_since(start); }

  /// One round of the reader: sends what waits, reads what has come, tells the time.
  void serve_rtde() {
    std::string output;
    {
      const std::lock_guard lock(mutex);
      output = driver.take_rtde_output();
    }
    if (!output.empty()) {
      rtde.write(output, kWriteS);
    }
    const std::string bytes = rtde.read(kReadS);
    const std::lock_guard lock(mutex);
    driver.on_rtde(bytes, now_s());
    driver.on_time(now_s());
  }

  void serve_primary() {
    std::string output;
    TcpLink* link = nullptr;
    bool is_stop = false;
    {
      const std::lock_guard lock(mutex);
      link = primary.get();
      is_stop = driver.is_stopping();
      output = driver.take_script_output();
    }
    if (link == nullptr) {
      return;
    }
    if (!output.empty()) {
      has_sent = true;
      if (is_stop) {
        check_nothing_waits(*link);
      }
      link->set_longest_delivery(is_stop ? 0.0 : kMotionDeliveryS);
      link->write(output, kWriteS);
    }
    const std::string bytes = link->read(0.0);
    const std::lock_guard lock(mutex);
    driver.on_primary(bytes);
  }

  /// @return the connection still stands
  template <class Serve, class Lose>
  bool try_serve(const Serve& serve, const Lose& lose) {
    try {
      serve();
      return true;
    } catch (const std::exception& error) {  // of any kind: an arm that moves is to be stopped
      const std::lock_guard lock(mutex);
      failure = failure.empty() ? failure_text(rtde.peer(), error) : failure;
      lose(error.what());
      return false;
    }
  }

  /// A motion that this connection has not delivered must not come after the stop on another one.
  void lose_primary(const std::string& why) {
    driver.on_primary_closed(why);
    if (!driver.result()) {
      primary->abandon();
    }
  }

  /// A stop that is due when the connection is gone is sent on a new one: the controller goes on
  /// with the motion that it has.
  void send_last_stop() {
    {
      const std::lock_guard lock(mutex);
      if (std::string output = driver.take_script_output(); !output.empty()) {
        last_stop = std::move(output);
      } else if (driver.result()) {
        last_stop.clear();
      }
    }
    if (last_stop.empty()) {
      return;
    }
    try {
      TcpLink link(driver.settings().host, driver.settings().primary_port, kWriteS);
      link.write(last_stop, kWriteS);
      link.finish(kWriteS);
      last_stop.clear();
    } catch (const std::exception&) {
      return;  // tried again until there is a result, which says that the link is lost
    }
  }

  /// What waits goes out before the connection is closed, and arrives.
  void finish_scripts() {
    const auto is_written = [this] {
      return try_serve([this] { serve_primary(); },
                       [this](const std::string& why) { lose_primary(why); });
    };
    if (!has_primary || !is_written()) {
      send_last_stop();
    } else if (has_sent) {
      primary->finish(kWriteS);
    }
  }

  void read(const std::stop_token& token) {
    bool has_rtde = true;
    while (!token.stop_requested() && (has_rtde || has_primary)) {
      // Scripts first: a stop must go out even when RTDE has fallen silent.
      has_primary = has_primary && try_serve([this] { serve_primary(); },
                                             [this](const std::string& why) { lose_primary(why); });
      if (!has_primary) {
        send_last_stop();
      }
      if (has_rtde) {
        has_rtde = try_serve([this] { serve_rtde(); },
                             [this](const std::string& why) { driver.on_rtde_closed(why); });
      } else {
        std::this_thread::sleep_for(kPoll);
        const std::lock_guard lock(mutex);
        driver.on_time(now_s());
      }
      end_round();
    }
    finish_scripts();
    const std::lock_guard lock(mutex);
    has_ended = true;
    changed.notify_all();
  }

  void end_round() {
    const std::lock_guard lock(mutex);
    ++rounds;
    changed.notify_all();
  }

  /// Waits until the reader has taken what had come by now.
  void wait_for_round(std::unique_lock<std::mutex>& lock) {
    const std::uint64_t by = rounds + 2;  // the one that goes on may have read already
    while (rounds < by && !has_ended) {
      changed.wait_for(lock, kPoll);
    }
  }

  /// What the controller says of remote control; a CB3, which has none, takes scripts.
  /// @throws IoError
  std::string remote_control_reply() const {
    const UrSettings& settings = driver.settings();
    if (is_cb3(settings.model)) {
      return "true";
    }
    try {
      Dashboard dashboard(settings.host, settings.dashboard_port, kDashboardS);
      return dashboard.ask("is in remote control");
    } catch (const IoError& error) {
      throw IoError(fmt::format("{} (asked whether remote control is on)", error.what()));
    }
  }

  /// A stop that leaves the controller its program has it dropped; the reader goes on meanwhile.
  MotionResult result_after_drop(std::unique_lock<std::mutex>& lock) {
    if (permit && driver.may_hold_program()) {
      lock.unlock();
      const std::string why = drop_program(driver.settings(), *permit);
      lock.lock();
      driver.on_program_dropped(why);
    }
    return *driver.result();
  }

  mutable std::mutex mutex;
  std::condition_variable changed;
  std::optional<MotionPermit> permit;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  UrDriver driver;
  TcpLink rtde;
  std::unique_ptr<TcpLink> primary;
  bool has_primary = true;  ///< it is not lost; the reader's alone
  bool has_sent = false;    ///< a script; the reader's alone
  std::string last_stop;    ///< that nobody has got yet; the reader's alone
  std::uint64_t rounds = 0;
  bool has_ended = false;  ///< the reader
  std::string failure;     ///< the first one, with the address of who it is of
  std::jthread reader;     // last: ends before what it uses
};

UrRobot::UrRobot(const UrSettings& settings, const ArmWithTool& arm, double timeout_s)
    : impl_(std::make_unique<Impl>(settings, arm, timeout_s)) {
  impl_->reader =
      std::jthread([impl = impl_.get()](const std::stop_token& token) { impl->read(token); });
  std::unique_lock lock(impl_->mutex);
  const double by_s = impl_->now_s() + timeout_s;
  while (!impl_->driver.is_streaming() && impl_->failure.empty() && impl_->now_s() < by_s) {
    impl_->changed.wait_for(lock, kPoll);
  }
  if (!impl_->driver.is_streaming()) {
    throw IoError(
        impl_->failure.empty()
            ? fmt::format("{}: sends no data within {:.1f} s", impl_->rtde.peer(), timeout_s)
            : impl_->failure);
  }
}

UrRobot::~UrRobot() = default;

void UrRobot::allow_motion(const MotionPermit& permit) {
  const UrSettings& settings = impl_->driver.settings();
  const std::string why = remote_control_problem(impl_->remote_control_reply());
  if (!why.empty()) {
    throw ConfigError(fmt::format("{}: {}", settings.host, why));
  }
  constexpr double kConnectS = 2.0;
  auto link = std::make_unique<TcpLink>(settings.host, settings.primary_port, kConnectS);
  const std::lock_guard lock(impl_->mutex);
  impl_->driver.allow_motion(permit);
  impl_->permit = permit;
  impl_->primary = std::move(link);
}

std::optional<RobotState> UrRobot::state() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->driver.state(impl_->now_s());
}

namespace {

MotionResult interrupted() {
  return {.outcome = MotionOutcome::kRefused, .text = "interrupted"};
}

}  // namespace

MotionResult UrRobot::run(const Begin& begin) {
  std::unique_lock lock(impl_->mutex);
  if (auto refusal = begin(impl_->driver, impl_->now_s())) {
    return *refusal;
  }
  while (!impl_->driver.result()) {
    impl_->changed.wait_for(lock, kPoll);
    if (is_interrupted()) {
      impl_->driver.interrupt(impl_->now_s());
    }
    if (impl_->has_ended) {
      impl_->driver.on_time(impl_->now_s());  // nobody else tells it any more
    }
  }
  return impl_->result_after_drop(lock);
}

std::optional<MotionResult> UrRobot::refusal() {
  using enum MotionOutcome;
  if (is_interrupted()) {
    return interrupted();
  }
  {
    const std::lock_guard lock(impl_->mutex);
    if (auto why = impl_->driver.refusal(impl_->now_s())) {
      return why;
    }
  }
  for (bool is_last : {false, true}) {  // a busy dashboard is asked twice
    try {
      std::string why = remote_control_problem(impl_->remote_control_reply());
      return why.empty() ? std::nullopt
                         : std::optional(MotionResult{.outcome = kRefused, .text = std::move(why)});
    } catch (const IoError& error) {
      if (is_last) {
        return MotionResult{.outcome = kRefused, .text = error.what()};
      }
    }
  }
  return std::nullopt;
}

// Looking along the way takes a while, in which the reader goes on.
MotionResult UrRobot::move(const std::function<CheckedMotion(const RobotState&)>& check) {
  if (auto why = refusal()) {
    return *why;
  }
  const CheckedMotion motion = check(state().value());
  {
    std::unique_lock lock(impl_->mutex);
    impl_->wait_for_round(lock);
  }
  return explained(run([&](UrDriver& driver, double now_s) {
    return is_interrupted() ? std::optional(interrupted()) : driver.begin(motion, now_s);
  }));
}

/// A controller in local mode takes no scripts, and does not say so.
MotionResult UrRobot::explained(const MotionResult& result) {
  if (result.outcome != MotionOutcome::kTimeout) {
    return result;
  }
  try {
    const std::string reply = impl_->remote_control_reply();
    const std::lock_guard lock(impl_->mutex);
    if (flag_of_reply(reply) == false) {
      impl_->driver.explain_timeout(remote_control_problem(reply));
    }
    return impl_->driver.result().value_or(result);
  } catch (const IoError&) {
    return result;
  }
}

MotionResult UrRobot::move_joints(const JointVector& goal_rad, double share) {
  return move([&](const RobotState& state) {
    return check_joint_motion(impl_->driver.arm(), state.actual_q_rad, goal_rad, share);
  });
}

MotionResult UrRobot::move_line(const Eigen::Isometry3d& base_from_tcp, double share) {
  return move([&](const RobotState& state) {
    return check_line_motion(impl_->driver.arm(), state.actual_q_rad, base_from_tcp, share);
  });
}

MotionResult UrRobot::stop() {
  return run([](UrDriver& driver, double now_s) { return driver.begin_stop(now_s); });
}

std::optional<StillPose> UrRobot::still_pose(double timeout_s) {
  std::unique_lock lock(impl_->mutex);
  const double by_s = impl_->now_s() + timeout_s;
  impl_->driver.restart_still_pose();
  while (!impl_->driver.still_pose() && !impl_->driver.halted() && impl_->now_s() < by_s) {
    impl_->changed.wait_for(lock, kPoll);
  }
  return impl_->driver.halted() ? std::nullopt : impl_->driver.still_pose();
}

std::optional<MotionResult> UrRobot::halted() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->driver.halted();
}

ControllerVersion UrRobot::controller() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->driver.rtde().controller();
}

std::uint64_t UrRobot::num_packages() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->driver.rtde().num_packages();
}

double UrRobot::rate_hz() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->driver.rtde().rate_hz();
}

bool UrRobot::is_loopback() const {
  return impl_->rtde.is_loopback();
}

}  // namespace glint
