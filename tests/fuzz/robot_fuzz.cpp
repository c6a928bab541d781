// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes from a controller, and any bytes to its twin. The first byte tells who reads them, the
// second into pieces of what size they are cut. What is refused is refused with a text; what is
// kept stays within the length of one message.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "hardware/robot/motion_watch.h"
#include "hardware/robot/protocol/dashboard_text.h"
#include "hardware/robot/rtde_client.h"
#include "hardware/twin/robot/rtde_session.h"
#include "hardware/twin/robot/script_program.h"

namespace {

/// Calls feed() with the pieces of a text.
template <class Feed>
void in_pieces(std::string_view bytes, std::size_t piece, const Feed& feed) {
  while (!bytes.empty()) {
    feed(bytes.substr(0, piece));
    bytes.remove_prefix(std::min(piece, bytes.size()));
  }
}

void read_rtde(std::string_view bytes, std::size_t piece) {
  glint::RtdeClient client({.outputs = {"timestamp", "actual_q", "robot_mode"},
                            .newer = {"payload"},
                            .inputs = {"standard_digital_output"},
                            .rate_hz = 125.0});
  in_pieces(bytes, piece, [&client](std::string_view part) {
    client.feed(part, [&client] { client.get<double>("timestamp"); });
    client.take_output();
  });
  GLINT_CHECK(client.texts().size() <= 20, "few texts are kept");
}

void read_primary(std::string_view bytes, std::size_t piece) {
  glint::FrameSplitter splitter = glint::FrameSplitter::of_primary();
  in_pieces(bytes, piece, [&splitter](std::string_view part) {
    splitter.append(part);
    while (const auto frame = splitter.next()) {
      const auto message = glint::parse_primary(frame->kind, frame->payload);
      GLINT_CHECK(!message || message->text.size() <= 1000, "texts are cut");
    }
    GLINT_CHECK(splitter.buffered_bytes() <= 65536, "one message is kept");
  });
}

void read_dashboard(std::string_view bytes, std::size_t piece) {
  glint::LineSplitter lines;
  in_pieces(bytes, piece, [&lines](std::string_view part) {
    lines.append(part);
    while (const auto line = lines.next()) {
      glint::value_of_reply(*line);
      glint::flag_of_reply(*line);
      glint::is_success(*line);
    }
    GLINT_CHECK(lines.buffered_bytes() <= 4096, "one line is kept");
  });
}

void serve_twin(std::string_view bytes, std::size_t piece) {
  glint::TwinController twin(glint::TwinSettings{});
  glint::HeldInputs held;
  glint::RtdeSession session(twin, held);
  in_pieces(bytes, piece, [&](std::string_view part) {
    session.on_bytes(part);
    twin.step(0.008);
    session.on_cycle();
  });
}

void run_scripts(std::string_view bytes, std::size_t piece) {
  glint::TwinController twin(glint::TwinSettings{});
  glint::LineSplitter lines(glint::ScriptReader::kMaxBytes);
  glint::ScriptReader reader;
  in_pieces(bytes, piece, [&](std::string_view part) {
    lines.append(part);
    while (const auto line = lines.next()) {
      if (const auto result = reader.add_line(*line)) {
        twin.run(*result);
      }
      twin.reply(*line);
      twin.step(0.008);
    }
  });
  GLINT_CHECK(twin.view().joints_rad.allFinite(), "joints are numbers");
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using Read = void (*)(std::string_view bytes, std::size_t piece);
  constexpr Read kReaders[] = {read_rtde, read_primary, read_dashboard, serve_twin, run_scripts};
  if (size < 2) {
    return 0;
  }
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 2, size - 2);
  const std::size_t piece = 1 + data[1] % 64U;
  try {
    kReaders[data[0] % std::size(kReaders)](bytes, piece);
  } catch (const glint::ProtocolError& error) {
    GLINT_CHECK(error.what()[0] != '\0', "errors have a text");
  }
  return 0;
}
