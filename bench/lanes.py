#!/usr/bin/env python3
"""What wide instructions give: a step and its compile time for SSE2, for AVX2 chosen as the program runs, and for AVX2

    python3 bench/lanes.py [--quick] [--compiler CXX]    --quick: small pyramids, fewer rounds

Compiles bench/lanes/pyramid.cpp at -O2 with no flags, with -DPHYSICS_HPP_RUNTIME_AVX2 and with -mavx2, plays pyramids
at rest with all three by turns, and compares the bits of what they come to. Milliseconds of CPU time a step: the least,
and the median of the rounds' least; compile: CPU seconds, the least of the rounds. Writes bench/out/lanes.csv.
"""
import argparse
import csv
import pathlib
import statistics
import subprocess
import sys

from features import ROOT, compiled, progress

BUILD = ROOT / "build/bench/lanes.d"
CSV = ROOT / "bench/out/lanes.csv"
FLAGS = {"SSE2": [], "chosen at run time": ["-DPHYSICS_HPP_RUNTIME_AVX2"], "AVX2": ["-mavx2"]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--compiler", default="g++")
    options = parser.parse_args()
    rounds = 3 if options.quick else 8
    BUILD.mkdir(parents=True, exist_ok=True)
    CSV.parent.mkdir(parents=True, exist_ok=True)
    cells = [(scalar, dimension) for dimension in (2, 3) for scalar in ("float", "double")]
    total = len(cells) * len(FLAGS) * (rounds + 1)
    rows, done, differ = [], 0, False
    for scalar, dimension in cells:
        programs, times, hashes = {}, {name: [] for name in FLAGS}, set()
        for name, flags in FLAGS.items():
            progress(done, total, f"compiling {scalar}/{dimension}D for {name}")
            target = BUILD / f"{scalar}{dimension}_{len(programs)}"
            seconds, code = compiled(options.compiler, ROOT / "bench/lanes/pyramid.cpp", f"{target}.o",
                                     f"-DSCALAR={scalar}", f"-DDIMENSION={dimension}", *flags)
            subprocess.run([options.compiler, f"{target}.o", "-o", target], check=True)
            programs[name] = target, seconds, code
            done += 1
        size = (30 if options.quick else 60) if dimension == 2 else (8 if options.quick else 16)
        for _ in range(rounds):
            for name, (program, *_) in programs.items():
                progress(done, total, f"{scalar}/{dimension}D: {name}")
                out = subprocess.run([program, str(size), "1", "60"], check=True, text=True, stdout=subprocess.PIPE)
                least, found = out.stdout.split()
                times[name].append(float(least))
                hashes.add(found)
                done += 1
        differ = differ or len(hashes) > 1
        first = min(times["SSE2"])
        for name, (_, seconds, code) in programs.items():
            rows.append({"cell": f"{scalar}/{dimension}D", "build": name, "ms": min(times[name]),
                         "median": statistics.median(times[name]), "ratio": min(times[name]) / first,
                         "compile_s": seconds, "code_kB": code / 1000})
    progress(1, 1, "")
    print(f"{'':12}{'':20}{'ms':>9}{'median':>9}{'ratio':>7}{'compile':>9}{'code':>9}")
    for row in rows:
        print(f"{row['cell']:12}{row['build']:20}{row['ms']:9.3f}{row['median']:9.3f}{row['ratio']:7.2f}"
              f"{row['compile_s']:7.1f} s{row['code_kB']:6.0f} kB")
    with CSV.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    print("all builds come to the same bits" if not differ else "THE BITS DIFFER")
    return differ


if __name__ == "__main__":
    sys.exit(main())
