#!/usr/bin/env python3
"""Pictures of a Sluice run: fields at a few times, curves over time, and an animation.

    python3 pictures.py RESULTS_DIR [--fields equivalent_plastic_strain material displacement]
                                    [--times 0 10 20 50] [--animation]

Reads RESULTS_DIR/results.h5 (of a finished run, or of one under way), history.csv and observations.csv; writes
RESULTS_DIR/pictures/FIELD.png (one panel a time), history.png, observations.png and FIELD.gif.
Needs python3-h5py, python3-numpy, python3-matplotlib, python3-pil and python3-yaml. Made to be adapted: the layout of results.h5 is
read in `Results`, a field is turned into an image in `rasterise`, and each figure is drawn by one function.
"""
import argparse
import csv
import sys
import textwrap
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import yaml
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.patches import Patch
from PIL import Image, ImageDraw, ImageFont

COLOUR_MAP = "viridis"  # perceptually uniform, and legible in grey print
MATERIAL_COLOURS = ["#4477aa", "#ddaa33", "#bb5566", "#228833", "#66ccee", "#aa3377", "#994455", "#bbbbbb"]
DOTS_PER_INCH = 200
plt.rcParams.update({"font.size": 9, "axes.linewidth": 0.6, "savefig.dpi": DOTS_PER_INCH})


class Results:
    """results.h5, a temporal VTKHDF file: the rows of every time follow one another in each dataset."""

    def __init__(self, folder):
        path = Path(folder) / "results.h5"
        if not path.exists():
            sys.exit(f"{path}: does not exist")
        self.file = h5py.File(path, "r")
        data, about = self.file["VTKHDF"], self.file["Sluice"]
        self.times = data["Steps/Values"][:]
        self.first = data["Steps/PointOffsets"][:]
        self.count = data["NumberOfPoints"][:]
        self.fields = data["PointData"]
        self.points = data["Points"]
        self.dimension = int(about.attrs["dimension"])
        self.low, self.high, self.cell = (about.attrs[name] for name in ("grid_min", "grid_max", "grid_cell"))
        self.materials = [name.decode() for name in about["material_names"][:]]
        self.title = text(about.attrs["title"])
        resolved = yaml.safe_load(text(about["resolved_case"][:][0]))
        self.obstacles = list((resolved.get("obstacles") or {}).values())

    def rows(self, frame):
        return slice(self.first[frame], self.first[frame] + self.count[frame])

    def positions(self, frame):
        """(N, dimension) in metres."""
        return self.points[self.rows(frame)][:, : self.dimension]

    def initial_positions(self, frame):
        return self.positions(frame) - self.fields["displacement"][self.rows(frame)][:, : self.dimension]

    def values(self, name, frame):
        """(N,): of a vector its length, of a stress the mean."""
        values = self.fields[name][self.rows(frame)]
        if values.ndim == 2:
            values = np.linalg.norm(values, axis=1) if values.shape[1] == 3 else values[:, :3].mean(axis=1)
        return values / 1000 if self.unit(name) == "kPa" else values

    def unit(self, name):
        """Of `values`: SI, but kPa for stresses and pressures."""
        unit = text(self.fields[name].attrs["unit"])
        return "kPa" if unit == "Pa" else unit

    def dry(self, frame):
        """Which particles hold no water, where some do and some do not; else None."""
        if "wet" not in self.fields:
            return None
        dry = self.fields["wet"][self.rows(frame)] == 0
        return dry if dry.any() and not dry.all() else None

    def label(self, name):
        words = name.replace("_", " ")
        if self.fields[name].ndim == 2:
            words = f"{words}, {'magnitude' if self.fields[name].shape[1] == 3 else 'mean of xx, yy, zz'}"
        unit = self.unit(name)
        return words if unit == "1" else f"{words} [{unit}]"

    def require(self, names):
        missing = [name for name in names if name not in self.fields]
        if missing:
            there = ", ".join(sorted(self.fields))
            sys.exit(f"{self.file.filename}: has no field {', '.join(missing)}; it has {there}")


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


