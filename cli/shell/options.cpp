// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/options.h"

#include <limits>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace glint {

CLI::Validator between(int min, int max) {
  return CLI::Range(min, max).description(fmt::format("{} to {}", min, max));
}

CLI::Validator not_empty() {
  return {[](const std::string& text) {
            return text.empty() ? std::string("is empty, must be a name") : std::string();
          },
          ""};
}

CLI::Option* add_out(CLI::App& verb, std::filesystem::path& out, const std::string& what) {
  return verb.add_option("--out", out, what)->type_name("DIR")->check(not_empty());
}

void add_seed(CLI::App& verb, std::optional<int>& seed, const std::string& what) {
  verb.add_option("--seed", seed, what)
      ->type_name("N")
      ->check(between(0, std::numeric_limits<int>::max()));
}

void add_jobs(CLI::App& verb, int& jobs, const std::string& what) {
  verb.add_option("--jobs", jobs, what)->type_name("N")->check(between(1, 1024));
}

}  // namespace glint
