#!/usr/bin/env python3
"""The stability table: extremes of mass, size, speed, distance and time, by solver and scalar

    bash bench/run extremes [--quick] [--rows A,B] [--columns A,B] [--jobs N] [--fresh] [--collect] [--publish]

Plays each row of tests/extremes/rows.hpp in 2D and 3D with both solvers and three scalars, at 1 to 64 substeps of
1/60 s, and prints what becomes of it: pass, degrade or FAIL with what was measured, and the fewest substeps that pass.
--quick: at the default of 4 substeps alone; --rows, --columns: those whose names begin with any of these. Tables go to
bench/out/extremes.md and .csv; --publish also writes the page bench/extremes/README.md. What this program has played
before is not played again unless by --fresh: a run that was stopped goes on. --collect makes tables of what is there.
"""
import argparse
import collections
import concurrent.futures
import csv
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/bench/extremes"
PAGE = ROOT / "bench/extremes"
DEFAULT = 4
TIMEOUT = 1800  # seconds a cell
ORDER = {"pass": 0, "degrade": 1, "FAIL": 2}
Row = collections.namedtuple("Row", "name dimension played metric passes degrades why probe budget most")
Result = collections.namedtuple("Result", "figure verdict refusal")


def asked(*words):
    return subprocess.run([PROGRAM, *words], check=True, text=True, stdout=subprocess.PIPE).stdout.splitlines()


def rows_of_program():
    split = [line.split("\t") for line in asked("rows")]
    return [Row(x[0], int(x[1]), *x[2:4], float(x[4]), float(x[5]), *x[6:8], int(x[8]), int(x[9])) for x in split]


def file_of(folder, row, column, quick):
    return folder / (re.sub(r"\W+", "_", f"{column} {row.dimension} {row.name}") + ("_quick" if quick else "") + ".csv")


def play(folder, tasks, quick, jobs):
    left = [(row, column) for row, column in tasks if not file_of(folder, row, column, quick).exists()]
    # What takes long comes last, so that a run that is stopped has most of the table.
    left.sort(key=lambda task: ("fixed" in task[1], "impulse" in task[1], task[0].most < 64, task[0].dimension))
    print(f"{len(left)} of {len(tasks)} cells to play", flush=True)

    def one(task):
        row, column = task
        words = [PROGRAM, "play", column, str(row.dimension), row.name, *([str(DEFAULT)] if quick else [])]
        file = file_of(folder, row, column, quick)
        part = file.with_suffix(".part")
        with part.open("w") as out:
            try:
                subprocess.run(words, check=True, stdout=out, timeout=TIMEOUT)
            except subprocess.TimeoutExpired:
                # More substeps than were played count as not tried.
                print(f"{column} {row.dimension}D {row.name}: over {TIMEOUT} s")
            except subprocess.CalledProcessError as error:
                print(f"{column} {row.dimension}D {row.name}: {error}")
                return
        part.rename(file)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for number, _ in enumerate(pool.map(one, left), 1):
            if number % 100 == 0:
                print(f"{number} of {len(left)}", flush=True)


def results_of(folder, tasks, quick):
    """(name, dimension, column): {substeps: result}, where a row whose probe fails has failed too."""
    found = {}
    for row, column in tasks:
        file = file_of(folder, row, column, quick)
        lines = csv.reader(file.read_text().splitlines()) if file.exists() else []
        found[row.name, row.dimension, column] = {
            int(x[3]): Result(float(x[4]), x[5], x[6]) for x in lines if len(x) == 7}
    judged = {}
    for row, column in tasks:
        probes = found.get((row.probe, row.dimension, column), {})
        judged[row.name, row.dimension, column] = {
            n: it._replace(verdict="FAIL", refusal=it.refusal or "its probe fails: " + row.probe)
            if n in probes and probes[n].verdict == "FAIL" and it.verdict != "FAIL" else it
            for n, it in found[row.name, row.dimension, column].items()}
    return judged


