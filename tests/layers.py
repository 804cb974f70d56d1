#!/usr/bin/env python3
"""The order of the house, as rules over the text of include/ and tests/. Each rule says which accident it prevents.

    python3 tests/layers.py

Prints one line a violation; the last line is `N passed, M failed`, counted in rules.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = ROOT / "include"
FLOORS = ["base", "space", "shape", "collide", "broadphase", "joint", "dynamics", "step", "world", "loop", "kit"]

# What each costs decides: a unit that includes physics.hpp pays for all of them (budget: bench/compile.py).
STANDARD = {"bit", "compare", "concepts", "cstddef", "cstdint", "cstdio", "cstdlib", "cstring", "exception",
            "initializer_list", "limits", "new", "type_traits", "typeindex", "utility"}
OUTSIDE = {"base/handle.hpp"}  # specialises std::hash behind the region, without a floating-point number
APART = {"physics/base/thread_pool.hpp": {"atomic", "thread"}}  # parts that the default header leaves out
CONDITIONAL = STANDARD | {"cmath", "intrin.h"}  # under an #if: for compilers without the builtins that we use
# Private words for which the field has others (include/physics/README.md), and how often each may still stand in code.
# The list only shrinks: a word that has become rarer lowers its number, one that has gone stays, so that it does not return.
RETIRED = dict.fromkeys("""crew hands movers mover_of giant rouse blow blows begin_without across_and_back bears_nothing
    are_idle rub soft_whole passage find_passage parting_axis parted askew torque_answer angular_answer answers lever levers
    kept_if left_out stretch refile_proxies swept_mover lasting asks_for_parts names_parts max_push_speed restitution_slop
    state_image disturb_sleepers forget_blows is_sound nobody way most least""".split(), 0)
RETIRED |= {"begun": 11, "each_part": 8}
# Files of step/ that may name the whole state, and how often: the step itself and its state as they like; what writes
# all that a step has made; and what takes of a state what waking needs, for steps and for edits between them.
WHOLE_STATE = {"step/state.hpp": None, "step/step.hpp": None, "step/publish.hpp": 1, "step/sleep.hpp": 1}
MOST_LINES = 400
MOST_COLUMNS = 120
MOST_SHOWN = 30

OWN = re.compile(r'^\s*#\s*include\s+"physics/([^"]+)"', re.MULTILINE)
LIBM = re.compile(r"\b(?:std::|__builtin_)(?:sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|"
                  r"log10|log1p|pow|cbrt|hypot|fma|fmin|fmax|fmod|remainder|lerp|round|nearbyint|rint)[fl]?\s*\(")
DECLARES = re.compile(r"^(?:class|struct|union|enum class|enum|using|concept|inline constexpr \w+) (\w+)\b")
SPECIALISES = re.compile(r"^(?:class|struct|inline constexpr \w+) \w+<")


class House:
    def __init__(self):
        paths = sorted((INCLUDE / "physics").rglob("*.hpp"))
        self.parts = {str(path.relative_to(INCLUDE / "physics")): path.read_text(encoding="utf-8") for path in paths}
        self.all = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in [
            INCLUDE / "physics.hpp", *paths,
            *(path for folder in ("tests", "samples", "bench") for kind in ("*.hpp", "*.cpp", "*.py")
              for path in sorted((ROOT / folder).rglob(kind)) if "out" not in path.parts)] if path.is_file()}

    def laws(self):
        return {name: text for name, text in self.all.items() if name.startswith("tests/laws/")}


def floors_only_downwards(house):
    """A part includes from its own floor or lower ones: a lower floor can be understood, tested and used alone."""
    for name, text in house.parts.items():
        floor = name.split("/")[0]
        if floor not in FLOORS:
            yield f"{name}: no such floor"
            continue
        for other in OWN.findall(text):
            if other not in house.parts:
                yield f"{name}: includes physics/{other}, which does not exist"
            elif FLOORS.index(other.split("/")[0]) > FLOORS.index(floor):
                yield f"{name}: includes physics/{other} from a floor above"


def operators_outside(house):
    """Friends are not defined in classes: gcc takes those of templates out of the determinism region, so that products
    fuse in them where users call them, and inlines nothing into them. Packs, always inlined, are an exception."""
    for name, text in house.parts.items():
        if name.startswith("base/pack"):
            continue
        for match in re.finditer(r"^.*\bfriend\b.*$", text, re.MULTILINE):
            line = match.group().strip()
            if line.endswith("{") or line.endswith("}"):
                yield f"{name}:{text[:match.start()].count(chr(10)) + 1}: {line}"


def no_circles(house):
    """Includes have no circle: with #pragma once, one would compile or not depending on what came first."""
    state = {}

    def visit(name, path):
        if state.get(name) == "open":
            yield "circle: " + " -> ".join(path[path.index(name):] + [name])
        if name in state or name not in house.parts:
            return
        state[name] = "open"
        for other in OWN.findall(house.parts[name]):
            yield from visit(other, path + [name])
        state[name] = "done"

    for name in house.parts:
        yield from visit(name, [])


