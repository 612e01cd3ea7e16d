"""The package and lightwell.h say the same: every public function is bound or left out on purpose, enumerations and fields have the
header's names and values, and docs/python.md lists what stands for what."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import lightwell as lw
from lightwell import _frame, _library
from lightwell._library import ffi, lib

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "samples/python"))
import bind_header  # noqa: E402

HEADER = (ROOT / "include/lightwell/lightwell.h").read_text()
SOURCE = "".join(path.read_text() for path in sorted((ROOT / "samples/python/lightwell").glob("*.py")))
PAGE = (ROOT / "docs/python.md").read_text()

TYPED = re.compile(r"lw(Create|Default)(Rsm|Ssvp|Fallback|ScreenSpace|Horizon|Ao|Lpv|ConeTracing|StaticVpl|Auto)")
# What the package does without, and why.
LEFT_OUT = {
    "lwRetainDevice": "references are Python's", "lwRetainView": "references are Python's", "lwRetainTechnique": "references are Python's",
}
# Fields of structs that dataclasses do not have.
ABSENT = {
    "LWGBuffer": set(), "LWRsm": set(), "LWLight": {"rsmCount", "profileCount"}, "LWFrame": {"lightCount", "vplCount", "blockerCount",
              "sourceViewCount", "staticVplCount", "sync", "frameIndex"}, "LWGeometry": {"surfelCount", "triangleCount", "vertexCount"},
    "LWPlan": set(), "LWPlanProbes": set(), "LWInputFinding": set(), "LWOutput": {"sync"}, "LWPointOutput": {"sync", "baked"},
    "LWDebugView": set(), "LWDeviceInfo": set(),
}
CLASSES = {"LWGBuffer": lw.GBuffer, "LWRsm": lw.Rsm, "LWLight": lw.Light, "LWFrame": lw.Frame, "LWGeometry": lw.Geometry, "LWPlan": lw.Plan,
           "LWPlanProbes": lw.Probes, "LWInputFinding": lw.Finding, "LWOutput": lw.Output, "LWPointOutput": lw.PointOutput,
           "LWDebugView": lw.DebugView, "LWDeviceInfo": lw.DeviceInfo}
ENUMS = {"LWStatus": lw.Status, "LWLogLevel": lw.LogLevel, "LWFormat": lw.Format, "LWDepthKind": lw.DepthKind, "LWLightKind": lw.LightKind,
         "LWReceivers": lw.Receivers, "LWParameterKind": lw.ParameterKind, "LWSeverity": lw.Severity, "LWInputFault": lw.InputFault}


class Header(unittest.TestCase):
    def functions(self):
        names = bind_header.functions(HEADER)
        self.assertGreater(len(names), 50)
        return names

    def test_every_function_is_bound_or_left_out(self):
        for name in self.functions():
            called = "lib.%s" % name in SOURCE
            typed = bool(TYPED.fullmatch(name))  # lwCreateTechnique and LWTechniqueInfo::setDefaults do the same by name
            self.assertEqual(called + typed + (name in LEFT_OUT), 1, name)
            self.assertTrue(hasattr(lib, name), name)
        self.assertLessEqual(set(LEFT_OUT), set(self.functions()))

    def test_the_page_lists_every_function(self):
        for name in self.functions():
            if not TYPED.fullmatch(name):
                self.assertIn("`%s`" % name, PAGE)
        for name in re.findall(r"`(lw[A-Z][A-Za-z]+)`", PAGE):
            self.assertIn(name, self.functions())

    def test_the_page_names_what_exists(self):
        for name in re.findall(r"`(?:lightwell\.)([A-Za-z_]+)", PAGE):
            self.assertTrue(hasattr(lw, name), name)
        for owner, name in re.findall(r"`(Device|View|Technique|Light)\.([a-z_]+)", PAGE):
            self.assertTrue(hasattr(getattr(lw, owner), name) or name in PAGE and hasattr(getattr(lw, owner)(*()), name), owner + "." + name)
        for name in lw.__all__:
            self.assertTrue(hasattr(lw, name), name)

    def test_enumerations(self):
        stated = {}
        for body, name in re.findall(r"typedef enum \w+ \{(.*?)\} (\w+);", re.sub(r"/\*.*?\*/", "", HEADER, flags=re.S), re.S):
            stated[name] = {key: int(value) for key, value in re.findall(r"(LW_\w+) = (\d+)", body)}
        settings = {parameter.choices for info in lw.describe_techniques().values() for parameter in info.parameters.values()}
        for name, values in stated.items():
            if name in ENUMS:
                ours = {member: int(value) for member, value in ENUMS[name].__members__.items()}
                shortened = {key: value for key, value in values.items()}
                self.assertEqual(len(ours), len(shortened), name)
                for key, value in shortened.items():
                    self.assertTrue(any(key.endswith("_" + member) and value == number for member, number in ours.items()), key)
            else:  # of a setting: the library's own table has its names
                ends = sorted(key.lower() for key in values)
                self.assertTrue(any(len(choices) == len(ends) and all(any(end.endswith(c.replace("-", "_")) for end in ends) for c in choices)
                                    for choices in settings), name)

    def test_fields(self):
        for struct, kind in CLASSES.items():
            theirs = {name for name, _ in ffi.typeof(struct).fields} - ABSENT[struct] - {"structSize", "reserved"}
            ours = {_frame.camel(name) for name in kind.__dataclass_fields__}
            ours = {{"index": "frameIndex"}.get(name, name) for name in ours} - ({"frameIndex"} if struct == "LWFrame" else set())
            self.assertEqual(ours, theirs, struct)

    def test_records(self):
        from lightwell import _records
        for struct, dtype in (("LWVpl", _records.VPL), ("LWStaticVpl", _records.STATIC_VPL), ("LWBlocker", _records.BLOCKER),
                              ("LWListedLight", _records.LISTED_LIGHT)):
            self.assertEqual(dtype.itemsize, ffi.sizeof(struct))
            self.assertEqual([dtype.fields[name][1] for name in dtype.names], [field.offset for _, field in ffi.typeof(struct).fields])


class Library(unittest.TestCase):
    def importing(self, library, package=None):
        folder = str(package or pathlib.Path(lw.__file__).resolve().parents[1])
        done = subprocess.run([sys.executable, "-B", "-c", "import lightwell"], env=dict(os.environ, PYTHONPATH=folder, LIGHTWELL_LIBRARY=str(library)),
                              stderr=subprocess.PIPE, text=True)
        return done.stderr.splitlines()[-1] if done.returncode else ""

    def test_what_is_no_library(self):
        self.assertRegex(self.importing("/nonexistent.so"), "^ImportError: lightwell: cannot open /nonexistent.so")
        self.assertRegex(self.importing("libc.so.6"), "^ImportError: lightwell: expected Lightwell's library, got libc.so.6")

    def test_a_library_of_another_version(self):
        library = pathlib.Path(os.environ.get("LIGHTWELL_LIBRARY") or pathlib.Path(lw.__file__).with_name(_library.FILE_NAME)).resolve()
        self.assertEqual(self.importing(library), "")
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(pathlib.Path(lw.__file__).parent, pathlib.Path(folder, "lightwell"), ignore=shutil.ignore_patterns("*.so*", "__pycache__"))
            header = pathlib.Path(folder, "lightwell.h")
            header.write_text(HEADER.replace("#define LW_VERSION_MAJOR 0", "#define LW_VERSION_MAJOR 7"))
            made = subprocess.run([sys.executable, str(ROOT / "samples/python/bind_header.py"), str(header), str(pathlib.Path(folder, "lightwell/_header.py")), "0"],
                                  stdout=subprocess.DEVNULL)
            self.assertEqual(made.returncode, 0)
            self.assertRegex(self.importing(library, folder), r"^ImportError: lightwell: expected a library of version 7\.\d+\.\d+, got ")


class Documents(unittest.TestCase):
    def test_programs_are_shown_as_they_are(self):
        program = (ROOT / "samples/python/examples/ten_lines.py").read_text()
        self.assertIn("```python\n" + program + "```", (ROOT / "README.md").read_text())
        self.assertLessEqual(len(program.splitlines()), 10)
        for path, code in re.findall(r"<!-- file: (\S+\.py) -->\n```python\n(.*?)```", PAGE, re.S):
            self.assertEqual(code, (ROOT / path).read_text(), path)

    def test_examples_run(self):
        for name in ("ten_lines.py", "room.py"):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                small = ["--size", "64x48", "--technique", "rsm vpls=64"] if name == "room.py" else []
                try:
                    import matplotlib  # noqa: F401
                except ImportError:
                    self.skipTest("matplotlib is not installed")
                done = subprocess.run([sys.executable, str(ROOT / "samples/python/examples" / name), *small], cwd=folder, stderr=subprocess.PIPE,
                                      text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(len(list(pathlib.Path(folder).glob("*.png"))), 1)

    def test_types(self):
        try:
            from mypy import api
        except ImportError:
            self.skipTest("mypy is not installed")
        report, errors, status = api.run(["--strict", str(ROOT / "samples/python/lightwell"), "--cache-dir", "/dev/null"])
        self.assertEqual(status, 0, report + errors)


if __name__ == "__main__":
    unittest.main()
