// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/driven_session.h"

#include <poll.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "cli/shell/interrupts.h"
#include "studies/cell/ready_file.h"

namespace glint {
namespace {

/// A line of the terminal, without its end; none: it was closed, or the user wants it all to end.
std::optional<std::string> line_of_terminal(const std::atomic<int>& interrupts) {
  constexpr int kPatienceMs = 100;
  std::string line;
  while (interrupts == 0) {
    pollfd waiting = {.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (::poll(&waiting, 1, kPatienceMs) <= 0) {
      continue;  // nothing was typed so far, or a signal came
    }
    std::array<char, 256> typed = {};
    const ssize_t count = ::read(STDIN_FILENO, typed.data(), typed.size());
    if (count == 0 || (count < 0 && errno != EINTR)) {
      return std::nullopt;
    }
    line.append(typed.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (const std::size_t end = line.find('\n'); end != std::string::npos) {
      return line.substr(0, end);
    }
  }
  return std::nullopt;
}

/// A question to whoever sits at the terminal; Ctrl-C is no.
bool ask_person(const std::string& what, const std::atomic<int>& interrupts) {
  std::cerr << what << " - done? [y/N] " << std::flush;
  const std::optional<std::string> answer = line_of_terminal(interrupts);
  if (!answer) {
    std::cerr << '\n';
  }
  return answer == "y" || answer == "yes";
}

}  // namespace

Cell driven_cell(const AcquireArguments& arguments) {
  Cell cell = read_cell(arguments.cell);
  return arguments.twin.empty() ? cell
                                : with_ports(std::move(cell), arguments.twin, DrivenDevices::kAll);
}

AcquireOptions driven_options(const AcquireArguments& arguments) {
  // Before anything else is read. A round of glint calibrate that has all its pictures needs no
  // twins any more: there the file may be gone, and elsewhere that is told later.
  if (!arguments.twin.empty() && std::filesystem::exists(arguments.twin)) {
    driven_cell(arguments);
  }
  return {.source = arguments.source,
          .cell = arguments.cell,
          .out = arguments.out,
          .twin = arguments.twin,
          .speed_share = arguments.speed_share,
          .confirmed = arguments.confirmed,
          .mounted = arguments.mounted};
}

DrivenSession::DrivenSession(bool is_silent)
    : is_silent_(is_silent), interrupts_(take_interrupts()) {
  keep_attending();
}

void DrivenSession::attend(AcquireOptions& options) {
  if (::isatty(STDIN_FILENO) != 0) {
    options.confirm = [this](const std::string& what) { return ask_person(what, interrupts_); };
  }
  lights_ = ConfirmedLights(options.confirmed);
  options.lights = &lights_;
  options.interrupt = &interrupts_;
  options.progress = [this](int done, int total, const std::string& note) {
    if (!bar_) {
      bar_ =
          std::make_unique<Progress>("acquire",
                                     std::max(1, total),
                                     is_silent_ ? Progress::Style::kNone : Progress::Style::kAuto);
    }
    bar_->update(done, note);
    if (done >= total) {
      bar_.reset();  // the next round has one of its own
    }
  };
}

}  // namespace glint
