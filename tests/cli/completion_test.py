"""`lightwell complete`, the shells' scripts around it, and the manual page: all of it the program's own declarations.

Usage: completion_test.py PROGRAM [unittest options]. Standard library; fish, zsh and man are used where they are.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from cli_test import PROGRAM, CommandLine  # noqa: E402


class Complete(CommandLine):
    def offered(self, *words):
        lines = self.done("complete", *words).stdout.splitlines()
        return [line.split("\t")[0] for line in lines]

    def test_commands_and_options(self):
        usage = self.done("--help").stdout
        commands = re.findall(r"^  ([a-z-]+)  +\S", usage[usage.index("Subcommands:"):usage.index("Exit codes")], re.M)
        self.assertGreater(len(commands), 12)
        self.assertEqual(self.offered(""), commands)
        self.assertEqual(self.offered("comp"), ["compare", "completion"])
        for command in ("render",):  # every option that --help names
            named = set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", self.done(command, "--help").stdout, re.M))
            self.assertEqual(set(self.offered(command, "--")), named, command)

    def test_values(self):
        techniques = self.offered("render", "cornell", "--technique", "")
        self.assertLessEqual({"ssvp", "none", "auto"}, set(techniques))
        # Neither a value nor a flag takes the scene's place.
        self.assertEqual(self.offered("render", "--technique", "rsm", "--json", "sphere_r"), ["sphere_room", ":files"])
        self.assertEqual(self.offered("render", "--technique=rs"), ["--technique=rsm"])
        self.assertEqual(self.offered("render", "--technique", "rsm", "sphere_r"), ["sphere_room", ":files"])  # a value is no positional
        self.assertEqual(self.offered("render", "--json", "sphere_r"), ["sphere_room", ":files"])  # a flag takes none
        self.assertEqual(self.offered("render", "cornell", "x"), [])  # no second scene
        self.assertEqual(self.offered("render", "--technique", "ssvp", "--set", "vpls=8", "clusters"), ["clusters="])
        self.assertEqual(self.offered("render", "--technique", "rsm", "--set", "filter="), ["filter=on", "filter=off"])
        self.assertEqual(self.offered("chart", "--techniques", "rsm", "ssvp,visibility=h"), ["ssvp,visibility=hard"])
        self.assertEqual(self.offered("check", "cornell", "--plant", "normal-z"), ["normal-zero"])
        self.assertEqual(self.offered("render", "cornell", "--quantity", "sh"), ["shadow"])

    def test_what_is_offered_is_what_is_valid(self):
        self.refused(["reference", "cornell", "--bounces", "some", "--out", self.path("a.exr")], *self.offered("reference", "cornell", "--bounces", ""))
        self.refused(["completion", "csh"], *self.offered("completion", ""))

    def bash(self, line):
        script = self.done("completion", "bash").stdout
        program = script + ('\nset_=()\ncompopt() { set_+=("$2"); }\nCOMP_LINE=$1 COMP_POINT=${#1}\n_lightwell "$2"\n'
                            'printf "%s\\n" "${COMPREPLY[@]}"\nprintf "%s\\n" "${set_[@]}" >&2\n')
        with tempfile.TemporaryDirectory() as folder:
            for name in ("picture.exr", "two words.exr"):
                open(os.path.join(folder, name), "w").close()
            done = subprocess.run(["bash", "-c", program, "bash", line, PROGRAM], cwd=folder, capture_output=True, text=True)
        return done.stdout.split("\n")[:-1], done.stderr.split()

    def test_bash(self):
        self.assertEqual(self.bash("lightwell render --technique rsm --set interl"), (["interleave="], ["nospace"]))
        # Behind the "=", which parts words there.
        self.assertEqual(self.bash("lightwell render --technique rsm --set interleave=")[0], ["1", "2", "4", "8"])
        self.assertEqual(self.bash("lightwell render --technique=rs")[0], ["rsm"])
        self.assertEqual(self.bash("lightwell compare pic"), (["picture.exr"], ["filenames"]))
        self.assertEqual(self.bash("lightwell compare two\\ wo"), (["two words.exr"], ["filenames"]))
        self.assertEqual(self.bash("lightwell compare two\\ "), (["two words.exr"], ["filenames"]))
        self.assertEqual(self.bash("lightwell visibility cornell --technique ssvp --sweep visibility=h")[0], ["hard"])
        self.assertEqual(self.bash("lightwell render --out=pic")[0], ["picture.exr"])
        self.assertIn("cornell", self.bash("lightwell render ")[0])  # the word being typed is empty


class Shells(CommandLine):
    """Whole shells; with seconds of waiting, so that a run of its own asks for them."""

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish(self):
        script = self.path("lightwell.fish")
        with open(script, "w") as file:
            file.write(self.done("completion", "fish").stdout)
        environment = dict(os.environ, PATH=os.path.dirname(PROGRAM) + ":" + os.environ["PATH"], HOME=self.path(""), XDG_CONFIG_HOME=self.path(""))
        for line, expected in (("lightwell rend", "render\tIndirect light"), ("lightwell render --technique rs", "rsm\tvirtual point"),
                               ("lightwell render --technique rsm --set interleave=", "interleave=4")):
            done = subprocess.run(["fish", "--no-config", "-c", "source %s; complete -C '%s'" % (script, line)], env=environment,
                                  capture_output=True, text=True)
            self.assertIn(expected, done.stdout, done.stderr)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh(self):
        folder = self.path("")
        with open(os.path.join(folder, "_lightwell"), "w") as file:
            file.write(self.done("completion", "zsh").stdout)
        # A shell that types: completion runs only in one.
        program = """