class View:
    """The window of all pictures, in the plane of the first and the last axis, cut into pixels of half a cell."""

    def __init__(self, results):
        axes = [0, results.dimension - 1]
        self.axes = axes
        self.pixel = results.cell[axes] / 2
        low, high = results.high[axes].copy(), results.low[axes].copy()
        for frame in evenly_spaced(results, 12):
            if results.count[frame]:
                # A single particle that was thrown far does not make the picture small.
                near, far = np.percentile(results.positions(frame)[:, axes], [0.02, 99.98], axis=0)
                low, high = np.minimum(low, near), np.maximum(high, far)
        margin = 0.03 * (high - low) + 2 * results.cell[axes]
        low = np.maximum(low - margin, results.low[axes])
        high = np.minimum(high + margin, results.high[axes])
        low[1] = results.low[axes[1]] if low[1] - results.low[axes[1]] < 0.5 * (high[1] - low[1]) else low[1]
        first = np.floor((low - results.low[axes]) / self.pixel)
        self.shape = np.maximum(1, np.ceil((high - results.low[axes]) / self.pixel) - first).astype(int)
        self.low = results.low[axes] + first * self.pixel
        self.high = self.low + self.shape * self.pixel
        self.floor = results.low[axes[1]]

    def pixels(self, positions):
        """Pixel of every particle, as one number, and which particles are in the window."""
        index = np.floor((positions[:, self.axes] - self.low) / self.pixel).astype(int)
        inside = np.all((index >= 0) & (index < self.shape), axis=1)
        return index[:, 1] * self.shape[0] + index[:, 0], inside

    @property
    def extent(self):
        return self.low[0], self.high[0], self.low[1], self.high[1]


def evenly_spaced(results, most):
    return sorted({round(i) for i in np.linspace(0, len(results.times) - 1, most)})


def neighbours(image):
    """The eight images shifted by one pixel."""
    padded = np.pad(image, 1)
    rows, columns = image.shape
    return [padded[1 + j : 1 + j + rows, 1 + i : 1 + i + columns] for j in (-1, 0, 1) for i in (-1, 0, 1) if i or j]


def rasterise(view, positions, values, category=False):
    """Image (rows from below) of the mean of the particles in each pixel, not a number where there are none.

    Of a category (a material) the commonest is taken. Pixels without particles that are surrounded by others are
    filled from their neighbours, so that material that has stretched does not look perforated.
    """
    pixel, inside = view.pixels(positions)
    size = view.shape[0] * view.shape[1]
    pixel, values = pixel[inside], values[inside]

    def image(weights=None):
        return np.bincount(pixel, weights, size).reshape(view.shape[1], view.shape[0])

    if category:
        kinds = int(values.max(initial=0)) + 1
        counts = np.array([image((values == kind).astype(float)) for kind in range(kinds)])
        sums, count = None, counts.sum(axis=0)
    else:
        sums, count = image(values), image()
    for _ in range(2):
        full = count > 0
        gaps = ~full & (sum(neighbours(full.astype(int))) >= 5)
        if category:
            for kind in range(kinds):
                counts[kind][gaps] = sum(neighbours(counts[kind]))[gaps]
            count = counts.sum(axis=0)
        else:
            sums[gaps], count[gaps] = sum(neighbours(sums))[gaps], sum(neighbours(count))[gaps]
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(count > 0, counts.argmax(axis=0), np.nan) if category else sums / count


