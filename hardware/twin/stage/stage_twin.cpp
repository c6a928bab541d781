// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/stage/stage_twin.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "core/error.h"
#include "core/wall_clock.h"

namespace glint {
namespace {

constexpr std::size_t kLongestLine = 256;  // longer ones are an overflow for Grbl, too

/// The number behind a letter of a G-code line.
std::optional<double> word_of(const std::string& line, char letter) {
  const std::size_t at = line.find(letter);
  double value = 0.0;
  if (at == std::string::npos ||
      std::from_chars(line.data() + at + 1, line.data() + line.size(), value).ec != std::errc()) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

double StageController::position_mm(double now_s) const {
  const double way_mm = speed_mm_s_ * (now_s - began_s_);
  const double whole_mm = std::abs(to_mm_ - from_mm_);
  return way_mm >= whole_mm ? to_mm_ : from_mm_ + std::copysign(way_mm, to_mm_ - from_mm_);
}

bool StageController::is_moving(double now_s) const {
  return position_mm(now_s) != to_mm_;
}

std::optional<double> StageController::reached_mm(double now_s) const {
  return has_moved_ && !is_moving(now_s) ? std::optional(to_mm_) : std::nullopt;
}

void StageController::raise_alarm(double now_s) {
  from_mm_ = to_mm_ = position_mm(now_s);
  is_in_alarm_ = true;
}

std::string StageController::status(double now_s) const {
  const char* state = is_in_alarm_ ? "Alarm" : is_moving(now_s) ? "Run" : "Idle";
  return fmt::format("<{}|MPos:{:.3f},0.000,0.000|FS:0,0>\r\n", state, position_mm(now_s));
}

// Error 2: a number is malformed; alarm 2: the goal is beyond the travel.
std::string StageController::move(const std::string& line, double now_s) {
  const std::optional<double> goal_mm = word_of(line, 'X');
  const std::optional<double> feed_mm_min = word_of(line, 'F');
  if (!goal_mm || (feed_mm_min && *feed_mm_min <= 0.0)) {
    return "error:2\r\n";
  }
  if (*goal_mm < 0.0 || *goal_mm > settings_.travel_mm) {
    raise_alarm(now_s);
    return "ALARM:2\r\n";
  }
  from_mm_ = position_mm(now_s);
  to_mm_ = *goal_mm;
  began_s_ = now_s;
  has_moved_ = true;
  if (feed_mm_min) {
    speed_mm_s_ = std::min(settings_.max_speed_mm_s, *feed_mm_min / 60.0);
  }
  return "ok\r\n";
}

// Error 9: locked by an alarm; 20: a command that is not supported.
std::string StageController::run(const std::string& line, double now_s) {
  if (line == "$X") {
    is_in_alarm_ = false;
    return "ok\r\n";
  }
  if (line == "$I") {
    return fmt::format("[VER:1.1h.20190825:{}]\r\n[OPT:V,15,128]\r\nok\r\n", settings_.kept_text);
  }
  if (is_in_alarm_) {
    return "error:9\r\n";
  }
  if (line == "$H") {
    from_mm_ = to_mm_ = 0.0;
    return "ok\r\n";
  }
  if (line == "G90" || line == "G21" || line.empty()) {
    return "ok\r\n";
  }
  return line.starts_with("G1 ") || line.starts_with("G0 ") ? move(line, now_s) : "error:20\r\n";
}

std::string StageController::receive(const std::string& text, double now_s) {
  std::string answers;
  for (const char letter : text) {
    if (letter == '?') {
      answers += status(now_s);
    } else if (letter == '\n') {
      answers += unfinished_.size() > kLongestLine ? "error:11\r\n" : run(unfinished_, now_s);
      unfinished_.clear();
    } else if (letter != '\r' && unfinished_.size() <= kLongestLine) {
      unfinished_ += letter;
    }
  }
  return answers;
}

class StageTwin::Server {
 public:
  explicit Server(const StageTwinSettings& settings)
      : controller_(settings), listening_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(settings.port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int yes = 1;
    ::setsockopt(listening_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    if (::bind(listening_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 ||
        ::listen(listening_, 1) != 0) {
      const std::string reason = last_system_error();
      ::close(listening_);
      throw IoError(fmt::format("cannot listen at 127.0.0.1 port {}: {}", settings.port, reason));
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }

  ~Server() {
    thread_ = {};
    close_client();
    ::close(listening_);
  }

  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const {
    sockaddr_in address = {};
    socklen_t size = sizeof(address);
    ::getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }

  double position_mm() const {
    const std::scoped_lock lock(mutex_);
    return controller_.position_mm(seconds_since(began_));
  }

  std::optional<double> reached_mm() const {
    const std::scoped_lock lock(mutex_);
    return controller_.reached_mm(seconds_since(began_));
  }

  void raise_alarm() {
    const std::scoped_lock lock(mutex_);
    controller_.raise_alarm(seconds_since(began_));
  }

 private:
  void close_client() {
    if (client_ >= 0) {
      ::close(client_);
      client_ = -1;
    }
  }

  void serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd waiting = {.fd = client_ >= 0 ? client_ : listening_, .events = POLLIN, .revents = 0};
      if (::poll(&waiting, 1, 20) <= 0) {
        continue;
      }
      if (client_ < 0) {
        client_ = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
        continue;
      }
      std::array<char, 256> buffer = {};
      const ssize_t count = ::recv(client_, buffer.data(), buffer.size(), 0);
      if (count <= 0) {
        close_client();
        continue;
      }
      const std::scoped_lock lock(mutex_);
      const std::string answer = controller_.receive(
          std::string(buffer.data(), static_cast<std::size_t>(count)), seconds_since(began_));
      if (::send(client_, answer.data(), answer.size(), MSG_NOSIGNAL) < 0) {
        close_client();
      }
    }
  }

  StageController controller_;
  int listening_ = -1;
  int client_ = -1;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  mutable std::mutex mutex_;
  std::jthread thread_;
};

StageTwin::StageTwin(const StageTwinSettings& settings)
    : server_(std::make_unique<Server>(settings)) {}

StageTwin::~StageTwin() = default;

int StageTwin::port() const {
  return server_->port();
}

double StageTwin::position_mm() const {
  return server_->position_mm();
}

std::optional<double> StageTwin::reached_mm() const {
  return server_->reached_mm();
}

void StageTwin::raise_alarm() {
  server_->raise_alarm();
}

}  // namespace glint