def opening(house):
    """A part opens with one line of comment that says what it is, then #pragma once."""
    for name, text in house.parts.items():
        lines = text.splitlines()
        if not lines or not re.match(r"// \S", lines[0]):
            yield f"{name}: the first line is no comment"
        elif len(lines) < 2 or lines[1] != "#pragma once":
            yield f"{name}: the second line is not #pragma once"


def region(house):
    """All code is between PHYSICS_HPP_BEGIN and PHYSICS_HPP_END, once, and all includes are before: code outside
    is contracted, standard headers inside land in our namespace."""
    for name, text in house.parts.items():
        if name == "base/config.hpp":
            continue
        marks = re.findall(r"^PHYSICS_HPP_(?:BEGIN|END)$", text, re.MULTILINE)
        if marks != ["PHYSICS_HPP_BEGIN", "PHYSICS_HPP_END"]:
            yield f"{name}: not exactly one PHYSICS_HPP_BEGIN and then one PHYSICS_HPP_END"
            continue
        before, rest = re.split(r"^PHYSICS_HPP_BEGIN$", text, flags=re.MULTILINE)
        inside, after = re.split(r"^PHYSICS_HPP_END$", rest, flags=re.MULTILINE)
        if re.search(r"^\s*#\s*include\b", inside + after, re.MULTILINE):
            yield f"{name}: includes after PHYSICS_HPP_BEGIN"
        for place, outside in (("before PHYSICS_HPP_BEGIN", before), ("after PHYSICS_HPP_END", after)):
            outside = re.sub(r"\\\n", " ", outside)
            if name not in OUTSIDE and re.search(r"^(?!\s*(?://|#|$))", outside, re.MULTILINE):
                yield f"{name}: code {place}"


def cheap_standard_headers(house):
    """Only standard headers that compile in milliseconds: the others are most of what such libraries cost."""
    for name, text in house.parts.items():
        depth = 0
        for line in text.splitlines():
            depth += bool(re.match(r"\s*#\s*if", line)) - bool(re.match(r"\s*#\s*endif", line))
            header = re.match(r"\s*#\s*include\s+<([^>]+)>", line)
            allowed = (CONDITIONAL if depth else STANDARD) | APART.get(f"physics/{name}", set())
            if header and header.group(1) not in allowed:
                yield f"{name}: includes <{header.group(1)}>; allowed are {', '.join(sorted(STANDARD))}"


def small_files(house):
    """No part is longer than a reader's patience."""
    for name, text in house.parts.items():
        if text.count("\n") > MOST_LINES:
            yield f"{name}: {text.count(chr(10))} lines; at most {MOST_LINES}"


def documented(house):
    """Every public type, concept and alias has a docstring: the header is the manual. Specialisations, later
    declarations of a name and the rest of a run of aliases share the first one's."""
    for name, text in house.parts.items():
        lines = text.splitlines()
        hidden = False
        known = set()
        for i, line in enumerate(lines):
            if re.match(r"namespace detail\b", line):
                hidden = True
            elif re.match(r"}  // namespace detail", line):
                hidden = False
            declared = DECLARES.match(line)
            if hidden or not declared or SPECIALISES.match(line) or declared.group(1) in known:
                continue
            above = i - 1
            while above >= 0 and re.match(r"template\b|\s*requires\b|\s{4,}\S.*[>,]$", lines[above]):
                above -= 1
            if above >= 0 and re.match(r"///|using ", lines[above]):
                known.add(declared.group(1))
            else:
                yield f"{name}:{i + 1}: no docstring: {line.strip()}"


def own_macros(house):
    """Macros begin with PHYSICS_HPP_: they reach into the user's file, past every namespace."""
    for name, text in house.parts.items():
        for macro in re.findall(r"^\s*#\s*define\s+(\w+)", text, re.MULTILINE):
            if not macro.startswith("PHYSICS_HPP_"):
                yield f"{name}: defines {macro}"


def no_libm(house):
    """No call into libm: its last bits differ from system to system. Square roots are exact everywhere."""
    for name, text in house.parts.items():
        for i, line in enumerate(text.splitlines(), 1):
            found = LIBM.search(re.sub(r"//.*", "", line))
            if found:
                yield f"{name}:{i}: calls {found.group(0)[:-1]}"


