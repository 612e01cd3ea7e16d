"""What the scripts of docs/figures share: their options, and a call of the program `lightwell`."""
import argparse
import datetime
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def read_options(description, scenes, spp, size="1280x720", parts=(), default=None, more=()):
    """The options of a script, with `work` as a folder that exists. `parts`: what --part may name; all of them, or `default`, unless it does. `more`:
    options of its own."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/figures")
    parser.add_argument("--size", default=size)
    parser.add_argument("--scenes", nargs="+", default=scenes)
    parser.add_argument("--spp", type=int, default=spp)
    if parts:
        parser.add_argument("--part", nargs="+", choices=parts, default=list(default or parts))
    for name in more:
        parser.add_argument("--" + name)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    return options


def caller(program):
    """call(*arguments): what the program prints; its own message ends the script when it fails. shown=True: it prints for itself, as of what takes hours."""
    def call(*arguments, shown=False):
        result = subprocess.run([program, *map(str, arguments)], capture_output=not shown, text=True)
        if result.returncode:
            sys.exit((result.stderr or "").strip() or f"lightwell {arguments[0]} failed")
        return result.stdout
    return call


def write_between(page, begin, end, lines):
    """Puts lines between two marks of a page, in place of what stood there."""
    before, rest = page.read_text(encoding="utf-8").split(begin)
    page.write_text(before + begin + "\n" + "\n".join(lines) + "\n" + end + rest.split(end)[1], encoding="utf-8")
    print(page)


def read_work(doc, folder, declare=lambda parser: None):
    """Options of a script that measures below a folder, or with --put takes in what lies there."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lightwell", default=str(ROOT / "build/release/bin/lightwell"))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build" / folder)
    parser.add_argument("--date", default=datetime.date.today().isoformat())
    parser.add_argument("--put", action="store_true")
    declare(parser)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    return options
