"""Tables of `palpate chart`: what its CSV files hold, and results.md for docs/accuracy.md."""

import math
import re
import shutil

import csv_rows

# Shown in the docs.
PICTURES = ["accuracy_cost.png", "accuracy_cost_mesh.png", "accuracy_curves.png", "accuracy_iterations.png",
            "accuracy_mesh.png", "accuracy_profile.png", "accuracy_volume.png", "touch.png"]
TITLES = {
    "ball": "solid ball between plates, 10–40 %",
    "block": "bonded block, 5–18 %",
    "truthcube": "Truth Cube beads",
    "indent": "5 mm sphere into a block, 2–8 mm",
    "vibration": "free ball, ellipsoidal mode",
    "squeeze": "ball squeezed by 20 % in 60 ms and held",
    "beam": "cantilever under its weight",
    "liver": "liver, 8 mm sphere, 3–9 mm",
    "stomach": "stomach as a solid, 8 mm sphere, 3–9 mm",
    "liver_4mm": "liver, 4 mm sphere, 3–9 mm",
    "stomach_4mm": "stomach as a solid, 4 mm sphere, 3–9 mm",
    "slide": "8 mm sphere slides on a block, 4 mm deep",
}
# Pressed at many places: half of all forces are within the error shown.
PLACES = ("liver", "stomach", "liver_4mm", "stomach_4mm")
# What stands for the error of a case: column, factor for the axis, words.
ERRORS = {
    "ball": ("force_error", 100, "error of force [%]"),
    "block": ("force_error", 100, "error of force [%]"),
    "truthcube": ("field_error_m", 1e3, "error of bead positions [mm]"),
    "indent": ("force_error", 100, "error of force [%]"),
    "vibration": ("force_error", 100, "error of frequency [%]"),
    "squeeze": ("force_error", 100, "error of force over time [%]"),
    "beam": ("shape_error_m", 1e3, "error of the tip's sag [mm]"),
    "liver": ("force_median", 100, "median error of force [%]"),
    "stomach": ("force_median", 100, "median error of force [%]"),
    "liver_4mm": ("force_median", 100, "median error of force [%]"),
    "stomach_4mm": ("force_median", 100, "median error of force [%]"),
    "slide": ("force_error", 100, "error of force [%]"),
}
SMALL = {"": "as shipped", "near": "small where it is touched", "follow": "following"}


# Columns of the tables that only some cases fill: name, column, factor.
FURTHER = [("shape [mm]", "shape_error_m", 1e3), ("field [mm]", "field_error_m", 1e3),
           ("contact radius [%]", "contact_radius_error", 100), ("profile [mm]", "profile_error_m", 1e3),
           ("volume", "volume_error", 1)]


def rows_of(file):
    return csv_rows.rows_of(file, words=("case", "model", "small", "solver", "setting", "verdict"))


def known(*values):
    return all(math.isfinite(value) and value > 0 for value in values)


def nodes_of(point):
    return point["surface_nodes"] + point["inner_nodes"]


def cell(value, scale=1, digits=3):
    return f"{scale * value:.{digits}g}" if math.isfinite(value) else "–"


def with_bar(point, column):
    """In per cent, to the digits that the bar leaves."""
    value, bar = 100 * point[column], 100 * point[f"{column}_bar"]
    if not math.isfinite(value):
        return "–"
    digits = 0 if value >= 30 else 1
    return f"{value:.{digits}f} ± {bar:.{digits}f}"


def effectivity(samples):
    """The middle half of what models say over what is wrong."""
    ratios = sorted(s["estimated_error"] / abs(s["force"] / s["reference_force"] - 1) for s in samples
                    if math.isfinite(s["estimated_error"]) and math.isfinite(s["reference_force"]))
    if not ratios or ratios[-1] <= 0:
        return "none"
    return f"{ratios[len(ratios) // 4]:.2g} to {ratios[3 * len(ratios) // 4]:.2g}"


