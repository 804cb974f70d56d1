#!/usr/bin/env python3
"""The groups of tests, in the order in which they run: cheap checks first, heavy builds after. tests/run calls this.
What a run checks depends on the commit alone: no test passes or fails by a clock, and fuzzers have seeds and counts.

Counts doctest's test cases over all builds, the checks of each script, and one failure for each unit that does not
compile. The last line is `N passed, M failed`; the exit code is 0 only where something passed and nothing failed.
"""
import concurrent.futures
import json
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"
JOBS = os.cpu_count() or 1
TERMINAL = sys.stdout.isatty()
MOST_LINES = 20      # of what a failing unit or program says
MOST_SECONDS = 600   # for one test program
FUZZ_INPUTS = 3000   # of each fuzzer
WORLD_INPUTS = 42    # of fuzzers of whole worlds, of which one takes half a second to two and is some 100 calls of a world

COUNTED = re.compile(r"^(\d+) passed, (\d+) failed$", re.MULTILINE)
DOCTEST = re.compile(r"^\[doctest\] test cases: +\d+ \| +(\d+) passed \| +(\d+) failed", re.MULTILINE)
STEP = re.compile(r"^\[(\d+)/(\d+)\] ")


# Seconds that each group takes on two idle cores: all that the estimates of what is left are made of.
SECONDS = {"cheap": 110, "misuse": 30, "gcc": 700, "clang": 700, "determinism": 350, "sanitize": 250, "fuzz": 200,
           "quick": 300}


class Tally:
    def __init__(self):
        self.passed = 0
        self.failed = 0

    def add(self, passed, failed):
        self.passed += passed
        self.failed += failed


