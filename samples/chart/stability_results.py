"""What `lightwell stability` measured, as tables and plots need it: figures with their floors, and how much they show."""
import math

from report import ReportError, read_json

FORMAT = "lightwell-stability 1"
# key: (title, what a viewer begins to notice, in words); docs/stability.md defines each
INDICES = {
    "flicker": ("flicker", 0.05, "change from frame to frame that the truth has not, relative to its mean light"),
    "ghost": ("ghost", 1.0, "error shortly after a change over the settled error, less 1"),
    "leak": ("leak", 0.01, "light in a sealed room over the light outside"),
    "drift": ("drift", 0.1, "range of the bias, smoothed in time and relative to the truth's mean"),
    "spike": ("spike", 0.25, "what flashes in one frame, in the worst part of the picture"),
}
ERRORS = {
    "nrmse": ("nRMSE", 0.3, "error, mean over the frames"),
    "bias": ("bias", 0.1, "light too much (above 0) or missing, mean over the frames"),
}
COLUMNS = {**INDICES, **ERRORS}
# Of a figure: with a larger floor it says too much about the truth's noise. That of nRMSE adds in squares, of which a
# tenth may be noise as everywhere (docs/accuracy.md).
NOISE_SHARE, NOISE_SHARE_NRMSE = 0.25, math.sqrt(0.1)
LEVELS = {"none": "nothing to judge by", "noisy": "too close to its floor", "quiet": "hardly noticed", "seen": "noticed",
          "bad": "four times what is noticed", "exact": "0"}


class StabilityResults:
    def __init__(self, path):
        data = read_json(path, FORMAT)
        try:
            self.folder, self.header = path.parent, data["header"]
            self.sequences, self.results = data["sequences"], data["results"]
            self.techniques = list(dict.fromkeys(r["technique"] for r in self.results))
            self.sequences = [s for s in self.sequences if any(r["sequence"] == s["id"] for r in self.results)]
            self._by_id = {(r["technique"], r["sequence"]): r for r in self.results}
        except (KeyError, TypeError) as error:
            raise ReportError(f"{path}: expected {FORMAT}; missing or malformed: {error}") from error

    def of(self, technique, sequence):
        """The result of a technique in a sequence; None where it was not measured."""
        return self._by_id.get((technique, sequence["id"]))

    def others_build(self):
        """Results of another build than the last run's."""
        return [r for r in self.results if r.get("build") != self.header.get("build")]


def figure(result, key):
    """(value, floor) of one index or error of a result; None where there is nothing."""
    if key in INDICES:
        return result["indices"].get(key), result["floors"].get(key)
    return result["errors"].get(key), result["error_floors"].get(key)


def level(key, value, floor):
    """How much a figure shows: a key of LEVELS."""
    if value is None:
        return "none"
    size = abs(value) if key == "bias" else max(value, 0.0)
    if size == 0.0:
        return "exact"
    noticed = COLUMNS[key][1]
    # A figure far below what is noticed is small, whatever the noise.
    share = NOISE_SHARE_NRMSE if key == "nrmse" else NOISE_SHARE
    if floor is not None and abs(floor) > share * size and max(size, abs(floor)) > share * noticed:
        return "noisy"
    return "quiet" if size < noticed else "seen" if size < 4.0 * noticed else "bad"


def short(value):
    """Three digits that matter, without exponents where they can be avoided."""
    if value is None:
        return ""
    if value == 0.0:
        return "0"
    if abs(value) >= 1e4 or abs(value) < 5e-5:
        return f"{value:.1e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{value:.{max(0, 2 - int(math.floor(math.log10(abs(value)))))}f}" if abs(value) >= 0.01 else f"{value:.4f}"
