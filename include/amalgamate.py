#!/usr/bin/env python3
"""Makes the single header physics.hpp from include/physics.hpp and its parts.

    python3 include/amalgamate.py            write physics.hpp at the top of the repository
    python3 include/amalgamate.py --check    exit 1 and print the difference where it is stale, byte for byte
    python3 include/amalgamate.py --version  print the version that config.hpp states

Each part appears once, after the parts that it includes, under a banner that names it, with its comments.
Standard headers move to the top, once each; those under a condition stay where they are.
Refused: a part that the umbrella does not reach, a circle of includes, an include of anything else.
"""
import argparse
import difflib
import pathlib
import re
import sys

INCLUDE = pathlib.Path(__file__).resolve().parent
ROOT = INCLUDE.parent
UMBRELLA = INCLUDE / "physics.hpp"
SINGLE = ROOT / "physics.hpp"
CONFIG = INCLUDE / "physics/base/config.hpp"
GUARD = "PHYSICS_HPP"
RULE = "// " + "=" * 97

OWN = re.compile(r'\s*#\s*include\s+"(physics/[^"]+)"')
STANDARD = re.compile(r"\s*#\s*include\s+<(\w+(?:\.h)?)>")
ANY_INCLUDE = re.compile(r"\s*#\s*include\b")
ONCE = re.compile(r"\s*#\s*pragma\s+once\b")
OPENS = re.compile(r"\s*#\s*if")
CLOSES = re.compile(r"\s*#\s*endif")


class Refused(Exception):
    pass


def version():
    text = CONFIG.read_text(encoding="utf-8")
    parts = []
    for name in ("MAJOR", "MINOR", "PATCH"):
        found = re.search(rf"^#define PHYSICS_HPP_VERSION_{name} (\d+)$", text, re.MULTILINE)
        if not found:
            raise Refused(f"{CONFIG.relative_to(ROOT)} does not define PHYSICS_HPP_VERSION_{name}")
        parts.append(found.group(1))
    return ".".join(parts)


def copyright_line():
    for line in (ROOT / "LICENSE").read_text(encoding="utf-8").splitlines():
        if line.startswith("Copyright"):
            return line
    raise Refused("LICENSE has no line that starts with Copyright")


class Amalgam:
    def __init__(self):
        self.standard = set()
        self.done = set()
        self.open = []
        self.lines = []

    def trim(self):
        while self.lines and not self.lines[-1].strip():
            self.lines.pop()

    def part(self, name, conditional):
        """Appends the part, unless it is there already, and first the parts that it includes."""
        if name in self.done:
            return
        if name in self.open:
            raise Refused("circle of includes: " + " -> ".join(self.open[self.open.index(name):] + [name]))
        path = INCLUDE / name
        if not path.is_file():
            raise Refused(f"{self.open[-1]} includes {name}, which does not exist")
        self.open.append(name)
        body = self.body(path, conditional)
        self.open.pop()
        self.done.add(name)
        self.trim()
        self.lines += ["", RULE, f"// {name}", RULE, *body]

    def body(self, path, conditional):
        """The part's own lines. Parts that it includes go to self.lines, before it."""
        result = []
        depth = 0
        for line in path.read_text(encoding="utf-8").splitlines():
            own = OWN.match(line)
            standard = STANDARD.match(line)
            if own:
                name = own.group(1)
                if (depth or conditional) and name not in self.done:
                    raise Refused(f"{self.open[-1]} includes {name} under a condition, but nothing included it before")
                self.part(name, conditional)
                continue
            if standard and depth == 0 and not conditional:
                self.standard.add(standard.group(1))
                continue
            if ANY_INCLUDE.match(line) and not standard:
                raise Refused(f"{path.relative_to(ROOT)} includes something else than a part or a standard header: {line.strip()}")
            if ONCE.match(line):
                continue
            depth += bool(OPENS.match(line)) - bool(CLOSES.match(line))
            if line.strip() or (result and result[-1].strip()):
                result.append(line)
        while result and not result[-1].strip():
            result.pop()
        return result

    def umbrella(self):
        """The umbrella's lines, each include replaced by its part; one under a condition stays under it. What is said of
        a directive stays with it; what heads a group of includes does not."""
        depth = 0
        said = []
        before = []
        header = []
        in_header = True
        for line in UMBRELLA.read_text(encoding="utf-8").splitlines():
            if in_header and (line.startswith("//") or ONCE.match(line)):
                if not ONCE.match(line):
                    header.append(line)
                continue
            in_header = False
            if line.startswith("//"):
                said.append(line)
                continue
            own = OWN.match(line)
            if own:
                said = []
                self.part(own.group(1), depth > 0)
                continue
            if ANY_INCLUDE.match(line):
                raise Refused(f"include/physics.hpp includes something else than a part: {line.strip()}")
            if line.startswith("#"):
                depth += bool(OPENS.match(line)) - bool(CLOSES.match(line))
                (self.lines if self.done else before).extend([*([""] if said else []), *said, line])
                said = []
        self.trim()
        # What the umbrella says before its first part acts on standard headers too.
        return header, before


def amalgamate():
    amalgam = Amalgam()
    header, before = amalgam.umbrella()
    parts = {str(path.relative_to(INCLUDE)) for path in (INCLUDE / "physics").rglob("*.hpp")}
    missing = sorted(parts - amalgam.done)
    if missing:
        raise Refused("include/physics.hpp does not reach " + ", ".join(missing))
    top = [
        f"// physics.hpp {version()}",
        "// SPDX-License-Identifier: MIT",
        f"// {copyright_line()}",
        "//",
        *header,
        "//",
        "// Made from include/physics.hpp and its parts by include/amalgamate.py: change those, not this file.",
        f"#ifndef {GUARD}",
        f"#define {GUARD}",
        *before,
        "",
        *(f"#include <{name}>" for name in sorted(amalgam.standard)),
    ]
    return "\n".join([*top, *amalgam.lines, "", f"#endif  // {GUARD}"]) + "\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true", help="compare only; exit 1 where physics.hpp is stale")
    arguments.add_argument("--version", action="store_true", help="print the version")
    options = arguments.parse_args()
    try:
        if options.version:
            print(version())
            return 0
        made = amalgamate()
    except Refused as refusal:
        print(f"amalgamate.py: {refusal}", file=sys.stderr)
        return 1
    if not options.check:
        SINGLE.write_bytes(made.encode("utf-8"))
        print(f"{SINGLE.name}: {made.count(chr(10))} lines")
        return 0
    there = SINGLE.read_bytes() if SINGLE.is_file() else b""
    if there == made.encode("utf-8"):
        return 0
    difference = list(difflib.unified_diff(there.decode("utf-8", "replace").splitlines(), made.splitlines(),
                                           "physics.hpp as it is", "physics.hpp as its parts make it", lineterm="", n=1))
    print("\n".join(difference[:60]) or "physics.hpp differs in its line ends", file=sys.stderr)
    if len(difference) > 60:
        print(f"... and {len(difference) - 60} more lines", file=sys.stderr)
    print("physics.hpp is stale: run python3 include/amalgamate.py", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
