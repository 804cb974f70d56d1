#!/usr/bin/env python3
"""Flags that break the promise of the same bits: refused at compile time, disarmed, or found by the probe.

    python3 tests/refusals/check.py [COMPILER [INCLUDE]]    default: g++ and clang++, and this repository's include/

    refused    the compiler stops with the one sentence of config.hpp, unless PHYSICS_HPP_NONDETERMINISTIC is defined
    probed     what no macro shows is found by float_environment(), or does not reach the library's code
    the same   inline functions of the library return the same bits under all flags that are let through
Skipped with a word: what compiler or processor can't do. Last line: `N passed, M failed`.
"""
import concurrent.futures
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
X86 = platform.machine() in ("x86_64", "AMD64")

MACRO = "drop that flag for this file, or define PHYSICS_HPP_NONDETERMINISTIC"
FAST = "physics.hpp promises the same bits everywhere, which -ffast-math breaks: " + MACRO
UNSAFE = ("physics.hpp promises the same bits everywhere, which flags such as -fassociative-math break: "
          "drop them for this file, or define PHYSICS_HPP_NONDETERMINISTIC")
X87 = ("physics.hpp promises the same bits everywhere, which x87 arithmetic breaks: "
       "add -msse2 -mfpmath=sse, or define PHYSICS_HPP_NONDETERMINISTIC")
CPP20 = "physics.hpp needs C++20: compile with -std=c++20 or later"
LOOSE = "-DPHYSICS_HPP_NONDETERMINISTIC"
ASSOCIATIVE = "-fassociative-math -fno-signed-zeros -fno-trapping-math"

CONTRACTION, EXTENDED, REASSOCIATION, SIGNS, DIVISION, ROOTS, ROUNDING, FLUSH, DENORMALS = (1 << i for i in range(9))
CONTROL = FLUSH | DENORMALS  # what linking with -ffast-math switches on
UNSAFE_CODE = REASSOCIATION | SIGNS | DIVISION  # what compiling with it does

# Flags, the sentence, and how many errors there may be: the second one ends the compilation.
REFUSED = {
    "g++": [
        ("-ffast-math", FAST, 1), ("-Ofast", FAST, 1), ("-ffinite-math-only", FAST, 1), (ASSOCIATIVE, UNSAFE, 1),
        ("-freciprocal-math", UNSAFE, 1), ("-fno-signed-zeros", UNSAFE, 1), ("-funsafe-math-optimizations", UNSAFE, 1),
        ("-fsingle-precision-constant", UNSAFE, 1), ("-mfpmath=387", X87, 1), ("-mfpmath=both", X87, 1),
        ("-m32 -mno-sse", X87, 1), ("-m32", X87, 1),
        ("-U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=2", X87, 1), ("-std=c++17", CPP20, 2), ("-std=c++14", CPP20, 2),
    ],
    "clang++": [
        ("-ffast-math", FAST, 1), ("-Ofast", FAST, 1), ("-ffinite-math-only", FAST, 1), ("-m32 -mno-sse", X87, 1),
        ("-U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=2", X87, 1), ("-std=c++17", CPP20, 2), ("-std=c++14", CPP20, 2),
    ],
}

