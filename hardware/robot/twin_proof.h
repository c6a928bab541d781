// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a twin proves that it is one. A twin of Glint serves a Unix socket beside its ports, in a
// folder that only its user may enter, and tells its token there; the same token is an output of
// its RTDE. A peer whose two tokens do not agree is a real robot, on 127.0.0.1 too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace glint {

/// The RTDE output (UINT64) that holds a twin's token. Real controllers answer NOT_FOUND.
inline constexpr const char* kTwinTokenOutput = "glint_twin_token";

/// The socket of the twin that serves this RTDE port: <temporary
/// folder>/glint-<user>/robot-<port>.sock
std::filesystem::path twin_socket_path(int rtde_port);

/// One line to a twin's side channel and its reply; none: nobody listens there, or the socket is
/// not this user's alone (mode 0600).
std::optional<std::string> ask_side_channel(const std::filesystem::path& socket,
                                            const std::string& line,
                                            double timeout_s = 1.0);

/// The token that RTDE and side channel of that port both tell; none: it is no twin of this user.
std::optional<std::uint64_t> proven_token(const std::string& host, int rtde_port);

bool is_proven_twin(const std::string& host, int rtde_port);

}  // namespace glint
