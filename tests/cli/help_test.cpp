// SPDX-License-Identifier: GPL-3.0-or-later
//
// Help, manual pages and completions, all made from what the command line takes.
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "tests/cli/program.h"

namespace glint::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const Arguments kVerbs = {"run",       "check",   "render",  "frontier", "stability",
                          "imprint",   "inspect", "compare", "validate", "calibrate",
                          "undistort", "cover",   "cell",    "acquire",  "plan",
                          "part",      "new",     "report",  "explain",  "help"};

/// What a shell's command prints; empty with a failure where it exits with another code than 0.
std::string output_of(const TemporaryFolder& folder, const std::string& command) {
  const std::string redirected =
      fmt::format("cd '{}' && ({}) > shell.out 2>&1", (folder / "").string(), command);
  const int status = std::system(redirected.c_str());
  std::string text = read_file(folder / "shell.out");
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << command << "\n" << text;
  return text;
}

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " > /dev/null 2>&1").c_str()) == 0;
}

/// What the program does when it is asked for help: it is called once, whichever tests ask.
const ProgramResult& told_by(const Arguments& arguments) {
  static std::map<Arguments, ProgramResult> known;
  const auto found = known.find(arguments);
  if (found != known.end()) {
    return found->second;
  }
  const TemporaryFolder folder;
  return known.emplace(arguments, glint_in(folder, arguments)).first->second;
}

