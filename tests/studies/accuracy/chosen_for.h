// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/file.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "tests/support/temporary_folder.h"

namespace glint::test {

/// What [accuracy] chooses for a study from the text of its file.
inline ChosenAccuracy chosen_for(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", text);
  const Study study = load_study(folder / "study.toml", {});
  ThreadPool pool(2);
  SceneStore store(pool);
  return choose_accuracy({.study = study, .store = store, .jobs = 1});
}

}  // namespace glint::test