def clock():
    """Seconds since an arbitrary moment, and CPU seconds of all that has been run: what the budget is made of."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic(), used.ru_utime + used.ru_stime


def since(start):
    """How long ago that was, as text."""
    now = clock()
    return f"{now[0] - start[0]:.0f} s, {now[1] - start[1]:.0f} CPU s"


def left(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


class Progress:
    """Which group runs, how much is done, and how long the rest will take at the speed so far."""

    def __init__(self, groups):
        self.groups = groups
        self.done = 0.0  # of the seconds that were expected
        self.total = sum(SECONDS[group.__name__] for group in groups)
        self.started = time.monotonic()

    def begin(self, group):
        elapsed = time.monotonic() - self.started
        rest = self.total - self.done
        if self.done > 0:
            rest *= elapsed / self.done
        place = f"{self.groups.index(group) + 1} of {len(self.groups)}"
        say(f"{group.__name__} ({place}, {100 * self.done / self.total:.0f} % done, about {left(rest)} left): {group.__doc__}")

    def end(self, group):
        self.done += SECONDS[group.__name__]


def show(text):
    """One line that the next one replaces; only on a terminal."""
    if TERMINAL:
        width = shutil.get_terminal_size().columns - 1
        print(f"\r\033[K{text[:width]}", end="", flush=True)


def say(text):
    show("")
    print(text, flush=True)


def excerpt(text):
    lines = text.rstrip().splitlines()
    if len(lines) > MOST_LINES:
        lines = lines[:MOST_LINES] + [f"... and {len(lines) - MOST_LINES} more lines"]
    return "\n".join("    " + line for line in lines)


def script(tally, *command):
    """A check that prints `N passed, M failed` last; or one that says nothing but by its exit code."""
    label = pathlib.Path(command[0]).relative_to(ROOT)
    show(f"{label} ...")
    done = subprocess.run([sys.executable, *map(str, command)], cwd=ROOT, text=True, errors="replace",
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    counts = COUNTED.findall(done.stdout)
    passed, failed = map(int, counts[-1]) if counts else (int(done.returncode == 0), int(done.returncode != 0))
    if done.returncode != 0 and failed == 0 or passed + failed == 0:
        failed += 1
    tally.add(passed, failed)
    say(f"  {label}: {passed} passed, {failed} failed")
    if failed:
        print(excerpt(done.stdout))


def setup(name, compiler, options):
    """Configures build/NAME, or brings it up to date: the lists of files may have grown."""
    directory = BUILD / name
    environment = dict(os.environ)
    environment["CXX"] = f"ccache {compiler}" if shutil.which("ccache") else compiler
    command = ["meson", "setup", directory, ROOT, "-Dwarning_level=3", "-Db_staticpic=false", *options]
    if (directory / "build.ninja").exists():
        command.append("--reconfigure")
    elif directory.exists():
        command.append("--wipe")
    show(f"{name}: meson setup ...")
    done = subprocess.run(command, cwd=ROOT, env=environment, text=True, errors="replace",
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode:
        say(f"  {name}: meson setup failed")
        print(excerpt(done.stdout))
    return done.returncode == 0


def compile_units(name, target):
    """Builds the target with ninja, as far as it goes; returns how many steps failed, and of how many."""
    process = subprocess.Popen(["ninja", "-C", BUILD / name, "-k", "0", "-j", str(JOBS), target], text=True,
                               errors="replace", stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    failures = 0
    message = []
    steps = 0
    said = set()
    for line in process.stdout:
        step = STEP.match(line)
        if not step:
            message.append(line)
            continue
        failures += report(name, message, said)
        message = []
        done, steps = map(int, step.groups())
        if TERMINAL:
            bar = "#" * (24 * done // steps)
            show(f"  {name} [{bar:24}] {done}/{steps} {line[step.end():].split(' ')[-1].strip()}")
        elif 4 * done // steps > 4 * (done - 1) // steps and done < steps:
            say(f"  {name}: {done}/{steps}")
    failures += report(name, message, said)
    process.wait()
    return max(failures, int(process.returncode != 0)), steps


def report(name, message, said):
    """Prints what a build step said, unless another said the same; returns how many steps failed."""
    failed = [i for i, line in enumerate(message) if line.startswith("FAILED: ")]
    # The line after FAILED repeats the command; of ninja's own lines only errors say something.
    lines = [line for i, line in enumerate(message) if i not in failed and i - 1 not in failed
             and not re.match(r"ninja: (?!error)", line)]
    errors = tuple(re.sub(r"^\S*/", "", line) for line in lines if "error: " in line)
    repeated = errors and errors in said
    for i in failed:
        unit = pathlib.PurePath(message[i].split()[1]).name.removeprefix("meson-generated_.._").removesuffix(".o")
        say(f"  {name}: FAILED: {unit}{' (the same errors as above)' if repeated else ''}")
    if lines and not repeated:
        say(excerpt("".join(lines)))
    said.add(errors)
    return len(failed)


def telling(output):
    """The blocks of doctest's output that hold an error; all of it where none does."""
    blocks = re.split(r"^={60,}\n", output, flags=re.MULTILINE)
    errors = [re.sub(r"^\S+ MESSAGE: .*\n\n?", "", block, flags=re.MULTILINE) for block in blocks
              if re.search(r"\b(ERROR|FATAL ERROR):", block)]
    return "".join(errors) or output


