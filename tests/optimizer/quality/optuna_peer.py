#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: optuna_peer.py STUDY
#
# Asks Optuna's samplers for points of a study that is minimised. STUDY is JSON: {"sampler": "tpe" or
# "cmaes", "seed": 1, "variables": [{"name": "x", "low": 0, "high": 1, "log": false, "integer": false,
# "choices": [], "when": "", "values": []}]}; a variable with `when` is suggested only while that
# earlier one has one of `values`. The first line of the output is {"ready": true}, or {"missing":
# "package"}. Then a line {"x": [..]} for each question, choices as index and null for what is not
# active, is answered by a line {"value": 0.5}; ends with its input.
import json
import sys


def write(message):
    print(json.dumps(message), flush=True)


try:
    import cmaes  # noqa: F401: what CmaEsSampler loads late
    import optuna
except ImportError as error:
    write({"missing": f"python3-{error.name}"})
    sys.exit(0)


def sampler_of(study):
    if study["sampler"] == "tpe":
        return optuna.samplers.TPESampler(seed=study["seed"])
    return optuna.samplers.CmaEsSampler(seed=study["seed"], warn_independent_sampling=False)


def suggest(trial, variables):
    values = {}
    point = []
    for variable in variables:
        name = variable["name"]
        if variable["when"] and values.get(variable["when"]) not in variable["values"]:
            point.append(None)
        elif variable["choices"]:
            values[name] = trial.suggest_categorical(name, variable["choices"])
            point.append(variable["choices"].index(values[name]))
        elif variable["integer"]:
            point.append(trial.suggest_int(name, int(variable["low"]), int(variable["high"])))
        else:
            point.append(
                trial.suggest_float(name, variable["low"], variable["high"], log=variable["log"])
            )
    return point


def main():
    wanted = json.loads(sys.argv[1])
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(direction="minimize", sampler=sampler_of(wanted))
    write({"ready": True})
    while True:
        trial = study.ask()
        write({"x": suggest(trial, wanted["variables"])})
        line = sys.stdin.readline()
        if not line:
            return
        study.tell(trial, json.loads(line)["value"])


main()
