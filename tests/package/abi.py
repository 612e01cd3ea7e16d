#!/usr/bin/env python3
"""What a program built against lightwell.h relies on: functions, constants, and where each field of each struct lies.

    abi.py HEADER abi.txt             checks the list: 0 as it stands; 1 something was added or changed, and what to do
    abi.py HEADER abi.txt --update    writes it; refuses what breaks programs of a release unless LIGHTWELL_ABI was raised
    abi.py HEADER abi.txt --released  marks its number as that of a release

Added functions and constants leave programs running, and so do fields added at the end of a struct of which the library takes the old
size (kFirstSize in src/api/structs.h); anything else breaks them. docs/packaging.md tells more. Standard library and a C compiler
(CC, else cc) only.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def stripped(header):
    text = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    text = re.sub(r"\\\n", " ", text)
    return "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("#"))


def fields(body):
    """Names and types of a struct's fields: "uint32_t a, b;" are two."""
    for declaration in filter(None, (part.strip() for part in body.split(";"))):
        pointer = re.match(r"(.*?)\(\*(\w+)\)\((.*)\)$", declaration, re.S)
        if pointer:
            yield pointer[2], " ".join(f"{pointer[1]}(*)({pointer[3]})".split())
            continue
        first, *others = declaration.split(",")
        kind, name, length = re.match(r"(.*?)(\w+)\s*(\[\w+\])?$", first.strip(), re.S).groups()
        for each in [name + (length or "")] + [other.strip() for other in others]:
            base, bounds = re.match(r"(\w+)(\[\w+\])?$", each).groups()
            yield base, " ".join(kind.split()) + (bounds or "")


def functions(text):
    for result, name, arguments in re.findall(r"LW_API\s+([^;(]*?[ *])(lw\w+)\(([^;]*)\);", text):
        # Names of arguments are no part of a call.
        kinds = [re.sub(r"\s*\b\w+$", "", " ".join(each.split())) if each.strip() != "void" else "void" for each in arguments.split(",")]
        yield name, f"{' '.join(result.split())}({', '.join(kinds)})"


def measure(header, expressions):
    """Sizes and offsets as the compiler has them."""
    lines = "".join(f'    printf("%llu\\n", (unsigned long long)({expression}));\n' for expression in expressions)
    program = f'#include "{header}"\n#include <stdio.h>\nint main(void) {{\n{lines}    return 0;\n}}\n'
    with tempfile.TemporaryDirectory() as folder:
        source, binary = pathlib.Path(folder, "abi.c"), pathlib.Path(folder, "abi")
        source.write_text(program)
        subprocess.run([os.environ.get("CC", "cc"), "-std=c99", "-o", binary, source], check=True)
        return subprocess.run([binary], check=True, capture_output=True, text=True).stdout.split()


def entries(path):
    """Name -> what is relied on, in the header's order."""
    text = stripped(path.read_text())
    found = {f"function {name}": signature for name, signature in functions(text)}
    for name, arguments in re.findall(r"typedef void \(\*(\w+)\)\((.*?)\);", text, re.S):
        found[f"callback {name}"] = " ".join(arguments.split())
    for body in re.findall(r"typedef enum \w+ \{(.*?)\} \w+;", text, re.S):
        for name, value in re.findall(r"(\w+)\s*=\s*(\d+)", body):
            found[f"constant {name}"] = value
    structs = re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", text, re.S)
    members = [(struct, name, kind) for body, struct in structs for name, kind in fields(body)]
    numbers = iter(measure(path, [f"offsetof({struct}, {name})" for struct, name, _ in members] + [f"sizeof({struct})" for _, struct in structs]))
    for struct, name, kind in members:
        found[f"field {struct}.{name}"] = f"at {next(numbers)}, {kind}"
    for _, struct in structs:
        found[f"struct {struct}"] = f"{next(numbers)} bytes"
    return found


def grows(struct, old, new):
    """A larger struct leaves programs running where the library takes the size that they state: kFirstSize is their size, or less."""
    before, now = (int(each[f"struct {struct}"].split()[0]) for each in (old, new))
    first = re.search(r"kFirstSize<%s> = (\d+);" % struct, (ROOT / "src/api/structs.h").read_text())
    return now > before and first is not None and int(first[1]) <= before


def changes(old, new):
    """What breaks programs, and what does not, as lines."""
    breaking, added = [], []
    for name, value in old.items():
        if new.get(name) == value:
            continue
        line = f"{name}: {value} -> {new.get(name, 'gone')}"
        kind, _, what = name.partition(" ")
        (added if kind == "struct" and name in new and grows(what, old, new) else breaking).append(line)
    for name, value in new.items():
        if name in old:
            continue
        struct = name.partition(" ")[2].partition(".")[0]
        # A field that fills a gap of a struct whose size did not change is read where callers of old left anything.
        inside = name.startswith("field ") and f"struct {struct}" in old and not grows(struct, old, new)
        (breaking if inside else added).append(f"{name}: new, {value}")
    return breaking, added


def abi_number():
    """The number in the library's name, as CMakeLists.txt has it."""
    return re.search(r"set\(LIGHTWELL_ABI (\d+)\)", (ROOT / "CMakeLists.txt").read_text())[1]


def read_list(path):
    """Its number, whether a release has had that, and its entries."""
    if not path.exists():
        return None, False, {}
    first, *lines = path.read_text().splitlines()
    return re.search(r"ABI (\d+)", first)[1], first.endswith("(released)"), dict(line.split(": ", 1) for line in lines)


def advise(breaking, changed, is_bound, command):
    if breaking and is_bound:
        print("take the change back, or raise LIGHTWELL_ABI in CMakeLists.txt; then", command)
    elif changed:
        print("write the list:", command)


def main(arguments):
    if len(arguments) not in (2, 3) or arguments[2:] not in ([], ["--update"], ["--released"]):
        print(__doc__, file=sys.stderr)
        return 2
    header, listed = pathlib.Path(arguments[0]).resolve(), pathlib.Path(arguments[1])
    new, number = entries(header), abi_number()
    if len([name for name in new if name.startswith("function ")]) < 50:
        print(f"only {len(new)} entries found in {header}: this script reads it wrongly", file=sys.stderr)
        return 1
    old_number, is_released, old = read_list(listed)
    breaking, added = changes(old, new) if old else ([], [])
    for title, lines in (("breaks programs that were built before", breaking), ("leaves programs running", added)):
        if lines:
            print(title + ":", *lines, sep="\n    ")
    is_bound = is_released and number == old_number
    changed = bool(breaking or added or number != old_number)
    if len(arguments) == 2:
        advise(breaking, changed, is_bound, f"tests/package/abi.py {arguments[0]} {arguments[1]} --update")
        return int(changed)
    if breaking and is_bound:
        print(f"not written: expected LIGHTWELL_ABI in CMakeLists.txt above {old_number}, got {number}", file=sys.stderr)
        return 1
    state = "released" if is_bound or arguments[2] == "--released" else "in no release yet"
    listed.write_text(f"liblightwell.so, ABI {number} ({state})\n" + "".join(f"{name}: {value}\n" for name, value in new.items()))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
