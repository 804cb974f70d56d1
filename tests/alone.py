#!/usr/bin/env python3
"""Each part compiles alone, by one of both compilers in turn, and all of them under each option by both, warning-clean;
so do the benchmarks' units, but for those that name a peer.

    python3 tests/alone.py [NAME...]    NAME: only the parts whose path contains one of these, by both compilers; so are
                                        all with EVERYTHING=1 in the environment

A part that leans on what another file happened to include breaks its first user, and a benchmark that nobody compiles
breaks unseen. Last line: `N passed, M failed`.
"""
import concurrent.futures
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMPILERS = ["g++", "clang++"]
FLAGS = ["-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-pedantic", "-Werror"]
OPTIONS = [[], ["-fno-exceptions", "-fno-rtti"], ["-DPHYSICS_HPP_NO_INT128"], ["-DPHYSICS_HPP_AUDIT"],
           ["-DPHYSICS_HPP_NONDETERMINISTIC", "-ffast-math"], ["-march=native"], ["-std=c++2b"]]
# What the scripts of bench define where they compile a unit for each of several values.
BENCH = ["-DSCALAR=float", "-DDIMENSION=2", "-DNAME=plain", "-DLEFT_OUT=physics::feature::sleeping",
         "-DSOLVER=soft_step", "-DHAS_JOINTS=1"]


def compiles(job):
    compiler, header, options = job
    done = subprocess.run([compiler, *FLAGS, *options, "-Iinclude", "-I.", "-x", "c++", "-"], cwd=ROOT, text=True,
                          errors="replace", input=f'#include "{header}"\n', stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    return job, done.returncode == 0, done.stdout


def main():
    include = ROOT / "include"
    parts = [str(path.relative_to(include)) for path in sorted((include / "physics").rglob("*.hpp"))]
    wanted = sys.argv[1:]
    jobs = [(compiler, part, []) for i, part in enumerate(parts) for k, compiler in enumerate(COMPILERS)
            if (any(name in part for name in wanted) if wanted else i % 2 == k or os.environ.get("EVERYTHING"))]
    if not wanted:
        jobs += [(compiler, "physics.hpp", options) for options in OPTIONS for compiler in COMPILERS]
        units = [path for path in sorted((ROOT / "bench").rglob("*.cpp")) if "// peer: " not in path.read_text()]
        jobs += [(COMPILERS[i % 2], str(unit.relative_to(ROOT)), BENCH) for i, unit in enumerate(units)]
    passed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for (compiler, header, options), good, output in pool.map(compiles, jobs):
            passed += good
            if not good:
                print(" ".join([compiler, *options, header]))
                print("\n".join("    " + line for line in output.splitlines()[:8]))
    print(f"{passed} passed, {len(jobs) - passed} failed")
    return passed != len(jobs) or not jobs


if __name__ == "__main__":
    sys.exit(main())
