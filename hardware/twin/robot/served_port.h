// SPDX-License-Identifier: GPL-3.0-or-later
//
// Included by twin_server.cpp alone, as Boost.Asio takes long to compile.
#pragma once

#include <list>
#include <memory>
#include <utility>

#include <boost/asio.hpp>

#include "hardware/twin/robot/rtde_session.h"
#include "hardware/twin/robot/served_client.h"

namespace glint {

struct Connected {
  std::shared_ptr<ServedClient> client;
  std::shared_ptr<RtdeSession> session;  ///< of RTDE; none on other ports
};

/// A listening port and those who have come to it.
struct Port {
  explicit Port(boost::asio::io_context& context) : acceptor(context) {}

  boost::asio::ip::tcp::acceptor acceptor;
  boost::asio::ip::tcp::endpoint endpoint;
  std::list<Connected> clients;

  void drop_closed() {
    clients.remove_if([](const Connected& connected) { return !connected.client->is_open(); });
  }

  void close_all() {
    for (const Connected& connected : clients) {
      connected.client->close();
    }
    clients.clear();
  }
};

}  // namespace glint
