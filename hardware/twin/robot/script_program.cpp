// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/script_program.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr std::size_t kMaxArguments = 8;
constexpr std::size_t kMaxNumbers = 6;

/// A function of the subset and what its first argument must be.
struct KnownFunction {
  std::string_view name;
  std::size_t min_arguments;
};

constexpr std::array<KnownFunction, 11> kFunctions = {{
    {"movej", 1},
    {"movel", 1},
    {"stopj", 1},
    {"stopl", 1},
    {"sleep", 1},
    {"set_tcp", 1},
    {"set_payload", 1},
    {"write_output_integer_register", 2},
    {"set_digital_out", 2},
    {"set_standard_digital_out", 2},
    {"textmsg", 0},
}};

std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_space(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_space(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

bool is_name(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Cuts a text at commas that no bracket and no quote encloses.
std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  int depth = 0;
  bool is_quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    is_quoted = text[i] == '"' ? !is_quoted : is_quoted;
    depth += is_quoted ? 0 : text[i] == '[' ? 1 : text[i] == ']' ? -1 : 0;
    if (text[i] == ',' && depth == 0 && !is_quoted) {
      parts.push_back(trimmed(text.substr(begin, i - begin)));
      begin = i + 1;
    }
  }
  if (!trimmed(text).empty()) {
    parts.push_back(trimmed(text.substr(begin)));
  }
  return parts;
}

std::optional<double> number_of(std::string_view text) {
  if (text == "True" || text == "False") {
    return text == "True" ? 1.0 : 0.0;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool take_list(std::string_view text, ScriptArgument& argument) {
  const bool is_pose = text.starts_with("p[");
  const std::size_t head = is_pose ? 2 : 1;
  if (text.size() < head + 1 || text.back() != ']') {
    return false;
  }
  argument.kind = is_pose ? ScriptArgument::Kind::kPose : ScriptArgument::Kind::kList;
  for (const std::string_view part : parts_of(text.substr(head, text.size() - head - 1))) {
    const auto value = number_of(part);
    if (!value || argument.numbers.size() == kMaxNumbers) {
      return false;
    }
    argument.numbers.push_back(*value);
  }
  return !is_pose || argument.numbers.size() == 6;
}

std::optional<ScriptArgument> argument_of(std::string_view text) {
  ScriptArgument argument;
  if (text.starts_with('"')) {
    argument.kind = ScriptArgument::Kind::kText;
    return text.size() >= 2 && text.ends_with('"') ? std::optional(argument) : std::nullopt;
  }
  const std::size_t equals = text.find('=');
  if (equals != std::string_view::npos) {
    argument.name = trimmed(text.substr(0, equals));
    text = trimmed(text.substr(equals + 1));
    if (!is_name(argument.name)) {
      return std::nullopt;
    }
  }
  if (text.starts_with('[') || text.starts_with("p[")) {
    return take_list(text, argument) ? std::optional(argument) : std::nullopt;
  }
  const auto value = number_of(text);
  if (!value) {
    return std::nullopt;
  }
  argument.numbers = {*value};
  return argument;
}

/// What the first argument of a motion or setting must look like.
bool has_right_target(const ScriptStatement& statement) {
  using Kind = ScriptArgument::Kind;
  const ScriptArgument* first = statement.arguments.empty() ? nullptr : &statement.arguments[0];
  if (statement.function == "movej") {
    return first->numbers.size() == 6 && first->kind != Kind::kNumber;
  }
  if (statement.function == "movel" || statement.function == "set_tcp") {
    return first->kind == Kind::kPose;
  }
  return first == nullptr || first->kind == Kind::kNumber || first->kind == Kind::kText;
}

/// The name of "def name():"; empty: the line is none.
std::string_view head_name(std::string_view line, std::string_view keyword) {
  if (!line.starts_with(keyword) || !line.ends_with("():") || line.size() <= keyword.size() + 3) {
    return {};
  }
  const std::string_view name =
      trimmed(line.substr(keyword.size(), line.size() - keyword.size() - 3));
  return is_name(name) ? name : std::string_view();
}

ScriptStatement thread_statement(std::string_view function,
                                 std::initializer_list<std::string_view> names) {
  ScriptStatement statement = {.function = std::string(function), .arguments = {}};
  for (const std::string_view name : names) {
    statement.arguments.push_back({.kind = ScriptArgument::Kind::kText,  //
                                   .name = std::string(name),
                                   .numbers = {}});
  }
  return statement;
}

/// "x = run beat()", "kill x"; none: another statement.
std::optional<ScriptStatement> parse_thread_statement(std::string_view line) {
  constexpr std::string_view kKill = "kill ";
  constexpr std::string_view kRun = "run ";
  if (line.starts_with(kKill) && is_name(trimmed(line.substr(kKill.size())))) {
    return thread_statement("kill", {trimmed(line.substr(kKill.size()))});
  }
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view variable = trimmed(line.substr(0, equals));
  std::string_view call = trimmed(line.substr(equals + 1));
  if (!is_name(variable) || !call.starts_with(kRun) || !call.ends_with("()")) {
    return std::nullopt;
  }
  call = trimmed(call.substr(kRun.size(), call.size() - kRun.size() - 2));
  return is_name(call) ? std::optional(thread_statement("run", {call, variable})) : std::nullopt;
}

std::string_view without_comment(std::string_view line) {
  return trimmed(line.substr(0, line.find('#')));
}

}  // namespace

const ScriptArgument* ScriptStatement::find(std::string_view name, std::size_t place) const {
  const auto named = std::ranges::find(arguments, name, &ScriptArgument::name);
  if (named != arguments.end() && !name.empty()) {
    return &*named;
  }
  return place < arguments.size() && arguments[place].name.empty() ? &arguments[place] : nullptr;
}

double ScriptStatement::number(std::string_view name, std::size_t place, double otherwise) const {
  const ScriptArgument* argument = find(name, place);
  return argument != nullptr && argument->numbers.size() == 1 ? argument->numbers[0] : otherwise;
}

ParsedLine parse_statement(std::string_view line) {
  line = without_comment(line);
  if (line.empty()) {
    return {};
  }
  if (auto of_thread = parse_thread_statement(line)) {
    return {.statement = std::move(of_thread), .error = ""};
  }
  const std::size_t open = line.find('(');
  if (open == std::string_view::npos || line.back() != ')' || !is_name(line.substr(0, open))) {
    return {.statement = {}, .error = "syntax error"};
  }
  ScriptStatement statement = {.function = std::string(line.substr(0, open)), .arguments = {}};
  const auto known =
      std::ranges::find(kFunctions, std::string_view(statement.function), &KnownFunction::name);
  if (known == kFunctions.end()) {
    return {.statement = {},
            .error = fmt::format("unknown function {}", statement.function.substr(0, 40))};
  }
  for (const std::string_view part : parts_of(line.substr(open + 1, line.size() - open - 2))) {
    const auto argument = argument_of(part);
    if (!argument || statement.arguments.size() == kMaxArguments) {
      return {.statement = {}, .error = fmt::format("{}: wrong argument", statement.function)};
    }
    statement.arguments.push_back(*argument);
  }
  if (statement.arguments.size() < known->min_arguments || !has_right_target(statement)) {
    return {.statement = {}, .error = fmt::format("{}: wrong arguments", statement.function)};
  }
  return {.statement = std::move(statement), .error = ""};
}

/// A line that opens a thread or its loop, or closes one. @return it was one
bool ScriptReader::change_block(std::string_view text) {
  const std::string_view thread = head_name(text, "thread ");
  if (block_ == Block::kProgram && !thread.empty()) {
    program_.threads.push_back({.name = std::string(thread), .statements = {}});
    block_ = Block::kThread;
  } else if (block_ == Block::kThread && text == "while True:" &&
             program_.threads.back().statements.empty()) {
    program_.threads.back().is_loop = true;
    block_ = Block::kLoop;
  } else if (block_ != Block::kProgram && text == "end") {
    block_ = block_ == Block::kLoop ? Block::kThread : Block::kProgram;
  } else {
    return false;
  }
  return true;
}

void ScriptReader::add_statement(ScriptStatement statement) {
  if (block_ == Block::kProgram) {
    program_.statements.push_back(std::move(statement));
  } else if (block_ == Block::kThread && program_.threads.back().is_loop) {
    error_ = "a statement after an endless loop";
  } else {
    program_.threads.back().statements.push_back(std::move(statement));
  }
}

std::optional<ScriptReader::Result> ScriptReader::add_line(std::string_view line) {
  const std::string_view text = without_comment(line);
  if (!is_inside_) {
    const std::string_view def = head_name(text, "def ");
    const std::string_view sec = head_name(text, "sec ");
    if (!def.empty() || !sec.empty()) {
      program_ = {.name = std::string(def.empty() ? sec : def),
                  .is_secondary = def.empty(),
                  .statements = {}};
      error_.clear();
      bytes_ = 0;
      is_inside_ = true;
      return std::nullopt;
    }
    if (text.empty()) {
      return std::nullopt;
    }
    program_ = {.name = "", .is_secondary = false, .statements = {}};
  }
  bytes_ += line.size();
  if (bytes_ > kMaxBytes) {
    error_ = fmt::format("a program of more than {} bytes", kMaxBytes);
    return finish();
  }
  if (is_inside_ && change_block(text)) {
    return std::nullopt;
  }
  return is_inside_ && text == "end" ? std::optional(finish()) : add_text(text);
}

/// A statement within a program, or one that is a program of its own.
std::optional<ScriptReader::Result> ScriptReader::add_text(std::string_view text) {
  ParsedLine parsed = parse_statement(text);
  if (!parsed.error.empty() && error_.empty()) {
    error_ = std::move(parsed.error);
  }
  if (parsed.statement) {
    add_statement(std::move(*parsed.statement));
  }
  return is_inside_ ? std::nullopt : std::optional(finish());
}

ScriptReader::Result ScriptReader::finish() {
  is_inside_ = false;
  block_ = Block::kProgram;
  bytes_ = 0;
  Result result;
  result.error = std::exchange(error_, {});
  if (result.error.empty()) {
    result.program = std::move(program_);
  }
  program_ = {};
  return result;
}

}  // namespace glint
