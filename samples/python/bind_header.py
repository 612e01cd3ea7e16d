"""Turns lightwell.h into the table that cffi calls the library by: nothing of the header is copied by hand.

    python3 bind_header.py include/lightwell/lightwell.h OUT.py ABI     needs cffi, and no compiler

ABI: the number in the library's name, LIGHTWELL_ABI of CMakeLists.txt.
"""
import re
import sys


def declarations(header: str) -> str:
    """The header's types, functions and numeric constants as cffi's parser takes them."""
    text = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    text = re.sub(r"\\\n", " ", text)
    text = re.sub(r"#ifdef __cplusplus.*?#endif", "", text, flags=re.S)
    kept = []
    for line in text.splitlines():
        if line.lstrip().startswith("#"):
            if re.fullmatch(r"#define LW_[A-Z0-9_]+ \d+", line.strip()):
                kept.append(line.strip())
        elif line.strip():
            kept.append(line)
    return "\n".join(kept).replace("LW_API ", "") + "\n"


def functions(header: str) -> list:
    """Names of the public functions, in the header's order."""
    text = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    return re.findall(r"LW_API [^;(]*[ *](lw[A-Za-z0-9]+)\(", text)


def main(arguments: list) -> int:
    if len(arguments) != 3 or not arguments[2].isdigit():
        print(__doc__, file=sys.stderr)
        return 2
    import cffi

    with open(arguments[0], encoding="utf-8") as file:
        text = declarations(file.read())
    builder = cffi.FFI()
    builder.cdef(text)
    builder.set_source("lightwell._header", None)
    builder.emit_python_code(arguments[1])
    with open(arguments[1], "a", encoding="utf-8") as file:
        file.write(f"ABI = {arguments[2]}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
