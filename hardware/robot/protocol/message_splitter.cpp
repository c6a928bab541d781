// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/message_splitter.h"

#include <fmt/format.h>

#include "hardware/robot/protocol/byte_order.h"

namespace glint {
namespace {

constexpr std::size_t kCompactBytes = 1 << 16;

}  // namespace

void FrameSplitter::append(std::string_view bytes) {
  if (begin_ > kCompactBytes || begin_ == buffer_.size()) {
    buffer_.erase(0, begin_);
    begin_ = 0;
  }
  buffer_.append(bytes);
}

std::optional<FrameSplitter::Frame> FrameSplitter::next() {
  const std::string_view unread = std::string_view(buffer_).substr(begin_);
  if (unread.size() < length_bytes_) {
    return std::nullopt;
  }
  ByteReader reader(unread);
  const std::size_t length =
      length_bytes_ == 2 ? reader.take<std::uint16_t>() : reader.take<std::uint32_t>();
  const std::size_t head = length_bytes_ + 1;
  if (length < head || length > max_bytes_) {
    throw ProtocolError(fmt::format(
        "{}: a message of {} bytes, allowed are {} to {}", name_, length, head, max_bytes_));
  }
  if (unread.size() < length) {
    return std::nullopt;
  }
  begin_ += length;
  return Frame{.kind = static_cast<std::uint8_t>(unread[length_bytes_]),
               .payload = std::string(unread.substr(head, length - head))};
}

std::optional<std::string> LineSplitter::next() {
  const std::size_t end = buffer_.find('\n');
  if (end == std::string::npos ? buffer_.size() > max_bytes_ : end > max_bytes_) {
    throw ProtocolError(fmt::format("a line of more than {} bytes", max_bytes_));
  }
  if (end == std::string::npos) {
    return std::nullopt;
  }
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  if (!line.empty() && line.back() == '\r') {
    line.pop_back();
  }
  return line;
}

}  // namespace glint
