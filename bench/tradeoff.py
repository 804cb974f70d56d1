#!/usr/bin/env python3
"""What accuracy costs: CPU time against error over solvers, substeps, iterations, steps, scalars and engines

    bash bench/run tradeoff [--quick] [--scenes A,B] [--engines A,B] [--rounds N] [--jobs N]
                            [--fresh] [--tasks] [--collect] [--publish]

Plays each scene of bench/tradeoff/questions.cpp, whose right answer is known, with each engine that is installed, and
draws the fronts: what error can be had for how much time. Engines that run under node are adapters in
bench/tradeoff/node, whose packages npm installs. --quick: 60 Hz and 1 to 64 substeps for engines that have them, 60 to
960 Hz for others, all as they ship otherwise. Tables go to bench/out/tradeoff.md and .csv; --publish also writes the
page bench/tradeoff/README.md with its pictures.

A task is a line of tasks.txt in build/bench/tradeoff.d/PROGRAM/, PROGRAM being a hash of the program and of the scripts
that run under node; its result is a file in results/ROUND/. What has a result is not played again unless by --fresh: a
run that was stopped goes on. GNU parallel plays them, in an order that mixes engines. Elsewhere, as an array of jobs:
--tasks makes tasks.txt and says where; job N runs

    build/bench/tradeoff play $(sed -n Np tasks.txt) > results/1/N.csv

and --collect makes tables of what is there.

Where no closed form or invariant is known, the right answer is what the library itself does with numbers of about 31
digits and 64 times the work of the most exact task; such films are kept until what they are made from changes.
"""
import argparse
import collections
import csv
import hashlib
import math
import os
import pathlib
import random
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/bench/tradeoff"
NODE = ROOT / "build/bench/node"  # scripts of bench/tradeoff/node and their packages
OUT = ROOT / "bench/out/tradeoff"
PAGE = ROOT / "bench/tradeoff"
COLUMNS = ["scene", "engine", "rate", "substeps", "iterations", "sweeps", "error", "solved", "cpu_min", "cpu_median",
           "runs", "hash"]
TASK = COLUMNS[:5]
OURS = ("soft_step", "sequential_impulse")
TIMEOUT = 120  # seconds a task; what takes longer is no bargain
COLOURS = {"soft_step-float": "#0044aa", "soft_step-double": "#66aaee", "soft_step-fixed32": "#9955bb",
           "sequential_impulse-float": "#008855", "sequential_impulse-double": "#77cc99", "box2d-2.4": "#dd2222",
           "chipmunk-7": "#ee8833", "bullet-3": "#bb7700", "ode-0.16": "#ee66aa", "box2d-3-wasm": "#880000",
           "rapier2d-wasm": "#00bbbb", "rapier2d-simd-wasm": "#006666", "rapier3d-simd-wasm": "#006666",
           "jolt-wasm": "#880000", "havok-wasm": "#222222", "physx-5-wasm": "#99bb00", "physx-5-tgs-wasm": "#556600",
           "matter-js": "#ccaa00", "cannon-es": "#cc44ff"}
Row = collections.namedtuple("Row", COLUMNS)


def asked(*words):
    return subprocess.run([PROGRAM, *words], check=True, text=True, stdout=subprocess.PIPE).stdout.splitlines()


def scenes():
    """name: (dimension, what is visible, what is played, what is judged)"""
    split = [line.split("\t") for line in asked("scenes")]
    return {name: (int(dimension), float(visible), about, metric) for name, dimension, visible, about, metric in split}


def place():
    """Where results are of this program and these scripts."""
    digest = hashlib.sha256(PROGRAM.read_bytes())
    for script in sorted([*NODE.glob("*.mjs"), *NODE.glob("package.json")]):
        digest.update(script.read_bytes())
    return ROOT / "build/bench/tradeoff.d" / digest.hexdigest()[:12]


