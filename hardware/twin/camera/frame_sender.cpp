// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/frame_sender.h"

#include <algorithm>

#include "core/error.h"

namespace glint {
namespace {

constexpr std::size_t kKeptFrames = 3;
constexpr double kLargestBurstBytes = 64e3;

}  // namespace

FrameSender::FrameSender(UdpSocket& socket, double bytes_per_second)
    : socket_(socket), bytes_per_second_(bytes_per_second) {}

void FrameSender::begin(std::uint16_t frame_id,
                        const StreamLeader& leader,
                        Bytes payload,
                        std::size_t packet_size,
                        const Endpoint& to) {
  GLINT_CHECK(packet_size > kStreamOverheadBytes, "a packet has room for data");
  if (kept_.size() == kKeptFrames) {
    kept_.pop_front();
  }
  const std::size_t data_size = packet_size - kStreamOverheadBytes;
  const std::size_t num_data = (payload.size() + data_size - 1) / data_size;
  kept_.push_back({.frame_id = frame_id,
                   .leader = leader,
                   .payload = std::move(payload),
                   .data_size = data_size,
                   .num_data = static_cast<std::uint32_t>(num_data)});
  to_ = to;
  next_packet_ = 0;
  last_packet_ = static_cast<std::uint32_t>(num_data) + 1;
  pumped_ = Clock::now();
  credit_bytes_ = kLargestBurstBytes;
}

double FrameSender::send(const Kept& frame, std::uint32_t packet_id, const Endpoint& to) {
  Bytes packet;
  if (packet_id == 0) {
    packet = stream_leader(frame.frame_id, frame.leader);
  } else if (packet_id > frame.num_data) {
    packet = stream_trailer(frame.frame_id, packet_id, frame.leader.height_px);
  } else {
    const std::size_t begin = (packet_id - 1) * frame.data_size;
    const std::size_t size = std::min(frame.data_size, frame.payload.size() - begin);
    packet = stream_data(frame.frame_id, packet_id, BytesView(frame.payload).subspan(begin, size));
  }
  socket_.send(to, packet);
  return static_cast<double>(packet.size());
}

// What could not be sent in time is not caught up with: a burst would overflow the client's socket.
void FrameSender::pump(Clock::time_point now) {
  const double seconds = std::chrono::duration<double>(now - pumped_).count();
  pumped_ = now;
  credit_bytes_ = std::min(kLargestBurstBytes, credit_bytes_ + bytes_per_second_ * seconds);
  while (is_sending() && credit_bytes_ > 0.0) {
    credit_bytes_ -= send(kept_.back(), next_packet_++, to_);
  }
}

int FrameSender::resend(const ResendRequest& request, const Endpoint& to) {
  const auto frame = std::ranges::find_if(
      kept_, [&](const Kept& kept) { return kept.frame_id == request.frame_id; });
  if (frame == kept_.end()) {
    return 0;
  }
  const std::uint32_t last = std::min(request.last, frame->num_data + 1);
  int count = 0;
  for (std::uint32_t packet = request.first; packet <= last; ++packet) {
    send(*frame, packet, to);
    ++count;
  }
  return count;
}

void FrameSender::abort() {
  next_packet_ = 1;
  last_packet_ = 0;
}

}  // namespace glint
