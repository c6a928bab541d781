// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which internet sockets a process has, as the system tells in /proc/net.
#pragma once

#include <sys/types.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace glint {

/// A socket of IPv4 or IPv6, UDP or TCP, or a raw one.
struct ProcessSocket {
  std::string table;    ///< of /proc/net: "udp", "tcp", "udp6", "tcp6", "raw", "raw6"
  std::string address;  ///< "127.0.0.1"; of IPv6 the hexadecimal digits of the table
  int port = 0;
  bool is_listening = false;  ///< of TCP

  bool is_on_loopback() const { return address.starts_with("127."); }

  std::string text() const { return fmt::format("{} {}:{}", table, address, port); }
};

inline std::set<std::string> socket_inodes_of(pid_t process) {
  namespace fs = std::filesystem;
  std::set<std::string> inodes;
  for (const auto& entry : fs::directory_iterator(fmt::format("/proc/{}/fd", process))) {
    std::error_code gone;
    const std::string target = fs::read_symlink(entry.path(), gone).string();
    if (target.starts_with("socket:[")) {
      inodes.insert(target.substr(8, target.size() - 9));
    }
  }
  return inodes;
}

/// "0100007F", the bytes of an IPv4 address from the last to the first, as "127.0.0.1".
inline std::string address_of_digits(const std::string& digits) {
  if (digits.size() != 8) {
    return digits;
  }
  const unsigned long raw = std::stoul(digits, nullptr, 16);
  return fmt::format(
      "{}.{}.{}.{}", raw & 0xffU, (raw >> 8U) & 0xffU, (raw >> 16U) & 0xffU, raw >> 24U);
}

/// A line of the tables: number, local address and port in hexadecimal, the peer's, state (0A:
/// listening), ..., inode in the tenth column.
inline std::vector<ProcessSocket> sockets_of(pid_t process) {
  const std::set<std::string> inodes = socket_inodes_of(process);
  std::vector<ProcessSocket> sockets;
  for (const char* table : {"udp", "tcp", "udp6", "tcp6", "raw", "raw6"}) {
    std::ifstream file(fmt::format("/proc/net/{}", table));
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream words(line);
      std::array<std::string, 10> columns;
      for (std::string& column : columns) {
        words >> column;
      }
      if (inodes.contains(columns[9])) {
        const std::size_t colon = columns[1].find(':');
        sockets.push_back({.table = table,
                           .address = address_of_digits(columns[1].substr(0, colon)),
                           .port = std::stoi(columns[1].substr(colon + 1), nullptr, 16),
                           .is_listening = columns[3] == "0A"});
      }
    }
  }
  return sockets;
}

}  // namespace glint
