#!/usr/bin/env python3
"""What each feature costs: time of a step, memory, machine code and compile time, with it and without

    python3 bench/features.py [--quick] [2d] [3d] [--rounds N] [--compiler CXX]    --quick: small scenes, fewer rounds

Compiles bench/features/world.cpp at -O2 once for each set of features that a recipe leaves out, counts the machine code
of the object, and plays scenes in all worlds by turns: CPU time a step and body, each step's least over the rounds, on
average; and the median of the rounds. Worlds are float, know balls and boxes, and let nobody sleep, though all are
watched; no surface bounces, resists rolling, or runs: but for friction, rotation, and sweeps of the fastest bodies in
the drum, features are there and wait. Without rotation the drum stands, and boxes keep the way up that they are given.
All surfaces of a scene are alike: without materials a shape, settings say how. Bytes are what a fresh copy of a world
holds. Writes bench/out/features.csv, and the tables of README to bench/out/features.md.
"""
import argparse
import csv
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/bench/features.d"
CSV = ROOT / "bench/out/features.csv"
FEATURES = ["friction", "restitution", "rotation", "rolling_resistance", "surface_velocity", "materials", "sleeping",
            "continuous"]
LEFT_OUT = {"nothing": [], **{feature: [feature] for feature in FEATURES}, "all": FEATURES}
SCENES = ["resting pyramid", "tumbling pile", "falling apart"]


def progress(done, total, what):
    if sys.stderr.isatty():
        width = 30 * done // total
        print(f"\r\033[K[{'#' * width:30}] {done}/{total} {what}", end="" if done < total else "\r\033[K",
              file=sys.stderr, flush=True)


def compiled(compiler, source, target, *flags):
    """CPU seconds of the compiler, and the object's bytes of machine code."""
    command = [compiler, "-std=c++20", "-O2", f"-I{ROOT}", *flags, "-c", str(source), "-o", str(target)]
    child = os.posix_spawnp(command[0], command, os.environ)
    _, status, usage = os.wait4(child, 0)
    if status:
        sys.exit(f"failed: {' '.join(command)}")
    sections = subprocess.run(["size", "-A", "-d", str(target)], check=True, text=True, stdout=subprocess.PIPE).stdout
    rows = [line.split() for line in sections.splitlines()]
    code = sum(int(row[1]) for row in rows if len(row) == 3 and row[0].startswith(".text"))
    return usage.ru_utime + usage.ru_stime, code


def build(compiler, dimensions, runs):
    """The program, and (seconds, bytes of code) of each world."""
    BUILD.mkdir(parents=True, exist_ok=True)
    objects, units = [], {}
    for source in ["bench/scenes/makers2.cpp", "bench/scenes/makers3.cpp", "bench/features/main.cpp"]:
        objects.append(BUILD / (pathlib.Path(source).stem + ".o"))
        compiled(compiler, ROOT / source, objects[-1])
    jobs = [(dimension, name) for dimension in dimensions for name in LEFT_OUT]
    for run in range(runs):
        for i, (dimension, name) in enumerate(jobs):
            progress(run * len(jobs) + i, runs * len(jobs), f"compiling a world in {dimension}D without {name}")
            target = BUILD / f"world{dimension}_{name}.o"
            seconds, code = compiled(compiler, ROOT / "bench/features/world.cpp", target, f"-DDIMENSION={dimension}",
                                     f"-DLEFT_OUT={','.join(LEFT_OUT[name])}", f"-DNAME={name}")
            units[dimension, name] = (min(seconds, units.get((dimension, name), (seconds,))[0]), code)
            if run == 0:
                objects.append(target)
    progress(1, 1, "")
    program = BUILD / "features"
    subprocess.run([compiler, *map(str, objects), "-o", str(program)], check=True)
    return program, units


def table(rows, units, dimension):
    """For each set of features that is left out: what is measured, as a dictionary."""
    found = {(row["scene"], row["left_out"]): row for row in rows if row["dimension"] == str(dimension)}
    result = []
    for name in LEFT_OUT:
        falling, resting = found[SCENES[2], name], found[SCENES[0], name]
        body = float(falling["bytes_of_copy"]) / float(falling["bodies"])
        contact = (float(resting["bytes_of_copy"]) - body * float(resting["bodies"])) / float(resting["contacts"])
        seconds, code = units[dimension, name]
        line = {"dimension": dimension, "left_out": name}
        for scene in SCENES:
            row = found[scene, name]
            key = scene.split()[0]
            line[f"{key}_ns"], line[f"{key}_ns_median"] = float(row["ns"]), float(row["ns_median"])
            line[f"{key}_contacts"] = float(row["contacts"]) / float(row["bodies"])
            line[f"{key}_same"] = row["places"] == found[scene, "nothing"]["places"]
        line |= {"bytes_a_body": body, "bytes_a_contact": contact,
                 "bytes_at_work": float(resting["bytes_at_work"]) / float(resting["bodies"]),
                 "code": code, "compile_s": seconds}
        result.append(line)
    return result


