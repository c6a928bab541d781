// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/bad_cable.h"

#include <poll.h>

#include <algorithm>
#include <array>

#include "core/error.h"

namespace glint {
namespace {

namespace gev = gige_register;

constexpr int kCableBytes = 64 << 20;
constexpr std::size_t kKeptPictures = 4;
constexpr std::size_t kHeader = 8;
constexpr int kPacketsAtOnce = 256;
constexpr std::size_t kUdpHeaders = 28;  ///< bytes of headers

std::uint32_t on_this_machine(std::uint32_t address) {
  if (!is_loopback(address)) {
    throw ConfigError("a simulated cable lies in 127.0.0.0/8 alone, not at " + ipv4_text(address));
  }
  return address;
}

bool is_too_long(const Bytes& packet, const CableFaults& faults) {
  return faults.longest_packet > 0 && packet.size() + kUdpHeaders > faults.longest_packet;
}

}  // namespace

BadCable::BadCable(std::uint32_t camera, std::uint32_t listen, std::uint64_t seed)
    : camera_(on_this_machine(camera)),
      listen_(on_this_machine(listen)),
      control_({.address = listen, .port = kGvcpPort}),
      upstream_({.address = listen, .port = 0}),
      pictures_in_({.address = listen, .port = 0}),
      pictures_out_({.address = listen, .port = 0}),
      random_(seed, Stream::kTest, 0) {
  pictures_in_.set_buffer_bytes(kCableBytes);
  pictures_out_.set_buffer_bytes(kCableBytes);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

BadCable::~BadCable() = default;

void BadCable::set_faults(const CableFaults& faults) {
  const std::scoped_lock lock(mutex_);
  faults_ = faults;
}

CableCounts BadCable::counts() const {
  const std::scoped_lock lock(mutex_);
  return counts_;
}

void BadCable::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::array<pollfd, 3> waiting = {{{control_.descriptor(), POLLIN, 0},
                                      {upstream_.descriptor(), POLLIN, 0},
                                      {pictures_in_.descriptor(), POLLIN, 0}}};
    ::poll(waiting.data(), waiting.size(), delayed_.empty() ? 20 : 1);
    const std::scoped_lock lock(mutex_);
    const CableFaults faults = faults_;
    pass_requests(faults);
    pass_answers(faults);
    pass_pictures(faults);
    pass_delayed();
  }
}

void BadCable::pass_requests(const CableFaults& faults) {
  Bytes packet;
  Endpoint from;
  while (control_.receive(packet, from)) {
    const auto request = parse_gvcp_request(packet);
    if (!request || faults.is_cut) {
      continue;
    }
    client_ = from;
    if (request->command == static_cast<std::uint16_t>(GvcpCommand::kPacketResend)) {
      if (const auto wanted = parse_resend(*request); wanted && faults.answers_resend) {
        resend(*wanted, faults);
      }
      continue;
    }
    // Written as a register or as memory of 4 bytes, both lie at the same place.
    if (request->command == static_cast<std::uint16_t>(GvcpCommand::kWriteRegister) ||
        request->command == static_cast<std::uint16_t>(GvcpCommand::kWriteMemory)) {
      redirect_stream(packet);
    }
    upstream_.send({.address = camera_, .port = kGvcpPort}, packet);
  }
}

// The camera sends its pictures here, and where the client wants them is remembered.
void BadCable::redirect_stream(Bytes& packet) {
  for (std::size_t i = kHeader; i + 8 <= packet.size(); i += 8) {
    const std::uint32_t address = read_u32(packet, i);
    const std::uint32_t value = read_u32(packet, i + 4);
    if (address == gev::kStreamPort) {
      destination_.port = static_cast<std::uint16_t>(value & 0xffffU);
      const std::uint32_t port = destination_.port == 0 ? 0U : pictures_in_.port();
      store_u32(packet, i + 4, (value & 0xffff0000U) | port);
    } else if (address == gev::kStreamAddress) {
      destination_.address = value;
      store_u32(packet, i + 4, value == 0 ? 0 : listen_);
    }
  }
}

void BadCable::pass_answers(const CableFaults& faults) {
  Bytes packet;
  Endpoint from;
  while (upstream_.receive(packet, from)) {
    const auto answer = parse_gvcp_acknowledgement(packet);
    if (!answer || !client_ || faults.is_cut) {
      continue;
    }
    const bool is_discovery =
        answer->command == static_cast<std::uint16_t>(GvcpCommand::kDiscovery) + 1;
    if (is_discovery && answer->payload.size() >= gev::kDiscoveryEnd) {
      store_u32(packet, kHeader + gev::kCurrentIp, listen_);
    }
    control_.send(*client_, packet);
  }
}

void BadCable::keep(const Bytes& packet) {
  const auto header = parse_stream_header(packet);
  if (!header) {
    return;
  }
  if (!kept_.contains(header->frame_id)) {
    kept_order_.push_back(header->frame_id);
    if (kept_order_.size() > kKeptPictures) {
      kept_.erase(kept_order_.front());
      kept_order_.pop_front();
    }
  }
  kept_[header->frame_id][header->packet_id] = packet;
}

void BadCable::send_on(const Bytes& packet, const CableFaults& faults) {
  if (faults.is_cut || destination_.port == 0) {
    return;
  }
  if (faults.delay.count() > 0 || !delayed_.empty()) {
    delayed_.push_back({.due = Clock::now() + faults.delay, .packet = packet});
    return;
  }
  pictures_out_.send(destination_, packet);
}

void BadCable::resend(const ResendRequest& request, const CableFaults& faults) {
  const auto picture = kept_.find(static_cast<std::uint16_t>(request.frame_id));
  if (picture == kept_.end()) {
    return;
  }
  const auto end = picture->second.upper_bound(request.last);
  for (auto packet = picture->second.lower_bound(request.first); packet != end; ++packet) {
    if (is_too_long(packet->second, faults) || happens(faults.dropped)) {
      ++counts_.dropped;
      continue;
    }
    ++counts_.resent;
    send_on(packet->second, faults);
  }
}

void BadCable::pass_pictures(const CableFaults& faults) {
  Bytes packet;
  Endpoint from;
  for (int i = 0; i < kPacketsAtOnce && pictures_in_.receive(packet, from); ++i) {
    keep(packet);
    ++counts_.packets;
    if (is_too_long(packet, faults) || happens(faults.dropped)) {
      ++counts_.dropped;
      continue;
    }
    if (!held_ && happens(faults.swapped)) {
      ++counts_.swapped;
      held_ = packet;
      continue;
    }
    send_on(packet, faults);
    if (happens(faults.doubled)) {
      ++counts_.doubled;
      send_on(packet, faults);
    }
    if (held_) {
      send_on(*held_, faults);
      held_.reset();
    }
  }
}

void BadCable::pass_delayed() {
  const auto now = Clock::now();
  while (!delayed_.empty() && delayed_.front().due <= now) {
    pictures_out_.send(destination_, delayed_.front().packet);
    delayed_.pop_front();
  }
}

}  // namespace glint
