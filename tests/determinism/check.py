#!/usr/bin/env python3
"""One hash for each scene of hash.cpp, whatever compiled it: both compilers, -O1 to -O3, this machine's
own instructions, 32 bits, wasm, both 128-bit paths, the parts and the single header, and no flag that asks for it.

    python3 tests/determinism/check.py [--quick|--one]    --quick: half of the builds; EVERYTHING=1 in the environment:
                                                          more; --one: one build, whose hashes are compared with those
                                                          of the last run of several: what differs moves otherwise

The program prints `NAME HASH` lines. As a control, a build that gives up the determinism region has to differ where
the processor can fuse a product into a sum: else the scenes could not see the fusing that the region prevents.
Last line: `N passed, M failed`, counted in scenes and the control.
"""
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
OUT = ROOT / "build/determinism"
JOBS = 2 if (os.cpu_count() or 1) >= 2 else 1
MOST_SECONDS = 300  # for one run of the program; clang++ -O0 takes more than a minute
PARTS = "-Iinclude"
SINGLE = "-I."

WASM = ("clang++", "--target=wasm32-wasi", "-fno-exceptions", "-Wl,-z,stack-size=1048576")

BUILDS = [
    ("g++", "-O3", "-march=native", PARTS),
    ("clang++-19", "-O3", "-march=native", PARTS),
    ("g++-11", "-O2", PARTS),
    ("g++", "-O1", "-m32", "-msse2", "-mfpmath=sse", PARTS),
    (*WASM, "-O2", "-msimd128", "-fno-slp-vectorize", "-DPHYSICS_HPP_NO_SLP_VECTORIZE", PARTS),
    ("clang++", "-O1", SINGLE, "-DPHYSICS_HPP_NO_INT128", "-DPHYSICS_HPP_RUNTIME_AVX2"),
]
# For time, only with EVERYTHING=1 in the environment.
MORE_BUILDS = [
    ("clang++", "-O3", "-march=native", PARTS),
    ("g++", "-O0", PARTS),
    ("clang++-16", "-O2", PARTS),
    ("g++", "-O2", SINGLE, "-DPHYSICS_HPP_NO_INT128", "-DPHYSICS_HPP_RUNTIME_AVX2"),
    ("g++", "-Os", PARTS),
    ("g++", "-O2", "-flto", PARTS),
    ("g++", "-O2", PARTS),
    ("clang++", "-O2", PARTS),
    ("clang++", "-O0", PARTS),
    ("g++", "-O3", PARTS),
    ("g++", "-O3", "-floop-nest-optimize", PARTS),
    ("clang++", "-O3", PARTS),
]
CONTROL = ("g++", "-O2", "-march=native", PARTS, "-DPHYSICS_HPP_NONDETERMINISTIC", "-DCONTROL")
ONE = ("g++", "-O0", PARTS)
LAST = OUT / "hashes.txt"


def label(build):
    return " ".join(flag for flag in build if not flag.startswith(("-I", "-Wl")) or flag == SINGLE)


def can_build(build):
    """Whether the compiler is there, with the libraries of its target."""
    if not shutil.which(build[0]) or (build[: len(WASM)] == WASM and not shutil.which("node")):
        return False
    return subprocess.run([*build, "-std=c++20", "-x", "c++", "-", "-o", "/dev/null"], cwd=ROOT, text=True,
                          input="#include <vector>\nint main() {}", capture_output=True).returncode == 0


def command_of(build, program):
    if build[: len(WASM)] != WASM:
        return [program]
    version = subprocess.run(["node", "--version"], text=True, stdout=subprocess.PIPE).stdout
    old = int(version.lstrip("v").split(".")[0]) < 20  # Of Debian 12: WASI is behind a flag there.
    return ["node", "--no-warnings", *["--experimental-wasi-unstable-preview1"] * old, HERE / "wasi.mjs", program]


