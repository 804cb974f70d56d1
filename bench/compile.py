#!/usr/bin/env python3
"""CPU seconds that a compiler spends on physics.hpp and on the hello sample, against the budgets

    python3 bench/compile.py [--quick]    --quick: fewer runs, and without the floors

User and system time of the compiler and what it starts, at -O2; runs are interleaved, so that a busy moment hits all
rows alike. Includes count over an empty unit. The verdict takes the minimum, the run that was disturbed least. Floors
count from the ground up: each row has all parts up to that floor. Writes bench/out/compile.csv; exit code 1 where a
budget is exceeded.
"""
import argparse
import os
import pathlib
import re
import shutil
import statistics
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
CSV = ROOT / "bench/out/compile.csv"
HELLO = ROOT / "samples/01_hello.cpp"
COMPILERS = ["g++", "clang++"]
FLOORS = ["base", "space", "shape", "collide", "broadphase", "dynamics", "world", "loop", "kit"]
INCLUDE_BUDGET = 0.5
HELLO_BUDGET = 3.0
# A unit that uses a world which another one compiles.
SHARED = ROOT / "samples/05_two_units.cpp"
EMPTY = "empty unit"


def seconds(command):
    """CPU time of the process and all that it waited for."""
    child = os.posix_spawnp(command[0], command, os.environ)
    _, status, usage = os.wait4(child, 0)
    if status:
        sys.exit(f"failed: {' '.join(command)}")
    return usage.ru_utime + usage.ru_stime


def progress(done, total, what):
    if sys.stderr.isatty():
        width = 30 * done // total
        print(f"\r\033[K[{'#' * width:30}] {done}/{total} {what}", end="" if done < total else "\r\033[K", file=sys.stderr,
              flush=True)


def units(quick):
    """What is measured: name, source text or file, include folder, budget (None: no budget), whether over an empty unit."""
    top = (ROOT / "physics.hpp").read_text(encoding="utf-8").split("\n// ===")[0]
    standard = re.findall(r"^#include <.*>$", top, re.MULTILINE)
    yield EMPTY, "", ".", None, False
    yield "its standard headers", "\n".join(standard), ".", None, True
    if not quick:
        parts = []
        for floor in FLOORS:
            found = sorted((ROOT / "include/physics" / floor).rglob("*.hpp"))
            if found:
                parts += [f'#include "{path.relative_to(ROOT / "include")}"' for path in found]
                yield f"up to {floor}/", "\n".join(parts), "include", None, True
    yield "physics.hpp", "#include <physics.hpp>", ".", INCLUDE_BUDGET, True
    if HELLO.is_file():
        yield "01_hello.cpp (linked)", HELLO, ".", HELLO_BUDGET, False
    yield SHARED.name, SHARED, ".", None, False


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--quick", action="store_true")
    quick = arguments.parse_args().quick
    runs = 3 if quick else 7
    compilers = [compiler for compiler in COMPILERS if shutil.which(compiler)]
    with tempfile.TemporaryDirectory() as folder:
        jobs = []
        for i, (name, source, include, budget, over_empty) in enumerate(units(quick)):
            path = source
            if isinstance(source, str):
                path = pathlib.Path(folder) / f"{i}.cpp"
                path.write_text(source + "\n", encoding="utf-8")
            for compiler in compilers:
                command = [compiler, "-std=c++20", "-O2", f"-I{ROOT / include}", str(path), "-o", f"{folder}/out"]
                if path != HELLO:
                    command.append("-c")
                jobs.append((name, compiler, budget, over_empty, command, []))
        for run in range(runs):
            for i, (name, compiler, _, _, command, times) in enumerate(jobs):
                progress(run * len(jobs) + i, runs * len(jobs), f"{compiler}, {name}")
                times.append(seconds(command))
        progress(runs * len(jobs), runs * len(jobs), "")
    empty = {compiler: times for name, compiler, _, _, _, times in jobs if name == EMPTY}
    rows = []
    for name, compiler, budget, over_empty, _, times in jobs:
        base = empty[compiler] if over_empty else [0.0] * runs
        least = min(times) - min(base)
        middle = statistics.median(times) - statistics.median(base)
        verdict = "" if budget is None else "pass" if least <= budget else "over"
        rows.append((name, compiler, least, middle, "" if budget is None else f"{budget:.1f}", verdict))
    print(f"{'CPU seconds at -O2':28}{'compiler':>10}{'minimum':>10}{'median':>10}{'budget':>10}")
    for name, compiler, least, middle, budget, verdict in rows:
        print(f"{name:28}{compiler:>10}{least:10.3f}{middle:10.3f}{budget:>10}  {verdict}".rstrip())
    CSV.parent.mkdir(exist_ok=True)
    with CSV.open("w", encoding="utf-8") as out:
        print("what,compiler,minimum_s,median_s,budget_s,verdict", file=out)
        for name, compiler, least, middle, budget, verdict in rows:
            print(f"{name},{compiler},{least:.4f},{middle:.4f},{budget},{verdict}", file=out)
    return any(row[-1] == "over" for row in rows)


if __name__ == "__main__":
    sys.exit(main())