def figure(result):
    if result.refusal.startswith("physics:"):
        return "refused"
    text = f"{result.figure:.2g}"
    return f"{text}, frozen" if result.refusal else text


def cell(by_substeps):
    result = by_substeps.get(DEFAULT)
    if result is None:
        return "not played"
    verdict = "**FAIL**" if result.verdict == "FAIL" else result.verdict
    return f"{verdict} {figure(result)}"


def least(by_substeps):
    """The fewest substeps that pass, and those of more that do not."""
    passing = [n for n, it in by_substeps.items() if it.verdict == "pass"]
    if not passing:
        return None, []
    first = min(passing)
    return first, [n for n, it in by_substeps.items() if n > first and it.verdict != "pass"]


def price(row, by_substeps):
    if not by_substeps:
        return "?"
    first, lost = least(by_substeps)
    if first is None:
        return "-"
    text = str(first) if first <= row.budget else f"({first})"
    return text + ("!" if lost else "")


def default_table(rows, columns, results):
    lines = ["| row | " + " | ".join(column.replace("-", ", ") for column in columns) + " |",
             "|---" * (len(columns) + 1) + "|"]
    for row in rows:
        cells = [cell(results[row.name, row.dimension, column]) for column in columns]
        lines.append(f"| {row.name} | " + " | ".join(cells) + " |")
    return lines


def solvers_of(columns):
    return list(dict.fromkeys(column.split("-")[0] for column in columns))


def price_table(rows, columns, results):
    keys = [(dimension, solver) for dimension in (2, 3) for solver in solvers_of(columns)]
    lines = ["| row | target | within | " + " | ".join(f"{d}D {solver}" for d, solver in keys) + " |",
             "|---" * (len(keys) + 3) + "|"]
    named = {(row.name, row.dimension): row for row in rows}
    for name in dict.fromkeys(row.name for row in rows):
        row = named.get((name, 2)) or named[name, 3]
        cells = []
        for dimension, solver in keys:
            it = named.get((name, dimension))
            found = [price(it, results[name, dimension, column]) for column in columns
                     if column.split("-")[0] == solver] if it else [""]
            cells.append(found[0] if len(set(found)) == 1 else " / ".join(found))
        lines.append(f"| {name} | {row.passes:g} | {row.budget} | " + " | ".join(cells) + " |")
    return lines


def tally(rows, columns, results):
    lines = ["| | pass at 4 | degrade at 4 | FAIL at 4 | of both, pass with others | never pass | not played |",
             "|---|---|---|---|---|---|---|"]
    for column in columns:
        counts = collections.Counter()
        for row in rows:
            by = results[row.name, row.dimension, column]
            verdict = by[DEFAULT].verdict if DEFAULT in by else "not played"
            counts[verdict] += 1
            if verdict in ("degrade", "FAIL"):
                counts["other" if least(by)[0] else "never"] += 1
        lines.append(f"| {column.replace('-', ', ')} | {counts['pass']} | {counts['degrade']} | {counts['FAIL']} | "
                     f"{counts['other']} | {counts['never']} | {counts['not played']} |")
    return lines


def open_targets(rows, columns, results):
    """What no column, or only some, meet within the target's substeps."""
    lines = []
    for row in rows:
        met = []
        played = [column for column in columns if results[row.name, row.dimension, column]]
        for column in played:
            first, _ = least(results[row.name, row.dimension, column])
            if first is not None and first <= row.budget:
                met.append(column)
        if len(met) == len(played):
            continue
        missed = [column for column in played if column not in met]
        best = min((it for column in missed for it in results[row.name, row.dimension, column].values()
                    if it.figure >= 0 and not it.refusal), key=lambda it: it.figure, default=None)
        whom = "all" if not met else ", ".join(column.replace("-", " in ") for column in missed)
        lines.append(f"| {row.name}, {row.dimension}D | {row.metric} | {row.passes:g} within {row.budget} | {whom} | "
                     f"{'-' if best is None else f'{best.figure:.2g}'} |")
    head = ["| row | measured | target, substeps | missed by | the least that those measure, with any |",
            "|---|---|---|---|---|"]
    return head + lines


