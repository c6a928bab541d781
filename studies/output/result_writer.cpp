// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/result_writer.h"

#include "core/file.h"
#include "core/wall_clock.h"
#include "studies/output/provenance.h"

namespace glint {
namespace {

const std::filesystem::path& without_stale_stages(const std::filesystem::path& out) {
  remove_stale_stages(out);
  return out;
}

}  // namespace

ResultWriter::ResultWriter(const std::filesystem::path& out, ResultKind kind)
    : kind_(kind), folder_(out), stage_(without_stale_stages(out), "") {}

void ResultWriter::finish(const nlohmann::ordered_json& given,
                          std::chrono::steady_clock::time_point start) {
  nlohmann::ordered_json run = provenance();
  run["verb"] = command_of(kind_);
  run.update(given);
  run["timings"] = {{"this_run_s", seconds_since(start)}};
  write_file(stage_.path() / "run.json", run.dump(2) + "\n");
  stage_.commit();
  folder_.keep();
}

}  // namespace glint
