// SPDX-License-Identifier: GPL-3.0-or-later
//
// The camera's side of control: who is in control, what requests are answered, and what registers
// set off.
#pragma once

#include <chrono>
#include <deque>
#include <optional>

#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/camera_registers.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/camera/frame_sender.h"

namespace glint {

/// Used by one thread: feed it packets, and call step() every millisecond or so.
class GvcpServer {
 public:
  using Clock = std::chrono::steady_clock;

  GvcpServer(const CameraTwinSettings& settings, PictureSource& source);

  const UdpSocket& control() const { return control_; }

  /// Answers what has arrived, and does what is due: a picture whose exposure has ended, packets,
  /// an answer that waited for the source, a client that is no longer heard.
  void step();

  /// When step() should be called again, if nothing arrives before.
  std::chrono::microseconds pause() const;

  const CameraTwinCounts& counts() const { return counts_; }

 private:
  /// A picture that is being taken.
  struct Exposure {
    SensorPicture picture;
    Clock::time_point end;
    std::uint64_t timestamp_ns = 0;
  };

  /// An answer that waits for the source.
  struct Waiting {
    Endpoint client;
    GvcpCommand command;
    std::uint16_t id = 0;
    Bytes request;  ///< its payload
    Bytes payload;  ///< of the answer
    Clock::time_point next_notice;
    Clock::time_point give_up;
  };

  /// What a request was answered, for a client that sends it once more.
  struct Answered {
    Endpoint client;
    std::uint16_t command = 0;
    std::uint16_t id = 0;
    Bytes request;  ///< its payload
    Bytes packet;
  };

  void handle(BytesView packet, const Endpoint& client);
  void do_request(const GvcpRequest& request, const Endpoint& client);
  /// None: it is new.
  const Answered* answer_to(const GvcpRequest& request, const Endpoint& client) const;
  void remember(Answered answered);
  void answer(const Endpoint& client,
              const GvcpRequest& request,
              GvcpStatus status,
              BytesView payload = {});
  void read_registers(const Endpoint& client, const GvcpRequest& request);
  void read_memory(const Endpoint& client, const GvcpRequest& request);
  void write_registers(const Endpoint& client, const GvcpRequest& request);
  void write_memory(const Endpoint& client, const GvcpRequest& request);
  void finish_write(const Endpoint& client,
                    const GvcpRequest& request,
                    GvcpStatus status,
                    bool needs_new_picture,
                    const Bytes& payload);
  GvcpStatus write(const Endpoint& client, std::uint32_t address, BytesView bytes);
  GvcpStatus write_privilege(const Endpoint& client, std::uint32_t value);
  GvcpStatus trigger();
  void send_test_packet(std::uint32_t size);
  void resend(const GvcpRequest& request);
  void release_control();
  void answer_waiting(Clock::time_point now);
  void send_exposed(Clock::time_point now);
  GvcpStatus refuse(TwinRefusal refusal);
  Endpoint stream_endpoint() const;

  CameraTwinSettings settings_;
  PictureSource& source_;
  CameraRegisters registers_;
  UdpSocket control_;
  UdpSocket stream_;
  FrameSender sender_;
  std::optional<Endpoint> controller_;
  Clock::time_point heard_ = {};
  bool is_acquiring_ = false;
  std::optional<Exposure> exposing_;
  std::optional<Waiting> waiting_;
  std::deque<Answered> answered_;  ///< the newest last
  Clock::time_point began_ = Clock::now();
  CameraTwinCounts counts_;
};

}  // namespace glint