def make_references(wanted, jobs):
    """Films of references, beside the program. They change with the library, the scenes and the reference alone."""
    made_from = ["physics.hpp", "bench/scenes/ours.hpp", "bench/scenes/parts.hpp", "bench/tradeoff.cpp",
                 "bench/tradeoff/questions.cpp", "bench/tradeoff/reference.cpp"]
    key = hashlib.sha256(b"".join((ROOT / path).read_bytes() for path in made_from)).hexdigest()
    into = PROGRAM.parent / "references"
    if not (into / "KEY").exists() or (into / "KEY").read_text() != key:
        shutil.rmtree(into, ignore_errors=True)
        into.mkdir(parents=True)
        (into / "KEY").write_text(key)
    left = [name for name in asked("references") if name in wanted and not (into / f"{name}.film").exists()]
    if left:
        print(f"references of {', '.join(left)}: some minutes", flush=True)
        subprocess.run(["parallel", "--jobs", str(jobs), f"{PROGRAM} reference {{}} > {into}/{{}}.part && "
                        f"mv {into}/{{}}.part {into}/{{}}.film"], input="\n".join(left) + "\n", text=True)


def results(folder):
    """The rows of each round, by task."""
    found = {}
    for file in sorted(folder.glob("results/*/*.csv")):
        for row in csv.reader(file.read_text().splitlines()):
            if len(row) == len(COLUMNS):
                found.setdefault(file.parent.name, {})[tuple(row[:5])] = row
    return found


def play(folder, tasks, rounds, jobs):
    if not shutil.which("parallel"):
        sys.exit("GNU parallel is missing (in Debian: apt-get install parallel)")
    for number in range(1, rounds + 1):
        into = folder / "results" / str(number)
        into.mkdir(parents=True, exist_ok=True)
        done = results(folder).get(str(number), {})
        left = [task for task in tasks if tuple(task.split()) not in done]
        print(f"round {number} of {rounds}: {len(left)} of {len(tasks)} tasks to play", flush=True)
        if not left:
            continue
        # The same order each time, in which engines and scenes take turns.
        random.Random(number).shuffle(left)
        name = f"{into}/{{1}},{{2}},{{3}},{{4}},{{5}}"
        bar = ["--bar"] if sys.stderr.isatty() else []
        subprocess.run(["parallel", *bar, "--jobs", str(jobs), "--timeout", str(TIMEOUT), "--colsep", " ",
                        f"{PROGRAM} play {{1}} {{2}} {{3}} {{4}} {{5}} > {name}.part 2> {name}.said && "
                        f"mv {name}.part {name}.csv"],
                       input="\n".join(left) + "\n", text=True, stdout=subprocess.DEVNULL,
                       stderr=None if bar else subprocess.DEVNULL)
        missed = len(left) - len([task for task in left if (into / (",".join(task.split()) + ".csv")).exists()])
        if missed:
            print(f"{missed} tasks have no result: they took over {TIMEOUT} s, or see *.said in {into}")


def rows_of(folder):
    """One row a task: minimum and median over rounds."""
    of_task = collections.defaultdict(list)
    for by_task in results(folder).values():
        for task, row in by_task.items():
            of_task[task].append(row)
    rows = []
    for task, found in of_task.items():
        if len({row[11] for row in found}) > 1:
            sys.exit(f"{' '.join(task)}: two rounds end in other states")
        rows.append(Row(task[0], task[1], *(int(x) for x in task[2:]), int(found[0][5]), float(found[0][6]),
                        int(found[0][7]), min(float(row[8]) for row in found),
                        statistics.median(float(row[9]) for row in found), sum(int(row[10]) for row in found),
                        found[0][11]))
    return sorted(rows)


def front(rows):
    """What no other row beats in both, cheapest first."""
    best, kept = math.inf, []
    for row in sorted(rows, key=lambda row: (row.cpu_min, row.error)):
        if row.solved and row.error < best:
            best = row.error
            kept.append(row)
    return kept


def cheapest(rows, tolerance):
    good = [row for row in rows if row.solved and row.error <= tolerance]
    return min(good, key=lambda row: row.cpu_min, default=None)


