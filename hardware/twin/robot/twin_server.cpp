// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/twin_server.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/asio.hpp>

#include "core/error.h"
#include "hardware/robot/twin_proof.h"
#include "hardware/twin/robot/dashboard_replies.h"
#include "hardware/twin/robot/served_port.h"
#include "hardware/twin/side_channel/side_channel.h"

namespace glint {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxClients = 16;
constexpr std::size_t kBusyWaiting = 1 << 17;  ///< as fast as possible: cycles pause above it

}  // namespace

struct TwinServer::Impl {
  explicit Impl(TwinServerSettings given)
      : settings(std::move(given)),
        twin(with_token(settings.twin)),
        rtde(context),
        primary(context),
        secondary(context),
        dashboard(context),
        timer(context),
        reopening(context) {
    error_code error;
    const auto address = asio::ip::make_address_v4(settings.address, error);
    if (error || !address.is_loopback()) {
      throw ConfigError(
          fmt::format("a twin serves 127.0.0.0/8 alone, not \"{}\"", settings.address));
    }
    open(rtde, address, settings.ports.rtde);
    open(primary, address, settings.ports.primary);
    open(secondary, address, settings.ports.secondary);
    open(dashboard, address, settings.ports.dashboard);
    settings.ports = {.rtde = rtde.endpoint.port(),
                      .primary = primary.endpoint.port(),
                      .secondary = secondary.endpoint.port(),
                      .dashboard = dashboard.endpoint.port()};
    side.emplace(twin_socket_path(settings.ports.rtde),
                 [this](const std::string& line) { return side_reply(line); });
    accept_all();
    next_cycle = Clock::now();
    wait_for_cycle();
  }

  TwinSettings with_token(TwinSettings given) {
    token = fresh_token();
    given.token = token;
    return given;
  }

  static void listen(Port& port) {
    port.acceptor.open(tcp::v4());
    port.acceptor.set_option(tcp::acceptor::reuse_address(true));
    port.acceptor.bind(port.endpoint);
    port.acceptor.listen();
    port.endpoint = port.acceptor.local_endpoint();
  }

  static void open(Port& port, const asio::ip::address_v4& address, int number) {
    port.endpoint = tcp::endpoint(address, static_cast<unsigned short>(number));
    try {
      listen(port);
    } catch (const boost::system::system_error& error) {
      throw IoError(fmt::format("{}:{}: {}", address.to_string(), number, error.code().message()));
    }
  }

  void accept_all() {
    accept_rtde();
    accept_scripts(primary);
    accept_scripts(secondary);
    accept_dashboard();
  }

  void accept_rtde() {
    accept(rtde, [this](Connected& connected) {
      auto session = std::make_shared<RtdeSession>(twin, held);
      connected.session = session;
      return [session](std::string_view bytes) { return session->on_bytes(bytes); };
    });
  }

  void accept_scripts(Port& port) {
    accept(port, [this](Connected&) {
      struct Scripts {
        LineSplitter lines{ScriptReader::kMaxBytes};
        ScriptReader reader;
      };
      auto scripts = std::make_shared<Scripts>();
      return [this, scripts](std::string_view bytes) {
        num_command_bytes += bytes.size();
        scripts->lines.append(bytes);
        while (const auto line = scripts->lines.next()) {
          if (const auto result = scripts->reader.add_line(*line)) {
            twin.run(*result);
          }
        }
        return std::string();
      };
    });
  }

  void accept_dashboard() {
    accept(dashboard, [this](Connected& connected) {
      ServedClient* client = connected.client.get();
      client->send(DashboardReplies::greeting() + "\n");
      auto lines = std::make_shared<LineSplitter>();
      return [this, lines, client](std::string_view bytes) {
        num_command_bytes += bytes.size();
        lines->append(bytes);
        std::string replies;
        while (const auto line = lines->next()) {
          replies += twin.reply(*line) + "\n";
          if (*line == "quit") {
            client->send(std::exchange(replies, {}));
            client->close_when_sent();
          }
        }
        return replies;
      };
    });
  }

