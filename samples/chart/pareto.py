"""The Pareto front of (time, error): what nothing else beats in both."""


def pareto_front(points):
    """Indices of the points that no other beats, by rising time. `points`: (time, error) pairs, less is better.

    One point beats another when it is no worse in both and better in one; of equal points the first counts."""
    front, best = [], None
    for index in sorted(range(len(points)), key=lambda i: (points[i][0], points[i][1], i)):
        if best is None or points[index][1] < best:
            best = points[index][1]
            front.append(index)
    return front
