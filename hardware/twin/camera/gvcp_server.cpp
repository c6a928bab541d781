// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/gvcp_server.h"

#include <algorithm>

#include "core/log.h"
#include "hardware/twin/camera/genicam_xml.h"

namespace glint {
namespace {

namespace gev = gige_register;
namespace at = twin_register;
using std::chrono::milliseconds;

constexpr std::size_t kLargestMemoryBlock = 540;
constexpr std::uint32_t kFireTestPacket = 1U << 31U;
constexpr std::uint32_t kControlBits = 3;  ///< exclusive access, control
constexpr int kSocketBytes = 16 << 20;
constexpr milliseconds kNoticeEvery{400};
constexpr milliseconds kLongestWait{120'000};
constexpr std::size_t kAnswersKept = 32;

/// Whether a write there is answered when the source has a picture.
bool needs_picture(std::uint32_t address) {
  return changes_pictures(address) || address == at::kAcquisitionStart;
}

Bytes number_bytes(std::uint32_t value) {
  Bytes bytes;
  append_u32(bytes, value);
  return bytes;
}

}  // namespace

GvcpServer::GvcpServer(const CameraTwinSettings& settings, PictureSource& source)
    : settings_(settings),
      source_(source),
      registers_(settings),
      control_({.address = settings.address, .port = kGvcpPort}),
      stream_({.address = settings.address, .port = 0}),
      sender_(stream_, settings.bytes_per_second) {
  stream_.set_buffer_bytes(kSocketBytes);
  registers_.store_number(gev::kStreamSourcePort, stream_.port());
  source_.prepare(registers_.capture_settings());
}

void GvcpServer::step() {
  const auto now = Clock::now();
  const milliseconds heartbeat(registers_.read_number(gev::kHeartbeatTimeoutMs));
  if (controller_ && now - heard_ > heartbeat) {
    log(LogLevel::kWarning, "camera twin: the client was not heard for {} ms", heartbeat.count());
    ++counts_.lost_controls;
    release_control();
  }
  Bytes packet;
  Endpoint client;
  while (control_.receive(packet, client)) {
    handle(packet, client);
  }
  answer_waiting(now);
  send_exposed(now);
  sender_.pump(now);
}

std::chrono::microseconds GvcpServer::pause() const {
  if (sender_.is_sending()) {
    return std::chrono::microseconds(200);
  }
  return exposing_ || waiting_ ? milliseconds(1) : milliseconds(20);
}

void GvcpServer::handle(BytesView packet, const Endpoint& client) {
  const std::optional<GvcpRequest> request = parse_gvcp_request(packet);
  if (!request || !is_loopback(client.address)) {
    return;
  }
  if (controller_ == client) {
    heard_ = Clock::now();
  }
  if (waiting_ && waiting_->client == client && waiting_->id == request->id) {
    return;
  }
  if (const Answered* known = answer_to(*request, client)) {
    control_.send(client, known->packet);
    return;
  }
  do_request(*request, client);
}

void GvcpServer::do_request(const GvcpRequest& request, const Endpoint& client) {
  switch (static_cast<GvcpCommand>(request.command)) {
    case GvcpCommand::kDiscovery:
      answer(client, request, GvcpStatus::kSuccess, registers_.read(0, gev::kDiscoveryEnd));
      break;
    case GvcpCommand::kPacketResend:
      resend(request);
      break;
    case GvcpCommand::kReadRegister:
      read_registers(client, request);
      break;
    case GvcpCommand::kReadMemory:
      read_memory(client, request);
      break;
    case GvcpCommand::kWriteRegister:
      write_registers(client, request);
      break;
    case GvcpCommand::kWriteMemory:
      write_memory(client, request);
      break;
    default:
      answer(client, request, GvcpStatus::kNotImplemented);
      break;
  }
}

// A client sends a request again, under the same id, when it hears no answer: it is answered as it
// was the first time and not done once more, whatever else has been asked in between. Ids begin
// again, so the same id with another payload is another request.
const GvcpServer::Answered* GvcpServer::answer_to(const GvcpRequest& request,
                                                  const Endpoint& client) const {
  if (!request.wants_acknowledgement) {
    return nullptr;
  }
  const auto known = std::ranges::find_if(answered_, [&](const Answered& one) {
    return one.client == client && one.id == request.id && one.command == request.command &&
           std::ranges::equal(one.request, request.payload);
  });
  return known == answered_.end() ? nullptr : &*known;
}

void GvcpServer::remember(Answered answered) {
  answered_.push_back(std::move(answered));
  if (answered_.size() > kAnswersKept) {
    answered_.pop_front();
  }
}

void GvcpServer::answer(const Endpoint& client,
                        const GvcpRequest& request,
                        GvcpStatus status,
                        BytesView payload) {
  if (!request.wants_acknowledgement) {
    return;
  }
  const auto command = static_cast<GvcpCommand>(request.command);
  Bytes packet = gvcp_acknowledgement(command, request.id, status, payload);
  control_.send(client, packet);
  remember({.client = client,
            .command = request.command,
            .id = request.id,
            .request = {request.payload.begin(), request.payload.end()},
            .packet = std::move(packet)});
}

void GvcpServer::read_registers(const Endpoint& client, const GvcpRequest& request) {
  Bytes values;
  for (std::size_t i = 0; i + 4 <= request.payload.size(); i += 4) {
    const BytesView value = registers_.read(read_u32(request.payload, i), 4);
    if (value.empty()) {
      answer(client, request, GvcpStatus::kInvalidAddress);
      return;
    }
    values.insert(values.end(), value.begin(), value.end());
  }
  answer(client, request, GvcpStatus::kSuccess, values);
}

void GvcpServer::read_memory(const Endpoint& client, const GvcpRequest& request) {
  if (request.payload.size() < 8) {
    answer(client, request, GvcpStatus::kInvalidParameter);
    return;
  }
  const std::uint32_t address = read_u32(request.payload, 0);
  const std::size_t size = read_u16(request.payload, 6);
  const BytesView data = registers_.read(address, size);
  if (data.empty() || size > kLargestMemoryBlock) {
    answer(client, request, GvcpStatus::kInvalidAddress);
    return;
  }
  Bytes payload = number_bytes(address);
  payload.insert(payload.end(), data.begin(), data.end());
  answer(client, request, GvcpStatus::kSuccess, payload);
}

void GvcpServer::write_registers(const Endpoint& client, const GvcpRequest& request) {
  std::uint32_t written = 0;
  bool changes = false;
  GvcpStatus status = GvcpStatus::kSuccess;
  for (std::size_t i = 0; i + 8 <= request.payload.size(); i += 8) {
    const std::uint32_t address = read_u32(request.payload, i);
    status = write(client, address, request.payload.subspan(i + 4, 4));
    if (status != GvcpStatus::kSuccess) {
      break;
    }
    changes = changes || needs_picture(address);
    ++written;
  }
  finish_write(client, request, status, changes, number_bytes(written));
}

void GvcpServer::write_memory(const Endpoint& client, const GvcpRequest& request) {
  if (request.payload.size() < 8) {
    answer(client, request, GvcpStatus::kInvalidParameter);
    return;
  }
  const std::uint32_t address = read_u32(request.payload, 0);
  const GvcpStatus status = write(client, address, request.payload.subspan(4));
  const bool changes = status == GvcpStatus::kSuccess && needs_picture(address);
  finish_write(client, request, status, changes, number_bytes(address));
}

// Writes that change what the next trigger takes are answered when its picture is there.
void GvcpServer::finish_write(const Endpoint& client,
                              const GvcpRequest& request,
                              GvcpStatus status,
                              bool needs_new_picture,
                              const Bytes& payload) {
  if (needs_new_picture) {
    source_.prepare(registers_.capture_settings());
  }
  const bool must_wait = needs_new_picture && is_acquiring_ && status == GvcpStatus::kSuccess &&
                         !source_.is_finished(registers_.capture_settings());
  if (!must_wait || !request.wants_acknowledgement) {
    answer(client, request, status, payload);
    return;
  }
  const auto now = Clock::now();
  waiting_ = Waiting{.client = client,
                     .command = static_cast<GvcpCommand>(request.command),
                     .id = request.id,
                     .request = {request.payload.begin(), request.payload.end()},
                     .payload = payload,
                     .next_notice = now,
                     .give_up = now + kLongestWait};
}

GvcpStatus GvcpServer::write(const Endpoint& client, std::uint32_t address, BytesView bytes) {
  if (address == gev::kPrivilege && bytes.size() == 4) {
    return write_privilege(client, read_u32(bytes, 0));
  }
  if (controller_ != client) {
    return GvcpStatus::kAccessDenied;
  }
  if (address == at::kTriggerSoftware) {
    return trigger();
  }
  const GvcpStatus status = registers_.write(address, bytes, is_acquiring_);
  if (status != GvcpStatus::kSuccess) {
    return status;
  }
  if (address == at::kAcquisitionStart) {
    is_acquiring_ = true;
  } else if (address == at::kAcquisitionStop) {
    is_acquiring_ = false;
    exposing_.reset();
    sender_.abort();
  } else if (address == gev::kPacketSize && (read_u32(bytes, 0) & kFireTestPacket) != 0) {
    send_test_packet(read_u32(bytes, 0) & 0xffffU);
  }
  return status;
}

GvcpStatus GvcpServer::write_privilege(const Endpoint& client, std::uint32_t value) {
  if (controller_ && controller_ != client) {
    return GvcpStatus::kAccessDenied;
  }
  if ((value & kControlBits) == 0) {
    release_control();
    return GvcpStatus::kSuccess;
  }
  controller_ = client;
  heard_ = Clock::now();
  registers_.store_number(gev::kPrivilege, value & kControlBits);
  return GvcpStatus::kSuccess;
}

void GvcpServer::release_control() {
  std::erase_if(answered_, [this](const Answered& one) { return controller_ == one.client; });
  controller_.reset();
  registers_.store_number(gev::kPrivilege, 0);
  registers_.store_number(gev::kStreamPort, 0);
  is_acquiring_ = false;
  exposing_.reset();
  waiting_.reset();
  sender_.abort();
}

GvcpStatus GvcpServer::refuse(TwinRefusal refusal) {
  log(LogLevel::kError, "camera twin: {}", name_of(refusal));
  ++counts_.refused;
  counts_.last_refusal = refusal;
  return GvcpStatus::kBusy;
}

GvcpStatus GvcpServer::trigger() {
  if (!is_acquiring_) {
    return refuse(TwinRefusal::kNotAcquiring);
  }
  if (exposing_ || sender_.is_sending()) {
    return refuse(TwinRefusal::kStillExposing);
  }
  const CaptureSettings settings = registers_.capture_settings();
  SensorPicture picture = source_.finished(settings, counts_.frames);
  if (!picture) {
    return refuse(TwinRefusal::kNoFinishedPicture);
  }
  const auto now = Clock::now();
  const auto exposure = std::chrono::duration<double, std::micro>(settings.exposure_us);
  const auto age = std::chrono::duration_cast<std::chrono::nanoseconds>(now - began_);
  exposing_ = Exposure{.picture = std::move(picture),
                       .end = now + std::chrono::duration_cast<Clock::duration>(exposure),
                       .timestamp_ns = static_cast<std::uint64_t>(age.count())};
  return GvcpStatus::kSuccess;
}

Endpoint GvcpServer::stream_endpoint() const {
  return {.address = registers_.read_number(gev::kStreamAddress),
          .port = static_cast<std::uint16_t>(registers_.read_number(gev::kStreamPort) & 0xffffU)};
}

void GvcpServer::send_test_packet(std::uint32_t size) {
  constexpr std::uint32_t kIpAndUdp = 28;
  const Endpoint to = stream_endpoint();
  if (to.port != 0 && is_loopback(to.address)) {
    stream_.send(to, Bytes(size - kIpAndUdp, 0xa5));
  }
}

void GvcpServer::resend(const GvcpRequest& request) {
  if (const auto wanted = parse_resend(request)) {
    counts_.resent_packets +=
        static_cast<std::uint64_t>(sender_.resend(*wanted, stream_endpoint()));
  }
}

void GvcpServer::answer_waiting(Clock::time_point now) {
  if (!waiting_) {
    return;
  }
  const bool is_finished = source_.is_finished(registers_.capture_settings());
  if (is_finished || now > waiting_->give_up) {
    const GvcpStatus status = is_finished ? GvcpStatus::kSuccess : GvcpStatus::kBusy;
    Bytes packet = gvcp_acknowledgement(waiting_->command, waiting_->id, status, waiting_->payload);
    control_.send(waiting_->client, packet);
    remember({.client = waiting_->client,
              .command = static_cast<std::uint16_t>(waiting_->command),
              .id = waiting_->id,
              .request = std::move(waiting_->request),
              .packet = std::move(packet)});
    waiting_.reset();
  } else if (now >= waiting_->next_notice) {
    Bytes time;
    append_u16(time, 0);
    append_u16(time, static_cast<std::uint32_t>(2 * kNoticeEvery.count()));
    control_.send(
        waiting_->client,
        gvcp_acknowledgement(GvcpCommand::kPending, waiting_->id, GvcpStatus::kSuccess, time));
    waiting_->next_notice = now + kNoticeEvery;
    heard_ = now;  // the client waits for this answer and asks nothing meanwhile
  }
}

void GvcpServer::send_exposed(Clock::time_point now) {
  if (!exposing_ || now < exposing_->end) {
    return;
  }
  StreamLeader leader = registers_.leader();
  leader.timestamp_ticks = exposing_->timestamp_ns;
  const auto frame_id =
      static_cast<std::uint16_t>((settings_.first_frame_id - 1 + counts_.frames) % 65535 + 1);
  sender_.begin(frame_id,
                leader,
                registers_.payload_of(*exposing_->picture),
                registers_.read_number(gev::kPacketSize) & 0xffffU,
                stream_endpoint());
  ++counts_.frames;
  exposing_.reset();
}

}  // namespace glint
