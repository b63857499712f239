#!/usr/bin/env python3
"""Checks the dependency rules of docs/architecture.md: which folder may include which.

usage: check_includes.py [SOURCE_DIR]     exit code 1 and one line for each forbidden or unknown include
"""
import pathlib
import re
import sys

PROJECT = ["common", "lcmtypes", "drivers", "estimation", "control", "supervision", "planning_offline", "sim_hil", "app"]

# Folder (longest prefix wins) -> project folders it may include besides itself. A name ending in .h is a single header.
MAY_INCLUDE = {
    "common": [],
    "lcmtypes": ["common"],
    "drivers": ["common"],
    "estimation": ["common"],
    "control": ["common"],
    "supervision": ["common"],
    "planning_offline": ["common"],
    "sim_hil": ["common", "lcmtypes", "drivers/fotokite_protocol.h", "drivers/tautline_protocol.h"],
    "app": ["common", "lcmtypes", "drivers", "estimation", "control", "supervision"],
    "app/bench": PROJECT,
    "app/experiments": PROJECT,
}

# Third-party headers that only the named folders may use; everything that is not listed here is free to all but common.
ONLY_IN = {
    "toml++": ["common/toml"],
    "lcm": ["app", "sim_hil", "lcmtypes"],
    "tautline": ["app", "sim_hil"],
    "CLI": ["app", "sim_hil", "planning_offline"],
    "octomap": ["planning_offline"],
    "dynamicEDT3D": ["planning_offline/field/benchmark"],
    "ompl": ["planning_offline"],
    "nlohmann": ["app", "planning_offline", "sim_hil"],
    "fmt": ["app", "planning_offline", "sim_hil"],
}
EVERYWHERE_IN_TESTS = ["nlohmann"]

# The simulator's tether is an independent model: these parts of common would make the bench prove only self-consistency.
FORBIDDEN = {"sim_hil": ["common/catenary.h", "common/tether_geometry.h"]}

INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')


def is_under(path, folder):
    return path == folder or path.startswith(folder + "/")


def folder_of(path):
    return max((f for f in MAY_INCLUDE if is_under(path, f)), key=len, default=None)


def problems_in(root, path):
    rel = path.relative_to(root).as_posix()
    me = folder_of(rel)
    if me is None:
        return
    is_test = "/test/" in rel or "/testing/" in rel or "/benchmark/" in rel or "/fuzz/" in rel
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quote, target = match.groups()
        where = f"{rel}:{number}"
        if quote == '"':
            if not (root / target).is_file():
                yield f'{where}: "{target}" is not a file of the project; include from the root'
            elif not any(is_under(target, f) for f in [me, *MAY_INCLUDE[me]]):
                yield f'{where}: {me} may not include "{target}"; allowed: {", ".join([me, *MAY_INCLUDE[me]])}'
            elif ("/test/" in target or is_under(target, "common/testing")) and not is_test:
                yield f'{where}: "{target}" is for tests only'
            elif target in FORBIDDEN.get(me, []):
                yield f'{where}: {me} may not include "{target}": its tether must be a model of its own'
            continue
        library = target.split("/")[0]
        if library in ONLY_IN and not (is_test and library in EVERYWHERE_IN_TESTS):
            if not any(is_under(rel, f) for f in ONLY_IN[library]):
                yield f'{where}: <{target}> may only be included in {", ".join(ONLY_IN[library])}'


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    files = [p for folder in PROJECT for suffix in ("*.h", "*.cpp") for p in sorted((root / folder).rglob(suffix))]
    problems = [problem for path in files for problem in problems_in(root, path)]
    for problem in problems:
        print(problem)
    print(f"{len(files)} files scanned, {len(problems)} forbidden includes")
    return 1 if problems or not files else 0


if __name__ == "__main__":
    sys.exit(main())
