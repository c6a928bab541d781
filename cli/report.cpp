// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/file.h"
#include "studies/run/run_report.h"

namespace glint {

int report_command(const ReportArguments& arguments, const CommonArguments& common) {
  std::filesystem::path out = arguments.out;
  if (out.empty()) {
    out = arguments.runs.size() == 1 ? arguments.runs.front() / "report.html"
                                     : std::filesystem::path("report.html");
  }
  write_file(out, report_html(arguments.runs));
  print_result(common,
               {{"schema", 1}, {"status", "done"}, {"report", out.string()}},
               "report: " + out.string() + "\n");
  return kExitDone;
}

}  // namespace glint
