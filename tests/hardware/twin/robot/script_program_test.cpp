// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/script_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

TEST(ParseStatement, ReadsNumbersListsPosesAndNames) {
  const ParsedLine parsed =
      parse_statement("  movej([1, -2.5, 3e-1, 0, 0, 0], a=1.4, v = 0.5) # go");
  ASSERT_TRUE(parsed.statement.has_value()) << parsed.error;
  EXPECT_EQ(parsed.statement->function, "movej");
  EXPECT_EQ(parsed.statement->arguments[0].numbers[1], -2.5);
  EXPECT_EQ(parsed.statement->number("v", 2, 0.0), 0.5);
  EXPECT_EQ(parsed.statement->number("t", 3, 7.0), 7.0);
  const ParsedLine pose = parse_statement("movel(p[0.1,0.2,0.3,0,0,0],1.2,0.25)");
  ASSERT_TRUE(pose.statement.has_value());
  EXPECT_EQ(pose.statement->arguments[0].kind, ScriptArgument::Kind::kPose);
  EXPECT_EQ(pose.statement->number("v", 2, 0.0), 0.25);
  EXPECT_TRUE(parse_statement("set_digital_out(1, True)").statement.has_value());
  EXPECT_TRUE(parse_statement("textmsg(\"a, b\")").statement.has_value());
}

TEST(ParseStatement, RefusesWhatItDoesNotKnow) {
  for (const char* line : {"movej(",
                           "movej()",
                           "movej([1,2,3])",
                           "movej([1,2,3,4,5,x])",
                           "movel([1,2,3,4,5,6])",
                           "movep(p[0,0,0,0,0,0])",
                           "while True:",
                           "x = 3",
                           "x = run 3()()",
                           "run beat()",
                           "kill",
                           "movej([1,2,3,4,5,6,7])",
                           "popup(1)",
                           "movej([nan,0,0,0,0,0])",
                           "movej([1,2,3,4,5,6]))",
                           "sleep([1])"}) {
    const ParsedLine parsed = parse_statement(line);
    EXPECT_FALSE(parsed.statement.has_value()) << line;
    EXPECT_FALSE(parsed.error.empty()) << line;
  }
  EXPECT_TRUE(parse_statement("  # a comment").error.empty());
}

TEST(ScriptReader, CollectsProgramsAndSingleLines) {
  ScriptReader reader;
  EXPECT_FALSE(reader.add_line("def prog():").has_value());
  EXPECT_FALSE(reader.add_line("  sleep(1)").has_value());
  const auto program = reader.add_line("end");
  ASSERT_TRUE(program.has_value() && program->program.has_value());
  EXPECT_EQ(program->program->name, "prog");
  EXPECT_FALSE(program->program->is_secondary);
  EXPECT_EQ(program->program->statements.size(), 1U);
  const auto line = reader.add_line("stopj(2)");
  ASSERT_TRUE(line.has_value() && line->program.has_value());
  reader.add_line("sec light():");
  EXPECT_TRUE(reader.add_line("end")->program->is_secondary);
}

std::optional<ScriptReader::Result> read(std::initializer_list<const char*> lines) {
  ScriptReader reader;
  std::optional<ScriptReader::Result> result;
  for (const char* line : lines) {
    result = reader.add_line(line);
  }
  return result;
}

TEST(ScriptReader, CollectsThreads) {
  const auto result = read({"def prog():",
                            "  thread beat():",
                            "    while True:",
                            "      sleep(1)",
                            "    end",
                            "  end",
                            "  thread once():",
                            "    sleep(1)",
                            "    sleep(2)",
                            "  end",
                            "  b = run beat()",
                            "  kill b",
                            "end"});
  ASSERT_TRUE(result.has_value() && result->program.has_value());
  const ScriptProgram& program = *result->program;
  ASSERT_EQ(program.threads.size(), 2U);
  EXPECT_TRUE(program.threads[0].is_loop);
  EXPECT_EQ(program.threads[0].statements.size(), 1U);
  EXPECT_EQ(program.threads[1].name, "once");
  EXPECT_FALSE(program.threads[1].is_loop);
  EXPECT_EQ(program.threads[1].statements.size(), 2U);
  ASSERT_EQ(program.statements.size(), 2U);
  EXPECT_EQ(program.statements[0].arguments[0].name, "beat");
  EXPECT_EQ(program.statements[1].arguments[0].name, "b");
}

TEST(ScriptReader, RefusesBlocksWhereTheyMayNotStand) {
  for (const auto& result :
       {read({"def p():", "while True:", "end"}),
        read({"def p():", "thread a():", "thread b():", "end", "end"}),
        read({"def p():", "thread a():", "sleep(1)", "while True:", "end", "end"}),
        read({"def p():", "thread a():", "while True:", "end", "sleep(1)", "end", "end"})}) {
    ASSERT_TRUE(result.has_value());
    EXPECT_NE(result->error, "");
  }
}

TEST(ScriptReader, AProgramWithAnErrorIsDroppedAsAWhole) {
  ScriptReader reader;
  reader.add_line("def prog():");
  reader.add_line("  fly(1)");
  reader.add_line("  sleep(1)");
  const auto result = reader.add_line("end");
  ASSERT_TRUE(result.has_value());
  EXPECT_FALSE(result->program.has_value());
  EXPECT_THAT(result->error, testing::HasSubstr("fly"));
}

TEST(ScriptReader, KeepsNoEndlessProgram) {
  ScriptReader reader;
  reader.add_line("def prog():");
  std::optional<ScriptReader::Result> result;
  for (int i = 0; i < 100000 && !result; ++i) {
    result = reader.add_line("  sleep(1)");
  }
  ASSERT_TRUE(result.has_value());
  EXPECT_THAT(result->error, testing::HasSubstr("65536"));
}

TEST(ScriptReader, SurvivesAnyBytes) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(1, Stream::kTest, i);
    ScriptReader reader;
    constexpr std::string_view kBytes = "movejlp[](),=.0123456789 \"#defsc:end-+";
    for (int line = 0; line < 5; ++line) {
      std::string text;
      for (int k = 0; k < 40; ++k) {
        text += kBytes[rng.next_u32() % kBytes.size()];
      }
      reader.add_line(text);
    }
  }
}

}  // namespace
}  // namespace glint