# Flags; the faults that must be found in the library's code, in the unit's own, and in the library's code within a
# scope that repairs the control word. None: anything. FMA marks what only processors with a fused multiply-add show.
FMA = 1 << 31
PROBED = {
    "g++": [
        ("-O0", 0, 0, 0), ("-O2", 0, 0, 0), ("-O0 -march=native", 0, 0, 0),
        ("-O2 -march=native", 0, CONTRACTION | FMA, 0), ("-O3 -march=native", 0, CONTRACTION | FMA, 0),
        ("-O3 -march=native -ffp-contract=fast", 0, CONTRACTION | FMA, 0),
        ("-O3 -march=native -ffp-contract=off", 0, 0, 0), ("-O2 -march=native -flto", 0, CONTRACTION | FMA, 0),
        ("-O2 -fno-math-errno -fno-trapping-math", 0, 0, 0), ("-O2 -frounding-math", 0, 0, 0),
        (f"-O2 {LOOSE} -march=native", CONTRACTION | FMA, CONTRACTION | FMA, CONTRACTION | FMA),
        (f"-O2 {LOOSE} -ffast-math", CONTROL | UNSAFE_CODE, None, UNSAFE_CODE),
        (f"-O2 {LOOSE} -ffast-math -mrecip=all", CONTROL | UNSAFE_CODE | ROOTS, None, None),
        (f"-O2 {LOOSE} {ASSOCIATIVE}", REASSOCIATION | SIGNS, REASSOCIATION | SIGNS, REASSOCIATION | SIGNS),
        (f"-O2 {LOOSE} -freciprocal-math", DIVISION, DIVISION, DIVISION),
        (f"-O2 {LOOSE} -fno-signed-zeros", SIGNS, SIGNS, SIGNS),
        (f"-O2 {LOOSE} -mfpmath=387", EXTENDED, EXTENDED, EXTENDED),
    ],
    "clang++": [
        ("-O0", 0, 0, 0), ("-O2", 0, 0, 0),
        ("-O2 -march=native", 0, CONTRACTION | FMA, 0), ("-O3 -march=native", 0, CONTRACTION | FMA, 0),
        # The one that clang's pragma does not keep out of the library.
        ("-O3 -march=native -ffp-contract=fast", CONTRACTION | FMA, CONTRACTION | FMA, CONTRACTION | FMA),
        ("-O3 -march=native -ffp-contract=off", 0, 0, 0), ("-O2 -frounding-math", 0, 0, 0),
        ("-O2 -ffp-model=strict", 0, 0, 0),
        (f"-O2 {ASSOCIATIVE}", 0, REASSOCIATION | SIGNS, 0),
        ("-O2 -freciprocal-math", 0, DIVISION, 0), ("-O2 -fno-signed-zeros", 0, SIGNS, 0),
        ("-O3 -funsafe-math-optimizations", CONTROL, None, 0),
        (f"-O2 {LOOSE} -ffast-math", CONTROL | UNSAFE_CODE, None, UNSAFE_CODE),
        (f"-O2 {LOOSE} {ASSOCIATIVE}", REASSOCIATION | SIGNS, REASSOCIATION | SIGNS, REASSOCIATION | SIGNS),
    ],
}

SAME = {
    "g++": ["-O0", "-O2", "-O0 -march=native", "-O1 -march=native", "-O2 -march=native", "-O3 -march=native",
            "-O3 -march=native -ffp-contract=fast", "-O2 -march=native -flto", "-O3 -march=native -fno-math-errno",
            "-O2 -U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=16"],
    "clang++": ["-O0", "-O2", "-O0 -march=native", "-O1 -march=native", "-O2 -march=native", "-O3 -march=native",
                f"-O3 -march=native {ASSOCIATIVE} -freciprocal-math", "-O3 -funsafe-math-optimizations"],
}
REFERENCE = "-O0 -ffp-contract=off"
UNSAFE_FLAGS = re.compile("unsafe|associative")  # these change the unit's own sums by right

ERROR = re.compile(r"^(?:[^\s:][^:]*:(?:\d+:)*\s+)?(?:fatal )?error: (.*)$", re.MULTILINE)


class Skipped(Exception):
    pass


def run(command, **options):
    return subprocess.run([str(word) for word in command], text=True, errors="replace", stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, env={**os.environ, "LC_ALL": "C"}, **options)


