// SPDX-License-Identifier: GPL-3.0-or-later
//
// One cell of a sweep: the ordinary evaluation of a scene, judged by a reference that shares no
// kernel with it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/definition/scene_notes.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_store.h"
#include "studies/stability/stability_sweeps.h"

namespace glint::stability {

/// What may be wrong without a word.
struct Bounds {
  double h_points = 0.5;          ///< > 0; of h_rms
  double contrast_percent = 5.0;  ///< > 0; of a dent's change, of at least kMinContrast
  double picture = 0.01;          ///< > 0; of full scale: rms over the region, and its mean
};

/// Relative errors are of at least this contrast: one grey value in a hundred.
inline constexpr double kMinContrast = 0.01;

enum class Verdict {
  kRight,    ///< within all bounds
  kTold,     ///< beyond one, and the program says so beside its result
  kRefused,  ///< a message that names the key, and no result
  kWrong     ///< beyond one without a word
};

/// "right", "told", "refused", "silently wrong".
const char* verdict_name(Verdict verdict);

/// How far one quantity is off.
struct CellError {
  std::string quantity;  ///< "h_points", "contrast_percent", "picture", "mean"
  double error = 0.0;    ///< >= 0
  double bound = 1.0;    ///< > 0
  double measured = 0.0;
  double reference = 0.0;
  double uncertainty = 0.0;  ///< of the reference: by half and by all of its rays; 0: not needed
};

struct Cell {
  double value = 0.0;
  std::string method;             ///< as asked for: render.method
  std::vector<CellError> errors;  ///< none when refused
  Verdict verdict = Verdict::kRight;
  std::string message;  ///< of the refusal; what was told
};

/// The error that is largest against its bound; null for a refused cell.
const CellError* worst_of(const Cell& cell);

/// What the program makes of a scene.
struct Outcome {
  Evaluation evaluation;
  SceneSettings scene;
  std::vector<SceneNote> notes;
};

/// Reads, checks and evaluates a scene as `glint check` does. @throws ConfigError, IoError
Outcome evaluated(SceneStore& store, const ConfigNode& root);

/// Notes on this outcome of kinds that the harmless one has none of.
std::vector<SceneNote> notes_beside(const Outcome& outcome, const Outcome* harmless);

/// A scene under a tunnel against the reference tracer. @throws ConfigError
std::vector<CellError> errors_of_tunnel(const Outcome& outcome, const Bounds& bounds);

/// A matt plate below a bar against Lambert's formula.
std::vector<CellError> errors_of_bar(const Outcome& outcome, const Bounds& bounds);

/// The verdict on the errors, each by itself: wrong where one of them is beyond its bound for
/// certain and no note that covers its quantity (note_coverages()) says so.
void judge(const Outcome& outcome, const Outcome* harmless, Cell& cell);

}  // namespace glint::stability
