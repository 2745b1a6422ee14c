"""Oracle: the reader of scene files (its own messages, lines counted by hand), and definitions."""

import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
import palpate

STOMACH = palpate.scene_path("stomach_probe")
E = "organs[0].tissue.youngs_modulus_pa"


class SceneTest(unittest.TestCase):
    def setUp(self):
        self.scene = palpate.Scene.load(STOMACH)

    def test_values_have_their_types(self):
        scene = self.scene
        self.assertIsInstance(scene[E], float)
        self.assertIs(type(scene["deformation_threads"]), int)
        self.assertIs(scene["contacts.self"], False)
        self.assertEqual(scene["organs[0].integrator"], "automatic")
        self.assertIsNone(scene["probes[0].device.scripted.moves[1].to_m"])
        self.assertEqual(len(scene["gravity_m_per_s2"]), 3)
        self.assertEqual(scene["organs"][0]["name"], scene.organs[0])

    def test_a_change_is_what_the_file_would_be_with_it(self):
        self.scene[E] = 8e3
        text = STOMACH.read_text()
        line = next(line for line in text.splitlines() if "youngs_modulus_pa" in line)
        number = line.split("youngs_modulus_pa:")[1].split(",")[0].split("}")[0].split("#")[0].strip()
        other = palpate.Scene.parse(text.replace(f"youngs_modulus_pa: {number}", "youngs_modulus_pa: 8e3"), STOMACH)
        self.assertEqual(self.scene, other)
        self.assertEqual(self.scene.digest, other.digest)

    def test_numpy_numbers_tuples_and_paths_are_taken(self):
        self.scene[E] = np.float32(8192)
        self.scene["gravity_m_per_s2"] = np.array([0, 0, -9.81])
        self.scene["probes[0].device"] = {"topic": {"start_m": (0, 0, 1)}}
        self.scene["organs[0].mesh.file"] = Path(self.scene["organs[0].mesh.file"])
        self.assertEqual(self.scene[E], 8192)
        self.assertEqual(self.scene["gravity_m_per_s2"], [0, 0, -9.81])
        self.assertEqual(self.scene["probes[0].device"]["topic"]["start_m"], [0, 0, 1])

    def test_refusals_carry_file_line_and_key_and_change_nothing(self):
        line = 1 + next(i for i, t in enumerate(STOMACH.read_text().splitlines()) if "tissue" in t)
        before = self.scene.text()
        for value in (-3, float("nan"), float("inf"), 10**400, "8e3", True, [1], {}, {"a": 1}):
            with self.assertRaises(palpate.SceneError) as caught:
                self.scene[E] = value
            self.assertEqual((caught.exception.file, caught.exception.line, caught.exception.key), (str(STOMACH), line, E))
            self.assertTrue(str(caught.exception).startswith(f"{STOMACH}:{line}: key '{E}' = "), caught.exception)
        self.assertEqual(self.scene.text(), before)

    def test_what_no_scene_holds_is_a_type_error(self):
        loop = []
        loop.append(loop)
        for value in (object(), 1j, b"8e3", {1: 2}, {3}, loop, lambda: 0):
            with self.assertRaises(TypeError):
                self.scene[E] = value
        with self.assertRaises(TypeError):
            self.scene[3]
        with self.assertRaises(TypeError):
            self.scene.update({3: 4})

    def test_changes_that_go_only_together(self):
        with self.assertRaises(palpate.SceneError):
            self.scene["organs[0].iterations"] = 5
        self.scene.update({"organs[0].iterations": 5, "organs[0].model": "xpbd_springs"})
        self.assertEqual(self.scene["organs[0].iterations"], 5)
        with self.assertRaises(palpate.SceneError):
            self.scene.update({"name": "other", E: -1})
        self.assertEqual(self.scene.name, "stomach_probe")

    def test_del_and_none_give_the_default_back(self):
        self.scene["rates.haptics_hz"] = 2000
        del self.scene["rates.haptics_hz"]
        self.assertEqual(self.scene["rates.haptics_hz"], 1000)
        self.scene["rates"] = {"haptics_hz": 2000}
        self.scene["rates.haptics_hz"] = None
        self.assertEqual(self.scene["rates.haptics_hz"], 1000)

    def test_saved_pickled_copied_it_is_the_same(self):
        self.scene[E] = 8e3
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "saved.yaml"
            self.scene.save(file)
            self.assertEqual(palpate.Scene.load(file), self.scene)
            self.assertEqual(palpate.Scene.load(file).digest, self.scene.digest)
            self.scene.save(file)  # a scene replaces a scene
            precious = Path(folder) / "precious.txt"
            precious.write_text("mine")
            with self.assertRaises(FileExistsError):
                self.scene.save(precious)
            self.assertEqual(precious.read_text(), "mine")
            self.assertEqual(sorted(Path(folder).iterdir()), [precious, file])
        self.assertEqual(pickle.loads(pickle.dumps(self.scene)), self.scene)
        copy = self.scene.copy()
        copy[E] = 9e3
        self.assertEqual(self.scene[E], 8e3)

    def test_files_that_are_none(self):
        for file in ("/nowhere/none.yaml", "/", "/etc/hostname"):
            with self.assertRaises(palpate.SceneError):
                palpate.Scene.load(file)
        with self.assertRaisesRegex(palpate.InputError, "there are: .*stomach_probe"):
            palpate.scene_path("none")

    def test_repr(self):
        self.assertEqual(repr(self.scene), "<palpate.Scene 'stomach_probe': organs stomach; probes probe>")


if __name__ == "__main__":
    unittest.main()