  /// @param make_handler  called with each new client, gives what handles its bytes
  template <class MakeHandler>
  void accept(Port& port, MakeHandler make_handler) {
    port.acceptor.async_accept(
        [this, &port, make_handler](const error_code& error, tcp::socket socket) {
          if (error) {
            return;  // closed
          }
          const std::lock_guard lock(mutex);
          port.drop_closed();
          if (port.clients.size() < kMaxClients) {
            error_code ignored;
            socket.set_option(tcp::no_delay(true), ignored);
            add_client(port, std::move(socket), make_handler);
          }
          accept(port, make_handler);
        });
  }

  template <class MakeHandler>
  void add_client(Port& port, tcp::socket socket, const MakeHandler& make_handler) {
    // The handler is made for the client, which is made with it: it is set afterwards.
    auto handler = std::make_shared<ServedClient::OnBytes>();
    auto client = std::make_shared<ServedClient>(
        std::move(socket),
        [this, handler](std::string_view bytes) {
          const std::lock_guard lock(mutex);
          return (*handler)(bytes);
        },
        [this] { cycle_when_drained(); });
    client->set_split(is_split);
    port.clients.push_back({.client = client, .session = nullptr});
    *handler = make_handler(port.clients.back());
    client->read();
  }

  std::string side_reply(const std::string& line) {
    const std::lock_guard lock(mutex);
    if (line == "token") {
      return fmt::format("{}", token);
    }
    if (line == "stop") {
      stop_asked = true;
      return "ok";
    }
    if (line == "state") {
      const TwinView view = twin.view();
      return fmt::format("{:.3f} [{:.6f}] {} {} {}",
                         view.time_s,
                         fmt::join(view.joints_rad.data(), view.joints_rad.data() + 6, ", "),
                         view.is_still ? "still" : "moving",
                         name_of(twin.robot_mode()),
                         name_of(twin.safety_mode()));
    }
    const auto fault =
        line.starts_with("fault ") ? parse_fault(std::string_view(line).substr(6)) : std::nullopt;
    if (!fault) {
      return "error: unknown; there are: token, state, stop, fault KIND [now|moving|still [S]]";
    }
    twin.add_fault(*fault);
    return "ok";
  }

  void wait_for_cycle() {
    if (settings.is_as_fast_as_possible) {
      asio::post(context, [this] { cycle(); });
      return;
    }
    const auto period = std::chrono::duration<double>(1.0 / twin.rate_hz());
    next_cycle += std::chrono::duration_cast<Clock::duration>(period);
    const auto now = Clock::now();
    if (now - next_cycle > std::chrono::milliseconds(100)) {
      next_cycle = now;  // the machine was busy: time that is lost is not caught up with
    }
    timer.expires_at(next_cycle);
    timer.async_wait([this](const error_code& error) {
      if (!error) {
        cycle();
      }
    });
  }

  bool is_busy() const {
    for (const Connected& connected : rtde.clients) {
      if (connected.client->is_open() && connected.client->waiting_bytes() > kBusyWaiting) {
        return true;
      }
    }
    return false;
  }

  void cycle_when_drained() {
    if (settings.is_as_fast_as_possible && is_waiting_for_clients) {
      is_waiting_for_clients = false;
      asio::post(context, [this] { cycle(); });
    }
  }

  void cycle() {
    {
      const std::lock_guard lock(mutex);
      if (settings.is_as_fast_as_possible && is_busy()) {
        is_waiting_for_clients = true;
        return;
      }
      twin.step(settings.speedup / twin.rate_hz());
      publish();
      for (const FaultKind fault : twin.take_network_faults()) {
        apply(fault);
      }
    }
    wait_for_cycle();
  }

