"""Oracle: real processes of `palpate run` on this host, and the tissue they press."""

import os
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
import palpate

PALPATE = Path(os.environ["PALPATE_BIN"]) / "palpate"
SESSION = f"python-{os.getpid()}"


def own_domain(first=100, count=90):
    """Held by a socket of that name, as by tests/modules/own_domain.h."""
    for k in range(count):
        domain = first + (os.getpid() + k) % count
        held = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            held.bind(f"\0palpate-test-domain-{domain}")
            return domain, held
        except OSError:
            held.close()
    return first + os.getpid() % count, None


DOMAIN, HELD = own_domain()
SCENE = """palpate_scene: 1
organs:
  - name: ball
    mesh: {{file: {mesh}}}
    tissue: {{youngs_modulus_pa: 20e3}}
    springs: {{inner_ratio: 0.5}}
    fixed: [{{box: {{min_m: [-1, -1, -1], max_m: [1, 1, -0.03]}}}}]
probes:
  - name: finger
    shape: {{sphere: {{radius_m: 0.01}}}}
    device: {{topic: {{start_m: [0, 0, 0.065]}}}}
"""


def until(condition, seconds=20.0):
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError("did not come true in time")
        time.sleep(0.005)


class LiveTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        scene = Path(cls.folder.name) / "scene.yaml"
        scene.write_text(SCENE.format(mesh=palpate.scene_path("ball_squeeze").parent / "meshes" / "ball.ply"))
        cls.scene = palpate.Scene.load(scene)
        cls.log = open(Path(cls.folder.name) / "run.log", "w")
        cls.run_process = subprocess.Popen(
            [PALPATE, "run", scene, "--headless", "--no-realtime", "--session", SESSION, "--domain", str(DOMAIN)],
            stdout=cls.log,
            stderr=cls.log,
        )
        cls.live = palpate.connect(SESSION, DOMAIN)
        until(lambda: cls.live.phase == "running")

    @classmethod
    def tearDownClass(cls):
        cls.live.close()
        cls.run_process.terminate()
        cls.run_process.wait(20)
        cls.log.close()
        cls.folder.cleanup()

    def test_every_topic_is_heard(self):
        wanted = {"scene", "surface", "node_positions", "probe_state", "contacts", "contact_model", "haptic_force",
                  "module_status", "session_control"}
        for topic in wanted:
            message = self.live.latest(topic, timeout_s=10)
            self.assertEqual(message.topic, topic)
            self.assertGreater(message["sequence_number"], 0)
        self.assertEqual(self.live.latest("scene")["digest"], self.scene.digest)
        self.assertEqual(self.live.latest("surface", 0)["name"], "ball")
        self.assertIn(self.live.latest("module_status", "haptics")["state"], ("running", "degraded"))
        self.assertEqual(self.live.latest("node_positions", 0)["positions_m"].shape[1], 3)
        with self.assertRaises(TimeoutError):
            self.live.latest("haptic_force", 7, timeout_s=0.05)
        with self.assertRaises(KeyError):
            self.live.latest("nothing")

    def test_a_probe_that_python_moves_presses(self):
        self.assertTrue(self.live.wait_for_haptics())
        self.live.take("haptic_force")
        began, strongest, heard = time.monotonic(), 0.0, 0
        while strongest < 0.05 and time.monotonic() - began < 20:
            depth = min(0.03 * (time.monotonic() - began), 0.02)
            self.live.write_probe_input([0, 0, 0.065 - depth])
            time.sleep(0.002)
            forces = self.live.take("haptic_force")
            heard += forces.messages
            if forces.messages:
                strongest = max(strongest, float(forces["force_n"][:, 2].max()))
        self.assertGreater(strongest, 0.05)
        self.assertGreater(heard, 10)

    def test_what_nobody_takes_is_not_kept(self):
        # Oracle: sequence numbers. Whoever asked for the newest alone grew by every message.
        with palpate.connect(SESSION, DOMAIN) as fresh:
            first = fresh.latest("haptic_force", timeout_s=10)["sequence_number"]
            until(lambda: fresh.latest("haptic_force")["sequence_number"] > first + 20)
            newest = fresh.latest("haptic_force")["sequence_number"]
            taken = []
            until(lambda: taken.append(fresh.take("haptic_force")) or taken[-1].messages > 0)
            self.assertGreater(taken[-1]["sequence_number"].min(), newest)
            # Once somebody takes, what is read for the newest is kept for the next take.
            last = taken[-1]["sequence_number"].max()
            until(lambda: fresh.latest("haptic_force")["sequence_number"] > last)
            newest = fresh.latest("haptic_force")["sequence_number"]
            self.assertIn(newest, fresh.take("haptic_force")["sequence_number"])

    def test_commands(self):
        self.live.control("pause")
        until(lambda: self.live.phase == "paused")
        until(lambda: self.live.latest("module_status", "deformation")["state"] == "paused")
        self.live.control("start")
        until(lambda: self.live.latest("module_status", "deformation")["state"] in ("running", "degraded"))
        self.assertEqual(self.live.phase, "running")
        with self.assertRaises(ValueError):
            self.live.control("explode")

    def test_commands_of_who_leaves_at_once(self):
        # Oracle: what each module says of itself, and the session's time, which a pause holds. Some never heard the
        # command, and went on alone; some who gave one had heard an older one last.
        self.live.latest("session_control", timeout_s=10)
        for word, state in (("pause", "paused"), ("start", "running")):
            with palpate.connect(SESSION, DOMAIN) as brief:
                brief.control(word)
            for module in ("haptics", "collision", "deformation"):
                until(lambda: self.live.latest("module_status", module)["state"] in (state, state.replace("running", "degraded")))
        said = self.live.take("session_control")
        in_order = sorted(zip(said["source_time_ns"], said["command"], said["sim_time_ns"]))
        held = {word: time for _, word, time in in_order}  # the last of each
        self.assertEqual(held["pause"], held["start"])

    def test_bad_input(self):
        for bad in ([1, 2], [np.nan, 0, 0], [[0, 0, 0]]):
            with self.assertRaises(ValueError):
                self.live.write_probe_input(bad)
        with self.assertRaisesRegex(ValueError, r"position_m: each number must be between -1e\+30 and 1e\+30"):
            self.live.write_probe_input([1e31, 0, 0])
        with self.assertRaisesRegex(IndexError, "no probe -1: they count from 0"):
            self.live.write_probe_input([0, 0, 0], probe=-1)
        with self.assertRaises(ValueError):
            self.live.latest("haptic_force", timeout_s=float("nan"))
        for name, domain in (("", 0), ("a b", 0), ("x" * 65, 0), ("a", -1), ("a", 201)):
            with self.assertRaises(palpate.InputError):
                palpate.connect(name, domain)

    def test_nobody_there_and_after_close(self):
        with palpate.connect(SESSION + "-none", DOMAIN) as nobody:
            with self.assertRaises(TimeoutError):
                nobody.latest("scene", timeout_s=0.05)
            with self.assertRaises(TimeoutError):
                nobody.control("pause", timeout_s=0.05)
            self.assertEqual(nobody.take("haptic_force").messages, 0)
        nobody.close()
        for use in (lambda: nobody.latest("scene"), lambda: nobody.phase, lambda: nobody.take("scene"),
                    lambda: nobody.write_probe_input([0, 0, 0])):
            with self.assertRaises(palpate.ClosedError):
                use()
        self.assertIn("closed", repr(nobody))


if __name__ == "__main__":
    unittest.main()