TEST(Help, OfEveryVerbShowsAnExample) {
  for (const std::string verb :
       {"run", "check", "render", "frontier", "report", "part", "explain", "new"}) {
    const ProgramResult& help = told_by({verb, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_THAT(help.out, HasSubstr("Example:\n  glint " + verb + " "));
    for (const std::string option : {"--json", "--quiet", "--threads", "--log"}) {
      EXPECT_THAT(help.out, HasSubstr(option)) << verb;
    }
  }
}

TEST(Help, OfTheProgramNamesTheVerbsAndItsVersion) {
  const TemporaryFolder folder;
  const ProgramResult& help = told_by({"--help"});
  EXPECT_EQ(help.code, 0);
  for (const std::string verb :
       {"run", "check", "render", "frontier", "report", "part", "explain", "new"}) {
    EXPECT_THAT(help.out, HasSubstr("\n  " + verb + " "));
  }
  const ProgramResult version = glint_in(folder, {"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_THAT(version.out, ::testing::MatchesRegex("glint [0-9]+\\.[0-9]+\\.[0-9]+\n.*"));
  EXPECT_THAT(version.out, HasSubstr("\ncompiler: "));
  for (const std::string library :
       {"Embree", "NLopt", "Pagmo", "Ceres", "OpenCV", "FCL", "Aravis"}) {
    EXPECT_THAT(version.out, ::testing::ContainsRegex(library + " [0-9]+\\.[0-9]+"));
  }
  EXPECT_THAT(version.out, Not(::testing::ContainsRegex("[A-Za-z+_] ,|, ,| \n"))) << "no version";
  EXPECT_EQ(glint_in(folder, {"-V"}).out, version.out);
}

TEST(Help, AsAVerbIsTheSameText) {
  EXPECT_EQ(told_by({"help"}).out, told_by({"--help"}).out);
  for (const std::string& verb : kVerbs) {
    const ProgramResult& help = told_by({"help", verb});
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.out, told_by({verb, "--help"}).out) << verb;
    EXPECT_THAT(help.out, HasSubstr("Usage: glint " + verb)) << verb;
  }
  const ProgramResult& unknown = told_by({"help", "rum"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err, "glint rum: no such verb, the nearest is run\n");
}

// No raw types of the parser: TEXT, INT:INT in [1 - 1024]=2, REQUIRED.
TEST(Help, IsReadable) {
  for (const std::string& verb : kVerbs) {
    const std::string help = told_by({"help", verb}).out;
    for (const std::string raw : {"TEXT", "INT", "REQUIRED", "FLOAT", "PATH", "{"}) {
      EXPECT_THAT(help, Not(HasSubstr(raw))) << verb;
    }
    std::size_t longest = 0;
    std::size_t line = 0;
    const std::string rows = help.substr(0, help.find("\nExample:"));
    for (const char c : rows) {
      line = c == '\n' ? 0 : line + 1;
      longest = std::max(longest, line);
    }
    EXPECT_LE(longest, 100U) << help;
  }
  const std::string run = told_by({"help", "run"}).out;
  EXPECT_THAT(run, HasSubstr("  --set KEY=VALUE "));
  EXPECT_THAT(run, HasSubstr("(may be repeated)"));
  EXPECT_THAT(run, ::testing::ContainsRegex("--threads N +threads to use \\(1 to 1024; default "));
  EXPECT_THAT(told_by({"help", "imprint"}).out, HasSubstr("glint imprint SCENE.toml"));
  EXPECT_THAT(told_by({"help", "cell"}).out, HasSubstr("what to do (list, status, grab, "));
}

TEST(ManPage, OfEveryVerbFormatsWithoutAWarning) {
  const TemporaryFolder folder;
  if (!has_program("groff")) {
    GTEST_SKIP() << "groff is not installed";
  }
  Arguments pages = kVerbs;
  pages.emplace_back("");
  for (const std::string& verb : pages) {
    Arguments arguments = {"help", "--man"};
    if (!verb.empty()) {
      arguments.push_back(verb);
    }
    write_file(folder / "page.1", glint_in(folder, arguments).out);
    EXPECT_EQ(output_of(folder, "groff -man -ww -z -Tascii page.1"), "") << verb;
    const std::string text = output_of(folder, "groff -man -Tascii -P-cbou page.1");
    EXPECT_THAT(text, HasSubstr("EXIT STATUS"));
    EXPECT_THAT(text, HasSubstr(verb.empty() ? "glint-run(1)" : "glint-" + verb)) << text;
  }
  write_file(folder / "page.1", glint_in(folder, {"help", "--man", "inspect"}).out);
  const std::string text = output_of(folder, "groff -man -Tascii -P-cbou page.1");
  EXPECT_THAT(text, HasSubstr("--reference_mask FILE"));
  EXPECT_THAT(text, HasSubstr("glint inspect part/frame_*.png --mask part.png"));
}

/// What bash would offer after these words, sorted.
std::string offered(const TemporaryFolder& folder, const std::string& words) {
  return output_of(folder,
                   fmt::format("bash -c 'compopt() {{ :; }}; source ./glint.bash; COMP_WORDS=({}); "
                               "COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _glint; printf \"%s\\n\" "
                               "\"${{COMPREPLY[@]}}\" | sort'",
                               words));
}

TEST(Completion, OfBashOffersVerbsOptionsChoicesAndKeys) {
  const TemporaryFolder folder;
  write_file(folder / "glint.bash", glint_in(folder, {"help", "--completion", "bash"}).out);
  output_of(folder, "bash -n glint.bash");
  EXPECT_EQ(offered(folder, "glint re"), "render\nreport\n");
  EXPECT_EQ(offered(folder, "glint run --b"), "--budget\n");
  EXPECT_EQ(offered(folder, "glint part --unit \"\""), "cm\ninch\nm\nmm\n");
  EXPECT_EQ(offered(folder, "glint run --set scan.pos"), "scan.positions=\n");
  EXPECT_EQ(offered(folder, "glint explain scan.pos"), "scan.positions\n");
  EXPECT_EQ(offered(folder, "glint help fro"), "frontier\n");
  EXPECT_EQ(offered(folder, "glint run glint.b"), "glint.bash\n");
  EXPECT_EQ(offered(folder, "glint cell st"), "status\n");
  EXPECT_EQ(offered(folder, "glint cell status glint.b"), "glint.bash\n");
  EXPECT_EQ(offered(folder, "glint new --light d"), "dome\n");
  EXPECT_EQ(offered(folder, "glint new --camera glint.b"), "glint.bash\n");
}

TEST(Completion, OfZshAndFishAreScriptsOfTheirs) {
  const TemporaryFolder folder;
  for (const std::string shell : {"zsh", "fish"}) {
    const ProgramResult script = glint_in(folder, {"help", "--completion", shell});
    EXPECT_EQ(script.code, 0);
    for (const std::string& verb : kVerbs) {
      EXPECT_THAT(script.out, HasSubstr(verb)) << shell;
    }
    write_file(folder / ("glint." + shell), script.out);
    if (has_program(shell)) {
      output_of(folder, shell + " -n glint." + shell);
    }
  }
  const ProgramResult unknown = glint_in(folder, {"help", "--completion", "tcsh"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err, "--completion tcsh: must be bash, zsh or fish\n");
}

}  // namespace
}  // namespace glint::test
