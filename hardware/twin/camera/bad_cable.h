// SPDX-License-Identifier: GPL-3.0-or-later
//
// A bad cable between a network camera and its client, both on this machine: it listens at an
// address of its own, passes control on, and drops, doubles, swaps or delays the packets of
// pictures. Requests for lost packets it answers itself, so that a camera need not be able to.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "core/rng.h"
#include "hardware/gige/udp_socket.h"

namespace glint {

/// What happens to packets of pictures; shares are probabilities in [0, 1] of each packet.
struct CableFaults {
  double dropped = 0.0;
  double doubled = 0.0;
  double swapped = 0.0;  ///< with the packet that comes next
  std::chrono::milliseconds delay{0};
  std::size_t longest_packet = 0;  ///< bytes with all headers, longer ones get lost; 0: none does
  bool answers_resend = true;
  bool is_cut = false;  ///< nothing passes, control neither
};

struct CableCounts {
  std::uint64_t packets = 0;
  std::uint64_t dropped = 0;
  std::uint64_t doubled = 0;
  std::uint64_t swapped = 0;
  std::uint64_t resent = 0;
};

class BadCable {
 public:
  /// @param camera  address that the camera listens at, in 127.0.0.0/8
  /// @param listen  another one, for its client
  /// @throws ConfigError for one that is not in 127.0.0.0/8, IoError when it is taken
  BadCable(std::uint32_t camera, std::uint32_t listen, std::uint64_t seed = 1);
  ~BadCable();
  BadCable(const BadCable&) = delete;
  BadCable& operator=(const BadCable&) = delete;

  void set_faults(const CableFaults& faults);
  CableCounts counts() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Delayed {
    Clock::time_point due;
    Bytes packet;
  };

  void run(const std::stop_token& stop);
  void pass_requests(const CableFaults& faults);
  void pass_answers(const CableFaults& faults);
  void pass_pictures(const CableFaults& faults);
  void pass_delayed();
  void resend(const ResendRequest& request, const CableFaults& faults);
  void redirect_stream(Bytes& packet);
  void send_on(const Bytes& packet, const CableFaults& faults);
  void keep(const Bytes& packet);

  bool happens(double share) { return share > 0.0 && random_.uniform() < share; }

  std::uint32_t camera_ = 0;
  std::uint32_t listen_ = 0;
  UdpSocket control_;   ///< towards the client
  UdpSocket upstream_;  ///< control towards the camera
  UdpSocket pictures_in_;
  UdpSocket pictures_out_;
  std::optional<Endpoint> client_;
  Endpoint destination_;
  std::map<std::uint16_t, std::map<std::uint32_t, Bytes>> kept_;  ///< by picture and packet
  std::deque<std::uint16_t> kept_order_;
  std::optional<Bytes> held_;
  std::deque<Delayed> delayed_;
  Rng random_;
  mutable std::mutex mutex_;
  CableFaults faults_;
  CableCounts counts_;
  std::jthread thread_;
};

}  // namespace glint