  void publish() {
    rtde.drop_closed();
    for (const Connected& connected : rtde.clients) {
      connected.client->send(connected.session->on_cycle());
    }
    for (const PrimaryMessage& message : twin.take_messages()) {
      for (const Connected& listener : primary.clients) {
        listener.client->send(primary_frame(message));
      }
    }
    constexpr double kStatesHz = 10.0;
    state_cycles += 1.0;
    if (state_cycles < twin.rate_hz() / kStatesHz) {
      return;
    }
    state_cycles = 0.0;
    const std::string state =
        primary_state_frame(static_cast<std::uint64_t>(1e6 * twin.view().time_s),
                            twin.robot_mode() == RobotMode::kRunning,
                            twin.is_program_running(),
                            static_cast<std::uint8_t>(twin.robot_mode()));
    for (const Port* port : {&primary, &secondary}) {
      for (const Connected& listener : port->clients) {
        listener.client->send(state);
      }
    }
  }

  void apply(FaultKind fault) {
    if (fault == FaultKind::kSplit || fault == FaultKind::kRelease) {
      is_split = fault == FaultKind::kSplit;
      for (Port* port : {&rtde, &primary, &secondary, &dashboard}) {
        for (const Connected& connected : port->clients) {
          connected.client->set_split(is_split);
        }
      }
      return;
    }
    close_clients();
    if (fault == FaultKind::kRestart) {
      twin.restart();
      reopen_after(std::chrono::seconds(1));
    }
  }

  void reopen_after(Clock::duration wait) {
    for (Port* port : {&rtde, &primary, &secondary, &dashboard}) {
      error_code ignored;
      port->acceptor.close(ignored);
    }
    reopening.expires_after(wait);
    reopening.async_wait([this](const error_code& error) {
      if (!error) {
        reopen();
      }
    });
  }

  /// Somebody else may have taken a port meanwhile, and give it back.
  void reopen() {
    const std::lock_guard lock(mutex);
    try {
      for (Port* port : {&rtde, &primary, &secondary, &dashboard}) {
        listen(*port);
      }
      accept_all();
    } catch (const boost::system::system_error&) {
      reopen_after(std::chrono::milliseconds(200));
    }
  }

  void close_clients() {
    for (Port* port : {&rtde, &primary, &secondary, &dashboard}) {
      port->close_all();
    }
  }

  TwinServerSettings settings;
  std::uint64_t token = 0;
  TwinController twin;
  HeldInputs held;
  asio::io_context context;
  Port rtde;
  Port primary;
  Port secondary;
  Port dashboard;
  asio::steady_timer timer;
  asio::steady_timer reopening;
  Clock::time_point next_cycle;
  double state_cycles = 0.0;
  bool is_split = false;
  bool is_waiting_for_clients = false;
  std::atomic<bool> stop_asked = false;
  std::atomic<std::uint64_t> num_command_bytes = 0;
  mutable std::mutex mutex;
  std::thread thread;
  std::optional<SideChannel> side;  ///< last: what it tells is still there when it ends
};

TwinServer::TwinServer(TwinServerSettings settings)
    : impl_(std::make_unique<Impl>(std::move(settings))) {
  impl_->thread = std::thread([impl = impl_.get()] { impl->context.run(); });
}

TwinServer::~TwinServer() {
  impl_->context.stop();
  impl_->thread.join();
}

const TwinPorts& TwinServer::ports() const {
  return impl_->settings.ports;
}

std::uint64_t TwinServer::token() const {
  return impl_->token;
}

const std::filesystem::path& TwinServer::side_channel() const {
  return impl_->side->path();
}

void TwinServer::add_fault(const Fault& fault) {
  const std::lock_guard lock(impl_->mutex);
  impl_->twin.add_fault(fault);
}

void TwinServer::hold_motion(bool is_held) {
  const std::lock_guard lock(impl_->mutex);
  impl_->twin.hold_motion(is_held);
}

TwinView TwinServer::view() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->twin.view();
}

bool TwinServer::is_stop_asked() const {
  return impl_->stop_asked;
}

std::uint64_t TwinServer::num_command_bytes() const {
  return impl_->num_command_bytes;
}

std::set<std::string> TwinServer::inputs_written() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->twin.inputs_written();
}

}  // namespace glint
