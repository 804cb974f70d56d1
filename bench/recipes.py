#!/usr/bin/env python3
"""Only what a scene requires: what typical games pay for a recipe that knows everything, and for one made for them

    bash bench/run recipes [--quick] [--rounds N] [--compiler CXX] [--publish]

Compiles each game of bench/recipes at -O2 twice, with a recipe that names all shapes and joints and leaves no feature
out, and with one that names what the game needs; measures the compiler's CPU time and the machine code of the unit, then
plays both by turns: CPU time a frame, minimum and median over rounds; bytes that a copy of the world holds. Both play
the same scene, in which features that the game leaves out are not used. Writes bench/out/recipes.csv and .md; --publish
also writes the page bench/recipes/README.md.
"""
import argparse
import csv
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))
from features import compiled, progress  # noqa: E402

BUILD = ROOT / "build/bench/recipes.d"
PAGE = ROOT / "bench/recipes/README.md"
OUT = ROOT / "bench/out/recipes.csv"
GAMES = sorted(path.stem for path in (ROOT / "bench/recipes").glob("*.cpp"))
COLUMNS = ["game", "recipe", "bodies", "ms_min", "ms_median", "bytes", "code", "compile_s", "place"]


def build(compiler):
    """(game, recipe): (program, seconds, bytes of code)"""
    BUILD.mkdir(parents=True, exist_ok=True)
    built = {}
    for i, (game, everything) in enumerate((game, e) for game in GAMES for e in (1, 0)):
        recipe = "everything" if everything else "tailored"
        progress(i, 2 * len(GAMES), f"compiling {game}, {recipe}")
        target = BUILD / f"{game}_{recipe}.o"
        seconds, code = compiled(compiler, ROOT / f"bench/recipes/{game}.cpp", target, f"-DEVERYTHING={everything}")
        subprocess.run([compiler, target, "-o", target.with_suffix("")], check=True)
        built[game, recipe] = (target.with_suffix(""), seconds, code)
    progress(1, 1, "")
    return built


def recipe_of(game):
    """The tailored recipe as the source has it, on one line."""
    text = (ROOT / f"bench/recipes/{game}.cpp").read_text()
    text = " ".join(text[text.index("struct tailored"):].split("{}")[0].split())
    return text.removeprefix("struct tailored :").replace("physics::", "").replace("<S,", "<fixed32,").strip()


def about(game):
    return (ROOT / f"bench/recipes/{game}.cpp").read_text().splitlines()[0].removeprefix("// ")


def page(rows, command, rounds):
    lines = ["# Only what a scene requires", "",
             "Typical games, each with a recipe that names every shape and joint and leaves no feature out, and with one "
             "made for it. A recipe costs what it names: code, compile time and memory come from shapes, joints and "
             "features; time comes most from features that work (rotation, sleeping, sweeps), less from those that wait.", "",
             f"Written by `{command}`: {rounds} rounds by turns, CPU time of one thread, minimum and median over rounds. "
             "A frame is a step of 1/60 s. Bytes: what a copy of the world holds. Code: of the whole unit.", "",
             "| game | recipe | bodies | ms a frame | median | kB held | code | compile |", "|---|---|---|---|---|---|---|---|"]
    for row in rows:
        lines.append(f"| {row['game'] if row['recipe'] == 'everything' else ''} | {row['recipe']} | {row['bodies']} | "
                     f"{row['ms_min']:.3g} | {row['ms_median']:.3g} | {row['bytes'] / 1e3:.0f} | "
                     f"{row['code'] / 1e3:.0f} kB | {row['compile_s']:.1f} s |")
    lines += ["", "## The games and their recipes", ""]
    for game in GAMES:
        lines += [f"**{game}**: {about(game)}", "", f"`{recipe_of(game)}`", ""]
    return lines


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--quick", action="store_true")
    arguments.add_argument("--rounds", type=int, default=0)
    arguments.add_argument("--compiler", default=os.environ.get("CXX", "c++"))
    arguments.add_argument("--publish", action="store_true")
    told = arguments.parse_args()
    rounds = told.rounds or (3 if told.quick else 15)
    built = build(told.compiler)
    played = {which: [] for which in built}
    for i in range(rounds):
        for n, (which, (program, _, _)) in enumerate(built.items()):
            progress(i * len(built) + n, rounds * len(built), ", ".join(which))
            played[which].append(subprocess.run([program, "1"], check=True, text=True,
                                                stdout=subprocess.PIPE).stdout.strip().split(","))
    progress(1, 1, "")
    rows = []
    for (game, recipe), runs in played.items():
        if len({(run[2], run[4]) for run in runs}) > 1:
            sys.exit(f"{game}, {recipe}: two runs end in other places")
        times = [float(run[0]) for run in runs]
        _, seconds, code = built[game, recipe]
        rows.append(dict(zip(COLUMNS, [game, recipe, int(runs[0][2]), min(times), statistics.median(times),
                                       int(runs[0][3]), code, seconds, runs[0][4]])))
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    text = "\n".join(page(rows, "bash bench/run recipes --publish" + " --quick" * told.quick, rounds)).rstrip() + "\n"
    OUT.with_suffix(".md").write_text(text)
    print(text)
    if told.publish:
        PAGE.write_text(text)


if __name__ == "__main__":
    main()
