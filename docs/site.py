#!/usr/bin/env python3
"""Builds the documentation as one site: every page of docs/, README and CHANGELOG, and the API reference of the public headers.

    docs/site.py [FOLDER]      (default build/site; needs doxygen; leaves FOLDER/html/index.html)

Fails where doxygen warns, where a page stands in no section below, and where a link of the built site leads nowhere.
"""
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# What the sidebar shows, in this order. A page of docs/techniques that is not named stands behind the one whose name it begins with.
SECTIONS = [
    ("guide", "Guide", ["getting-started", "integration", "viewer", "python", "packaging", "conventions", "checking-inputs", "troubleshooting", "choosing", "planner",
                        "points", "edge_slope", "temporal_history"]),
    ("techniques", "Techniques", ["techniques/rsm", "techniques/ssvp", "techniques/screen_space", "techniques/horizon", "techniques/ao",
                                  "techniques/lpv", "techniques/cone_tracing", "techniques/static_vpl", "techniques/fallback",
                                  "techniques/auto", "techniques/voxel_grid", "techniques/voxel_light", "techniques/voxel_mips",
                                  "techniques/cone_gather", "techniques/voxel_visibility", "techniques/vpl_view_sampling", "techniques/instant_radiosity",
                                  "techniques/rival"]),
    ("measured", "Measurements", ["accuracy", "performance", "stability", "thrift"]),
    ("tools", "Command line and files", ["cli", "hosts", "scenes", "vpls-file"]),
    ("inside", "Inside", ["architecture", "adding-a-technique", "testing"]),
]


def label_of(path):
    """Of a page by its path in the tree: name of its file in the site, less .html."""
    name = str(path.relative_to(ROOT).with_suffix("")).removeprefix("docs/")
    return "index" if name == "README" else "page_" + re.sub(r"[^a-z0-9]+", "_", name.lower())


def slug_of(title):
    """As GitHub makes anchors of headings."""
    return re.sub(r" ", "-", re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", title).strip().lower()))


def link(path, text, target):
    if re.match(r"[a-z]+:", target):
        return f'<a href="{target}">{text}</a>'
    file, _, anchor = target.partition("#")
    to = (path.parent / file).resolve() if file else path
    if to.suffix != ".md" or not to.exists():  # of the source tree, which the site does not hold
        return text
    label = label_of(to)
    return f'<a href="{label}.html{f"#{label}_{anchor}" if anchor else ""}">{text}</a>'


def prose(path, line, images):
    """What lies between headings and blocks of code; code in backquotes stays as it is."""
    # Images and links may hold code, so that they come first; what they become is kept aside.
    kept = []

    def keep(text):
        kept.append(text)
        return f"\x00{len(kept) - 1}\x00"

    def image(match):
        source = (path.parent / match[2]).resolve()
        images.add(source)
        return keep(f'<img src="images/{source.name}" alt="{match[1]}" style="max-width:100%"/>')

    def reference(match):
        made = link(path, "\x01", match[2])
        before, _, after = made.partition("\x01")
        return keep(before) + match[1] + keep(after)

    line = re.sub(r"!\[([^\]]*)\]\(([^)\s]+)\)", image, line)
    line = re.sub(r"(?<!\!)\[((?:`[^`]*`|[^\]`])+)\]\(([^)\s]+)\)", reference, line)
    line = re.sub(r"`[^`]+`", lambda m: keep(m[0]), line)
    line = re.sub(r"\$\$(.+?)\$\$", lambda m: keep(r"\f[" + m[1] + r"\f]"), line, flags=re.S)
    line = re.sub(r"(?<![\w$])\$(?=\S)([^$]+?)(?<=\S)\$(?!\w)", lambda m: keep(r"\f$" + m[1] + r"\f$"), line)
    line = re.sub(r"<!-- file: .*? -->", "", line)
    line = re.sub(r"@|\\(?=\w)(?!_)", lambda m: "\\" + m[0], line.replace("\\_", "_"))
    while "\x00" in line:
        line = re.sub("\x00(\\d+)\x00", lambda m: kept[int(m[1])], line)
    return line


def convert(path, images):
    label, lines, block, fence, used, level = label_of(path), [], [], False, {}, 1

    def flush():
        if block:
            lines.append(prose(path, "\n".join(block), images))
            block.clear()

    text = path.read_text()
    if not re.search(r"^# ", re.sub(r"```.*?```", "", text, flags=re.S), re.M):  # written by a script to be read behind another page
        text = f"# {path.stem.replace('_', ' ').replace('figures', 'in figures')}\n\n{text}"
    for line in text.splitlines():
        if re.match(r"\s*```", line):
            flush()
            fence = not fence
            lines.append(re.sub(r"```(\w+)", r"```{.\1}", line) if fence else line)
            continue
        heading = None if fence else re.match(r"(#+) +(.*)", line)
        if fence:
            lines.append(line)
        elif heading and len(heading[1]) == 1 and not used:
            used["title"] = 1
            lines.append(f"# {heading[2]} {{#{'mainpage' if label == 'index' else label}}}")
        elif heading:
            flush()
            level = min(len(heading[1]), level + 1)
            slug = slug_of(heading[2])
            count = used[slug] = used.get(slug, -1) + 1
            lines.append(f"{'#' * level} {prose(path, heading[2], images)} {{#{label}_{slug}{f'-{count}' if count else ''}}}")
        else:
            block.append(line)
    flush()
    return "\n".join(lines) + "\n"


def pages():
    found = {label_of(p): p for p in [*sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("docs/techniques/*.md"))]}
    rest, sections = dict(found), []
    for name, title, chosen in SECTIONS:
        members = []
        for page in chosen:
            path = ROOT / "docs" / (page + ".md")
            if label_of(path) not in rest:
                sys.exit(f"docs/site.py: section '{title}' names {page}, which is no page")
            members.append(path)
            del rest[label_of(path)]
        sections.append((name, title, members))
    # Further pages of a technique; the longest name that they begin with.
    for label, path in list(rest.items()):
        for _, _, members in sections:
            heads = [m for m in members if m.parent == path.parent and path.stem.startswith(m.stem + "_")]
            if heads:
                head = max(heads, key=lambda m: len(m.stem))
                at = members.index(head) + 1
                while at < len(members) and members[at].stem.startswith(head.stem + "_"):
                    at += 1
                members.insert(at, path)
                del rest[label]
                break
    if rest:
        sys.exit("docs/site.py: in no section: " + ", ".join(str(p.relative_to(ROOT)) for p in rest.values()))
    return sections


