#!/usr/bin/python3
"""Makes the examples' part of docs/python.md: runs examples/python/*.py and puts in their text, code, output and picture.

Usage: scripts/python_page.py [--check]     (after a build; PYTHONPATH and PALPATE_BIN name another than build/release)
--check: changes nothing; fails where the page or a picture would differ.
"""
import ast
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ["force_depth", "sweep", "hold_force", "identify", "environment", "live_plot"]
BEGIN, END = "<!-- begin of the generated examples -->\n\n", "<!-- end -->"
# A pixel's share of full brightness: text is drawn alike, curves that lie elsewhere are not.
MOST_DIFFERENCE = 0.004


def run(name, folder):
    """What an example prints."""
    script, arguments, beside = ROOT / "examples" / "python" / f"{name}.py", [], None
    binaries = Path(os.environ.get("PALPATE_BIN", ROOT / "build" / "release" / "bin"))
    environment = {"PYTHONPATH": str(binaries.parent / "python"), "MPLBACKEND": "Agg", **os.environ}
    try:
        if name == "live_plot":
            session, domain = f"page-{os.getpid()}", str(100 + os.getpid() % 90)
            scene = ROOT / "scenes" / "stomach_probe.yaml"
            command = [binaries / "palpate", "run", scene, "--headless", "--no-realtime", "--session", session]
            beside = subprocess.Popen([*command, "--domain", domain], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            arguments = [session, domain, "4.5"]
        ran = subprocess.run(["/usr/bin/python3", script, *arguments], cwd=folder, env=environment, text=True,
                             stdout=subprocess.PIPE, timeout=120)
    finally:
        if beside is not None:
            beside.terminate()
            beside.wait(20)
    if ran.returncode != 0:
        sys.exit(f"python_page: {script} failed")
    return ran.stdout


def section(name, folder):
    """An example's part of the page: its text, its code, what it prints, what it draws."""
    source = (ROOT / "examples" / "python" / f"{name}.py").read_text()
    text = ast.get_docstring(ast.parse(source))
    code = source.split('"""\n', 1)[1]
    printed = "".join(f"    {line}\n" for line in run(name, folder).splitlines())
    title = text.splitlines()[0].removeprefix("# ")
    path = f"../examples/python/{name}.py"
    return (f"#{text}\n\n[examples/python/{name}.py]({path}):\n\n```python\n{code}```\n\n{printed}\n"
            f"![{title}](images/python_{name}.png)\n\n")


def picture_differs(name, folder):
    """Whether a picture is another than the page's. A live session is never the same twice: only whether it is there."""
    import matplotlib.pyplot as plt
    import numpy as np

    kept = ROOT / "docs" / "images" / f"python_{name}.png"
    if not kept.is_file():
        return True
    a, b = plt.imread(kept), plt.imread(Path(folder) / f"{name}.png")
    return name != "live_plot" and (a.shape != b.shape or np.abs(a - b).mean() > MOST_DIFFERENCE)


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        print(__doc__)
        sys.exit(0 if sys.argv[1] in ("-h", "--help") else 2)
    page = ROOT / "docs" / "python.md"
    before, rest = page.read_text().split(BEGIN)
    after = rest.split(END)[1]
    with tempfile.TemporaryDirectory() as folder:
        text = before + BEGIN + "".join(section(name, folder) for name in EXAMPLES) + END + after
        if sys.argv[1:] == ["--check"]:
            wrong = [f"docs/images/python_{name}.png" for name in EXAMPLES if picture_differs(name, folder)]
            if text != page.read_text():
                Path("python_page.md").write_text(text)
                wrong.append(f"docs/python.md (what it would be: {Path('python_page.md').resolve()})")
            if wrong:
                sys.exit("run scripts/python_page.py; not current: " + ", ".join(wrong))
        else:
            page.write_text(text)
            for name in EXAMPLES:
                (ROOT / "docs" / "images" / f"python_{name}.png").write_bytes((Path(folder) / f"{name}.png").read_bytes())


main()
