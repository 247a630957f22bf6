#!/usr/bin/python3
"""Draws the figure of a study from chart.csv and chart.json, as chart.svg and chart.png.

    chart_figures.py FOLDER

Kind `curves`: error against CPU time, logarithmic, a curve a scheme; the first axis is the colour, the second the
marker, the third the line. The Pareto front is drawn through the variants that no other beats in both. Variants that
failed stand on the upper edge. Kind `map`: the error in colours over the last two axes, one panel for each combination of
the others; grey where a variant failed. Needs python3-matplotlib and python3-numpy.
"""
import csv
import itertools
import json
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.colors import LogNorm  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402

COLOURS = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#777777", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*", "<", ">"]
LINES = ["-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 4))]
plt.rcParams.update({"font.size": 9, "axes.titlesize": 10, "svg.hashsalt": "sluice", "legend.fontsize": 8})


def read(folder):
    with open(folder / "chart.json", encoding="utf-8") as file:
        chart = json.load(file)
    with open(folder / "chart.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row["error"] = float(row["error"] or "nan")
        row["cpu_s"] = float(row["cpu_s"] or "nan")
        row["front"] = not row["failure"] and float(row["times_front"]) == 1
    return chart, rows


class Style:
    """Colour, marker and line by the labels of the axes that are not along a curve. Axes with one label count not."""

    def __init__(self, chart):
        self.axes = [a for a in chart["axes"] if a["name"] != chart["along"] and len(a["labels"]) > 1]

    def of(self, row):
        place = [axis["labels"].index(row[axis["name"]]) for axis in self.axes] + [0, 0, 0]
        return COLOURS[place[0] % len(COLOURS)], MARKERS[place[1] % len(MARKERS)], LINES[place[2] % len(LINES)]

    def key(self, row):
        return tuple(row[axis["name"]] for axis in self.axes)

    def legends(self):
        """(title, handles) of each axis."""
        for number, axis in enumerate(self.axes[:3]):
            handles = []
            for i, label in enumerate(axis["labels"]):
                look = [dict(color=COLOURS[i % len(COLOURS)], lw=2),
                        dict(color="0.3", marker=MARKERS[i % len(MARKERS)], ls="none"),
                        dict(color="0.3", ls=LINES[i % len(LINES)])][number]
                handles.append(Line2D([], [], label=label, **look))
            yield axis["name"].replace("_", " "), handles


def draw_failures(ax, rows, style, top):
    """On the upper edge, at what they cost; failures that cost nothing, refusals, are left out."""
    failed = [row for row in rows if row["failure"] and row["failure"] != "refused" and row["cpu_s"] > 0]
    for row in failed:
        colour, marker, _ = style.of(row)
        ax.plot(row["cpu_s"], top, marker=marker, color=colour, mfc="none", ms=5, clip_on=False, ls="none", zorder=5)
        ax.plot(row["cpu_s"], top, marker="x", color=colour, ms=5, clip_on=False, ls="none", zorder=5)
    return failed


def draw_curves(chart, rows, folder):
    style = Style(chart)
    labels = next(a["labels"] for a in chart["axes"] if a["name"] == chart["along"])
    fig, ax = plt.subplots(figsize=(8.2, 5))
    good = [row for row in rows if not row["failure"] and row["error"] > 0]
    many = len({style.key(row) for row in good}) > 30
    for key in dict.fromkeys(style.key(row) for row in good):
        curve = sorted((row for row in good if style.key(row) == key), key=lambda row: labels.index(row[chart["along"]]))
        colour, marker, line = style.of(curve[0])
        ax.plot([r["cpu_s"] for r in curve], [r["error"] for r in curve], color=colour, marker=marker, ls=line,
                ms=3 if many else 4.5, lw=0.6 if many else 1.1, alpha=0.75)
    front = sorted((row for row in good if row["front"]), key=lambda row: row["cpu_s"])
    if front:
        ax.plot([r["cpu_s"] for r in front], [r["error"] for r in front], color="black", lw=3, alpha=0.25, zorder=1,
                drawstyle="steps-post", solid_capstyle="round")
        ax.plot([r["cpu_s"] for r in front], [r["error"] for r in front], ls="none", marker="o", mfc="none", mec="black",
                ms=9, zorder=6)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.grid(True, which="major", lw=0.5, alpha=0.5)
    ax.set_xlabel(f"CPU time of the steps [s]; points of a curve: {chart['along'].replace('_', ' ')} {', '.join(labels)}")
    ax.set_ylabel(chart["error_label"])
    ax.set_title(chart["title"])
    top = ax.get_ylim()[1] if good else 1
    failed = draw_failures(ax, rows, style, top)
    ax.set_ylim(top=top)
    where, legends = 1.0, []
    for title, handles in style.legends():
        legend = ax.legend(handles=handles, title=title, loc="upper left", bbox_to_anchor=(1.01, where), frameon=False,
                           alignment="left")
        ax.add_artist(legend)
        legends.append(legend)
        where -= 0.055 * (len(handles) + 1.6)
    last = [Line2D([], [], color="black", lw=3, alpha=0.25, marker="o", mfc="none", ms=9, label="the front")]
    if failed:
        causes = "\n".join(sorted({row["failure"] for row in failed}))
        last.append(Line2D([], [], color="0.3", marker="x", ls="none", label=f"failed:\n{causes}"))
    legends.append(ax.legend(handles=last, loc="upper left", bbox_to_anchor=(1.01, where), frameon=False))
    save(fig, folder, legends)


def numbers_of(labels):
    """The labels as numbers, if all of them begin with one."""
    try:
        return [float(label.split()[0]) for label in labels]
    except ValueError:
        return None


def cell_edges(centres):
    """Edges of the fields around centres: half-way, in the logarithm if they are spaced so."""
    centres = np.asarray(centres, float)
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5]), False
    log = bool(np.all(centres > 0)) and centres.max() / centres.min() > 30
    c = np.log(centres) if log else centres
    middle = (c[1:] + c[:-1]) / 2
    edges = np.concatenate([[2 * c[0] - middle[0]], middle, [2 * c[-1] - middle[-1]]])
    return (np.exp(edges), True) if log else (edges, False)