zmodload zsh/zpty
zpty -b typing zsh -f -i
zpty -w typing "PS1='> '; PATH=%s:$PATH; fpath=(%s $fpath); autoload -Uz compinit; compinit -u -d %s/dump; stty cols 200; echo rea''dy"
zpty -r -m typing line '*ready*'
zpty -w -n typing $'%s\\t'
sleep 1.5
repeat 50 { zpty -r -t typing line && print -rn -- "$line"; sleep 0.01 }
zpty -d typing
"""
        for line, expected in (("lightwell rend", "render "), ("lightwell render --technique rs", "--technique rsm"),
                               ("lightwell render --technique rsm --set interl", "interleave=")):
            done = subprocess.run(["zsh", "-f", "-c", program % (os.path.dirname(PROGRAM), folder, folder, line)], capture_output=True,
                                  text=True, errors="replace")
            self.assertIn(expected, re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|[\r\x07\x08]", "", done.stdout), done.stderr)


class Manual(CommandLine):
    def test_it_has_all_that_help_has(self):
        page = self.done("manual").stdout
        for escape, character in (("-", "-"), ("&", ""), ("(aq", "'"), ("(ga", "`"), ("(ha", "^"), ("(ti", "~"), ("(dq", '"'), ("e", "\\")):
            page = page.replace("\\" + escape, character)
        plain = page
        self.assertTrue(page.startswith('.TH LIGHTWELL 1 "" "lightwell '))
        commands = self.done("complete", "").stdout.splitlines()
        for command in (line.split("\t")[0] for line in commands):
            section = re.search(r"^\.SS %s\n(.*?)(?=^\.SS|\Z)" % command.upper(), plain, re.M | re.S)
            self.assertTrue(section, command)
            if command != "render":
                continue
            for option in re.findall(r"^  (?:-\w,)?(--[a-z-]+)", self.done(command, "--help").stdout, re.M):
                self.assertIn(option, section[1])
        self.assertEqual(plain.count("Exit codes:"), 1)
        self.assertIn("LIGHTWELL_SCENES", plain)
        self.assertIn("auto_resolution=", plain)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_roff_takes_it(self):
        done = subprocess.run(["groff", "-man", "-ww", "-b", "-z", "-Tutf8"], input=self.done("manual").stdout, capture_output=True, text=True)
        self.assertEqual([line for line in done.stderr.splitlines() if "can't break line" not in line and "cannot break" not in line], [])
        read = subprocess.run(["groff", "-man", "-Tutf8", "-P-cbou"], input=self.done("manual").stdout, capture_output=True, text=True).stdout
        self.assertRegex(read, r"with n\^2")  # characters that can be copied, no typographic signs
        self.assertNotRegex(read, "[\u2018\u2019\u02c6\u02dc]")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