def is_ours(row):
    return row.engine.startswith(OURS)


def settings(row):
    text = f"{row.rate} Hz"
    if row.substeps:
        text += f" x {row.substeps}"
    if row.iterations:
        text += f", {row.iterations} it."
    return text


def cell(row, is_best=False):
    if row is None:
        return "-"
    text = f"{1e3 * row.cpu_min:.3g} ms ({settings(row)})"
    return f"**{text}**" if is_best else text


def table(by_scene, known, share):
    """Who reaches a share of what is just visible, for how much time."""
    lines = ["| scene | within | soft_step, float | sequential_impulse, float | soft_step, fixed32 | another engine |",
             "|---|---|---|---|---|---|"]
    for name, rows in by_scene.items():
        tolerance = known[name][1] * share
        cells = [cheapest([row for row in rows if row.engine == engine], tolerance)
                 for engine in ("soft_step-float", "sequential_impulse-float", "soft_step-fixed32")]
        other = cheapest([row for row in rows if not is_ours(row)], tolerance)
        best = min((row for row in [*cells, other] if row), key=lambda row: row.cpu_min, default=None)
        texts = [cell(row, row is best) for row in [*cells, other]]
        if other:
            texts[-1] = f"{other.engine}: {texts[-1]}"
        lines.append(f"| {name} | {tolerance:g} | " + " | ".join(texts) + " |")
    return lines


def beaten(by_scene):
    """Where another engine's front holds an error that none of ours has for as much time."""
    lines, held, all_of = [], 0, 0
    for name, rows in by_scene.items():
        ours = [row for row in rows if is_ours(row) and row.solved]
        lost = []
        points = front([row for row in rows if not is_ours(row)])
        for point in points:
            all_of += 1
            if any(row.cpu_min <= point.cpu_min and row.error <= point.error for row in ours):
                held += 1
            else:
                lost.append(point)
        if lost:
            lines.append(f"| {name} | {len(lost)} of {len(points)} | " + "; ".join(
                f"{point.engine} {point.error:.2g} for {1e3 * point.cpu_min:.3g} ms" for point in lost[:3]) + " |")
    head = [f"Of {all_of} points of other engines' fronts {held} are met by one of ours, as exact for no more time. "
            "Not so:", "", "| scene | points | the cheapest of them |", "|---|---|---|"]
    return head + lines


def engines_of(rows):
    """Those with a colour first, in its order."""
    there = {row.engine for row in rows}
    return [name for name in COLOURS if name in there] + sorted(there - set(COLOURS))


def write_data(rows, by_scene, known):
    OUT.mkdir(parents=True, exist_ok=True)
    with (ROOT / "bench/out/tradeoff.csv").open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(COLUMNS)
        out.writerows(rows)
    floor = 1e-9  # of what is drawn

    def dat(name, lines):
        (OUT / f"{name}.dat").write_text("\n".join(lines) + "\n")

    def point(row):
        return f"{row.scene},{row.engine},{row.cpu_min:g},{max(row.error, floor):g}"

    dat("all", [point(row) for row in rows if row.solved])
    dat("front", [point(row) for by in by_scene.values() for engine in engines_of(rows)
                  for row in front([row for row in by if row.engine == engine])])
    ends = {name: (min(row.cpu_min for row in by), max(row.cpu_min for row in by)) for name, by in by_scene.items()}
    dat("visible", [f"{name},{end:g},{known[name][1]:g}" for name, both in ends.items() for end in both])
    failed = []
    top = {name: max([row.error for row in by if row.solved] + [known[name][1]]) * 3 for name, by in by_scene.items()}
    for row in rows:
        number = int(COLOURS.get(row.engine, "#444444")[1:], 16)
        failed += [] if row.solved else [f"{row.scene},{row.engine},{row.cpu_min:g},{top[row.scene]:g},{number}"]
    dat("failed", failed)
    dat("substeps", [f"{row.scene},{row.substeps},{max(row.error, floor) / known[row.scene][1]:g}" for row in rows
                     if row.engine == "soft_step-float" and row.rate == 60 and row.solved])


