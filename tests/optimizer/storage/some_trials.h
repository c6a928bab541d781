// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "optimizer/storage/storage.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint::test {

/// What opening it throws; empty: it can be opened.
inline std::string open_error(const std::filesystem::path& path, const std::string& hash = "abc") {
  try {
    Storage::open(path, identity(hash));
  } catch (const IoError& error) {
    return std::string("IoError ") + error.what();
  } catch (const ConfigError& error) {
    return std::string("ConfigError ") + error.what();
  }
  return "";
}

/// Asks and tells a number of trials, with a score "h" each.
inline void write_some_trials(Storage& storage, int count) {
  for (int n = 1; n <= count; ++n) {
    const std::vector<Trial> trials = {{.number = n, .point = {1.0 / n, 2.0 * n}}};
    storage.append(std::vector<Event>{{.kind = EventKind::kAsk, .trial = n}}, trials);
    storage.record(TrialKind::kSearch, n, {.scores = {{"h", 1.0 / n}}, .seconds = 0.5});
    storage.append(std::vector<Event>{{.kind = EventKind::kTell, .trial = n, .value = -1.0 / n}});
  }
}

}  // namespace glint::test
