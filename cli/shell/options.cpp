// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/options.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace glint {
namespace {

/// CLI11's own ranges let nan pass, and tell the largest double as a limit.
CLI::Validator number_that(const std::function<bool(double)>& is_allowed,
                           const std::string& allowed,
                           const std::string& remark) {
  return {[=](const std::string& text) {
            double number = 0.0;
            const char* end = text.data() + text.size();
            const auto [rest, error] = std::from_chars(text.data(), end, number);
            const bool is_number = error == std::errc() && rest == end && std::isfinite(number);
            return is_number && is_allowed(number)
                       ? std::string()
                       : fmt::format("is {}, must be {}", text, allowed);
          },
          remark};
}

}  // namespace

CLI::Validator between(int min, int max) {
  return CLI::Range(min, max).description(fmt::format("{} to {}", min, max));
}

CLI::Validator between(double min, double max) {
  const std::string range = fmt::format("{:g} to {:g}", min, max);
  return number_that([=](double number) { return number >= min && number <= max; },
                     "a number from " + range,
                     range);
}

CLI::Validator positive(const std::string& remark) {
  return number_that([](double number) { return number > 0.0; }, "a number > 0", remark);
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
