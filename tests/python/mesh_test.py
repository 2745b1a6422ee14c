"""Oracle: a tetrahedron and a cube by hand, and what `palpate mesh` promises (modules/geometry/mesh_prepare.h)."""

import tempfile
import unittest
from pathlib import Path

import numpy as np
import palpate
from palpate import mesh

NODES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


class MeshTest(unittest.TestCase):
    def test_a_tetrahedron_measures_what_it_is(self):
        report = mesh.check(NODES, TRIANGLES)
        self.assertTrue(report.holds_volume)
        self.assertEqual(report.problems, [])
        self.assertAlmostEqual(report.volume_m3, 1 / 6, 14)
        self.assertAlmostEqual(report.area_m2, 1.5 + np.sqrt(3) / 2, 14)
        self.assertEqual((report.node_count, report.triangle_count, report.genus), (4, 4, 0))

    def test_what_is_wrong_is_said_and_mended_where_it_is_safe(self):
        inside_out = TRIANGLES[:, ::-1]
        self.assertFalse(mesh.check(NODES, inside_out).holds_volume)
        self.assertTrue(mesh.check(NODES, inside_out).problems)
        twice = np.vstack([NODES, NODES[1:2]])
        surface, actions = mesh.repair(twice, np.where((inside_out == 1) & (np.arange(4) == 1)[:, None], 4, inside_out))
        self.assertTrue(actions)
        self.assertTrue(mesh.check(*surface).holds_volume)
        self.assertEqual(len(surface.nodes), 4)
        with self.assertRaisesRegex(palpate.InputError, "cannot hold a volume"):
            mesh.resample(NODES, TRIANGLES[:3], 10)

    def test_resampled_it_has_the_count_and_the_volume(self):
        ball = mesh.read(palpate.scene_path("ball_squeeze").parent / "meshes" / "ball.ply")
        coarse = mesh.resample(*ball, node_count=200)
        self.assertEqual(coarse.nodes.shape, (200, 3))
        self.assertAlmostEqual(mesh.check(*coarse).volume_m3 / mesh.check(*ball).volume_m3, 1, 12)
        self.assertTrue(mesh.check(*coarse).holds_volume)

    def test_written_and_read_it_is_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            for kind in ("ply", "obj", "off", "stl"):
                file = Path(folder) / f"t.{kind}"
                mesh.write(file, NODES, TRIANGLES)
                again = mesh.read(file)
                self.assertAlmostEqual(mesh.check(*again).volume_m3, 1 / 6, 6)
            self.assertAlmostEqual(mesh.check(*mesh.read(file, "mm")).volume_m3, 1e-9 / 6, 15)
            before = file.read_bytes()
            with self.assertRaisesRegex(palpate.InputError, "is there already; give another name, or overwrite=True"):
                mesh.write(file, 2 * np.array(NODES), TRIANGLES)
            self.assertEqual(file.read_bytes(), before)
            mesh.write(file, 2 * np.array(NODES), TRIANGLES, overwrite=True)
            self.assertNotEqual(file.read_bytes(), before)
            with self.assertRaises(palpate.InputError):
                mesh.write(Path(folder) / "t.xyz", NODES, TRIANGLES)
            with self.assertRaises(palpate.InputError):
                mesh.read(file, "parsec")
            for bad in (lambda: mesh.read(f"{file}\0.ply"), lambda: mesh.write(f"{file}\0.ply", NODES, TRIANGLES),
                        lambda: palpate.read(f"{file}\0.mcap"), lambda: palpate.Session(f"{file}\0")):
                with self.assertRaisesRegex(ValueError, "embedded null byte"):
                    bad()
            self.assertTrue(file.exists())
        with self.assertRaises(palpate.InputError):
            mesh.read("/nowhere.ply")

    def test_bad_arrays(self):
        for nodes, triangles, error in (
            (NODES[:, :2], TRIANGLES, ValueError),
            (NODES * np.nan, TRIANGLES, ValueError),
            (NODES * 1e9, TRIANGLES, ValueError),
            (NODES, TRIANGLES + 4, IndexError),
            (NODES, TRIANGLES - 1, IndexError),
            (NODES, TRIANGLES * 1.0, TypeError),
            (NODES, None, TypeError),
            ("abc", TRIANGLES, TypeError),
            (NODES * 1j, TRIANGLES, TypeError),
            (np.zeros((200_001, 3)), TRIANGLES, ValueError),
        ):
            for use in (mesh.check, mesh.repair, lambda n, t: mesh.resample(n, t, 10)):
                with self.assertRaises(error):
                    use(nodes, triangles)
        with self.assertRaises(ValueError):
            mesh.resample(NODES, TRIANGLES, 3)


if __name__ == "__main__":
    unittest.main()
