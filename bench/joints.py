#!/usr/bin/env python3
"""What joints cost: machine code, compile time, memory, time; and how far a loaded chain opens, by substeps

    python3 bench/joints.py [--quick] [2d] [3d] [--compiler CXX]    --quick: 8 s of the chain instead of 20

Compiles bench/joints/world.cpp at -O2 once for a recipe that names no joints, for each kind, and for all kinds at once.
Code is the machine code of that unit, which makes, steps and copies such a world; of each kind what it adds to that of
none. Bytes are those a joint takes in a copy, and what a step works with besides; time is CPU time a joint and step at
the default 4 substeps, of 512 joints of default values, each between a static body and a ball (float, minimum). Then a
chain of 40 links swings a ball of 672 times the mass of one for 20 s: its largest gap and the time of a step, solved
directly and by iterations, are in bench/out/joints.csv. The table of README goes to bench/out/joints.md; its picture is
drawn by

    gnuplot -e "csv='bench/out/joints.csv'; picture='bench/joints.svg'" bench/joints.gp
"""
import argparse
import os
import pathlib
import subprocess
import sys

from features import compiled, progress

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/bench/joints.d"
CSV = ROOT / "bench/out/joints.csv"
KINDS = ["ball", "cone", "distance", "filter", "gear", "motor", "prismatic", "pulley", "rack", "revolute",
         "six_degrees", "swing_twist", "target", "weld", "wheel"]
IN_3D = {"cone", "swing_twist"}


def kinds_of(dimension):
    return [kind for kind in KINDS if dimension == 3 or kind not in IN_3D]


def names_joints(target):
    """How many functions and objects of it name joints."""
    names = subprocess.run(["nm", "-C", target], check=True, text=True, stdout=subprocess.PIPE).stdout.splitlines()
    # A recipe's policies are part of its name.
    return sum("joint" in name.replace("physics::joints<>", "").replace("stage::joints", "") for name in names)


def measured(compiler, dimensions):
    """For each dimension and set of kinds: (bytes of code, seconds, [bytes a copy, bytes at work, ns] or None)."""
    main = BUILD / "main.o"
    compiled(compiler, ROOT / "bench/joints/main.cpp", main)
    jobs = [(dimension, name) for dimension in dimensions for name in ["none", *kinds_of(dimension), "all"]]
    result = {}
    for i, (dimension, name) in enumerate(jobs):
        progress(i, len(jobs), f"compiling a world in {dimension}D with joints of {name}")
        named = {"none": [], "all": kinds_of(dimension)}.get(name, [name])
        flags = [f"-DDIMENSION={dimension}"]
        if named:
            flags.append(f"-DKINDS=joints<{', '.join(f'physics::{kind}_joint' for kind in named)}>")
        target = BUILD / f"world{dimension}_{name}.o"
        seconds, code = compiled(compiler, ROOT / "bench/joints/world.cpp", target, *flags)
        figures = None
        if name == "none":
            print(f"{dimension}D: {names_joints(target)} symbols of a world without joints name any")
        elif name != "all":
            program = BUILD / f"world{dimension}_{name}"
            subprocess.run([compiler, main, target, "-o", program], check=True)
            line = subprocess.run([program], check=True, text=True, stdout=subprocess.PIPE).stdout
            figures = [float(x) for x in line.split(",")]
        result[dimension, name] = (code, seconds, figures)
    progress(1, 1, "")
    return result


def markdown(found, dimensions):
    """The table of README."""
    heads = ["Joints"]
    for dimension in dimensions:
        heads += [f"{dimension}D: code", "compile", "bytes a joint", "at work", "ns a joint"]
    rows = [heads, ["---"] * len(heads)]
    for name in ["none", *KINDS, "all"]:
        row = [name.replace("_", " ")]
        for dimension in dimensions:
            base_code, base_seconds, _ = found[dimension, "none"]
            if (dimension, name) not in found:
                row += [""] * 5
                continue
            code, seconds, figures = found[dimension, name]
            if name == "none":
                row += [f"{code / 1e3:.0f} kB", f"{seconds:.1f} s", "0", "0", "0"]
                continue
            row += [f"+{(code - base_code) / 1e3:.0f} kB", f"+{seconds - base_seconds:.1f} s"]
            row += [f"{max(x, 0):.0f}" for x in figures] if figures else [""] * 3
        rows.append(row)
    return "".join(f"| {' | '.join(row)} |\n" for row in rows).replace("| --- | --- |", "|---|---|").replace(" --- |",
                                                                                                        "---|")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--quick", action="store_true")
    arguments.add_argument("dimensions", nargs="*", metavar="2d|3d", help="default: both")
    arguments.add_argument("--compiler", default=os.environ.get("CXX", "c++"))
    given = arguments.parse_args()
    if set(given.dimensions) - {"2d", "3d"}:
        arguments.error("dimensions are 2d and 3d")
    dimensions = sorted({int(name[0]) for name in given.dimensions}) or [2, 3]
    BUILD.mkdir(parents=True, exist_ok=True)
    CSV.parent.mkdir(parents=True, exist_ok=True)
    text = markdown(measured(given.compiler, dimensions), dimensions)
    print(text)
    CSV.with_suffix(".md").write_text(text, encoding="utf-8")
    chain = BUILD / "chain"
    subprocess.run([given.compiler, "-std=c++20", "-O2", f"-I{ROOT}", ROOT / "bench/joints/chain.cpp", "-o", chain],
                   check=True)
    rows = subprocess.run([chain, "480" if given.quick else "1200"], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    print(rows, end="")
    CSV.write_text(rows, encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
