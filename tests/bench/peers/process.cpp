// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"

namespace glint::peers {
namespace {

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// In the child: never returns.
[[noreturn]] void become(const std::vector<std::string>& arguments,
                         const std::filesystem::path& folder,
                         const std::filesystem::path& log) {
  const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  const int in = open("/dev/null", O_RDONLY | O_CLOEXEC);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) {
    argv.push_back(const_cast<char*>(argument.c_str()));
  }
  argv.push_back(nullptr);
  if (out >= 0 && in >= 0 && chdir(folder.c_str()) == 0 && dup2(in, STDIN_FILENO) >= 0 &&
      dup2(out, STDOUT_FILENO) >= 0 && dup2(out, STDERR_FILENO) >= 0) {
    execvp(argv.front(), argv.data());
  }
  _exit(127);
}

}  // namespace

double cpu_seconds() {
  timespec time = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double run_program(const std::vector<std::string>& arguments,
                   const std::filesystem::path& folder,
                   const std::filesystem::path& log) {
  const pid_t child = fork();
  if (child < 0) {
    throw Error("cannot start a process: " + last_system_error());
  }
  if (child == 0) {
    become(arguments, folder, log);
  }
  int status = 0;
  rusage usage = {};
  if (wait4(child, &status, 0, &usage) != child) {
    throw Error("cannot wait for a process: " + last_system_error());
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw Error(fmt::format("{} failed; its output is in {}", arguments.front(), log.string()));
  }
  return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

double run_blender(const std::filesystem::path& script,
                   const std::filesystem::path& job,
                   const std::filesystem::path& folder,
                   const std::filesystem::path& log) {
  return run_program({"blender",
                      "-noaudio",
                      "--factory-startup",
                      "-b",
                      "-t",
                      "1",
                      "--python-exit-code",
                      "1",
                      "-P",
                      script.string(),
                      "--",
                      job.string()},
                     folder,
                     log);
}

std::filesystem::path find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path == nullptr ? "" : path, ':')) {
    std::filesystem::path candidate = std::filesystem::path(folder) / name;
    if (!folder.empty() && access(candidate.c_str(), X_OK) == 0) {
      return candidate;
    }
  }
  return {};
}

}  // namespace glint::peers
