// SPDX-License-Identifier: GPL-3.0-or-later
//
// Commands and replies of the dashboard server (TCP 29999): lines of text, one reply to a command.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace glint {

/// Commands that only ask. Every other one changes the controller's state.
bool is_query(std::string_view command);

/// "Robotmode: RUNNING" -> "RUNNING", "Program running: true" -> "true"; a reply without a name and
/// a colon is returned whole.
std::string value_of_reply(std::string_view reply);

/// "true", "Program running: false"; none for another text.
std::optional<bool> flag_of_reply(std::string_view reply);

/// Why a controller that answers so to "is in remote control" takes no scripts: it is off, or the
/// reply does not tell. Empty: it takes them.
std::string remote_control_problem(std::string_view reply);

/// The controller did what it was told: the reply does not say "failed", "could not" or "not
/// allowed".
bool is_success(std::string_view reply);

}  // namespace glint
