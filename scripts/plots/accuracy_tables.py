"""Tables of `palpate chart`: what its CSV files hold, and results.md for docs/accuracy.md."""

import math
import shutil

import csv_rows

# Shown in the docs.
PICTURES = ["accuracy_cost.png", "accuracy_cost_mesh.png", "accuracy_curves.png", "accuracy_iterations.png",
            "accuracy_mesh.png", "accuracy_profile.png", "accuracy_volume.png"]
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
}
# What stands for the error of a case: column, factor for the axis, words.
ERRORS = {
    "ball": ("force_error", 100, "error of force [%]"),
    "block": ("force_error", 100, "error of force [%]"),
    "truthcube": ("field_error_m", 1e3, "error of bead positions [mm]"),
    "indent": ("force_error", 100, "error of force [%]"),
    "vibration": ("force_error", 100, "error of frequency [%]"),
    "squeeze": ("force_error", 100, "error of force over time [%]"),
    "beam": ("shape_error_m", 1e3, "error of the tip's sag [mm]"),
    "liver": ("force_error", 100, "error of force [%]"),
    "stomach": ("force_error", 100, "error of force [%]"),
}


# Columns of the tables that only some cases fill: name, column, factor.
FURTHER = [("shape [mm]", "shape_error_m", 1e3), ("field [mm]", "field_error_m", 1e3),
           ("contact radius [%]", "contact_radius_error", 100), ("profile [mm]", "profile_error_m", 1e3),
           ("volume", "volume_error", 1)]


def rows_of(file):
    return csv_rows.rows_of(file, words=("case", "model", "solver", "setting", "verdict"))


def known(*values):
    return all(math.isfinite(value) and value > 0 for value in values)


def nodes_of(point):
    return point["surface_nodes"] + point["inner_nodes"]


def cell(value, scale=1, digits=3):
    return f"{scale * value:.{digits}g}" if math.isfinite(value) else "–"


def write_tables(folder, points, samples, cases):
    """results.md: the tables of docs/accuracy.md, at the smallest step rate of each model."""
    lines = []
    for case in cases:
        here = [p for p in points if p["case"] == case and not p["iterations"]]
        slowest = {(p["model"], p["level"]): min(q["rate_hz"] for q in here if (q["model"], q["level"]) ==
                                                 (p["model"], p["level"])) for p in here}
        here = [p for p in here if p["rate_hz"] == slowest[(p["model"], p["level"])]]
        loads = sorted({s["load"] for s in samples if s["case"] == case})
        column, scale = ("field_error_m", 1e3) if case == "truthcube" else ("force", None)
        if case in ("beam", "vibration", "squeeze"):
            column = None
        per_load = [f"at {load * (1e3 if case in ('indent', 'liver', 'stomach') else 100):g}"
                    f"{' mm' if case in ('indent', 'liver', 'stomach') else ' %'}" for load in loads]
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
    for name in PICTURES:
        shutil.copyfile(folder / name, docs / "images" / name)
    page = docs / "accuracy.md"
    text = page.read_text(encoding="utf-8")
    begin, end = "<!-- begin of results.md -->\n", "<!-- end of results.md -->"
    head, rest = text.split(begin)
    tail = rest.split(end)[1]
    results = (folder / "results.md").read_text(encoding="utf-8")
    page.write_text(head + begin + "\n" + results + "\n" + end + tail, encoding="utf-8")
