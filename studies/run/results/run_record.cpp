// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/results/run_record.h"

#include <nlohmann/json.hpp>

#include "studies/definition/study_text.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json cpu_json(const RunRecord& record) {
  const RunCpu& cpu = record.cpu;
  const double others_s = cpu.rescoring_s + cpu.populations_s + cpu.manufacture_s;
  Json json = {{"search", cpu.search_s},
               {"rescoring", cpu.rescoring_s},
               {"writing", cpu.finish_s - others_s},
               {"populations", cpu.populations_s}};
  if (record.has_front) {
    json["of_these_front"] = cpu.front_s;
  }
  if (cpu.manufacture_s > 0.0) {
    json["manufacture"] = cpu.manufacture_s;
  }
  if (record.accuracy_cpu_s) {
    json["accuracy"] = *record.accuracy_cpu_s;
  }
  return json;
}

}  // namespace

Json run_record_json(const RunRecord& record) {
  const Study& study = record.study;
  const SearchResult& search = record.search;
  Json json = provenance();
  json["verb"] = command_of(ResultKind::kRun);
  json["study"] = study.name;
  json["source"] = source_seen_from(record.out, study.root.place.file);
  json["started"] = utc_text(record.started);
  json["seed"] = study.search.seed;
  json["threads"] = record.threads;
  json["jobs"] = record.jobs;
  json["algorithm"] = search.algorithm;
  json["termination"] = study.has_search() ? termination_name(search.termination) : "none";
  json["timings"] = {{"search_s", search.seconds},
                     {"this_run_s", record.seconds},
                     {"replayed_evaluations", search.replayed},
                     {"reused_designs", search.reused},
                     {"traced_scenes", record.store.num_traced()},
                     {"retraced_scenes", record.store.num_retraced()}};
  json["cpu_s"] = cpu_json(record);
  json["warnings"] = search.warnings;
  json["derivatives"] = record.derivatives;
  json["configuration"] = resolved_text(study);
  return json;
}

}  // namespace glint
