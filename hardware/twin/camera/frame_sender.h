// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cuts pictures into the packets of a stream and sends them no faster than a cable would. Keeps the
// last pictures, so that packets can be sent once more.
#pragma once

#include <chrono>
#include <deque>
#include <memory>

#include "hardware/gige/udp_socket.h"

namespace glint {

class FrameSender {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param socket  must outlive the sender
  FrameSender(UdpSocket& socket, double bytes_per_second);

  /// Begins to send a picture. @param packet_size  bytes with all headers
  void begin(std::uint16_t frame_id,
             const StreamLeader& leader,
             Bytes payload,
             std::size_t packet_size,
             const Endpoint& to);

  bool is_sending() const { return next_packet_ <= last_packet_; }

  /// Sends what the cable takes by now.
  void pump(Clock::time_point now);

  /// Sends packets of a picture that is kept; those of none are left out.
  /// @return how many were sent
  int resend(const ResendRequest& request, const Endpoint& to);

  /// What is not sent yet never will be.
  void abort();

 private:
  struct Kept {
    std::uint16_t frame_id = 0;
    StreamLeader leader;
    Bytes payload;
    std::size_t data_size = 0;   ///< of a packet
    std::uint32_t num_data = 0;  ///< packets of data
  };

  /// @return its size in bytes
  double send(const Kept& frame, std::uint32_t packet_id, const Endpoint& to);

  UdpSocket& socket_;
  double bytes_per_second_ = 0.0;
  std::deque<Kept> kept_;  ///< the last one is being sent
  Endpoint to_;
  std::uint32_t next_packet_ = 1;
  std::uint32_t last_packet_ = 0;
  Clock::time_point pumped_ = {};
  double credit_bytes_ = 0.0;  ///< that the cable takes now
};

}  // namespace glint
