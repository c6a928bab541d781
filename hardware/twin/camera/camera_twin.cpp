// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/camera_twin.h"

#include <array>
#include <mutex>
#include <thread>

#include "core/error.h"
#include "hardware/gige/discovery.h"
#include "hardware/twin/camera/gvcp_server.h"

namespace glint {
namespace {

const CameraTwinSettings& checked(const CameraTwinSettings& settings) {
  if (!is_loopback(settings.address)) {
    throw ConfigError(
        "address",
        "is " + ipv4_text(settings.address) + ", a simulated camera listens in 127.0.0.0/8 alone");
  }
  return settings;
}

}  // namespace

std::string_view name_of(TwinRefusal refusal) {
  constexpr std::array<std::string_view, 4> kNames = {
      "none", "trigger_without_picture", "trigger_during_exposure", "trigger_while_stopped"};
  return kNames.at(static_cast<std::size_t>(refusal));
}

class CameraTwin::Server {
 public:
  Server(const CameraTwinSettings& settings, PictureSource& source)
      : gvcp_(checked(settings), source), thread_([this](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            gvcp_.control().wait(gvcp_.pause());
            gvcp_.step();
            const std::scoped_lock lock(mutex_);
            counts_ = gvcp_.counts();
          }
        }) {}

  CameraTwinCounts counts() const {
    const std::scoped_lock lock(mutex_);
    return counts_;
  }

 private:
  GvcpServer gvcp_;
  mutable std::mutex mutex_;
  CameraTwinCounts counts_;
  std::jthread thread_;
};

CameraTwin::CameraTwin(const CameraTwinSettings& settings, PictureSource& source)
    : server_(std::make_unique<Server>(settings, source)) {}

CameraTwin::~CameraTwin() = default;

CameraTwinCounts CameraTwin::counts() const {
  return server_->counts();
}

std::uint32_t free_camera_address() {
  for (std::uint32_t i = 0; i < kLoopbackAddresses; ++i) {
    try {
      const UdpSocket probe({.address = kFirstLoopback + i, .port = kGvcpPort});
      return kFirstLoopback + i;
    } catch (const IoError&) {
      continue;
    }
  }
  throw IoError("cameras listen at all addresses from " + ipv4_text(kFirstLoopback) + " to " +
                ipv4_text(kFirstLoopback + kLoopbackAddresses - 1));
}

}  // namespace glint
