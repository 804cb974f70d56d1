#!/usr/bin/env python3
"""README is never ahead of the code: its C++ compiles and its links lead somewhere.

    python3 tests/readme.py [COMPILER]

Last line: `N passed, M failed`, counted in blocks of code and links.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMPILER = sys.argv[1] if len(sys.argv) > 1 else os.environ.get("CXX", "g++")

# What the text around a block that is not a whole program has introduced.
BEFORE = {
    "struct quarry": "#include <physics.hpp>\n"
    "void mark(const physics::vec<float, 3>&, const physics::vec<float, 3>&);\n"
    "void mark(physics::shape_id);\n"
    "void use() {{\n{block}\n(void)sweep;\n(void)nearest;\n}}\n",
    "struct level ": "#include <physics.hpp>\nvoid mark(...);\nvoid use() {{\n{block}\n(void)grounded;\n}}\n",
    "struct tour": "#include <physics.hpp>\n#include <vector>\nvoid mark(...);\nvoid use() {{\n{block}\n}}\n",
    "struct platformer": "#include <physics.hpp>\nvoid use() {{\n{block}\n}}\n",
    "struct ": "#include <physics.hpp>\n{block}",
    "physics::dynamic_tree": "#include <physics.hpp>\nvoid meet(std::uint32_t, std::uint32_t);\n"
    "void use() {{\n{block}\n(void)hit;\n}}\n",
    "physics::character": "#include <physics.hpp>\n"
    "struct crates : physics::recipe<float, 2> {{}};\n"
    "using world = physics::world<crates>;\n"
    "void draw(const world::transform&);\n"
    "void frame(world& arena);\n"
    "void frame(world& arena) {{\n{block}\n}}\n",
    "physics::accumulator": "#include <physics.hpp>\n"
    "struct crates : physics::recipe<float, 2> {{}};\n"
    "using world = physics::world<crates>;\n"
    "void draw(const world::transform&);\n"
    "void frame(world& arena, physics::body_id crate, float seconds_since_last_frame);\n"
    "void frame(world& arena, physics::body_id crate, float seconds_since_last_frame) {{\n{block}\n(void)report;\n}}\n",
}


def program(block):
    if "#include" in block:
        return block
    for start, frame in BEFORE.items():
        if block.startswith(start):
            return frame.format(block=block)
    return block


def compiles(block, folder):
    source = pathlib.Path(folder) / "block.cpp"
    source.write_text(program(block))
    done = subprocess.run([COMPILER, "-std=c++20", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{ROOT}", source],
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode:
        print(f"README.md: a block does not compile:\n{block}\n{done.stdout}")
    return done.returncode == 0


def main():
    text = (ROOT / "README.md").read_text()
    with tempfile.TemporaryDirectory() as folder:
        results = [compiles(block, folder) for block in re.findall(r"^```cpp\n(.*?)^```$", text, re.M | re.S)]
    for link in re.findall(r"\]\(([^)#]+)\)", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)):
        results.append((ROOT / link).exists())
        if not results[-1]:
            print(f"README.md: a link leads nowhere: {link}")
    print(f"{results.count(True)} passed, {results.count(False)} failed")
    return 0 if all(results) and results else 1


sys.exit(main())
