#!/usr/bin/env python3
"""The cheapest settings that play a scene to within a tolerance, beside the defaults

    bash bench/run choose SCENE TOLERANCE [--full]

SCENE is one of bench/tradeoff/questions.cpp, TOLERANCE in the unit of its error. Plays it with all of this library's
solvers and scalars in steps of 1/60 s (--full: in all that are tried), or takes what has been played before, and prints
what meets the tolerance for the least CPU time, of each solver and scalar. Code is the machine code of a unit that
makes and steps a world of that recipe at -O2 (gcc), compile its CPU time.
"""
import argparse
import subprocess
import sys

import tradeoff
from features import compiled

BUILD = tradeoff.ROOT / "build/bench/choose.d"


def cost(engine, dimension, has_joints):
    """CPU seconds of the compiler and bytes of machine code."""
    solver, scalar = engine.split("-")
    BUILD.mkdir(parents=True, exist_ok=True)
    scalar = "physics::fixed32" if scalar == "fixed32" else scalar
    return compiled("g++", tradeoff.ROOT / "bench/choose/world.cpp", BUILD / f"{engine}{dimension}.o",
                    f"-DDIMENSION={dimension}", f"-DSCALAR={scalar}", f"-DSOLVER={solver}",
                    f"-DHAS_JOINTS={int(has_joints)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("tolerance", type=float)
    parser.add_argument("--full", action="store_true")
    told = parser.parse_args()
    if not told.tolerance > 0:
        sys.exit(f"tolerance = {told.tolerance:g}: it must be above 0")
    sweep = ["bash", tradeoff.ROOT / "bench/run", "tradeoff", "--scenes", told.scene, "--engines",
             ",".join(tradeoff.OURS), *([] if told.full else ["--quick"])]
    done = subprocess.run(sweep, stdout=subprocess.DEVNULL)
    if done.returncode:
        sys.exit(done.returncode)
    dimension, visible, about, metric = tradeoff.scenes()[told.scene]
    rows = [row for row in tradeoff.rows_of(tradeoff.place()) if row.scene == told.scene and tradeoff.is_ours(row)]
    usual = next(row for row in rows if row.engine == "soft_step-float" and (row.rate, row.substeps) == (60, 4))
    print(f"{told.scene}: {about}\n{metric}; visible from {visible:g}, wanted {told.tolerance:g}\n")
    print(f"{'':10}{'solver and scalar':28}{'settings':26}{'error':>10}{'ms / s':>9}{'code kB':>9}{'compile s':>11}")

    def say(what, row):
        seconds, code = cost(row.engine, dimension, "pendulum" in row.scene or "chain" in row.scene)
        print(f"{what:10}{row.engine:28}{tradeoff.settings(row):26}{row.error:>10.2g}{1e3 * row.cpu_min:>9.3g}"
              f"{code / 1000:>9.0f}{seconds:>11.1f}")

    found = [tradeoff.cheapest([row for row in rows if row.engine == engine], told.tolerance)
             for engine in sorted({row.engine for row in rows})]
    found = sorted((row for row in found if row), key=lambda row: row.cpu_min)
    for i, row in enumerate(found):
        say("cheapest" if i == 0 else "", row)
    if not found:
        best = min((row for row in rows if row.solved), key=lambda row: row.error)
        print("None of those that were tried meets it.")
        say("nearest", best)
    say("default", usual)
    if not found:
        sys.exit(1)


if __name__ == "__main__":
    main()
