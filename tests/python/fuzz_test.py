"""Oracle: the interpreter lives, every refusal is an exception of one of Python's or this package's kinds, and memory does not grow.

fuzz_test.py [CALLS [SEED]]: that many random calls with hostile arguments (default 5,000), and what they did.
"""

import collections
import faulthandler
import gc
import inspect
import os
import random
import resource
import shutil
import sys
import tempfile
import threading
import unittest
import warnings
from pathlib import Path

import numpy as np
import palpate

CALLS = int(sys.argv.pop(1)) if len(sys.argv) > 1 and sys.argv[1].isdigit() else 5_000
SEED = int(sys.argv.pop(1)) if len(sys.argv) > 1 and sys.argv[1].isdigit() else 1
ALLOWED = (palpate.Error, TypeError, ValueError, IndexError, KeyError, AttributeError, OverflowError, RuntimeError,
           OSError, MemoryError)
# Not among random calls: what may rightly take long or leave a file behind.
LEFT_OUT = {"save", "settle", "write"}


class Odd:
    """An object whose every conversion goes wrong."""

    def __index__(self):
        raise ValueError("no index")

    def __float__(self):
        raise ZeroDivisionError

    def __array__(self, dtype=None):
        raise ValueError("no array")

    def __fspath__(self):
        return 3


class Fuzz:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.outcomes = collections.Counter()
        # Away from the tree: what is recorded or written lies here.
        self.folder = tempfile.TemporaryDirectory()
        shutil.copytree(palpate.scene_path("stomach_probe").parent, Path(self.folder.name) / "scenes")
        self.stomach = Path(self.folder.name) / "scenes" / "stomach_probe.yaml"
        os.chdir(self.folder.name)
        self.ball = palpate.mesh.read(self.stomach.parent / "meshes" / "ball.ply")
        self.file = Path(self.folder.name) / "run.mcap"
        with palpate.Session(self.stomach, record=self.file) as session:
            session.run(0.02)
        try:
            palpate.read(self.file)["haptic_force"].to_pandas()  # what is imported late is no leak
        except ImportError:
            pass
        loop = []
        loop.append(loop)
        self.paths = ["organs[0].tissue.youngs_modulus_pa", "probes[0].device", "organs", "rates.deformation_hz",
                      "organs[0].model", "duration_s", "gravity_m_per_s2", "organs[0].mesh.file", "probes[1]", "name"]
        nan, inf = float("nan"), float("inf")
        self.values = [
            None, True, False, 0, 1, -1, 2, 3, 7, 2**31, 2**63, -(2**63), 2**64, 10**400, 0.0, -0.0, 0.3, 1e-320, 1e308,
            -1e308, nan, inf, -inf, "", "a", "0", "\0", "\ud800", "x" * 10_000, "organs[0]", "haptic_force", "surface",
            "contacts", "node_positions", "scene", "module_status", b"bytes", [], [1], [1, 2, 3], [0, 0, 0, 1], [nan] * 3,
            [1e300] * 3, ["a"] * 3, loop, (), (1, 2, 3), {}, {"a": 1}, {1: 2}, {"a": nan}, set(), {"haptic_force"}, 1j,
            object(), Odd(), Odd, len, np.float32(1), np.nan, np.int8(-1), np.uint64(2**64 - 1), np.array(3.0),
            np.zeros((0, 3)), np.zeros((3, 0)), np.zeros(3), np.zeros((4, 3)), np.zeros((2, 3, 3)), np.full(3, nan),
            np.zeros(3, dtype=object), np.array(["a", "b", "c"]), np.zeros(3, dtype="M8[s]"),
            np.zeros(3, dtype=[("a", "f8")]), np.arange(24.0)[::-8], np.arange(12).reshape(4, 3),
            np.full((4, 3), 2**63, np.uint64), np.zeros(3, ">f8"), self.ball.nodes, self.ball.triangles,
            self.ball.triangles[::-1], self.ball.nodes * 1e200, np.asfortranarray(self.ball.nodes), *self.paths,
            str(self.stomach), self.stomach, str(self.file), self.file, "/", "/nowhere", "m", "mm", 4, 10, 0.01, 0.02,
            "palpate_scene: 1\norgans: []", "[" * 3000, "&a [*a]", self.stomach.read_text(),
        ]
        self.objects = []

    def value(self):
        return self.random.choice(self.values)

    def arguments(self, function):
        """Mostly as many as it takes."""
        names = ["probe", "organ", "key", "keep", "record", "unit", "node_count", "topics", "timeout_s", "file"]
        keywords = {self.random.choice(names): self.value()} if self.random.random() < 0.2 else {}
        try:
            most = len(inspect.signature(function).parameters)
        except (TypeError, ValueError):
            most = 2
        return [self.value() for _ in range(self.random.randint(max(0, most - 3), most))], keywords

    def fresh(self):
        """An object to torment: most often made well."""
        kind = self.random.randrange(6)
        if kind == 0:
            return palpate.Session(self.stomach)
        if kind == 1:
            return palpate.read(self.file)["haptic_force"]
        if kind == 2:
            session = palpate.Session(self.stomach)
            return session.latest(self.random.choice(["contacts", "surface", "node_positions", "contact_model"]))
        if kind == 3:
            return palpate.read(self.file)["contacts"]["contacts.gap_m"]
        return palpate.Scene.load(self.stomach)

    def target(self):
        """Something to call, by name."""
        if self.random.random() < 0.4:
            module = self.random.choice([palpate, palpate.mesh])
            own = {n: f for n, f in vars(module).items() if getattr(f, "__module__", "").startswith("palpate")}
            names = [n for n in own if not n.startswith("_")]
            name = self.random.choice(names)
            return name, getattr(module, name)
        if len(self.objects) < 5 or self.random.random() < 0.01:
            self.objects.append(self.fresh())
            self.objects = self.objects[-5:]
        held = self.random.choice(self.objects)
        special = ["__getitem__", "__setitem__", "__delitem__", "__repr__", "__eq__", "__array__", "__len__", "__iter__"]
        names = [n for n in dir(type(held)) if not n.startswith("_")] + [n for n in special if hasattr(held, n)]
        name = self.random.choice(names)
        return f"{type(held).__name__}.{name}", getattr(held, name)

    def call(self):
        try:
            name, function = self.target()
            if name.split(".")[-1] in LEFT_OUT or name in ("Live", "connect") or not callable(function):
                return
            arguments, keywords = self.arguments(function)
            if name in ("Session.run", "Session.run_until"):  # not for 1e6 s
                if any(isinstance(a, (int, float, np.number)) and 1 < a <= 1e6 for a in [*arguments, *keywords.values()]):
                    return
            if name == "Session.step" and any(isinstance(a, (int, np.integer)) and a > 10 for a in arguments):
                return
            if name == "Session" and any(str(a) in (str(self.stomach), str(self.file)) for a in
                                         [*arguments[1:], keywords.get("record")]):
                return  # these would be overwritten by the recording, rightly
            result = function(*arguments, **keywords)
            repr(result)
            self.outcomes["fine"] += 1
            if isinstance(result, (palpate.Session, palpate.Scene)) and self.random.random() < 0.1:
                self.objects[self.random.randrange(len(self.objects))] = result
        except ALLOWED as error:
            str(error), repr(error)
            self.outcomes[type(error).__name__] += 1
        except ZeroDivisionError:
            self.outcomes["an argument's own"] += 1