def change(line, full, key):
    return 100 * (line[key] / full[key] - 1)


def show(lines):
    full = lines[0]
    print(f"\n{full['dimension']}D{'':19}ns a body and step: minimum, median, change of the minimum; contacts a body")
    print(f"{'left out':20}{'resting':^33}{'tumbling':^33}{'falling':^33}{'B/body':>8}{'B/contact':>10}{'at work':>8}"
          f"{'code kB':>9}{'compile s':>10}")
    for line in lines:
        print(f"{line['left_out']:20}", end="")
        for key in ["resting", "tumbling", "falling"]:
            part = f"{change(line, full, key + '_ns'):+.1f} %" if line is not full else ""
            mark = " " if line[f"{key}_same"] else "*"
            print(f"{line[key + '_ns']:8.1f}{line[key + '_ns_median']:8.1f}{part:>9}{mark}", end="")
            print(f"{line[key + '_contacts']:5.2f}  ", end="")
        print(f"{line['bytes_a_body']:8.0f}{line['bytes_a_contact']:10.0f}{line['bytes_at_work']:8.0f}"
              f"{line['code'] / 1e3:9.1f}{line['compile_s']:10.2f}")


def markdown(tables):
    """The table of README: the whole recipe, and what leaving out changes."""
    heads, rows = ["Left out"], [[name.replace("_", " ")] for name in LEFT_OUT]
    for lines in tables:
        full = lines[0]
        heads += [f"{full['dimension']}D: pyramid", "pile", "falling", "bytes a body", "a contact", "code",
                  "compile"]
        for row, line in zip(rows, lines):
            times = [line[key + "_ns"] for key in ["resting", "tumbling", "falling"]]
            if line is full:
                row += [f"{ns:,.0f} ns" for ns in times]
                row += [f"{line['bytes_a_body']:.0f}", f"{line['bytes_a_contact']:.0f}", f"{line['code'] / 1e3:.0f} kB",
                        f"{line['compile_s']:.1f} s"]
                continue
            row += [f"{change(line, full, key + '_ns'):+.0f} %" + ("" if line[key + "_same"] else " *")
                    for key in ["resting", "tumbling", "falling"]]
            row += [f"{line[key] - full[key]:+.0f}" for key in ["bytes_a_body", "bytes_a_contact"]]
            row += [f"{change(line, full, key):+.0f} %" for key in ["code", "compile_s"]]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in [heads, ["---"] * len(heads), *rows]).replace(
        "| --- | --- |", "|---|---|").replace(" --- |", "---|")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--quick", action="store_true")
    arguments.add_argument("dimensions", nargs="*", metavar="2d|3d", help="default: both")
    arguments.add_argument("--rounds", type=int, default=0)
    arguments.add_argument("--compiler", default=os.environ.get("CXX", "c++"))
    given = arguments.parse_args()
    if set(given.dimensions) - {"2d", "3d"}:
        arguments.error("dimensions are 2d and 3d")
    dimensions = sorted({int(name[0]) for name in given.dimensions}) or [2, 3]
    program, units = build(given.compiler, dimensions, 1 if given.quick else 2)
    command = [program] + ["--quick"] * given.quick + ["--rounds", str(given.rounds)] * (given.rounds > 0)
    printed = subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE).stdout
    rows = list(csv.DictReader(printed.splitlines()))
    sizes = {(row["dimension"], row["scene"]): row["bodies"] for row in rows}
    print("\n".join(f"{dimension}D {scene}: {bodies} bodies" for (dimension, scene), bodies in sizes.items()))
    tables = [table(rows, units, dimension) for dimension in dimensions]
    for lines in tables:
        show(lines)
    print("\n* the motion is another one, or at least its bits are. B: bytes that a copy holds; at work: bytes a body "
          "that the\npyramid holds, with what a step needs besides. Code: of a unit that makes and steps such a world.")
    CSV.parent.mkdir(parents=True, exist_ok=True)
    with CSV.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, tables[0][0].keys(), lineterminator="\n")
        writer.writeheader()
        for lines in tables:
            for line in lines:
                writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value
                                 for key, value in line.items()})
    CSV.with_suffix(".md").write_text(markdown(tables), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
