"""Oracle: `palpate inspect --csv` of the same recording, and definitions."""

import csv
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import palpate

PALPATE = Path(os.environ["PALPATE_BIN"]) / "palpate"


class RecordingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.file = Path(cls.folder.name) / "run.mcap"
        with palpate.Session(palpate.scene_path("ball_squeeze"), record=cls.file) as session:
            session.run_until(3.0)
        cls.recording = palpate.read(cls.file)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def table(self, name):
        folder = Path(self.folder.name) / "csv"
        if not folder.exists():
            subprocess.run([PALPATE, "inspect", self.file, "--csv", folder], check=True, stdout=subprocess.DEVNULL)
        with open(folder / f"{name}.csv") as file:
            rows = list(csv.DictReader(file))
        return {key: [row[key] for row in rows] for key in rows[0]}

    def test_columns_are_those_of_the_command(self):
        parts = {"x": 0, "y": 1, "z": 2, "w": 3}
        compared = 0
        for topic, key in (("haptic_force", 0), ("probe_state", 1), ("contacts", 0), ("contact_model", 1),
                           ("node_positions", 0)):
            own = self.recording[topic].of(key)
            table = self.table(f"{topic}_{key}")
            self.assertEqual(own.messages, len(table["sim_time_s"]))
            np.testing.assert_allclose(own.time, np.array(table["sim_time_s"], float), atol=1e-12)
            for field, column in own.items():
                if isinstance(column, palpate.Ragged):
                    continue
                for name, values in table.items():
                    if name == field:
                        mine = column
                    elif name.startswith(field.rsplit("_", 1)[0]) and np.ndim(column) == 2 and any(
                        name == palpate_name(field, part) for part in parts
                    ):
                        mine = column[:, parts[next(p for p in parts if name == palpate_name(field, p))]]
                    else:
                        continue
                    if isinstance(mine, np.ndarray) and mine.dtype.kind == "f":
                        np.testing.assert_array_equal(mine, np.array(values, float))
                        compared += 1
        self.assertGreater(compared, 20)
        counts = self.recording["contacts"].of(0)["face_nodes"].counts
        np.testing.assert_array_equal(counts, np.array(self.table("contacts_0")["face_node_count"], int))
        self.assertGreater(counts.max(), 0)

    def test_lists(self):
        positions = self.recording["node_positions"]["positions_m"]
        stacked = np.asarray(positions)
        self.assertEqual(stacked.shape, (len(positions), len(positions[0]), 3))
        self.assertEqual(stacked.dtype, np.float32)
        np.testing.assert_array_equal(stacked[-1], positions[-1])
        with self.assertRaises(IndexError):
            positions[len(positions)]
        with self.assertRaisesRegex(ValueError, "one by one"):
            np.asarray(self.recording["contacts"]["face_nodes"])
        contacts = self.recording["contacts"]
        both = zip(contacts["faces.gap_m"], contacts["contacts.gap_m"])
        deepest = [min(a.min(initial=np.inf), b.min(initial=np.inf)) for a, b in both]
        np.testing.assert_array_equal(deepest, contacts["deepest_gap_m"])
        nodes = [int(count.sum()) for count in contacts["faces.node_count"]]
        np.testing.assert_array_equal(nodes, contacts["face_nodes"].counts)

    def test_texts(self):
        self.assertEqual(self.recording["surface"]["name"], palpate.Scene.load(palpate.scene_path("ball_squeeze")).organs)
        self.assertEqual(self.recording.scene["name"], "ball_squeeze")
        families = self.recording["surface"]["spring_families"]
        self.assertIn(families[0][0], ("structural", "bending", "inner"))
        self.assertEqual(len(families[0]), len(self.recording["surface"]["spring_nodes"][0]))

    def test_chosen_topics_keys_and_what_is_not_there(self):
        only = palpate.read(self.file, ["haptic_force"])
        self.assertEqual(list(only), ["haptic_force"])
        self.assertEqual(list(palpate.read(self.file, "haptic_force")), ["haptic_force"])
        both = self.recording["haptic_force"]
        self.assertEqual(both.of(0).messages + both.of(1).messages, both.messages)
        self.assertEqual(both.of(9).messages, 0)
        with self.assertRaisesRegex(KeyError, "there are"):
            self.recording["probe_input"]
        with self.assertRaises(KeyError):
            self.recording["scene"].of(0)

    def test_pandas(self):
        try:
            import pandas  # noqa: F401
        except ImportError:
            self.skipTest("no pandas")
        table = self.recording["haptic_force"].of(0).to_pandas()
        self.assertEqual(table.index.name, "time_s")
        np.testing.assert_array_equal(table["force_n[2]"], self.recording["haptic_force"].of(0)["force_n"][:, 2])
        contacts = self.recording["contacts"].to_pandas()
        self.assertEqual(contacts["face_nodes.count"].max(), self.recording["contacts"]["face_nodes"].counts.max())

    def test_torn_and_no_recordings(self):
        torn = Path(self.folder.name) / "torn.mcap"
        whole = self.file.read_bytes()
        torn.write_bytes(whole[: len(whole) // 2])
        recording = palpate.read(torn)
        self.assertNotEqual(recording.warning, "")
        self.assertIn("torn", repr(recording) + recording.warning)
        self.assertEqual(self.recording.warning, "")
        for bad in ("/nowhere.mcap", "/", "/etc/hostname"):
            with self.assertRaises(palpate.InputError):
                palpate.read(bad)
        with self.assertRaisesRegex(palpate.InputError, "'nope'; there are .*haptic_force"):
            palpate.read(self.file, ["haptic_force", "nope"])

    def test_repr(self):
        self.assertIn("haptic_force: 6000 messages", repr(self.recording))


def palpate_name(field, part):
    """As modules/messages/csv.h: the part before the unit."""
    for unit in ("_rad_per_s", "_m_per_s", "_n_m", "_m", "_n"):
        if field.endswith(unit):
            return f"{field[: -len(unit)]}_{part}{unit}"
    return f"{field}_{part}"


if __name__ == "__main__":
    unittest.main()
