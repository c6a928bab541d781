// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/driven_session.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>

#include "cli/shell/interrupts.h"
#include "studies/cell/ready_file.h"

namespace glint {
namespace {

/// A question to whoever sits at the terminal.
bool ask_person(const std::string& what) {
  std::cerr << what << " - done? [y/N] " << std::flush;
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
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
    options.confirm = ask_person;
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