class Scale:
    """Colours of one field, the same at all times."""

    def __init__(self, results, name, frames):
        self.category = name == "material"
        self.label = results.label(name)
        if self.category:
            self.materials = results.materials
            colours = [MATERIAL_COLOURS[i % len(MATERIAL_COLOURS)] for i in range(len(self.materials))]
            self.map, self.norm = ListedColormap(colours), Normalize(-0.5, len(colours) - 0.5)
            return
        self.map = plt.get_cmap(COLOUR_MAP)
        values = np.concatenate([results.values(name, frame) for frame in frames])
        values = values[np.isfinite(values)]
        # A few extreme particles do not decide the scale; where most of a field is zero, a thin zone of large values neither.
        low, high = np.percentile(values, [0.5, 99.5]) if values.size else (0, 1)
        if name == "pore_pressure":
            # The whole range, from zero unless there is suction worth a colour.
            low, high = (0 if low > -0.02 * high else low), np.percentile(values, 99.9)
        elif 0 <= low < 0.2 * high:
            low, high = 0, np.percentile(values, 97)
        self.norm = Normalize(low, high if high > low else low + 1)
        self.extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[
            (int(values.size and values.min() < low - 0.02 * (high - low)),
             int(values.size and values.max() > high + 0.02 * (high - low)))
        ]

    def patches(self):
        return [Patch(color=self.map(self.norm(i)), label=m.replace("_", " ")) for i, m in enumerate(self.materials)]

    def explain(self, figure, axes):
        """The legend of materials, or the colour bar."""
        if self.category:
            columns = min(4, len(self.materials), max(1, int(figure.get_figwidth() / 1.7)))
            share = (0.1 + 0.2 * -(-len(self.materials) // columns)) / figure.get_figheight()
            figure.get_layout_engine().set(rect=(0, share, 1, 1 - share))
            figure.legend(handles=self.patches(), loc="lower center", ncol=columns, frameon=False)
        else:
            mappable = plt.cm.ScalarMappable(self.norm, self.map)
            figure.colorbar(mappable, ax=list(axes), label=self.label, extend=self.extend, extendfrac=0.02, shrink=0.9,
                            aspect=30, pad=0.01)


def draw_outline(axes, view, start):
    """The first configuration, as the boundary of the pixels that it occupied."""
    occupied = np.isfinite(start)
    x = view.low[0] + (np.arange(view.shape[0]) + 0.5) * view.pixel[0]
    y = view.low[1] + (np.arange(view.shape[1]) + 0.5) * view.pixel[1]
    x, y = np.r_[x[0] - view.pixel[0], x, x[-1] + view.pixel[0]], np.r_[y[0] - view.pixel[1], y, y[-1] + view.pixel[1]]
    axes.contour(x, y, np.pad(occupied.astype(float), 1), levels=[0.5], colors="0.25", linewidths=0.6)


def number(quantity):
    """Of a quantity in the resolved case, which is in SI: "0.5 m"."""
    return float(str(quantity).split()[0])


def moved_by(table, time):
    """Distance at a time of what has this velocity, a value or points in time."""
    if not isinstance(table, list):
        return number(table) * time
    at = np.array([[number(t), number(v)] for t, v in table])
    times = np.unique(np.r_[0, at[(at[:, 0] > 0) & (at[:, 0] < time), 0], time])
    return np.trapz(np.interp(times, at[:, 0], at[:, 1]), times)


def inside_polygon(x, y, points):
    inside = np.zeros(x.shape, dtype=bool)
    for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1]):
        crosses = (y0 <= y) != (y1 <= y)
        inside ^= crosses & (x < x0 + (y - y0) * (x1 - x0) / ((y1 - y0) or 1))
    return inside


def inside_region(x, y, region):
    """Which points of the plane lie in a region of the resolved case: in all of its shapes."""
    inside = np.ones(x.shape, dtype=bool)
    for shape, about in region.items():
        if shape == "box":
            (x0, y0), (x1, y1) = (map(number, about[end]) for end in ("min", "max"))
            inside &= (x >= x0) & (x < x1) & (y >= y0) & (y < y1)
        elif shape == "half_space":
            (x0, y0), (a, b) = map(number, about["point"]), map(number, about["normal"])
            inside &= a * (x - x0) + b * (y - y0) <= 0
        elif shape in ("circle", "sphere"):
            x0, y0 = map(number, about["centre"])
            inside &= np.hypot(x - x0, y - y0) <= number(about["radius"])
        elif shape == "polygon":
            inside &= inside_polygon(x, y, [tuple(map(number, point)) for point in about])
        elif shape == "layer":
            inside &= (y >= number(about.get("bottom", "-inf"))) & (y < number(about.get("top", "inf")))
        elif shape == "union":
            inside &= np.any([inside_region(x, y, part) for part in about], axis=0)
        elif shape == "intersection":
            inside &= np.all([inside_region(x, y, part) for part in about], axis=0)
        elif shape == "difference":
            inside &= inside_region(x, y, about[0]) & ~np.any([inside_region(x, y, part) for part in about[1:]], axis=0)
    return inside