def refusals(rows, columns, results):
    said = collections.defaultdict(list)
    for row in rows:
        for column in columns:
            for it in results[row.name, row.dimension, column].values():
                if it.refusal.startswith("physics:"):
                    where = f"{row.name}, {row.dimension}D, {column.replace('-', ' in ')}"
                    text = re.sub(r"-?\d+\.?\d*(e[+-]?\d+)?", "...", it.refusal)
                    if where not in said[text]:
                        said[text].append(where)
    return [f"- `{text}`: {'; '.join(where)}" for text, where in said.items()]


def described(rows):
    lines = ["| row | played | measured | pass | degrade | why | passes only while this does not fail |",
             "|---|---|---|---|---|---|---|"]
    for name in dict.fromkeys(row.name for row in rows):
        row = next(row for row in rows if row.name == name)
        lines.append(f"| {name} | {row.played} | {row.metric} | {row.passes:g} | {row.degrades:g} | {row.why} | "
                     f"{row.probe} |")
    return lines


def page(rows, columns, results, command):
    missing = sum(not by for by in results.values())
    text = [f"Written by `{command}`: {sum(len(by) for by in results.values())} runs." +
            f" It was stopped before {missing} of {len(results)} cells." * (missing > 0), "",
            "## How many cells", "", *tally(rows, columns, results)]
    for dimension in (2, 3):
        of = [row for row in rows if row.dimension == dimension]
        if of:
            text += ["", f"## At the defaults, {dimension}D", "",
                     "4 substeps at 60 Hz: what the scene is worth, and what was measured.", "",
                     *default_table(of, columns, results)]
    text += ["", "## The least work that passes", "",
             "Substeps at 60 Hz, of float / double / fixed32 where those differ. In brackets: more than the target "
             "allows. -: none that was tried. !: passes with those, and not with some that are more. ?: not played.", "",
             *price_table(rows, columns, results), "",
             "## Targets that are not met", "", *open_targets(rows, columns, results)]
    refused = refusals(rows, columns, results)
    if refused:
        text += ["", "## What the library refuses", "", *refused]
    return text + ["", "## The rows", "", *described(rows)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--rows", default="")
    parser.add_argument("--columns", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--collect", action="store_true")
    parser.add_argument("--publish", action="store_true")
    told = parser.parse_args()
    wanted = {"rows": told.rows.split(","), "columns": told.columns.split(",")}

    def is_wanted(what, name):
        return any(name.startswith(word) for word in wanted[what])

    every = rows_of_program()
    rows = [row for row in every if is_wanted("rows", row.name)]
    # A row is judged together with its probe.
    probes = {row.probe for row in rows}
    rows = [row for row in every if row in rows or row.name in probes]
    columns = [column for column in asked("columns") if is_wanted("columns", column)]
    if not rows or not columns:
        sys.exit(f"no such {'columns' if rows else 'rows'}; see bench/out/extremes.md")
    folder = ROOT / "build/bench/extremes.d" / hashlib.sha256(PROGRAM.read_bytes()).hexdigest()[:12]
    if told.fresh:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    tasks = [(row, column) for row in rows for column in columns]
    if not told.collect:
        play(folder, tasks, told.quick, told.jobs)
    results = results_of(folder, tasks, told.quick)
    with (ROOT / "bench/out/extremes.csv").open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["row", "dimension", "column", "substeps", "measured", "verdict", "remark"])
        for (name, dimension, column), by in results.items():
            for substeps, it in sorted(by.items()):
                out.writerow([name, dimension, column, substeps, it.figure, it.verdict, it.refusal])
    command = "bash bench/run extremes --publish" + " --quick" * told.quick
    text = page(rows, columns, results, command)
    (ROOT / "bench/out/extremes.md").write_text("\n".join(text) + "\n")
    print("\n".join(text))
    if told.publish:
        (PAGE / "README.md").write_text((PAGE / "head.md").read_text() + "\n" + "\n".join(text) + "\n")


if __name__ == "__main__":
    main()
