// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_folder.h"

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/definition/study_text.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/run_folder.h"
#include "studies/report/report.h"

namespace glint {
namespace fs = std::filesystem;

void check_frontier_folder(const Study& study, const fs::path& out) {
  const std::vector<std::string> names = {"frontier.json",
                                          "frontier.svg",
                                          "frontier.html",
                                          "inspector.json",
                                          "inspector.html",
                                          "search.json",
                                          "search.html",
                                          "searches",
                                          "run.json"};
  check_inputs_kept(input_files(study), out, names);
  if (result_kind_of(out) != ResultKind::kRun) {
    check_result_folder(out, ResultKind::kFrontier, names);
  }
  // A scene of the run's own folder has the name of its file there.
  const fs::path run = run_above(without_links(study.root.place.file));
  if (run.empty() || run != without_links(out)) {
    check_study_of_folder(out, study.name);
  }
}

void write_frontier_folder(const Study& study,
                           const fs::path& out,
                           const std::vector<std::pair<std::string, std::string>>& files,
                           const nlohmann::ordered_json& origin) {
  OutputFolder folder(out);
  remove_unfinished_files(out);
  const std::string source = source_seen_from(out, study.root.place.file);
  mark_result_folder(out, ResultKind::kFrontier, study.name, source);
  for (const auto& [name, content] : files) {
    write_file(out / name, content);
  }
  if (result_kind_of(out) == ResultKind::kFrontier) {
    nlohmann::ordered_json json = provenance();
    json["verb"] = command_of(ResultKind::kFrontier);
    json["study"] = study.name;
    json["source"] = source;
    json.update(origin);
    json["configuration"] = resolved_text(study);
    write_file(out / "run.json", json.dump(2) + "\n");
  }
  folder.keep();
}

nlohmann::ordered_json optional_json(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::string frontier_page_html(const Study& study,
                               const std::string& subtitle,
                               const std::string& sentence,
                               const std::string& key,
                               const nlohmann::ordered_json& json,
                               const std::vector<std::string>& notes) {
  nlohmann::ordered_json source = provenance();
  source.erase("cores");
  return render_report({{"title", study.title},
                        {"subtitle", subtitle},
                        {"verdict",
                         {{"sentence", sentence},
                          {"tone", "neutral"},
                          {"details", nlohmann::ordered_json::array()}}},
                        {key, json},
                        {"methods", notes},
                        {"config_toml", shown_text(study)},
                        {"provenance", source}});
}

}  // namespace glint
