// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Log, ShowsWarningsOnStderrAndKeepsInfoInTheFile) {
  const TemporaryFolder folder;
  testing::internal::CaptureStderr();
  configure_log(
      {.to_stderr = true, .stderr_level = LogLevel::kWarning, .files = {folder / "log.txt"}});
  log(LogLevel::kDebug, "detail {}", 1);
  log(LogLevel::kInfo, "step {}", 2);
  log(LogLevel::kWarning, "odd {}", 3);
  log(LogLevel::kError, "bad {}", 4);
  configure_log({});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: odd 3\nerror: bad 4\n");
  const std::string kept = read_file(folder / "log.txt");
  EXPECT_THAT(kept, HasSubstr(" info: step 2\n"));
  EXPECT_THAT(kept, HasSubstr(" warning: odd 3\n"));
  EXPECT_THAT(kept, HasSubstr(" error: bad 4\n"));
  EXPECT_THAT(kept, Not(HasSubstr("detail")));
}

TEST(Log, TakesTextWithBracesAsItIs) {
  testing::internal::CaptureStderr();
  configure_log({.stderr_level = LogLevel::kInfo});
  log_text(LogLevel::kInfo, "a {} b {x}");
  configure_log({});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "info: a {} b {x}\n");
}

TEST(ConfigureLog, SaysWhenTheFileCannotBeOpened) {
  const TemporaryFolder folder;
  write_file(folder / "plain", "x");
  EXPECT_THAT(
      text_thrown_by<IoError>([&] { configure_log({.files = {folder / "plain" / "log"}}); }),
      HasSubstr("plain/log"));
}

}  // namespace
}  // namespace glint