def draw(rows, by_scene, known):
    told = {"folder": OUT}
    for d in (2, 3):
        engines = engines_of([row for row in rows if known[row.scene][0] == d])
        told[f"engines{d}"] = " ".join(engines)
        told[f"colours{d}"] = " ".join(COLOURS.get(name, "#444444") for name in engines)
        told[f"scenes{d}"] = " ".join(name for name in by_scene if known[name][0] == d)
    drawn = subprocess.run(["gnuplot", "-e", "; ".join(f"{name}='{what}'" for name, what in told.items()),
                            PAGE / "draw.gp"], cwd=ROOT, text=True, capture_output=True)
    if drawn.returncode:
        sys.exit(drawn.stderr)


def page(by_scene, known, rows, command, rounds):
    lines = [f"Written by `{command}`: {len(rows)} runs of {len(by_scene)} scenes, "
             f"{rounds} round{'s' if rounds > 1 else ''}, CPU time of one thread, minimum.", "",
             "## What a visible error costs", "",
             "The cheapest settings whose error is below what is just visible (5 mm or 1 %), in CPU milliseconds a "
             "simulated second. Steps a second x substeps; -: none that was tried.", ""]
    lines += table(by_scene, known, 1)
    lines += ["", "## A tenth of that", ""]
    lines += table(by_scene, known, 0.1)
    lines += ["", "## Where other engines are the better bargain", ""]
    lines += beaten(by_scene)
    lines += ["", "## The scenes", "", "| scene | what is played | what is the error |", "|---|---|---|"]
    lines += [f"| {name} | {known[name][2]} | {known[name][3]} |" for name in by_scene]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--scenes", default="")
    parser.add_argument("--engines", default="")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=max(1, (os.cpu_count() or 2) // 2))
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--tasks", action="store_true")
    parser.add_argument("--collect", action="store_true")
    parser.add_argument("--publish", action="store_true")
    told = parser.parse_args()
    folder, known = place(), scenes()
    wanted = [name for name in told.scenes.split(",") if name] or list(known)
    for name in wanted:
        if name not in known:
            sys.exit(f"no such scene: {name}; there are {', '.join(known)}")
    tasks = asked("tasks", *(["--quick"] if told.quick else []))
    of_engines = [name for name in told.engines.split(",") if name]
    tasks = [task for task in tasks if task.split()[0] in wanted and
             (not of_engines or any(task.split()[1].startswith(name) for name in of_engines))]
    if not tasks:
        sys.exit(f"no engine's name begins with any of {told.engines}")
    if told.fresh:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "tasks.txt").write_text("\n".join(tasks) + "\n")
    if told.tasks:
        print(folder / "tasks.txt")
        return
    if not told.collect:
        make_references(wanted, told.jobs)
        play(folder, tasks, told.rounds, told.jobs)
    named = {tuple(task.split()) for task in tasks}
    rows = [row for row in rows_of(folder) if tuple(str(x) for x in row[:5]) in named]
    by_scene = {name: [row for row in rows if row.scene == name] for name in known}
    by_scene = {name: of_scene for name, of_scene in by_scene.items() if of_scene}
    if not by_scene:
        sys.exit("no results")
    write_data(rows, by_scene, known)
    command = "bash bench/run tradeoff --publish" + " --quick" * told.quick
    text = page(by_scene, known, rows, command, told.rounds)
    (ROOT / "bench/out/tradeoff.md").write_text("\n".join(text) + "\n")
    print("\n".join(text))
    if shutil.which("gnuplot") and told.publish:
        draw(rows, by_scene, known)
        head = (PAGE / "head.md").read_text()
        (PAGE / "README.md").write_text(head + "\n" + "\n".join(text) + "\n")


if __name__ == "__main__":
    main()