def scenes_of(build):
    """The scenes and their hashes as this build computes them, or what went wrong."""
    program = OUT / label(build).replace(" ", "_").replace("++", "xx")
    done = subprocess.run([build[0], "-std=c++20", *build[1:], HERE / "hash.cpp", "-o", program], cwd=ROOT, text=True,
                          errors="replace", stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode == 0:
        try:
            done = subprocess.run(command_of(build, program), cwd=ROOT, text=True, errors="replace", timeout=MOST_SECONDS,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        except subprocess.TimeoutExpired:
            return {}, f"stopped after {MOST_SECONDS} s"
    if done.returncode:
        return {}, "\n".join(done.stdout.splitlines()[:20]) or f"exit code {done.returncode}"
    return dict(line.rsplit(" ", 1) for line in done.stdout.splitlines() if line.strip()), ""


def clang_version():
    return int(subprocess.run([WASM[0], "-dumpversion"], text=True, stdout=subprocess.PIPE).stdout.split(".")[0])


def refuses_slp():
    """Whether the header refuses SIMD for wasm by a clang that would give other bits, where that is not told."""
    done = subprocess.run([*WASM, "-std=c++20", "-msimd128", "-E", HERE / "hash.cpp", PARTS, "-o", "/dev/null"], cwd=ROOT,
                          text=True, capture_output=True)
    return done.returncode != 0 and "add -fno-slp-vectorize" in done.stderr


def fuses(compiler):
    macros = subprocess.run([compiler, "-march=native", "-dM", "-E", "-x", "c++", "/dev/null"], text=True,
                            stdout=subprocess.PIPE).stdout
    return "__FP_FAST_FMAF " in macros or "__FMA__ " in macros


def main():
    quick = "--quick" in sys.argv[1:]
    builds = BUILDS[:len(BUILDS) // 2] if quick else BUILDS + MORE_BUILDS * bool(os.environ.get("EVERYTHING"))
    one = "--one" in sys.argv[1:]
    if one:
        builds = [ONE]
    for build in [build for build in builds if not can_build(build)]:
        print(f"skipped, not installed: {label(build)}")
        builds = [other for other in builds if other != build]
    control = [CONTROL] if not one and fuses(CONTROL[0]) else []
    OUT.mkdir(parents=True, exist_ok=True)
    passed = failed = 0
    hashes = {}
    started = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        results = dict(zip(builds + control, pool.map(scenes_of, builds + control)))
    for build, (scenes, wrong) in results.items():
        if wrong:
            failed += 1
            print(f"{label(build)}: {wrong}")
        elif build != CONTROL:
            for scene, value in scenes.items():
                hashes.setdefault(scene, {}).setdefault(value, []).append(label(build))
    ran = sum(not wrong for build, (_, wrong) in results.items() if build != CONTROL)
    for scene, values in hashes.items():
        same = len(values) == 1 and sum(map(len, values.values())) == ran
        passed += same
        failed += not same
        if same:
            print(f"{scene}: {next(iter(values))} in {ran} builds")
        else:
            print(f"{scene}: {len(values)} hashes")
            for value, where in values.items():
                print(f"    {value}  " + ", ".join(where))
    for build in control:
        scenes, wrong = results[build]
        seen = [scene for scene, value in scenes.items() if value not in hashes.get(scene, {})]
        if not wrong:
            passed += bool(seen)
            failed += not seen
            print(f"control without the region: {len(seen)} of {len(scenes)} scenes differ")
    if any(build[: len(WASM)] == WASM for build in builds) and clang_version() < 16:
        refused = refuses_slp()
        passed += refused
        failed += not refused
        print(f"SIMD for wasm by clang++ without -fno-slp-vectorize: {'refused' if refused else 'TAKEN'}")
    if one:
        last = dict(line.split() for line in LAST.read_text().splitlines()) if LAST.is_file() else {}
        for scene, value in sorted(results[ONE][0].items()):
            if last.get(scene, value) != value:
                print(f"{scene}: {value} instead of {last[scene]} in the last run of several builds")
    elif not failed:
        LAST.write_text("".join(f"{scene} {next(iter(values))}\n" for scene, values in hashes.items()))
    if not one and not control:
        print("control without the region: left out, this processor does not fuse")
    print(f"{time.monotonic() - started:.0f} s")
    print(f"{passed} passed, {failed} failed")
    return failed > 0 or passed == 0


if __name__ == "__main__":
    sys.exit(main())
