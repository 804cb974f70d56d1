#!/usr/bin/env python3
"""Each snippet in this folder is a mistake, and both compilers must say so in one sentence.

    python3 tests/misuse/check.py [NAME...]    NAME: only the snippets whose name contains one of these

The head of a snippet is comments:
    // expect: SENTENCE   what an error must say, word for word; the first line
    // errors: N          how many errors there may be; 1 where the line is missing
    // flags: FLAGS       more flags for the compiler
A compiler that goes on to complain about the engine's insides buries the sentence, hence the count.
And each sentence that the library can say, in a static_assert, has a snippet that makes it say so.
Last line: `N passed, M failed`.
"""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
COMPILERS = ["g++", "clang++"]
FLAGS = ["-std=c++20", "-Iinclude", "-Wall", "-Wextra"]
PRECOMPILED = ROOT / "build/misuse"
HEAD = re.compile(r"// (expect|errors|flags): (.+)")
SENTENCE = re.compile(r'static_assert\((?:[^;"]|\n)*?((?:"[^"]*"\s*)+)')  # in pieces, where it is longer than a line
ERROR = re.compile(r"^(?:[^\s:][^:]*:(?:\d+:)*\s+)?(?:fatal )?error: (.*)$", re.MULTILINE)


def unheard(snippets):
    """The sentences of the library that no snippet expects; those of its insides aside."""
    expected = {path.read_text(encoding="utf-8").splitlines()[0].removeprefix("// expect: ") for path in snippets}
    for part in sorted((ROOT / "include/physics").rglob("*.hpp")):
        for pieces in SENTENCE.findall(part.read_text(encoding="utf-8")):
            sentence = "".join(re.findall(r'"([^"]*)"', pieces))
            public = sentence.startswith("physics::") and not sentence.startswith("physics::detail::")
            if public and sentence not in expected:
                yield f"{part.relative_to(ROOT)}: no snippet expects: {sentence}"


def precompile(compiler):
    """Compiles the header once for all snippets; returns what makes them use it."""
    folder = PRECOMPILED / compiler
    folder.mkdir(parents=True, exist_ok=True)
    made = folder / "physics.hpp.gch"
    subprocess.run([compiler, *FLAGS, "-x", "c++-header", "include/physics.hpp", "-o", made], cwd=ROOT, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    # g++ looks for it wherever it looks for the header; clang++ is told.
    return [f"-I{folder}"] if compiler == "g++" else ["-include-pch", str(made)]


def complaint(job):
    """What is wrong with how the compiler refuses the snippet; empty where nothing is."""
    path, compiler, precompiled = job
    lines = path.read_text(encoding="utf-8").splitlines()
    head = dict(match.groups() for match in map(HEAD.fullmatch, lines[:3]) if match)
    if not lines or not lines[0].startswith("// expect: "):
        return "the first line is not `// expect: SENTENCE`", ""
    # What changes how the header reads has it anew.
    own = "flags" in head or any(line.startswith("#define") for line in lines)
    done = subprocess.run([compiler, *([] if own else precompiled), *FLAGS, "-fsyntax-only",
                           *head.get("flags", "").split(), path], cwd=ROOT, text=True,
                          errors="replace", env={**os.environ, "LC_ALL": "C"}, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    errors = [message.replace('\\"', '"') for message in ERROR.findall(done.stdout)]
    if done.returncode == 0:
        return "compiles", ""
    if not any(message.rstrip('"').endswith(head["expect"]) for message in errors):
        return f"no error says: {head['expect']}", done.stdout
    if len(errors) != int(head.get("errors", 1)):
        return f"{len(errors)} errors instead of {head.get('errors', 1)}", done.stdout
    return "", ""


def main():
    wanted = sys.argv[1:]
    snippets = [path for path in sorted(HERE.glob("*.cpp")) if not wanted or any(name in path.stem for name in wanted)]
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        precompiled = dict(zip(COMPILERS, pool.map(precompile, COMPILERS)))
        jobs = [(path, compiler, precompiled[compiler]) for path in snippets for compiler in COMPILERS]
        for (path, compiler, _), (wrong, output) in zip(jobs, pool.map(complaint, jobs)):
            if wrong:
                failed += 1
                print(f"{path.stem}, {compiler}: {wrong}")
                print("\n".join("    " + line for line in output.splitlines()[:12]))
    checks = len(jobs)
    if not wanted:
        missing = list(unheard(snippets))
        checks += 1
        failed += bool(missing)
        for sentence in missing:
            print(sentence)
    print(f"{checks - failed} passed, {failed} failed")
    return failed > 0 or not jobs


if __name__ == "__main__":
    sys.exit(main())