def private_laws(house):
    """Laws are written once and compiled for every cell; outside an unnamed namespace, two cells that link into one
    program would share a function by name, and one of them would silently test the other. Outside: includes, explicit
    instantiations, aliases, and named namespaces that do not speak of the cell. Cases carry the cell's name, else the
    run of that cell does not find them."""
    whole = re.MULTILINE | re.DOTALL
    for name, text in house.laws().items():
        if re.search(r"\bTEST_CASE", text):
            yield f"{name}: TEST_CASE; write CELL_CASE"
        code = re.sub(r"^namespace \{$.*?^\}  // namespace$", "", text, flags=whole)
        for named in re.finditer(r"^namespace (\w+) \{$.*?^\}  // namespace \1$", code, whole):
            if re.search(r"\bcell\b", named.group(0)):
                yield f"{name}: namespace {named.group(1)} speaks of the cell, but is shared by all cells"
        code = re.sub(r"^namespace (\w+) \{$.*?^\}  // namespace \1$", "", code, flags=whole)
        code = re.sub(r"^\s*(//|#).*$", "", code, flags=re.MULTILINE)
        for statement in code.split(";"):
            if not re.match(r"template (?!<)|using |$", statement.strip()):
                yield f"{name}: outside the unnamed namespace: {statement.strip().splitlines()[0]}"


def every_law_runs(house):
    """Each header of laws/ is in the matrix of tests/meson.build, or included by one that is: no law lies idle."""
    matrix = re.search(r"^matrix = \{.*?^\}", (ROOT / "tests/meson.build").read_text(encoding="utf-8"), re.M | re.S)
    entries = re.findall(r"'(\w+)':", matrix.group(0) if matrix else "")
    running = {f"tests/laws/{name}.hpp" for name in entries}
    todo = list(running)
    while todo:
        for other in re.findall(r'#include "(\w+\.hpp)"', house.laws().get(todo.pop(), "")):
            name = f"tests/laws/{other}"
            if name not in running:
                running.add(name)
                todo.append(name)
    for name in house.laws():
        if name not in running:
            yield f"{name}: not in the matrix of tests/meson.build"


def tidy(house):
    """No tabs, no space at line ends, no line over 120 columns (messages aside), no note to do it later."""
    for name, text in house.all.items():
        if text and not text.endswith("\n"):
            yield f"{name}: no line end at the end"
        for i, line in enumerate(text.split("\n"), 1):
            if "\t" in line or "\r" in line or line != line.rstrip():
                yield f"{name}:{i}: tab, carriage return or space at the line end"
            if name.startswith("include/") and len(line) > MOST_COLUMNS and '"' not in line:
                yield f"{name}:{i}: {len(line)} columns"
            if re.search(r"\b(TO" r"DO|FIX" r"ME|XX" r"X)\b", line):
                yield f"{name}:{i}: {line.strip()}"


def field_words(house):
    """Private words do not come back: who knows Box2D, Jolt or Bullet is to guess no name."""
    code = "\n".join(re.sub(r'//.*|"(?:\\.|[^"\\])*"', "", text) for text in house.parts.values())
    for word, allowed in RETIRED.items():
        found = len(re.findall(rf"\b{word}\b", code))
        if found > allowed:
            yield f"{word}: {found} times in code; at most {allowed}"
        elif found < allowed:
            yield f"{word}: {found} times in code; lower its number in RETIRED from {allowed}"


def stages_see_their_data(house):
    """A stage takes what it reads and gives what it makes: who reads the step sees what goes where, and a later stage
    can't come to lean on scratch that an earlier one happened to leave."""
    for name, text in house.parts.items():
        if not name.startswith("step/"):
            continue
        found, allowed = len(re.findall(r"\bstate<", text)), WHOLE_STATE.get(name, 0)
        if allowed is not None and found != allowed:
            yield f"{name}: names state<> {found} times; WHOLE_STATE says {allowed}"


RULES = [floors_only_downwards, no_circles, operators_outside, opening, region, cheap_standard_headers, small_files,
         documented, own_macros, no_libm, field_words, stages_see_their_data, private_laws, every_law_runs, tidy]


def main():
    house = House()
    failed = 0
    for rule in RULES:
        violations = list(rule(house))
        failed += bool(violations)
        for violation in violations[:MOST_SHOWN]:
            print(f"{rule.__name__}: {violation}")
        if len(violations) > MOST_SHOWN:
            print(f"{rule.__name__}: ... and {len(violations) - MOST_SHOWN} more")
    print(f"{len(RULES) - failed} passed, {failed} failed")
    return failed > 0 or not house.parts


if __name__ == "__main__":
    sys.exit(main())
