"""Tables of a technique's rows beside the scores that ten Brug 2017 publishes of them. Used by lpv_thesis.py and cone_tracing_thesis.py."""
from thesis_setting import SCENES


class Rows:
    """rows: technique, settings and whether SSAO multiplies the light, by name. published: scores by scene, view and name. has: which
    rows are measured."""

    def __init__(self, settings, rows, published, has=lambda scene, row: True):
        self.settings, self.rows, self.published, self.has = settings, rows, published, has
        self.ours, self.errors = {}, {}

    def of(self, scene):
        return [row for row in self.rows if row in self.published[scene, SCENES[scene]["views"][0]] and self.has(scene, row)]

    def table(self, scene):
        views, measured = SCENES[scene]["views"], self.of(scene)
        first = [self.settings[scene, view] for view in views]
        noise = ", ".join(f"`{s.view}` {s.figures(s.row(*self.rows[measured[0]]))['reference_noise']:.2g} and {s.floor():.2f}" for s in first)
        lines = [f"### {SCENES[scene]['title']} ({SCENES[scene]['size']})", "",
                 f"Truths' noise (relMSE), and the score of one half of their paths against the other: {noise}.", "",
                 "| | " + " | ".join(f"{v}: source | ours | relMSE | bias" for v in views) + " | mean: source | ours |",
                 "| --- | " + " | ".join(["---:"] * (4 * len(views) + 2)) + " |"]
        for row in self.published[scene, views[0]]:
            cells = []
            for view in views:
                theirs = self.published[scene, view][row]
                if row not in measured:
                    cells.append(f"{theirs:.2f} | | | ")
                    continue
                found = self.settings[scene, view].figures(self.settings[scene, view].row(*self.rows[row]))
                self.ours[scene, view, row] = found["score"]
                self.errors[scene, view, row] = found["relMSE"]
                cells.append(f"{theirs:.2f} | {found['score']:.2f} | {found['relMSE']:.3g} | {percent(found['bias'])}")
            mean = sum(self.published[scene, v][row] for v in views) / len(views)
            own = f"{sum(self.ours[scene, v, row] for v in views) / len(views):.2f}" if row in measured else ""
            lines.append(f"| {row} | " + " | ".join(cells) + f" | {mean:.2f} | {own} |")
        return lines + [""]

    def series(self):
        """(name, rows, theirs, ours): of each view, of means of views, of all of them together."""
        made = []
        for scene, s in SCENES.items():
            rows = [row for row in self.rows if (scene, s["views"][0], row) in self.ours]
            for view in s["views"]:
                made.append((f"{s['title']}, {view}", rows, [self.published[scene, view][r] for r in rows],
                             [self.ours[scene, view, r] for r in rows]))
            made.append((f"{s['title']}, mean", rows, [sum(self.published[scene, v][r] for v in s["views"]) / 2 for r in rows],
                         [sum(self.ours[scene, v, r] for v in s["views"]) / 2 for r in rows]))
        for name, part in (("all views", "mean"), ("both means", None)):
            chosen = [m for m in made if m[0].endswith("mean") == (part is None)]
            made.append((name, [f"{m[0]}: {r}" for m in chosen for r in m[1]], sum((m[2] for m in chosen), []), sum((m[3] for m in chosen), [])))
        return made

    def correlations(self, by_error=False):
        """by_error: beside them of the source's scores and our relMSE, view by view."""
        from scipy.stats import kendalltau, spearmanr

        lines = ["### The ordering", "", "| | rows | Spearman | Kendall | pairs the other way round |", "| --- | ---: | ---: | ---: | ---: |"]
        for name, rows, theirs, found in self.series():
            pairs = list(turned(rows, theirs, found))
            total = len(rows) * (len(rows) - 1) // 2
            lines.append(f"| {name} | {len(rows)} | {spearmanr(theirs, found)[0]:+.2f} | {kendalltau(theirs, found)[0]:+.2f} | {len(pairs)} of {total} |")
        if by_error:
            lines += ["", "Its scores against our relMSE, least first:", "", "| | rows | Spearman | Kendall |", "| --- | ---: | ---: | ---: |"]
            for scene, s in SCENES.items():
                for view in s["views"]:
                    rows = [row for row in self.rows if (scene, view, row) in self.errors]
                    theirs, found = [self.published[scene, view][r] for r in rows], [-self.errors[scene, view, r] for r in rows]
                    lines.append(f"| {s['title']}, {view} | {len(rows)} | {spearmanr(theirs, found)[0]:+.2f} | {kendalltau(theirs, found)[0]:+.2f} |")
        return lines + [""]

    def pairs_against(self, least=0.0):
        """Those that the source has `least` apart or more."""
        beyond = f", {least:g} apart or more there" if least else ""
        lines = [f"Pairs of one view that stand the other way round, as the source has them{beyond}:", "",
                 "| view | better in the source | than | by | here worse by |", "| --- | --- | --- | ---: | ---: |"]
        for name, rows, theirs, found in self.series()[:-2]:
            if not name.endswith("mean"):
                lines += [f"| {name} | {a} | {b} | {x:.2f} | {y:.2f} |" for a, b, x, y in turned(rows, theirs, found) if x >= least]
        return lines + [""]


def own_table(settings, scene, rows):
    """What the source did not have, against the same truths; relMSE against one bounce as well, which is all that most of them carry."""
    views = SCENES[scene]["views"]
    lines = ["Beside them, against the same truths; *of one*: relMSE against the first bounce alone:", "",
             "| | " + " | ".join(f"{v}: score | relMSE | of one | bias" for v in views) + " |",
             "| --- | " + " | ".join(["---:"] * 4 * len(views)) + " |"]
    for row, what in rows.items():
        cells = []
        for view in views:
            setting = settings[scene, view]
            picture = setting.row(*what)
            found, one = setting.figures(picture), setting.figures(picture, setting.part("bounce1"))
            cells.append(f"{found['score']:.2f} | {found['relMSE']:.3g} | {one['relMSE']:.3g} | {percent(found['bias'])}")
        lines.append(f"| {row} | " + " | ".join(cells) + " |")
    return lines + [""]


def percent(share):
    return f"{100 * share:+.0f} %"


def turned(rows, theirs, found):
    """Pairs of rows that one order has the other way round, as the source has them: better first."""
    for i, better in enumerate(rows):
        for j, worse in enumerate(rows):
            if theirs[i] > theirs[j] and found[i] < found[j]:
                yield better, worse, theirs[i] - theirs[j], found[j] - found[i]
