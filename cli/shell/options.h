// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that several verbs take.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace glint {

/// A whole number from min to max.
CLI::Validator between(int min, int max);

/// A finite number from min to max.
CLI::Validator between(double min, double max);

/// A finite number above 0.
CLI::Validator positive(const std::string& remark = "> 0");

/// A name that is empty is a slip: a variable of the shell that is not set.
CLI::Validator not_empty();

/// --out DIR
CLI::Option* add_out(CLI::App& verb, std::filesystem::path& out, const std::string& what);

/// --seed N, from 0
void add_seed(CLI::App& verb, std::optional<int>& seed, const std::string& what);

/// --jobs N, from 1 to 1024
void add_jobs(CLI::App& verb, int& jobs, const std::string& what);

}  // namespace glint