def draw_obstacles(results, axes, view, frame):
    """Grey where an obstacle is, in plane strain."""
    if results.dimension != 2:
        return
    fine = 4  # points in a pixel along each axis
    x = view.low[0] + (np.arange(view.shape[0] * fine) + 0.5) * view.pixel[0] / fine
    y = view.low[1] + (np.arange(view.shape[1] * fine) + 0.5) * view.pixel[1] / fine
    x, y = np.meshgrid(x, y)
    for obstacle in results.obstacles:
        velocity = obstacle.get("velocity") or [0, 0]
        by = [moved_by(table, results.times[frame]) for table in velocity]
        inside = inside_region(x - by[0], y - by[1], obstacle)
        axes.imshow(np.ma.masked_where(~inside, inside), extent=view.extent, origin="lower", cmap=ListedColormap(["0.7"]),
                    interpolation="nearest", zorder=0.5)


def shown(results, view, name, frame):
    return rasterise(view, results.positions(frame), results.values(name, frame), name == "material")


def draw_dry(results, axes, view, frame):
    """Grey over soil that holds no water, and the line that bounds it, in pictures of the pore pressure."""
    dry = results.dry(frame)
    if dry is None:
        return
    share = rasterise(view, results.positions(frame), dry.astype(float))
    axes.imshow(np.ma.masked_where(~(share > 0.5), share), extent=view.extent, origin="lower", cmap=ListedColormap(["0.85"]),
                interpolation="nearest")
    x = view.low[0] + (np.arange(view.shape[0]) + 0.5) * view.pixel[0]
    y = view.low[1] + (np.arange(view.shape[1]) + 0.5) * view.pixel[1]
    axes.contour(x, y, share, levels=[0.5], colors="#2255aa", linewidths=1.0)


