#!/usr/bin/env python3
"""Picture of an element test: what was driven, the path in p and q, volume, and the state of the material.

    python3 element_pictures.py RESULTS_DIR

Reads RESULTS_DIR/element.csv and, if it is there, reference.csv; writes RESULTS_DIR/pictures/element.png.
Needs python3-numpy and python3-matplotlib. Made to be adapted: each panel is drawn by one function.
Stress and strain are positive in tension in the tables; p, and in the picture axial stress and strain, in compression.
"""
import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import LogFormatter

COMPONENTS = ["xx", "yy", "zz", "xy", "yz", "xz"]
COLUMNS = ("time_s", "stage", "pressure_Pa", "mises_stress_Pa", "pore_pressure_Pa", "volumetric_strain", "void_ratio")
PLAIN = {"color": "#4477aa", "linewidth": 1.4}
REFERENCE = {"color": "k", "linewidth": 0.9, "linestyle": (0, (2, 2))}
plt.rcParams.update({"font.size": 9, "axes.linewidth": 0.6, "savefig.dpi": 200})


def read_table(path):
    """Columns of a CSV file by name; None if there is no file or no row."""
    if not path.exists():
        return None
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    if len(rows) < 2:
        return None
    columns = {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}
    return {name: values if name == "stage" else np.array(values, float) for name, values in columns.items()}


def driven(table):
    """The component whose strain changes most; a shear test is known by its shear, however much it dilates."""
    ranges = [np.ptp(table[f"strain_{c}"]) for c in COMPONENTS]
    shear = max(range(3, 6), key=lambda k: ranges[k])
    return COMPONENTS[shear if ranges[shear] > 0.3 * max(ranges) else int(np.argmax(ranges[:3]))]


def abscissa(table, component):
    """Strain in per cent and its name: axial compression, or gamma."""
    strain = 100 * table[f"strain_{component}"]
    if component in ("xy", "yz", "xz"):
        return 2 * strain, rf"$\gamma_{{{component}}}$ [%]"
    return -strain, rf"$-\varepsilon_{{{component}}}$ [%]"


def draw_driven(axis, tables, component):
    for table, style, label in tables:
        stress = table[f"stress_{component}_Pa"] / 1000
        sign = 1 if component in ("xy", "yz", "xz") else -1
        axis.plot(abscissa(table, component)[0], sign * stress, label=label, **style)
    name = rf"\sigma_{{{component}}}"
    axis.set(xlabel=abscissa(tables[0][0], component)[1], ylabel=f"${name}$ [kPa]" if sign > 0 else f"$-{name}$ [kPa]")
    axis.legend(fontsize=7, framealpha=0.8, edgecolor="none")


def draw_invariants(axis, tables, _):
    for table, style, label in tables:
        axis.plot(table["pressure_Pa"] / 1000, table["mises_stress_Pa"] / 1000, label=label, **style)
    axis.plot(tables[0][0]["pressure_Pa"][0] / 1000, tables[0][0]["mises_stress_Pa"][0] / 1000, "o", markersize=3, **PLAIN)
    axis.set(xlabel="$p$ [kPa]", ylabel="$q$ [kPa]")


def draw_volume(axis, tables, component):
    """Pore pressure if there is any; compression over the logarithm of p where it was driven; else volumetric strain."""
    first = tables[0][0]
    undrained = np.ptp(first["pore_pressure_Pa"]) > 0
    normal = [np.ptp(first[f"strain_{c}"]) for c in COMPONENTS[:3]]
    isotropic = min(normal) > 0.99 * max(normal)
    confined = np.allclose(first["volumetric_strain"], first["strain_zz"]) and max(normal) > 0
    if (isotropic or confined) and first["pressure_Pa"].min() > 0:
        name = "void_ratio" if "void_ratio" in first else "volumetric_strain"
        for table, style, label in tables:
            axis.semilogx(table["pressure_Pa"] / 1000, table[name], label=label, **style)
        for kind in (axis.xaxis.set_major_formatter, axis.xaxis.set_minor_formatter):
            kind(LogFormatter(labelOnlyBase=False, minor_thresholds=(2, 0.5)))
        axis.set(xlabel="$p$ [kPa]", ylabel=name.replace("_", " "))
        return
    for table, style, label in tables:
        values = table["pore_pressure_Pa"] / 1000 if undrained else 100 * table["volumetric_strain"]
        axis.plot(abscissa(table, component)[0], values, label=label, **style)
    axis.set(xlabel=abscissa(tables[0][0], component)[1],
             ylabel="excess pore pressure [kPa]" if undrained else "volumetric strain [%], + dilation")


def draw_state(axis, tables, component):
    """All state variables, each over the largest value of the path; q over time if there are none."""
    names = [name for name in tables[0][0] if name not in COLUMNS and not name.startswith(("strain_", "stress_"))]
    if not names:
        axis.plot(tables[0][0]["time_s"], tables[0][0]["mises_stress_Pa"] / 1000, **PLAIN)
        axis.set(xlabel="time [s]", ylabel="$q$ [kPa]")
        return
    for name, colour in zip(names, plt.rcParams["axes.prop_cycle"].by_key()["color"]):
        largest = np.abs(tables[0][0][name]).max() or 1.0
        for table, style, label in tables:
            text = f"{name.replace('_', ' ')} / {largest:.3g}" if style is PLAIN else None
            axis.plot(abscissa(table, component)[0], table[name] / largest, label=text,
                      **{**style, **({"color": colour} if style is PLAIN else {})})
    axis.set(xlabel=abscissa(tables[0][0], component)[1], ylabel="state over its largest value")
    axis.legend(fontsize=7, framealpha=0.8, edgecolor="none")


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: element_pictures.py RESULTS_DIR")
    folder = Path(sys.argv[1])
    table, reference = read_table(folder / "element.csv"), read_table(folder / "reference.csv")
    if table is None:
        sys.exit(f"{folder / 'element.csv'}: does not exist, or has no row")
    tables = [(table, PLAIN, "update of the program")]
    if reference is not None:
        tables.append((reference, REFERENCE, "reference"))
    component = driven(table)
    figure, axes = plt.subplots(2, 2, figsize=(7.2, 5.6), layout="constrained")
    for axis, draw in zip(axes.flat, (draw_driven, draw_invariants, draw_volume, draw_state)):
        draw(axis, tables, component)
        axis.grid(linewidth=0.3)
    (folder / "pictures").mkdir(exist_ok=True)
    picture = folder / "pictures" / "element.png"
    figure.savefig(picture)
    print(picture)


if __name__ == "__main__":
    main()