def draw_panel(ax, chart, rows, across, up, norm):
    scales = []
    for axis in (across, up):
        values = numbers_of(axis["labels"])
        scales.append(values if values else list(range(1, len(axis["labels"]) + 1)))
    errors = np.full((len(up["labels"]), len(across["labels"])), np.nan)
    failed = np.zeros_like(errors, dtype=bool)
    for row in rows:
        at = up["labels"].index(row[up["name"]]), across["labels"].index(row[across["name"]])
        errors[at] = np.nan if row["failure"] else max(row["error"], 1e-16)
        failed[at] = bool(row["failure"]) and row["failure"] != "refused"
    (x, log_x), (y, log_y) = cell_edges(scales[0]), cell_edges(scales[1])
    ax.set_facecolor("white")
    ax.pcolormesh(x, y, np.where(failed, 1.0, np.nan), cmap="gray", vmin=0, vmax=1.6)
    image = ax.pcolormesh(x, y, errors, cmap="viridis_r", norm=norm)
    for i, bound in enumerate(chart["bounds"]):
        points = np.array(bound["points"])
        ax.plot(points[:, 0], points[:, 1], color=COLOURS[(1 + i) % len(COLOURS)], lw=2, marker=".", label=bound["name"])
    for axis, scale, log, values, low, high in ((ax.xaxis, "x", log_x, across, x[0], x[-1]), (ax.yaxis, "y", log_y, up, y[0], y[-1])):
        if log:
            (ax.set_xscale if scale == "x" else ax.set_yscale)("log")
        if not numbers_of(values["labels"]):
            axis.set_ticks(range(1, len(values["labels"]) + 1), values["labels"])
        (ax.set_xlim if scale == "x" else ax.set_ylim)(low, high)
    ax.set_xlabel(across["name"].replace("_", " "))
    ax.set_ylabel(up["name"].replace("_", " "))
    return image


def draw_map(chart, rows, folder):
    *others, up, across = chart["axes"]
    good = [max(row["error"], 1e-16) for row in rows if not row["failure"]]
    norm = LogNorm(min(good), max(max(good), 1.01 * min(good)))
    panels = list(itertools.product(*(axis["labels"] for axis in others)))
    columns = min(3, len(panels))
    lines = math.ceil(len(panels) / columns)
    fig, axes = plt.subplots(lines, columns, figsize=(1 + 3.6 * columns, 0.8 + 3.0 * lines), squeeze=False,
                             layout="constrained")
    for ax in axes.flat[len(panels):]:
        ax.set_visible(False)
    for ax, labels in zip(axes.flat, panels):
        own = [row for row in rows if all(row[axis["name"]] == label for axis, label in zip(others, labels))]
        image = draw_panel(ax, chart, own, across, up, norm)
        ax.set_title(", ".join(labels))
    fig.colorbar(image, ax=axes, label=chart["error_label"] + "; grey: failed")
    if chart["bounds"]:
        axes.flat[0].legend(loc="best")
    fig.suptitle(chart["title"])
    save(fig, folder)


def save(fig, folder, legends=()):
    fig.savefig(folder / "chart.svg", bbox_inches="tight", bbox_extra_artists=legends, metadata={"Date": None})
    fig.savefig(folder / "chart.png", bbox_inches="tight", bbox_extra_artists=legends, dpi=110)
    print(folder / "chart.png")


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: chart_figures.py FOLDER")
    folder = Path(sys.argv[1])
    chart, rows = read(folder)
    (draw_map if chart["kind"] == "map" else draw_curves)(chart, rows, folder)


if __name__ == "__main__":
    main()