class Links(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.links, self.anchors = [], set()

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key in ("id", "name"):
                self.anchors.add(value)
            elif key in ("href", "src") and value:
                self.links.append(value)


def broken_links(folder):
    parsed = {}
    for page in folder.glob("*.html"):
        parser = Links()
        parser.feed(page.read_text(errors="replace"))
        parsed[page.name] = parser
    broken, checked = [], 0
    for name, parser in parsed.items():
        for target in parser.links:
            if re.match(r"[a-z]+:", target) or target.startswith("//"):
                continue
            checked += 1
            file, _, anchor = target.partition("#")
            file = file.partition("?")[0] or name
            if not (folder / file).exists() or (anchor and file in parsed and anchor not in parsed[file].anchors):
                broken.append(f"{name}: {target}")
    return broken, checked


def version():
    found = re.search(r"project\(.*?VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.S)
    return found[1] if found else "?"


def main():
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/site").resolve()
    if not shutil.which("doxygen"):
        print("SKIPPED: doxygen is not installed")
        return 0
    shutil.rmtree(out, ignore_errors=True)
    sources = out / "pages"
    sources.mkdir(parents=True)
    images, order = set(), []
    for name, title, members in pages():
        text = f"# {title} {{#section_{name}}}\n\n"
        for path in members:
            text += f"- @subpage {label_of(path)}\n"
            (sources / (label_of(path) + ".md")).write_text(convert(path, images))
        (sources / f"section_{name}.md").write_text(text)
        order.append(f"section_{name}")
    for path in (ROOT / "README.md", ROOT / "CHANGELOG.md"):
        (sources / (label_of(path) + ".md")).write_text(convert(path, images))
    inputs = [sources / (label_of(ROOT / "README.md") + ".md")] + [sources / (o + ".md") for o in order] + [sources]
    settings = (ROOT / "docs/Doxyfile").read_text() + f"""
INPUT = {" ".join(str(i) for i in inputs)} {ROOT}/include/lightwell
FILE_PATTERNS = *.h *.hpp *.md
OUTPUT_DIRECTORY = {out}
STRIP_FROM_PATH = {sources} {ROOT}
STRIP_FROM_INC_PATH = {ROOT}/include
"""
    # Where a warning says that something was left out of a page, that page must be known.
    (out / "Doxyfile").write_text(settings)
    run = subprocess.run(["doxygen", str(out / "Doxyfile")], cwd=ROOT, env={**os.environ, "LIGHTWELL_VERSION": version()},
                         capture_output=True, text=True)
    warnings = run.stderr.strip()
    if run.returncode or warnings:
        print(warnings, file=sys.stderr)
        return 1
    (out / "html/images").mkdir(exist_ok=True)
    for image in sorted(images):
        shutil.copy(image, out / "html/images")
    broken, checked = broken_links(out / "html")
    for one in broken:
        print("broken link: " + one, file=sys.stderr)
    if broken:
        return 1
    print(f"{len(list((out / 'html').glob('*.html')))} files, {checked} links: {out}/html/index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