def layout_of(view, count, bar=0.9, spare=0.35):
    """Rows, columns and size in inches of `count` panels and a bar beside them, on a page 7.5 wide at most 9 high."""
    aspect = (view.high[1] - view.low[1]) / (view.high[0] - view.low[0])
    best = None
    for columns in range(1, count + 1):
        rows = -(-count // columns)
        width = (7.5 - bar - 0.5) / columns
        width = min(width, ((9 - 0.8) / rows - spare) / aspect)  # tall panels become narrower
        empty = rows * columns - count
        size = width * width * aspect / (1 + 0.2 * empty)
        if best is None or size > 1.15 * best[0]:
            best = size, rows, columns, max(3.5, columns * width + bar + 0.5), rows * (width * aspect + spare) + 0.8
    return best[1:]


def draw_field(results, view, name, frames, path):
    """One panel a time, with the same colours in all panels."""
    scale = Scale(results, name, frames)
    rows, columns, width, height = layout_of(view, len(frames), 0 if scale.category else 0.9)
    figure, panels = plt.subplots(rows, columns, figsize=(width, height), sharex=True, sharey=True, squeeze=False,
                                  layout="constrained")
    axes = panels.ravel()[: len(frames)]
    for empty in panels.ravel()[len(frames) :]:
        empty.set_visible(False)
    start = rasterise(view, results.initial_positions(0), results.values("mass", 0))
    for axis, frame in zip(axes, frames):
        image = np.ma.masked_invalid(shown(results, view, name, frame))
        axis.imshow(image, extent=view.extent, origin="lower", cmap=scale.map, norm=scale.norm, interpolation="nearest")
        if name == "pore_pressure":
            draw_dry(results, axis, view, frame)
        draw_obstacles(results, axis, view, frame)
        draw_outline(axis, view, start)
        axis.axhline(view.floor, color="black", linewidth=1.2)
        axis.set(aspect="equal", xlim=(view.low[0], view.high[0]), ylim=(view.low[1] - view.pixel[1], view.high[1]))
        axis.spines[["top", "right"]].set_visible(False)
        axis.set_title(f"t = {results.times[frame]:.4g} s", loc="left", fontsize=9, fontweight="bold", pad=3)
    for axis in panels[:, 0]:
        axis.set_ylabel(f"{'xyz'[view.axes[1]]} [m]")
    for axis in axes[-columns:]:
        axis.set_xlabel("x [m]")
        axis.tick_params(labelbottom=True)
    figure.suptitle("\n".join(textwrap.wrap(results.title, round(width * 11))), fontsize=10)
    scale.explain(figure, axes)
    figure.savefig(path, bbox_inches="tight", pad_inches=0.06)
    plt.close(figure)


def draw_scatter(results, name, frames, path, most=60000):
    """3-D: the particles seen in perspective, thinned to `most`."""
    scale = Scale(results, name, frames)
    box = results.high - results.low
    width = 7.5
    row = 0.9 + 0.8 * width * min(1, (box[2] + 0.5 * box[1] + 0.15 * box[0]) / box[0])
    height = row * len(frames) + 0.6
    figure = plt.figure(figsize=(width, height))
    for number, frame in enumerate(frames):
        # Axes in perspective are square: each is as wide as the page, and overlaps its neighbours where it is empty.
        middle = (height - 0.6 - (number + 0.5) * row) / height
        axes = figure.add_axes([0, middle - 0.5 * width / height, 0.95, width / height], projection="3d")
        axes.patch.set_alpha(0)
        keep = slice(None, None, max(1, int(results.count[frame]) // most))
        axes.scatter(*results.positions(frame)[keep].T, c=results.values(name, frame)[keep], cmap=scale.map,
                     norm=scale.norm, s=1.5, linewidths=0)
        axes.set(xlim=(results.low[0], results.high[0]), ylim=(results.low[1], results.high[1]),
                 zlim=(results.low[2], results.high[2]), xlabel="x [m]", yticks=[results.low[1], results.high[1]],
                 zticks=[results.low[2], results.high[2]])
        axes.tick_params(labelsize=7, pad=0)
        axes.view_init(elev=22, azim=-70)
        axes.set_box_aspect(box, zoom=0.85)
        figure.text(0.03, middle + 0.4 * row / height, f"t = {results.times[frame]:.4g} s", fontweight="bold")
    if scale.category:
        figure.legend(handles=scale.patches(), loc="upper center", ncol=5, frameon=False)
    else:
        bar = figure.add_axes([0.2, 1 - 0.15 / height, 0.6, 0.1 / height])
        figure.colorbar(plt.cm.ScalarMappable(scale.norm, scale.map), cax=bar, orientation="horizontal",
                        label=scale.label, extend=scale.extend)
    figure.savefig(path, bbox_inches="tight", pad_inches=0.06)
    plt.close(figure)


def load_font(size):
    """The font of matplotlib, which is always there."""
    return ImageFont.truetype(matplotlib.get_data_path() + "/fonts/ttf/DejaVuSans.ttf", size)


def draw_animation(results, view, name, frames, path, most_bytes=3_000_000):
    """A GIF, drawn without matplotlib, which takes some 10 ms a frame. It is made smaller until it fits."""
    scale = Scale(results, name, frames)
    steps = len(scale.materials) if scale.category else 40
    colours = (scale.map(np.linspace(0, 1, steps))[:, :3] * 255).astype(np.uint8)
    white, black = steps, steps + 1
    palette = np.vstack([colours, [255, 255, 255], [0, 0, 0]]).astype(np.uint8)
    images = [shown(results, view, name, frame) for frame in frames]
    start = np.isfinite(rasterise(view, results.initial_positions(0), results.values("mass", 0)))[::-1]
    for width in (960, 720, 540, 400):
        zoom = max(0.1, width / view.shape[0])
        size = (int(view.shape[0] * zoom), max(1, int(view.shape[1] * zoom * view.pixel[1] / view.pixel[0])))
        head, bar = 40, 34
        occupied = np.asarray(Image.fromarray(start).resize(size, Image.NEAREST)).astype(int)
        outline = Image.fromarray((occupied == 1) & (sum(neighbours(occupied)) < 8))
        pictures = []
        for frame, values in zip(frames, images):
            scaled = np.clip(np.asarray(scale.norm(np.nan_to_num(values))), 0, 1)
            index = np.minimum((scaled * steps).astype(np.uint8), steps - 1)
            index = np.where(np.isfinite(values), index, white).astype(np.uint8)[::-1]
            picture = Image.new("P", (size[0], size[1] + head + bar), white)
            picture.putpalette(palette.ravel().tolist())
            picture.paste(Image.fromarray(index).resize(size, Image.NEAREST), (0, head))
            picture.paste(black, (0, head), outline)
            draw = ImageDraw.Draw(picture)
            draw.line([(0, head + size[1]), (size[0], head + size[1])], fill=black, width=2)
            draw.text((8, 8), f"t = {results.times[frame]:.4g} s", fill=black, font=load_font(18))
            draw_key(draw, scale, steps, size[0], head + size[1] + 8, black)
            pictures.append(picture)
        pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=[120] * (len(frames) - 1) + [2000],
                         loop=0, optimize=False)
        if path.stat().st_size <= most_bytes:
            return


def draw_key(draw, scale, steps, width, top, black):
    font = load_font(12)
    if scale.category:
        x = 8
        for i, material in enumerate(scale.materials):
            draw.rectangle([x, top + 3, x + 12, top + 15], fill=i)
            draw.text((x + 17, top + 1), material.replace("_", " "), fill=black, font=font)
            x += 30 + int(font.getlength(material))
        return
    left, right = 70, 70 + width // 4
    for i in range(right - left):
        draw.line([(left + i, top + 3), (left + i, top + 15)], fill=i * steps // (right - left))
    draw.text((left - 8, top + 1), f"{scale.norm.vmin:.3g}", fill=black, font=font, anchor="ra")
    draw.text((right + 8, top + 1), f"{scale.norm.vmax:.3g}   {scale.label}", fill=black, font=font)


def read_table(path):
    """Columns of a CSV file by name; None if there is no file or no row."""
    if not path.exists():
        return None
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    if len(rows) < 2:
        return None
    return {name: [row[i] for row in rows[1:] if len(row) == len(rows[0])] for i, name in enumerate(rows[0])}


UNITS = {"m_s": "m/s", "J_m": "J/m", "kg_m": "kg/m", "m": "m", "s": "s", "J": "J", "Pa": "Pa", "kg": "kg"}


def with_unit(name):
    """'front_m' as 'front [m]'. Only known units are taken for one, the longest first."""
    for word, unit in UNITS.items():
        if name.endswith("_" + word):
            return f"{name.removesuffix('_' + word).replace('_', ' ')} [{unit}]"
    return name.replace("_", " ")


def draw_history(table, path):
    """Kinetic energy; the change of all energies since the start; the time step by what limits it; forces on faces and
    obstacles, where there are any."""
    time = np.array(table["time_s"], float)
    energies = {name: np.array(table[name], float) for name in table if "energy" in name}
    kinetic = energies.get("kinetic_energy_J")
    step = np.array(table["dt_s"], float)
    forces = {name: np.array(table[name], float) for name in table if "_force_" in name}
    forces = {name: force for name, force in forces.items() if np.abs(force).max() > 0}
    panels = 4 if forces else 3
    figure, axes = plt.subplots(panels, 1, figsize=(7, 7 / 3 * panels), sharex=True, layout="constrained")
    if kinetic is not None and kinetic.max() > 0:
        axes[0].semilogy(time, np.maximum(kinetic, 1e-6 * kinetic.max()), color="#4477aa", linewidth=1.2)
        axes[0].axhline(1e-3 * kinetic.max(), color="0.6", linewidth=0.8, linestyle="--")
        axes[0].annotate("1/1000 of its peak", (time[-1], 1e-3 * kinetic.max()), ha="right", va="bottom", fontsize=7, color="0.4")
    axes[0].set_ylabel("kinetic energy [J]")
    for name, energy in energies.items():
        axes[1].plot(time, energy - energy[0], label=name.removesuffix("_energy_J"), linewidth=1.2)
    put_in = energies.pop("load_work_energy_J", 0 * time)
    balance = sum(energy - energy[0] for energy in energies.values()) - (put_in - put_in[0])
    axes[1].plot(time, balance, "k:", label="sum less load work" if put_in.any() else "sum", linewidth=1)
    axes[1].set_ylabel("change of energy [J]")
    axes[1].legend(frameon=False, fontsize=8)
    taken = step > 0
    limiter = np.array(table["limiter"])
    axes[2].plot(time[taken], step[taken], color="0.8", linewidth=0.8)
    for name in dict.fromkeys(limiter[taken]):
        chosen = taken & (limiter == name)
        axes[2].plot(time[chosen], step[chosen], ".", markersize=3, label=name)
    axes[2].set(ylabel="time step [s]", ylim=(0, None))
    axes[2].legend(frameon=False, fontsize=8, title="limited by", title_fontsize=8)
    for name, force in forces.items():
        axes[3].plot(time, force, label=name.removesuffix("_N").replace("_force_", ", ").replace("_", " "), linewidth=1.2)
    if forces:
        axes[3].set_ylabel("force of the material on it [N]")
        axes[3].legend(frameon=False, fontsize=8, ncol=2)
    axes[-1].set_xlabel("time [s]")
    figure.savefig(path, bbox_inches="tight", pad_inches=0.06)
    plt.close(figure)


def draw_observations(table, path):
    """One panel an observation."""
    time = np.array(table["time_s"], float)
    names = [name for name in table if name not in ("time_s", "step")]
    if not names:
        return
    figure, axes = plt.subplots(len(names), 1, figsize=(7, 1.9 * len(names)), sharex=True, squeeze=False,
                                layout="constrained")
    for axis, name in zip(axes[:, 0], names):
        axis.plot(time, np.array([float(value or "nan") for value in table[name]]), linewidth=1.2)
        axis.set_title(with_unit(name), fontsize=9, loc="left")
        axis.grid(linewidth=0.3)
    axes[-1, 0].set_xlabel("time [s]")
    figure.savefig(path, bbox_inches="tight", pad_inches=0.06)
    plt.close(figure)


def nearest_frames(results, times):
    """Frames nearest to the wanted times; without wanted times four evenly spaced ones."""
    if not times:
        times = np.linspace(results.times[0], results.times[-1], 4)
    return sorted({int(np.abs(results.times - time).argmin()) for time in times})


def main():
    parser = argparse.ArgumentParser(description="Pictures of a Sluice run.")
    parser.add_argument("folder", help="the folder with results.h5")
    parser.add_argument("--fields", nargs="+", help="default: plastic strain if there is any, material, displacement")
    parser.add_argument("--times", nargs="+", type=float, help="seconds; the nearest frames are drawn; default: four")
    parser.add_argument("--animation", action="store_true", help="also a GIF of the first field")
    arguments = parser.parse_args()

    results = Results(arguments.folder)
    usual = ("equivalent_plastic_strain", "material", "displacement")
    fields = arguments.fields or [name for name in usual if name in results.fields]
    results.require(fields)
    if not len(results.times):
        sys.exit(f"{results.file.filename}: has no frames")
    pictures = Path(arguments.folder) / "pictures"
    pictures.mkdir(exist_ok=True)
    view = View(results)
    frames = nearest_frames(results, arguments.times)
    for name in fields:
        draw_field(results, view, name, frames, pictures / f"{name}.png")
        if results.dimension == 3:
            draw_scatter(results, name, frames, pictures / f"{name}_3d.png")
    if arguments.animation:
        draw_animation(results, view, fields[0], evenly_spaced(results, 60), pictures / f"{fields[0]}.gif")
    for name, draw in (("history", draw_history), ("observations", draw_observations)):
        table = read_table(Path(arguments.folder) / f"{name}.csv")
        if table:
            draw(table, pictures / f"{name}.png")
    for picture in sorted(pictures.iterdir()):
        print(picture)


if __name__ == "__main__":
    main()
