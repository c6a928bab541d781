// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint::peers {

/// CPU seconds (user + system) this process has used, all threads.
double cpu_seconds();

/// Runs a program without a shell and waits. Output and errors go to the log.
/// @return CPU seconds (user + system) of the process, all threads
/// @throws Error when it cannot be run or fails; the message names the log
double run_program(const std::vector<std::string>& arguments,
                   const std::filesystem::path& folder,
                   const std::filesystem::path& log);

/// Runs a Python script in Blender on one thread, without window and sound.
/// @param job  the script's argument
/// @return CPU seconds as run_program(), which also throws
double run_blender(const std::filesystem::path& script,
                   const std::filesystem::path& job,
                   const std::filesystem::path& folder,
                   const std::filesystem::path& log);

/// The program's place on PATH; empty when it is not installed.
std::filesystem::path find_program(const std::string& name);

}  // namespace glint::peers