def resident():
    """Of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


class FuzzTest(unittest.TestCase):
    def test_hostile_calls_end_in_a_value_or_an_exception_and_leave_nothing_behind(self):
        faulthandler.enable()
        warnings.simplefilter("ignore")  # NumPy's, of comparisons with odd arrays
        fuzz = Fuzz(SEED)
        self.addCleanup(fuzz.folder.cleanup)
        self.addCleanup(os.chdir, "/")
        for _ in range(CALLS // 2):
            fuzz.call()
        gc.collect()
        before, objects = resident(), len(gc.get_objects())
        for _ in range(CALLS // 2):
            fuzz.call()
        gc.collect()
        grown, more = resident() - before, len(gc.get_objects()) - objects
        print(f"{CALLS} calls: {dict(fuzz.outcomes.most_common())}; second half: {grown / 1e6:.1f} MB, {more} objects more")
        self.assertGreater(fuzz.outcomes["fine"], CALLS // 100)
        # A leak of 100 bytes a call would be seen in a long run; a session (3 MB) at once in any. What five objects
        # held more or less hold, and malloc keeps, is less.
        self.assertLess(grown, 20e6 + 100 * CALLS / 2)
        self.assertLess(more, 3000)

    def test_sessions_and_messages_are_given_back(self):
        def use():
            session = palpate.Session(palpate.scene_path("stomach_probe"))
            session.run(0.02, keep=["node_positions", "contacts"])
            kept = [session.latest("node_positions"), session.latest("surface"), session.latest("contacts")]
            session.close()
            return kept

        for _ in range(10):
            use()
        before = resident()
        for _ in range(100):
            use()
        # 100 sessions would be 300 MB; their newest messages 40.
        self.assertLess(resident() - before, 15e6)

    def test_threads_that_do_as_they_like_with_one_session(self):
        session, outcomes = palpate.Session(palpate.scene_path("stomach_probe")), collections.Counter()

        def torment(seed):
            pick = random.Random(seed)
            uses = [session.step, session.positions, session.force, session.guards, lambda: session.run(0.05),
                    lambda: session.set_probe([0, 0, 1]), lambda: repr(session), lambda: session.contacts()]
            for _ in range(300):
                try:
                    pick.choice(uses)()
                    outcomes["fine"] += 1
                except (palpate.BusyError, palpate.ClosedError) as error:
                    outcomes[type(error).__name__] += 1
            if seed == 0:
                while not session.closed:
                    try:
                        session.close()
                    except palpate.BusyError:
                        pass

        threads = [threading.Thread(target=torment, args=(seed,)) for seed in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertGreater(outcomes["fine"], 100)


if __name__ == "__main__":
    unittest.main()
