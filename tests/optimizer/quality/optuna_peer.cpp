// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/optuna_peer.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>

namespace glint::quality {
namespace {

using Json = nlohmann::json;

Json described(const SearchSpace& space) {
  Json variables = Json::array();
  for (const Variable& variable : space.variables) {
    std::vector<std::string> values = variable.when_others;
    values.push_back(variable.when_value);
    variables.push_back(Json::object({{"name", variable.name},
                                      {"low", variable.low},
                                      {"high", variable.high},
                                      {"log", variable.is_log},
                                      {"integer", variable.kind == Variable::Kind::kInteger},
                                      {"choices", variable.choices},
                                      {"when", variable.when_name},
                                      {"values", values}}));
  }
  return variables;
}

}  // namespace

OptunaPeer::OptunaPeer(const SearchSpace& space, const std::string& sampler, std::uint64_t seed)
    : space_(space) {
  start(
      Json::object({{"sampler", sampler}, {"seed", seed}, {"variables", described(space)}}).dump());
}

OptunaPeer::~OptunaPeer() {
  end();
}

void OptunaPeer::end() {
  std::fclose(to_);  // the process ends with its input, after the question that it is at
  while (std::fgetc(from_) != EOF) {
  }
  std::fclose(from_);
  if (process_ > 0) {
    ::waitpid(process_, nullptr, 0);
  }
}

void OptunaPeer::start(const std::string& study) {
  std::array<int, 2> to = {};
  std::array<int, 2> from = {};
  GLINT_CHECK(::pipe2(to.data(), O_CLOEXEC) == 0 && ::pipe2(from.data(), O_CLOEXEC) == 0, "pipes");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to[0], 0);
  posix_spawn_file_actions_adddup2(&actions, from[1], 1);
  std::string program = "/usr/bin/python3";  // the one that Debian's packages are for
  std::string script = GLINT_OPTUNA_PEER;
  std::string argument = study;
  std::array<char*, 4> words = {program.data(), script.data(), argument.data(), nullptr};
  const int failure =
      ::posix_spawn(&process_, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(to[0]);
  ::close(from[1]);
  to_ = ::fdopen(to[1], "w");
  from_ = ::fdopen(from[0], "r");
  const Json first =
      failure == 0 ? Json::parse(read_line()) : Json::object({{"missing", "python3"}});
  if (first.contains("missing")) {
    end();
    throw PeerMissing(first["missing"].get<std::string>() +
                      " is not installed: script/bootstrap --peers");
  }
}

std::string OptunaPeer::read_line() {
  std::string line;
  for (int c = std::fgetc(from_); c != '\n'; c = std::fgetc(from_)) {
    if (c == EOF) {
      throw IoError("Optuna ended before the search did");
    }
    line += static_cast<char>(c);
  }
  return line;
}

Point OptunaPeer::ask() {
  const Json x = Json::parse(read_line()).at("x");
  Point point;
  for (const Json& value : x) {
    point.push_back(value.is_null() ? 0.0 : value.get<double>());  // canonical() sets the inactive
  }
  return canonical(space_, point);
}

void OptunaPeer::tell(double value) {
  const std::string line = Json::object({{"value", value}}).dump() + "\n";
  std::fputs(line.c_str(), to_);
  std::fflush(to_);
}

}  // namespace glint::quality
