// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/log.h"

#include <memory>
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

}  // namespace

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
