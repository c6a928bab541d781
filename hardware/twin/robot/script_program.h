// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part of URScript that the twin runs: one statement to a line, numbers for arguments.
//
//     def name():                                       sec name(): runs beside a program
//       movej([q1 ... q6], a=1.4, v=1.05)               joints in rad, or p[x, y, z, rx, ry, rz] in
//       m movel(p[...], a=1.2, v=0.25) stopj(2)  stopl(2)  sleep(0.5) set_tcp(p[...])
//       set_payload(1.2, [0, 0, 0.05]) write_output_integer_register(0, 17)  set_digital_out(1,
//       True)  textmsg("...")
//       thread beat():                                a thread of this program, which moves
//       nothing;
//         while True:                               with or without the loop around all of it
//           write_output_integer_register(0, 1)
//           sleep(0.1)
//         end
//       end
//       beats = run beat()
//       kill beats
//     end
//
// A line outside def and sec is a program of its own.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace glint {

/// One argument: a number (booleans are 0 and 1), a list of numbers, or a pose p[...].
struct ScriptArgument {
  enum class Kind { kNumber, kList, kPose, kText };

  Kind kind = Kind::kNumber;
  std::string name;  ///< of "a=1.4"; empty: by its place
  std::vector<double> numbers;
};

struct ScriptStatement {
  std::string function;
  std::vector<ScriptArgument> arguments;

  /// The argument of that name, else the one at that place; none: neither is there.
  const ScriptArgument* find(std::string_view name, std::size_t place) const;

  /// The same as a number.
  double number(std::string_view name, std::size_t place, double otherwise) const;
};

struct ScriptThread {
  std::string name;
  bool is_loop = false;
  std::vector<ScriptStatement> statements;
};

/// "x = run beat()" has the arguments named beat and x, "kill x" the one named x.
struct ScriptProgram {
  std::string name;
  bool is_secondary = false;
  std::vector<ScriptStatement> statements;
  std::vector<ScriptThread> threads = {};
};

/// A line of the subset; a text says what is wrong: of another language, unknown function, wrong
/// number of numbers.
struct ParsedLine {
  std::optional<ScriptStatement> statement;  ///< none for an empty line and for an error
  std::string error;
};

ParsedLine parse_statement(std::string_view line);

/// Collects lines into programs. Keeps at most 64 kB.
class ScriptReader {
 public:
  static constexpr std::size_t kMaxBytes = 65536;

  struct Result {
    std::optional<ScriptProgram> program;
    std::string error;  ///< compile error; the program is dropped
  };

  /// @return none: more lines are needed
  std::optional<Result> add_line(std::string_view line);

 private:
  enum class Block { kProgram, kThread, kLoop };

  Result finish();
  bool change_block(std::string_view text);
  std::optional<Result> add_text(std::string_view text);
  void add_statement(ScriptStatement statement);

  bool is_inside_ = false;
  Block block_ = Block::kProgram;  ///< the innermost that is open
  std::size_t bytes_ = 0;
  ScriptProgram program_;
  std::string error_;
};

}  // namespace glint