class Checks:
    def __init__(self, compiler, include, folder):
        self.compiler = compiler
        self.family = "clang++" if "clang" in run([compiler, "--version"]).stdout else "g++"
        self.include = include
        self.folder = pathlib.Path(folder)
        self.fma = "fma" in (pathlib.Path("/proc/cpuinfo").read_text() if X86 else "fma")

    def compile(self, source, flags, *more):
        return run([self.compiler, "-std=c++20", f"-I{self.include}", "-w", *flags.split(), source, *more])

    def supports(self, flags):
        """Whether the compiler takes the flags at all, and finds its standard library then."""
        return run([self.compiler, *flags.split(), "-fsyntax-only", "-x", "c++", "-"],
                   input="#include <cstdio>\n").returncode == 0

    def output(self, name, source, flags, *more):
        program = self.folder / f"{self.family}-{name}"
        done = self.compile(HERE / source, flags, "-o", program, *more)
        if done.returncode:
            raise AssertionError(f"does not compile:\n{done.stdout}")
        return run([program], timeout=120).stdout.split()

    def refused(self, flags, sentence, errors):
        if not self.supports(flags.replace("-ffast-math", "")):
            raise Skipped
        said = [message.replace('\\"', '"') for message in ERROR.findall(
            self.compile(HERE / "unit.cpp", flags, "-fsyntax-only").stdout)]
        assert said, "compiles"
        assert sentence in said[0], f"says: {said[0]}"
        assert len(said) == errors, f"{len(said)} errors, not {errors}"

    def accepted(self, flags):
        """The opt-out opens the door."""
        if not self.supports(flags):
            raise Skipped
        done = self.compile(HERE / "unit.cpp", f"{flags} {LOOSE}", "-fsyntax-only")
        assert done.returncode == 0, done.stdout

    def probed(self, name, flags, *expected):
        if not self.supports(flags):
            raise Skipped
        found = [int(word) for word in self.output(name, "unit.cpp", flags)]
        where = ("the library's code", "own code", "the library's code in a scope")
        for what, mask, want in zip(where, found, expected):
            if want is None or want & FMA and not self.fma:
                continue
            want &= ~FMA
            # What nothing is promised for may have more faults, as the processor's estimates have it.
            assert (mask & want if LOOSE in flags else mask) == want, f"{what}: faults {mask:#x} instead of {want:#x}"

    def shared(self, name):
        """A library that was linked with -Ofast turns the process's control word; gcc 13 and later leave it alone."""
        library = self.folder / f"lib{self.family}.so"
        done = run([self.compiler, "-Ofast", "-shared", "-fPIC", "-x", "c++", "-", "-o", library],
                   input="double twice(double x) { return 2 * x; }\n")
        assert done.returncode == 0, done.stdout
        outside, _, inside = map(int, self.output(name, "unit.cpp", "-O2", "-Wl,--no-as-needed", library))
        assert outside in (0, CONTROL), f"faults {outside:#x}"
        assert inside == 0, f"faults {inside:#x} in a scope"

    def same(self, name, flags, reference):
        if not self.supports(flags):
            raise Skipped
        library, border, own = self.output(name, "contraction.cpp", flags)
        assert library == reference[0], f"the library's bits are {library} instead of {reference[0]}"
        if UNSAFE_FLAGS.search(flags):
            return
        assert border == reference[1], f"sums of the library's products are {border} instead of {reference[1]}"
        if self.fma and re.search("-O[23] -march=native", flags):
            assert own != reference[2], "own code is not contracted, so this check shows nothing"

    def all(self, reference):
        refused, probed, same = REFUSED[self.family], PROBED[self.family], SAME[self.family]
        if not X86:
            refused = [case for case in refused if "-m" not in case[0]]
            probed = [case for case in probed if "-mfpmath" not in case[0] and "-mrecip" not in case[0]]
        for flags, sentence, errors in refused:
            yield f"refused: {flags}", self.refused, (flags, sentence, errors)
            if sentence != CPP20:
                yield f"accepted: {flags} {LOOSE}", self.accepted, (flags,)
        for i, (flags, *expected) in enumerate(probed):
            yield f"probed: {flags}", self.probed, (f"probe{i}", flags, *expected)
        if X86:
            yield "probed: next to a shared library linked with -Ofast", self.shared, ("shared",)
        for i, flags in enumerate(same):
            yield f"the same: {flags}", self.same, (f"same{i}", flags, reference)


def outcome(job):
    label, check, arguments = job
    try:
        check(*arguments)
        return label, "passed", ""
    except Skipped:
        return label, "skipped", ""
    except Exception as problem:
        return label, "failed", str(problem) or repr(problem)


def main():
    compilers = sys.argv[1:2] or ["g++", "clang++"]
    include = pathlib.Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else ROOT / "include"
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        checks = [Checks(compiler, include, folder) for compiler in compilers]
        try:
            reference = checks[0].output("reference", "contraction.cpp", REFERENCE)
        except AssertionError as problem:
            print(f"{compilers[0]}: {REFERENCE}: {problem}\n0 passed, 1 failed")
            return 1
        for check in checks:
            for label, result, problem in pool.map(outcome, check.all(reference)):
                counts[result] += 1
                if result != "passed":
                    print(f"{check.compiler}: {label}: {result}")
                    print("".join(f"    {line}\n" for line in problem.splitlines()[:12]), end="")
    print(f"{counts['passed']} passed, {counts['failed']} failed")
    return counts["failed"] > 0 or counts["passed"] == 0


if __name__ == "__main__":
    sys.exit(main())