def run_one(name, test):
    """Runs one program from its build folder, to which the paths that the compiler saw are relative."""
    environment = dict(os.environ, UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1")
    started = time.monotonic()
    try:
        done = subprocess.run(test["cmd"], cwd=BUILD / name, env=environment, text=True, errors="replace",
                              timeout=MOST_SECONDS, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        output, code = done.stdout, done.returncode
    except subprocess.TimeoutExpired as late:
        output, code = f"{late.stdout or ''}\nstopped after {MOST_SECONDS} s", 1
    counts = DOCTEST.findall(output)
    passed, failed = map(int, counts[-1]) if counts else (0, 0)
    if not counts:
        output += f"\nended without a summary, exit code {code}"
    elif passed + failed == 0:
        output += "\nno test case ran"
    if failed == 0 and (code != 0 or passed == 0):
        failed = 1
    return test, passed, failed, telling(output), time.monotonic() - started


def build(tally, name, compiler, suite, *options):
    """Configures and builds build/NAME, then runs the programs of one of the suites that tests/meson.build declares."""
    if not setup(name, compiler, options):
        tally.add(0, 1)
        return
    started = clock()
    broken, steps = compile_units(name, suite)
    tally.add(0, broken)
    say(f"  {name}: {suite}: {steps} build steps, {broken} failed ({since(started)})")
    listed = subprocess.run(["meson", "introspect", "--tests", BUILD / name], cwd=ROOT, text=True, check=True,
                            stdout=subprocess.PIPE)
    tests = [test for test in json.loads(listed.stdout) if any(s.split(":")[-1] == suite for s in test["suite"])]
    there = [test for test in tests if os.access(test["cmd"][0], os.X_OK)]
    if not there:
        tally.add(0, 1)
        say(f"  {name}: {suite}: nothing to run")
    totals = {}
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        for test, passed, failed, output, seconds in pool.map(lambda one: run_one(name, one), there):
            tally.add(passed, failed)
            total = totals.setdefault(test["name"].split(" ")[0], [0, 0, 0.0])
            for i, value in enumerate((passed, failed, seconds)):
                total[i] += value
            show(f"  {name}: {test['name']}: {passed} passed, {failed} failed")
            if failed:
                program, *arguments = test["cmd"]
                command = shlex.join([os.path.relpath(program, BUILD / name), *arguments])
                say(f"  {name}: {test['name']}: {passed} passed, {failed} failed (in build/{name}: {command})")
                print(excerpt(output))
    for program, (passed, failed, seconds) in totals.items():
        say(f"  {name}: {program}: {passed} passed, {failed} failed ({seconds:.1f} s)")


def order(tally):
    """What takes seconds: the layers, the format, and whether the single header is fresh."""
    script(tally, ROOT / "tests/layers.py")
    script(tally, ROOT / "tests/format.py")
    script(tally, ROOT / "include/amalgamate.py", "--check")


def cheap(tally):
    """the order of the house, the single header is fresh, every part compiles alone"""
    order(tally)
    script(tally, ROOT / "tests/alone.py")
    script(tally, ROOT / "tests/readme.py")


def misuse(tally):
    """each misuse is refused by both compilers with one sentence, and so is each flag that would change the bits"""
    script(tally, ROOT / "tests/misuse/check.py")
    script(tally, ROOT / "tests/refusals/check.py")


def gcc(tally):
    """the cells of the matrix that fall to g++, from the single header; all with EVERYTHING=1; and the installed package"""
    build(tally, "gcc", "g++", "cells", "-Doptimization=1", "-Dwerror=true")
    package(tally)
    units(tally)
    films(tally)


def clang(tally):
    """the cells of the matrix that fall to clang++, from the parts; all with EVERYTHING=1"""
    build(tally, "clang", "clang++", "cells", "-Doptimization=0", "-Dwerror=true")


def determinism(tally):
    """one hash for each scene, over compilers and optimisation levels"""
    script(tally, ROOT / "tests/determinism/check.py")


def sanitize(tally):
    """two cells of worlds and the single tests under the address and undefined-behaviour sanitizers, with clang++"""
    build(tally, "sanitize", "clang++", "sanitized", "-Doptimization=0", "-Db_sanitize=address,undefined", "-Db_lundef=false")


def quick(tally):
    """what to run before a commit: the order of the house, the float cells by clang++ -O0, one hash of each scene"""
    order(tally)
    os.environ["QUICK"] = "1"
    build(tally, "quick", "clang++", "cells", "-Doptimization=0", "-Dwerror=true")
    script(tally, ROOT / "tests/determinism/check.py", "--one")


def fuzz_one(source):
    """Compiles and runs one fuzzer; returns its name, how much it tried, whether all went well, what it said."""
    name = source.stem
    found = BUILD / "fuzz" / name
    program = BUILD / "fuzz" / f"{name}.run"
    seconds = os.environ.get("FUZZ_SECONDS")
    if not seconds:
        # Nothing of an earlier run is left, so that the same inputs come again.
        shutil.rmtree(found, ignore_errors=True)
    found.mkdir(parents=True, exist_ok=True)
    worlds = name.startswith("worlds")
    inputs = WORLD_INPUTS if worlds else FUZZ_INPUTS
    bound = [f"-max_total_time={seconds}"] if seconds else ["-seed=1", f"-runs={inputs}"]
    # So few inputs take less time than to optimise the code, or to tell comparisons to the fuzzer; and where pointers
    # lead to is half of all checks, which the group sanitize makes too.
    build = ["-O1"] if seconds else ["-O0"]
    if worlds and not seconds:
        build += ["-fno-sanitize-coverage=trace-cmp", "-fno-sanitize=null,alignment,object-size,vptr"]
    compiler = ["ccache", "clang++"] if shutil.which("ccache") else ["clang++"]
    # New inputs go to the first folder; those of the repository are only read.
    steps = [[*compiler, "-std=c++20", "-g1", "-fsanitize=fuzzer,address,undefined",
              "-fno-sanitize-recover=undefined", *build, "-Iinclude", source, "-o", program],
             [program, *bound, "-max_len=400", "-print_final_stats=1", f"-artifact_prefix={found.parent}/", found,
              ROOT / "tests/fuzz/corpus" / ("worlds" if worlds else name)]]
    for step in steps:
        done = subprocess.run(step, cwd=ROOT, text=True, errors="replace", stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        if done.returncode:
            return name, "0 inputs", False, done.stdout

    def count(what):
        number = re.search(rf"^stat::{what}: (\d+)$", done.stdout, re.MULTILINE)
        return int(number.group(1)) if number else 0

    tried = count("number_of_executed_units")
    said = f"{tried} inputs" + (f", {count('operations')} operations" if worlds else "")
    return name, said, tried >= (1 if seconds else inputs), done.stdout


def fuzz(tally):
    """hulls, separations, casts and whole worlds under libFuzzer and sanitizers, always the same inputs; others for FUZZ_SECONDS each"""
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        for name, tried, good, said in pool.map(fuzz_one, sorted((ROOT / "tests/fuzz").glob("*.cpp"))):
            tally.add(int(good), int(not good))
            say(f"  {name}: {tried}, {int(good)} passed, {int(not good)} failed")
            if not good:
                print(excerpt("\n".join(said.splitlines()[-MOST_LINES:])))


def package(tally):
    """Installs into a folder and compiles a unit against it, with what the .pc file says."""
    target = BUILD / "package"
    shutil.rmtree(target, ignore_errors=True)
    show("package ...")
    done = subprocess.run(["meson", "install", "-C", BUILD / "gcc", "--no-rebuild", "--destdir", target],
                          text=True, errors="replace", stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    message = done.stdout if done.returncode else ""
    described = list(target.rglob("physics.pc"))
    headers = list(target.rglob("physics.hpp"))
    if not message and (len(described) != 1 or len(headers) != 1):
        message = f"expected one physics.pc and one physics.hpp, found {described + headers}"
    if not message:
        fields = dict(re.findall(r"^(\w+)[=:] *(.*)$", described[0].read_text(), re.MULTILINE))
        version = subprocess.run([sys.executable, ROOT / "include/amalgamate.py", "--version"], text=True,
                                 stdout=subprocess.PIPE).stdout.strip()
        flags = re.sub(r"\$\{(\w+)\}", lambda name: fields[name.group(1)], fields["Cflags"])
        flags = re.sub(r"\$\{(\w+)\}", lambda name: fields[name.group(1)], flags).replace("-I/", f"-I{target}/")
        if fields["Version"] != version:
            message = f"physics.pc says version {fields['Version']}, config.hpp {version}"
        else:
            done = subprocess.run(["g++", "-std=c++20", "-fsyntax-only", *flags.split(), "-x", "c++", "-"], text=True,
                                  input="#include <physics.hpp>\n", cwd=target, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT)
            message = done.stdout if done.returncode else ""
    tally.add(int(not message), int(bool(message)))
    say(f"  package: {int(not message)} passed, {int(bool(message))} failed")
    if message:
        print(excerpt(message))


def units(tally):
    """The sample of two units runs, and does not link without the one that compiles the world."""
    objects = [BUILD / "two_units.o", BUILD / "arena.o"]
    message = ""
    for source, made in zip(("samples/05_two_units.cpp", "samples/two_units/arena.cpp"), objects):
        done = subprocess.run(["g++", "-std=c++20", "-O0", "-Wall", "-Wextra", "-Werror", "-I.", "-c", source, "-o", made],
                              cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        message += done.stdout if done.returncode else ""
    program = BUILD / "two_units"
    alone, both = (subprocess.run(["g++", *linked, "-o", program], text=True, errors="replace", stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT) for linked in (objects[:1], objects))
    if not message and (alone.returncode == 0 or "world_code" not in alone.stdout):
        message = f"without its world it links, or the linker does not name world_code:\n{alone.stdout}"
    if not message and both.returncode:
        message = both.stdout
    if not message and not re.search(r"^state \w{16}$", subprocess.run([program], text=True, stdout=subprocess.PIPE).stdout,
                                     re.MULTILINE):
        message = "the sample prints no state"
    tally.add(int(not message), int(bool(message)))
    say(f"  two units: {int(not message)} passed, {int(bool(message))} failed")
    if message:
        print(excerpt(message))


def film(name, page, compiler, arguments=(), look=True):
    """Compiles and runs one sample, which fails where what it shows is not so, and looks at the page that it writes, if
    it does; returns what went wrong, or nothing."""
    program, page = BUILD / name, page and ROOT / f"samples/out/{page}.html"
    if page:
        page.unlink(missing_ok=True)
    done = subprocess.run([*compiler.split(), "-std=c++20", "-Wall", "-Wextra", "-Werror", "-I.", f"samples/{name}.cpp",
                           "-o", program], cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode:
        return done.stdout
    done = subprocess.run([program, *arguments], cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode or re.search(r"\b(nan|inf)\b", done.stdout):
        return f"it ends with {done.returncode}:\n{done.stdout}"
    if page and not page.is_file():
        return f"it wrote no {page}"
    if not page or not look:
        return ""
    # Looks at the page where there is a browser, and only says so where there is none.
    done = subprocess.run([sys.executable, "samples/player/look.py", page], cwd=ROOT, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    return done.stdout if done.returncode else ""


def films(tally):
    """The samples that write a page run, tell numbers, and write pages that unpack and draw. Games are told by the
    numbers that they expect: they are built without optimisation. For time, three of the pages are looked at, in 2D and
    3D, with EVERYTHING=1 all."""
    of_motion = {"02_flagship": "flagship", "06_ragdolls": "ragdolls", "07_mechanisms": "mechanisms", "08_car": "car"}
    games = {"10_platformer": "platformer", "11_pinball": "pinball", "12_dominoes": "dominoes",
             "13_conveyor": "conveyor", "14_dice": "dice", "15_wrecking_ball": "wrecking_ball",
             "16_paper_walls": "paper_walls", "17_arena": "arena", "18_ecs": None, "19_lockstep": "lockstep",
             "20_tower": "tower", "21_platformer_3d": "platformer_3d"}
    # All throws of the dice take too long without optimisation.
    arguments, looked_at = {"14_dice": ["100"]}, {"02_flagship", "10_platformer", "17_arena"}
    if os.environ.get("EVERYTHING"):
        looked_at = {*of_motion, *games}
    passed, failed = 0, 0
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        runs = {name: pool.submit(film, name, page, "g++ -O1", (), name in looked_at) for name, page in of_motion.items()}
        runs |= {name: pool.submit(film, name, page, "clang++ -O0", arguments.get(name, ()), name in looked_at)
                 for name, page in games.items()}
        for name, run in runs.items():
            message = run.result()
            passed, failed = passed + (not message), failed + bool(message)
            if message:
                print(excerpt(f"{name}: {message}"))
    tally.add(passed, failed)
    say(f"  films: {passed} passed, {failed} failed")


GROUPS = [cheap, misuse, gcc, clang, determinism, sanitize, fuzz]
BY_NAME = {group.__name__: group for group in [*GROUPS, quick]}


def main():
    names = sys.argv[1:]
    if names == ["--list"]:
        for name, group in BY_NAME.items():
            print(f"{name:12} {group.__doc__}")
        return 0
    unknown = set(names) - set(BY_NAME)
    if unknown:
        print(f"no such group: {', '.join(sorted(unknown))}; bash tests/run --list names them", file=sys.stderr)
        return 2
    os.environ["LC_ALL"] = "C"
    BUILD.mkdir(exist_ok=True)
    tally = Tally()
    started = clock()
    progress = Progress([group for name, group in BY_NAME.items() if (name in names if names else group is not quick)])
    for group in progress.groups:
        progress.begin(group)
        began = clock()
        group(tally)
        progress.end(group)
        say(f"  {since(began)}")
    largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    say(f"all in {since(started)}; the largest process took {largest:.1f} GB")
    if tally.passed == 0:
        tally.add(0, 1)
    print(f"{tally.passed} passed, {tally.failed} failed", flush=True)
    return tally.failed > 0


if __name__ == "__main__":
    sys.exit(main())
