// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/log.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <spdlog/logger.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

#include "core/error.h"

namespace glint {
namespace {

spdlog::level::level_enum spdlog_level(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

std::shared_ptr<spdlog::logger> make_logger(const LogSettings& settings) {
  std::vector<spdlog::sink_ptr> sinks;
  if (settings.to_stderr) {
    auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    sink->set_level(spdlog_level(settings.stderr_level));
    sink->set_pattern("%l: %v");
    sinks.push_back(sink);
  }
  for (const std::filesystem::path& file : settings.files) {
    auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string());
    sink->set_level(spdlog::level::info);
    sink->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
    sinks.push_back(sink);
  }
  auto logger = std::make_shared<spdlog::logger>("glint", sinks.begin(), sinks.end());
  logger->set_level(spdlog::level::debug);
  logger->flush_on(spdlog::level::info);
  return logger;
}

std::shared_ptr<spdlog::logger>& the_logger() {
  static std::shared_ptr<spdlog::logger> logger = make_logger({});
  return logger;
}

/// A line as the pattern of files makes it: "2026-03-04 05:06:07.008 info: ".
bool is_log_line(const std::string& line) {
  constexpr std::string_view kStamp = "dddd-dd-dd dd:dd:dd.ddd ";
  return line.size() > kStamp.size() &&
         std::equal(kStamp.begin(), kStamp.end(), line.begin(), [](char wanted, char is) {
           return wanted == 'd' ? is >= '0' && is <= '9' : wanted == is;
         });
}

}  // namespace

void check_log_file(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::filesystem::path folder = file.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    throw IoError(file.string() + ": the log cannot be written: there is no folder " +
                  folder.string());
  }
  std::string line;
  if (std::filesystem::is_regular_file(file, ignored)) {
    std::ifstream in(file);
    if (std::getline(in, line) && !is_log_line(line)) {
      throw ConfigError(file.string() +
                        ": exists and is no log of glint; give the log another name");
    }
  }
}

void configure_log(const LogSettings& settings) {
  try {
    the_logger() = make_logger(settings);
  } catch (const spdlog::spdlog_ex& error) {
    throw IoError(std::string("log: ") + error.what());
  }
}

void log_text(LogLevel level, std::string_view text) {
  the_logger()->log(spdlog_level(level), text);
}

}  // namespace glint
