"""lightwell.h against tests/package/abi.txt, and abi.py itself on headers changed on purpose.

Usage: abi_test.py [unittest options]
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/package"))
import abi  # noqa: E402

HEADER = ROOT / "include/lightwell/lightwell.h"


class Abi(unittest.TestCase):
    def test_the_header_is_as_listed(self):
        done = subprocess.run([sys.executable, str(ROOT / "tests/package/abi.py"), "include/lightwell/lightwell.h", "tests/package/abi.txt"],
                              cwd=ROOT, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def changed(self, *replacements):
        text = HEADER.read_text()
        for old, new in replacements:
            self.assertEqual(text.count(old), 1, old)
            text = text.replace(old, new)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "lightwell.h")
            path.write_text(text)
            return abi.changes(abi.read_list(ROOT / "tests/package/abi.txt")[2], abi.entries(path))

    def test_what_leaves_programs_running(self):
        breaking, added = self.changed(("LW_API const char* lwVersion(void);", "LW_API const char* lwVersion(void);\nLW_API int lwNew(LWDevice device);"),
                                       ("LW_FORMAT_UINT8 = 11 ", "LW_FORMAT_UINT8 = 11, LW_FORMAT_NEW = 12 "))
        self.assertEqual(breaking, [])
        self.assertEqual(added, ["function lwNew: new, int(LWDevice)", "constant LW_FORMAT_NEW: new, 12"])

    def test_what_breaks_them(self):
        breaking, _ = self.changed(("LW_API const char* lwVersion(void);", ""), ("LW_FORMAT_UINT8 = 11 ", "LW_FORMAT_UINT8 = 13 "),
                                   ("LW_API LWStatus lwFinish(LWDevice device);", "LW_API LWStatus lwFinish(LWDevice device, int wait);"),
                                   ("    float radius;\n} LWBlocker;", "    float radius, softness;\n} LWBlocker;"),
                                   ("    uint32_t maxWidth, maxHeight; /**<", "    uint64_t maxWidth, maxHeight; /**<"))
        self.assertEqual({line.split(":")[0] for line in breaking},
                         {"function lwVersion", "constant LW_FORMAT_UINT8", "function lwFinish", "field LWBlocker.softness", "struct LWBlocker",
                          "field LWViewDesc.maxWidth", "field LWViewDesc.maxHeight", "struct LWViewDesc"})

    def test_structs_grow_where_the_library_takes_the_old_size(self):
        # kFirstSize of none is below its size today, so that growing one is a break until that is written.
        breaking, _ = self.changed(("    uint32_t staticVplCount;   /**<", "    float added[3]; uint32_t staticVplCount;   /**<"))
        self.assertIn("field LWFrame.added: new", "\n".join(breaking))
        old = {"struct LWFrame": "200 bytes"}
        self.assertFalse(abi.grows("LWFrame", old, {"struct LWFrame": "216 bytes"}))


if __name__ == "__main__":
    unittest.main()