def table_of_places(case, points, samples):
    """An organ pressed at many places, or a slide."""
    here = [p for p in points if p["case"] == case]
    lines = [f"**{case}**: {TITLES[case]}", ""]
    if case in PLACES:
        head = ["model", "tetrahedra", "level", "nodes", "cost [s/s]", "median [%]", "95 of 100 [%]", "at most [%]",
                "surface beside [mm]", "volume", "estimate over error, middle half", "in trouble"]
    else:
        head = ["model", "tetrahedra", "level", "nodes", "cost [s/s]", "error of force [%]", "ripple [%]", "volume"]
    lines += ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for p in here:
        key = (p["case"], p["model"], p["level"], p["small"])
        mine = [s for s in samples if (s["case"], s["model"], s["level"], s["small"]) == key]
        row = [p["model"], SMALL[p["small"]], f"{p['level']:g}", f"{nodes_of(p):g}", cell(p["cost_s_per_s"], 1, 2)]
        if case in PLACES:
            row += [with_bar(p, column) for column in ("force_median", "force_95", "force_most")]
            row += [cell(p["profile_error_m"], 1e3, 2), cell(p["volume_error"], 1, 2), effectivity(mine),
                    f"{p['troubled_places']:g}"]
        else:
            row += ["diverged"] * 2 if p["diverged"] else [with_bar(p, "force_error"), cell(p["ripple"], 100, 2)]
            row += [cell(p["volume_error"], 1, 2)]
        lines.append("| " + " | ".join(row) + " |")
    return lines + [""]


def write_tables(folder, points, samples, cases):
    """results.md: the tables of docs/accuracy.md, at the smallest step rate of each model."""
    lines = []
    for case in cases:
        if case in PLACES or case == "slide":
            lines += table_of_places(case, points, samples)
            continue
        here = [p for p in points if p["case"] == case and not p["iterations"]]
        slowest = {(p["model"], p["level"]): min(q["rate_hz"] for q in here if (q["model"], q["level"]) ==
                                                 (p["model"], p["level"])) for p in here}
        here = [p for p in here if p["rate_hz"] == slowest[(p["model"], p["level"])]]
        loads = sorted({s["load"] for s in samples if s["case"] == case})
        column, scale = ("field_error_m", 1e3) if case == "truthcube" else ("force", None)
        if case in ("beam", "vibration", "squeeze"):
            column = None
        per_load = [f"at {load * (1e3 if case == 'indent' else 100):g}{' mm' if case == 'indent' else ' %'}"
                    for load in loads]
        head = ["model", "level", "nodes", "cost [s/s]", ERRORS[case][2]]
        more = [(name, key, factor) for name, key, factor in FURTHER if any(math.isfinite(p[key]) for p in here)]
        head += [name for name, _, _ in more]
        head += per_load if column else []
        what = "error of force [%] at each load" if column == "force" else "RMS [mm] at each load" if column else ""
        lines += [f"**{case}**: {TITLES[case]}" + (f"; last columns: {what}" if what else ""), "",
                  "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
        for p in here:
            error, error_scale, _ = ERRORS[case]
            row = [p["model"], f"{p['level']:g}", f"{nodes_of(p):g}", cell(p["cost_s_per_s"]),
                   "diverged" if p["diverged"] else cell(p[error], error_scale)]
            row += [cell(p[key], factor, 2) for _, key, factor in more]
            mine = {s["load"]: s for s in samples if not s["iterations"]
                    and (s["case"], s["model"], s["level"], s["rate_hz"]) ==
                    (case, p["model"], p["level"], p["rate_hz"])}
            for load in loads if column else []:
                s = mine.get(load)
                if s is None:
                    row.append("–")
                elif column == "force":
                    ratio = s["force"] / s["reference_force"] - 1 if s["reference_force"] else math.nan
                    row.append(f"{100 * ratio:+.1f}" if math.isfinite(ratio) else "–")
                else:
                    row.append(cell(s["field_error_m"], 1e3))
            lines.append("| " + " | ".join(row) + " |")
        lines.append("")
    (folder / "results.md").write_text("\n".join(lines), encoding="utf-8")


def put_into_docs(folder, docs):
    """The tables of the cases measured; the page keeps those of others. Pictures of all cases only with all of them."""
    new = by_case((folder / "results.md").read_text(encoding="utf-8"))
    for name in PICTURES:
        if name == "touch.png" or set(new) >= set(TITLES) - {"truthcube"}:
            shutil.copyfile(folder / name, docs / "images" / name)
    page = docs / "accuracy.md"
    text = page.read_text(encoding="utf-8")
    begin, end = "<!-- begin of results.md -->\n", "<!-- end of results.md -->"
    head, rest = text.split(begin)
    old, tail = rest.split(end)
    tables = by_case(old) | new
    results = "\n\n".join(tables[case] for case in TITLES if case in tables)
    page.write_text(head + begin + "\n" + results + "\n\n" + end + tail, encoding="utf-8")


def by_case(text):
    """The tables of results.md."""
    tables = {}
    for part in re.split(r"^(?=\*\*)", text, flags=re.MULTILINE):
        name = re.match(r"\*\*(\w+)\*\*", part)
        if name:
            tables[name.group(1)] = part.strip()
    return tables
