// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace glint {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// Where log lines go; set once by the program before any work starts.
struct LogSettings {
  bool to_stderr = true;
  LogLevel stderr_level = LogLevel::kWarning;
  std::vector<std::filesystem::path> files;  ///< everything from kInfo upwards goes there
};

/// Asks whether a log may be added to a file: it is a log already, is empty, or can come to be in a
/// folder that is there. @throws ConfigError for a file of another kind, IoError for no folder
void check_log_file(const std::filesystem::path& file);

/// @throws IoError when the log file cannot be opened.
void configure_log(const LogSettings& settings);

/// Adds a line to the log; the text is one sentence without a full stop.
void log_text(LogLevel level, std::string_view text);

template <class... Args>
void log(LogLevel level, fmt::format_string<Args...> format, Args&&... args) {
  log_text(level, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace glint
