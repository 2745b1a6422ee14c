"""Oracle: the recording of `palpate run --in-process`, byte by byte, and invariants."""

import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import palpate

STOMACH = palpate.scene_path("stomach_probe")
BALL = palpate.scene_path("ball_squeeze")
PALPATE = Path(os.environ["PALPATE_BIN"]) / "palpate"


def end_of(scene):
    session = palpate.Session(scene)
    session.run_until(3.0)
    return session.positions().tobytes()


class SameBitsTest(unittest.TestCase):
    def test_a_recording_is_that_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            for scene, seconds in ((STOMACH, 4), (BALL, 1.5)):
                command, own = (Path(folder) / f"{Path(scene).stem}_{name}.mcap" for name in ("command", "own"))
                subprocess.run(
                    [PALPATE, "run", scene, "--in-process", "--duration", str(seconds), "--record", command],
                    check=True,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
                with palpate.Session(scene, record=own) as session:
                    session.step()
                    session.run(seconds / 3)
                    session.run_until(seconds, keep=["contacts"])
                self.assertEqual(command.read_bytes(), own.read_bytes())

    def test_a_snapshot_is_that_of_the_command_and_goes_on_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            command, own, rest = (Path(folder) / name for name in ("command", "own", "rest.mcap"))
            run = [PALPATE, "run", BALL, "--in-process"]
            quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
            save = ["--duration", "1", "--snapshot-at", "0.4", "--snapshot", command]
            subprocess.run([*run, *save], check=True, **quiet)
            with palpate.Session(BALL) as session:
                session.run_until(0.4)
                self.assertEqual(session.save_snapshot(own), 0.4)
                with self.assertRaisesRegex(palpate.InputError, "another name, or overwrite=True$"):
                    session.save_snapshot(own)
                self.assertEqual(session.save_snapshot(own, overwrite=True), 0.4)
                with self.assertRaisesRegex(palpate.InputError, "^file: an empty path names no file$"):
                    session.save_snapshot("")
                then = session.positions().tobytes()
                session.run_until(1.0)
                end = session.positions().tobytes()
            self.assertEqual(command.read_bytes(), own.read_bytes())
            for again in (False, True):
                with palpate.Session(BALL, from_snapshot=own, record=rest, overwrite=again) as session:
                    self.assertEqual(session.time, 0.4)
                    self.assertEqual(session.positions().tobytes(), then)
                    session.run_until(1.0)
                    self.assertEqual(session.positions().tobytes(), end)
            commands = Path(folder) / "commands.mcap"
            subprocess.run([*run, "--duration", "1", "--from-snapshot", own, "--record", commands], check=True, **quiet)
            self.assertEqual(commands.read_bytes(), rest.read_bytes())
            for argument in ("record", "from_snapshot"):
                with self.assertRaisesRegex(palpate.InputError, f"^{argument}: an empty path names no file$"):
                    palpate.Session(BALL, **{argument: ""})
            with self.assertRaisesRegex(palpate.InputError, "of scene 'ball_squeeze'"):
                palpate.Session(STOMACH, from_snapshot=own)

    def test_a_guided_probe_goes_on_from_a_snapshot(self):
        def press(session):
            session.run_until(0.2)
            session.set_probe((0, 0, 0.06), linear_velocity_m_per_s=(0, 0, -0.02))
            session.run_until(0.5)

        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "guided"
            ends = []
            with palpate.Session(BALL) as session:
                press(session)
                session.save_snapshot(file)
                session.run_until(0.7)
                ends.append((session.probe_position().tobytes(), session.positions().tobytes()))
            with palpate.Session(BALL, from_snapshot=file) as session:
                session.run_until(0.7)
                ends.append((session.probe_position().tobytes(), session.positions().tobytes()))
            self.assertEqual(ends[0], ends[1])
            with palpate.Session(BALL) as session:
                session.set_probe((0, 0, 0.1))
                session.save_snapshot(file, overwrite=True)
            with palpate.Session(BALL, from_snapshot=file) as session:
                session.run_until(0.1)
                self.assertEqual(list(session.probe_position()), [0, 0, 0.1])
            ran = subprocess.run(
                [PALPATE, "run", BALL, "--in-process", "--duration", "1", "--from-snapshot", file],
                stderr=subprocess.PIPE,
                text=True,
            )
            self.assertEqual(ran.returncode, 2)
            self.assertIn("whose probes python guides", ran.stderr)

    def test_threads_and_processes_give_the_same_bits(self):
        scene = palpate.Scene.load(STOMACH)
        alone = end_of(scene)
        with ThreadPoolExecutor(3) as pool:
            self.assertEqual(set(pool.map(end_of, [scene] * 4)), {alone})
        with ProcessPoolExecutor(2) as pool:
            self.assertEqual(set(pool.map(end_of, [scene] * 3)), {alone})

    def test_what_is_kept_is_what_is_recorded(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "run.mcap"
            with palpate.Session(STOMACH, record=file) as session:
                kept = session.run_until(3.0, keep=("node_positions", "haptic_force", "contacts"))
            recorded = palpate.read(file)
            for name, topic in kept.items():
                # What was said before the first cycle is recorded, too.
                start = recorded[name].messages - topic.messages
                self.assertLessEqual(start, 1)
                for field, column in topic.items():
                    other = recorded[name][field]
                    if isinstance(column, palpate.Ragged):
                        pairs = [(column[i], other[i + start]) for i in range(len(column))]
                    else:
                        pairs = [(column, other[start:])]
                    for a, b in pairs:
                        np.testing.assert_array_equal(a, b)


class SessionTest(unittest.TestCase):
    def test_time(self):
        session = palpate.Session(STOMACH)
        self.assertEqual(session.time, 0)
        session.step()
        self.assertAlmostEqual(session.time, 0.004, 12)
        session.step(5)
        self.assertAlmostEqual(session.time, 0.024, 12)
        session.run(0.0305)
        self.assertAlmostEqual(session.time, 0.055, 12)
        session.run_until(0.01)
        self.assertAlmostEqual(session.time, 0.055, 12)
        for bad in (float("nan"), float("inf"), -1.0, 1e7):
            with self.assertRaises(ValueError):
                session.run_until(bad)
        for bad in (-1, 2**62):
            with self.assertRaises((TypeError, ValueError, OverflowError)):
                session.step(bad)

    def test_a_guided_probe_presses_and_is_pushed_back(self):
        # The ball of ball_squeeze lies between plates; here one plate presses it.
        session = palpate.Session(BALL)
        session.step()
        position = session.probe_position()
        way = -position / np.linalg.norm(position)
        for i in range(100):
            session.set_probe(position + way * 2e-4 * i, session.latest("probe_state")["rotation_xyzw"])
            session.step()
        self.assertGreater(-session.latest("contact_model")["rows.force_n"].sum(axis=0) @ way, 0.01)
        self.assertGreater(session.pressure(), 1)
        gap = session.contacts()["contacts.gap_m"]
        self.assertEqual(gap.shape, (len(session.contacts()["contacts.organ"]),))
        self.assertEqual(session.contacts()["contacts.point_P_m"].shape, (len(gap), 3))

    def test_a_guided_probe_goes_on_at_its_velocity(self):
        session = palpate.Session(STOMACH)
        turn = np.pi / 2
        session.set_probe([1, 2, 3], linear_velocity_m_per_s=[0.5, 0, 0], angular_velocity_rad_per_s=[0, 0, turn])
        session.run(1.001)
        state = session.latest("probe_state")
        np.testing.assert_allclose(state["position_m"], [1.5, 2, 3], atol=1e-9)
        np.testing.assert_allclose(state["rotation_xyzw"], [0, 0, np.sin(turn / 2), np.cos(turn / 2)], atol=1e-9)
        np.testing.assert_allclose(state["linear_velocity_m_per_s"], [0.5, 0, 0])

    def test_a_volume_that_is_asked_for_comes(self):
        session = palpate.Session(STOMACH)
        rest = session.volume()
        session.set_volume_ratio(1.1)
        session.run(1.0)
        self.assertAlmostEqual(session.volume() / rest, 1.1, 4)
        self.assertGreater(session.pressure(), 10)
        for bad in (0.1, 6, float("nan")):
            with self.assertRaises(ValueError):
                session.set_volume_ratio(bad)

    def test_settling(self):
        session = palpate.Session(STOMACH)
        session.set_probe([1, 1, 1])
        session.set_volume_ratio(1.1)
        self.assertFalse(session.settle(within_s=0.1))
        self.assertTrue(session.settle())
        before = session.positions()
        session.run(0.5)
        self.assertLess(np.abs(session.positions() - before).max(), 0.5 * 1e-4)

    def test_views_need_no_copy_and_stay_as_they_are(self):
        session = palpate.Session(STOMACH)
        session.run(0.1)
        views = [session.positions(), session.force(), session.triangles(), session.contacts()["contacts.gap_m"]]
        copies = [view.copy() for view in views]
        for view in views:
            self.assertIsNotNone(view.base)
            self.assertFalse(view.flags.owndata)
            self.assertFalse(view.flags.writeable)
            with self.assertRaises(ValueError):
                view[...] = 0
        again = session.positions()
        self.assertTrue(np.shares_memory(again, views[0]))
        session.run(3)
        self.assertFalse(np.array_equal(session.positions(), copies[0]))
        session.close()
        del session, again
        for view, copy in zip(views, copies):
            np.testing.assert_array_equal(view, copy)

    def test_matrices_lie_row_by_row(self):
        session = palpate.Session(STOMACH)
        session.run(6)
        stiffness = session.latest("contact_model")["stiffness_n_per_m"]
        kept = session.run(0.01, keep="contact_model")["contact_model"]["stiffness_n_per_m"]
        self.assertEqual((stiffness.shape, kept.shape[1:]), ((3, 3), (3, 3)))
        self.assertGreater(np.abs(stiffness).max(), 1)
        np.testing.assert_array_equal(session.latest("contact_model")["stiffness_n_per_m"], kept[-1])

    def test_names_and_indices(self):
        session = palpate.Session(palpate.scene_path("liver_on_stomach"))
        session.step()
        for name in session.scene.organs:
            self.assertGreater(session.volume(name), 0)
        np.testing.assert_array_equal(session.positions(1), session.positions(session.scene.organs[1]))
        for bad, error, said in (
            (7, IndexError, "no 7; there are 0 to 1: stomach, liver"),
            (-1, IndexError, "no -1; there are 0 to 1"),
            (2**70, IndexError, "there are 0 to 1"),
            ("none", KeyError, "no 'none'"),
            (None, TypeError, "must be a whole number, not None"),
            (1.0, TypeError, "must be a whole number, not 1.0"),
        ):
            with self.assertRaisesRegex(error, said):
                session.positions(bad)
        for bad, error in ((-1, ValueError), (2**70, ValueError), (1.5, TypeError)):
            with self.assertRaisesRegex(error, "^(periods must be|that many periods)"):
                session.step(bad)
        with self.assertRaises(KeyError):
            session.latest("nothing")
        with self.assertRaises(KeyError):
            session.run(0.1, keep=["nothing"])

    def test_poses_that_are_none(self):
        session = palpate.Session(STOMACH)
        for bad in ([1, 2], [1, 2, 3, 4], [[1, 2, 3]], [1, 2, float("nan")], [1, 2, 1e9], [], 3):
            with self.assertRaises(ValueError):
                session.set_probe(bad)
        for bad in ("abc", None, [None] * 3, ["1", "2", "3"], [1j, 0, 0], object()):
            with self.assertRaises(TypeError):
                session.set_probe(bad)
        with self.assertRaises(ValueError):
            session.set_probe([0, 0, 1], [0, 0, 0, 0])

    def test_after_close(self):
        session = palpate.Session(STOMACH)
        session.close()
        session.close()
        self.assertTrue(session.closed)
        for use in (session.step, session.positions, session.guards, session.settle, session.force):
            with self.assertRaises(palpate.ClosedError):
                use()
        with self.assertRaises(palpate.ClosedError):
            session.set_probe([0, 0, 0])
        with self.assertRaises(palpate.ClosedError):
            session.run_until(1.0)
        self.assertIn("closed", repr(session))

    def test_one_thread_at_a_time(self):
        session = palpate.Session(STOMACH)
        thread = threading.Thread(target=session.run_until, args=(3.0,))
        thread.start()
        busy = 0
        while thread.is_alive():
            try:
                session.positions()
                time.sleep(0)
            except palpate.BusyError:
                busy += 1
            self.assertGreaterEqual(session.time, 0)
        thread.join()
        self.assertGreater(busy, 0)
        session.positions()

    def test_ctrl_c_stops_a_long_step_and_the_session_goes_on(self):
        session = palpate.Session(STOMACH)
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            session.run_until(1e5)
        timer.join()
        reached = session.time
        self.assertLess(reached, 1e4)
        session.step()
        self.assertGreater(session.time, reached)

    def test_an_interpreter_that_ends_while_threads_step_and_wait_ends_well(self):
        script = """
import threading, time, palpate
session, live = palpate.Session(palpate.scene_path("stomach_probe")), palpate.connect("python-nobody", 77)
for call in (lambda: session.run_until(1e5), lambda: live.latest("scene", timeout_s=1e5)):
    threading.Thread(target=call, daemon=True).start()
time.sleep(0.2)
threading.excepthook = lambda told: print(told.exc_type.__name__ + "\\n", end="")
"""
        ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        self.assertLessEqual(set(ended.stdout.split()), {"ClosedError"})

    def test_repr_and_pickle(self):
        session = palpate.Session(STOMACH)
        self.assertEqual(repr(session), "<palpate.Session of 'stomach_probe' at 0.000 s>")
        session.step()
        self.assertIn("force_n: [0., 0., 0.]", repr(session.latest("haptic_force")))
        with self.assertRaises(TypeError):
            pickle.dumps(session)

    def test_a_recording_is_replaced_only_when_asked(self):
        with tempfile.TemporaryDirectory() as folder:
            file, other = Path(folder) / "run.mcap", Path(folder) / "notes.txt"
            with palpate.Session(BALL, record=file) as session:
                session.run(0.02)
            before = file.read_bytes()
            with self.assertRaisesRegex(FileExistsError, "run.mcap: is there already; .* or overwrite=True$"):
                palpate.Session(BALL, record=file)
            self.assertEqual(file.read_bytes(), before)
            with palpate.Session(BALL, record=file, overwrite=True) as session:
                session.run(0.04)
            self.assertGreater(len(file.read_bytes()), len(before))
            other.write_text("notes")
            with self.assertRaises(palpate.InputError):
                palpate.Session(BALL, record=other, overwrite=True)
            self.assertEqual(other.read_text(), "notes")

    def test_a_recording_that_cannot_be_written(self):
        with self.assertRaises(RuntimeError):
            palpate.Session(STOMACH, record="/nowhere/run.mcap")

    def test_a_recording_that_cannot_be_ended(self):
        # It is told of once, and the session is closed all the same.
        with tempfile.TemporaryDirectory() as folder:
            session = palpate.Session(BALL, record=Path(folder) / "run.mcap")
            session.run(0.02)
            for file in Path(folder).iterdir():
                file.unlink()
            with self.assertRaisesRegex(RuntimeError, "was removed or replaced while it was recorded"):
                session.close()
            self.assertTrue(session.closed)
            session.close()
            with self.assertRaises(palpate.ClosedError):
                session.step()


if __name__ == "__main__":
    unittest.main()
