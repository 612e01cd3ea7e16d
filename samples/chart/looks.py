"""How techniques look in every figure: a technique has the same colour in all of them, whichever others stand beside it."""

# Okabe and Ito's colours, told apart by most colour-blind readers, too; their yellow, faint on white, is a brown here.
COLOURS = {"rsm": "#0072B2", "ssvp": "#D55E00", "rival": "#009E73", "screen_space": "#CC79A7", "horizon": "#E69F00", "ao": "#56B4E9",
           "fallback": "#000000", "instant_radiosity": "#882255", "lpv": "#7A4B00", "cone_tracing": "#5B3A9B", "static_vpl": "#A8C000"}
SPARE = ["#8A8A8A", "#1B7F79", "#C04040"]
LINES = ["-", "--", "-."]  # dots are the floors of noise
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*"]


def looks(techniques):
    """{technique: (colour, style of its line, marker of its line)}. "ssvp,warm_start=off" has the colour of ssvp and another line."""
    seen, found = {}, {}
    spare = list(SPARE)
    for index, technique in enumerate(techniques):
        base = technique.split(",")[0]
        if base not in seen:
            colour = COLOURS.get(base) or spare[0]
            if base not in COLOURS:
                spare = spare[1:] + spare[:1]
            seen[base] = [colour, 0]
        colour, count = seen[base]
        seen[base][1] += 1
        found[technique] = (colour, LINES[count % len(LINES)], MARKERS[index % len(MARKERS)])
    return found
