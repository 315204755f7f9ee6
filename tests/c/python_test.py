"""Weft for Python, as its users use it. Run by CTest, with WEFT_LIBRARY and PYTHONPATH set."""
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import weft

SCENE = {
    "pins": 2,
    "grabs": 1,
    "contacts": False,
    "cloths": [{"grid": {"size": [1, 1], "cells": [8, 8]}, "anchors": [{"vertices": [0, 8]}]}],
    "colliders": [{"shape": "sphere", "radius": 0.1, "centre": [0, -5, 0]}],
}
ASSETS = pathlib.Path(sys.argv.pop(1))


class Weft(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.device = weft.Device()

    @classmethod
    def tearDownClass(cls) -> None:
        cls.device.close()

    def setUp(self) -> None:
        self.cloth = weft.Simulation(self.device, SCENE)
        self.addCleanup(self.cloth.close)

    def test_simulates(self) -> None:
        before = self.cloth.positions()
        self.assertEqual(before.shape, (81, 3))
        self.assertEqual(before.dtype, np.float32)
        done = self.cloth.advance(1 / 60)
        self.assertEqual((done.substeps, done.clamped, done.pairs_lost), (10, 0, 0))
        for _ in range(29):
            self.cloth.advance(1 / 60)
        self.assertAlmostEqual(self.cloth.time, 0.5, places=6)
        self.assertLess(self.cloth.positions()[80, 1], -0.2)
        np.testing.assert_allclose(np.linalg.norm(self.cloth.normals(), axis=1), 1, atol=1e-4)
        np.testing.assert_array_equal(self.cloth.positions()[[0, 8]], before[[0, 8]])
        self.assertEqual(self.cloth.triangles().shape, (128, 3))
        self.assertEqual(self.cloth.triangles().max(), 80)
        self.assertEqual(self.cloth.uvs().shape, (81, 2))
        self.assertEqual(self.cloth.cloths(), [slice(0, 81)])
        self.assertEqual(self.cloth.counts().non_finite, 0)

    def test_reads_into_an_array_that_is_there(self) -> None:
        self.cloth.advance(1 / 60)
        out = np.zeros((81, 3), np.float32)
        self.assertIs(self.cloth.positions(out), out)
        np.testing.assert_array_equal(out, self.cloth.positions())
        for wrong in (np.zeros((80, 3), np.float32), np.zeros((81, 3)), np.zeros((81, 6), np.float32)[:, ::2]):
            with self.assertRaises(weft.Error):
                self.cloth.positions(wrong)

    def test_continues_bitwise_from_a_state(self) -> None:
        self.cloth.advance(0.1)
        state = self.cloth.save()
        self.cloth.advance(0.1)
        with weft.Simulation(self.device, SCENE) as again:
            again.restore(state)
            again.advance(0.1)
            self.assertEqual(again.hash(), self.cloth.hash())

    def test_moves_what_a_host_moves(self) -> None:
        self.cloth.move_anchors([[-0.5, 1, -0.5], [0.5, 1, -0.5]])
        self.cloth.pin([80])
        self.cloth.advance(1 / 60)
        self.cloth.move_pins([80], [[0, 2, 0]])
        self.cloth.move_collider(0, weft.Pose((1, 2, 3)))
        self.cloth.set_gravity((0, 1, 0))
        self.cloth.advance(1 / 60)
        at = self.cloth.positions()
        np.testing.assert_array_equal(at[80], [0, 2, 0])
        np.testing.assert_allclose(at[[0, 8], 1], 1)
        self.assertEqual(self.cloth.collider(0).centre, (1, 2, 3))
        self.cloth.release([80])
        self.assertIsNone(self.cloth.grab(at[40] + [0, 1, 0], [0, 1, 0]))
        held = self.cloth.grab(at[40] + [0, 1, 0], [0, -1, 0], force=5)
        self.cloth.move_grab(held.grab, held.point + np.float32([0, 0.2, 0]))
        self.cloth.let_go(held.grab)

    def test_meshes_are_made_in_code_and_named_by_scenes(self) -> None:
        x, z = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
        at = np.stack([x.ravel(), 0 * x.ravel(), z.ravel()], axis=1)
        first = np.array([5 * j + i for j in range(4) for i in range(4)])
        triangles = np.concatenate([np.stack([first, first + 6, first + 1], 1), np.stack([first, first + 5, first + 6], 1)])
        scene = {"cloths": [{"mesh": "sheet", "start": {"imperfection": 0}, "maps": {"mass": "_HEAVY"}, "anchors": [{"vertices": [0, 4]}]}]}
        with weft.Mesh(at, triangles, at[:, [0, 2]], {"_HEAVY": np.arange(1, 26)}) as sheet:
            cloth = weft.Simulation(self.device, scene, meshes={"sheet": sheet}, timings=True)
        with cloth:
            np.testing.assert_array_equal(cloth.positions(), at.astype(np.float32))
            np.testing.assert_array_equal(cloth.uvs(), at[:, [0, 2]].astype(np.float32))
            self.assertEqual(cloth.triangles().shape, (32, 3))
            masses = cloth.particles()[cloth.vertex_particles(), 3]
            self.assertEqual(list(np.flatnonzero(masses == 0)), [0, 4])
            np.testing.assert_array_equal(cloth.anchor_vertices(), [0, 4])
            self.assertGreater(masses[6], 1.5 * masses[12])   # the 13th has nearly twice the 7th's mass a vertex
            cloth.advance(0.1)
            self.assertGreater(cloth.gpu_milliseconds, 0)
            self.assertLess(cloth.positions()[24, 1], 0)
            moved = cloth.particles()
            moved[:, 1] += 1
            cloth.write_particles(moved)
            cloth.write_velocities(np.zeros_like(cloth.velocities()))
            np.testing.assert_allclose(cloth.particles()[:, 1], moved[:, 1])
            self.assertEqual(cloth.scene()["cloths"][0]["mesh"], "sheet")
            self.assertEqual(cloth.parts(), [weft.Part("cloth", 0, slice(0, 25), slice(0, 32), [], [])])
            self.assertIsInstance(cloth.notes(), list)
            np.testing.assert_array_equal(cloth.origin, [0, 0, 0])

    def test_drives_characters_colliders_and_air(self) -> None:
        ball = {"shape": "sphere", "radius": 0.2, "centre": [0, -0.25, 0], "resizes": True}
        scene = {**SCENE, "reactions": True, "air": {"fields": [{"shape": "sphere"}]}, "colliders": [ball, ball],
                 "cloths": [{**SCENE["cloths"][0], "skin": {}, "inertia": {}, "motion_constraints": {"max_distance": 0.5}}]}
        with weft.Simulation(self.device, scene) as cloth:
            self.assertEqual(cloth.parts()[0].joints, [""])
            raised = np.eye(4)
            raised[1, 3] = 0.25
            cloth.set_pose(0, [raised])
            cloth.set_morphs(0, [])
            cloth.limit_motion(0, 0.5)
            cloth.move_frame(0, weft.Frame((0, 0, 0)))
            cloth.move_air_field(0, (0, 0, 0), (1, 0, 0))
            cloth.move_colliders([weft.Pose((0, -0.2, 0)), weft.Pose((3, 0, 0))])
            cloth.resize_collider(0, weft.Size(radius=0.3))
            cloth.reserve_contacts(100)
            cloth.advance(1 / 60)
            np.testing.assert_allclose(cloth.positions()[[0, 8], 1], 0.25)   # anchors go with the skin
            self.assertEqual(cloth.collider_size(0).radius, 0.3)
            self.assertEqual(cloth.collider(1).centre, (3, 0, 0))
            reactions = cloth.take_reactions()
            self.assertLess(reactions.impulse[0, 1], 0)   # it is pushed down
            np.testing.assert_array_equal(reactions.impulse[1], 0)
            np.testing.assert_array_equal(cloth.take_reactions().impulse, 0)
            held = cloth.grab_near((0.5, 0, 0.5), stiffness=500)
            cloth.move_grab(held.grab, held.point + np.float32([0, 0.5, 0]))
            cloth.place_collider(0, weft.Pose((0, -9, 0)))
            cloth.advance(1 / 60)
            self.assertGreater(cloth.take_pulls().impulse[0, 1] ** 2, 0)
            here = cloth.positions()
            cloth.teleport(0, weft.Frame((0, 0, 0)), weft.Frame((0, 2, 0)))
            np.testing.assert_allclose(cloth.positions(), here + np.float32([0, 2, 0]), atol=1e-5)
            self.assertEqual(cloth.quality().unconverged, 0)
            cloth.check_fits(cloth.save())

    def test_writes_what_other_programs_read(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "cloth.pc2")
            with self.cloth.cache(file, frames=2) as cache:
                cache.add()
                self.cloth.advance(1 / 60)
                cache.add()
                cache.finish()
            frames = np.frombuffer(file.read_bytes()[32:], "<f4").reshape(2, 81, 3)
            np.testing.assert_array_equal(frames[1], self.cloth.positions())
            left = self.cloth.cache(pathlib.Path(folder, "left.pc2"), frames=2)
            self.cloth.close()
            with self.assertRaises(weft.Error):
                left.add()
            left.close()
            self.assertEqual(os.listdir(folder), ["cloth.pc2"])

    def test_cuts(self) -> None:
        scene = {"cloths": [{"grid": {"cells": [8, 8]}, "tear": {"strain": 100}}]}
        with weft.Simulation(self.device, scene) as cloth:
            whole = cloth.triangles()
            count = cloth.cut((0.03, 1, 0), (0, -1, -1), (0, -1, 1))
            self.assertGreaterEqual(count, 9)
            self.assertEqual(cloth.splits, count)
            self.assertEqual(cloth.triangles().shape, whole.shape)
            self.assertTrue((cloth.triangles() != whole).any())
            self.assertEqual(cloth.quality().splits_refused, 0)
            with tempfile.TemporaryDirectory() as folder, self.assertRaises(weft.Error) as caught:
                cloth.cache(os.path.join(folder, "cut.obj"), 2)
            self.assertIn("tears", str(caught.exception))
        with self.assertRaises(weft.Error) as caught:
            self.cloth.cut((0, 1, 0), (0, -1, -1), (0, -1, 1))
        self.assertIn("tear", str(caught.exception))

    def test_refuses_with_sentences(self) -> None:
        for wrong, said in (
            (lambda: weft.Device("a GPU that nobody has"), "a GPU that nobody has"),
            (lambda: weft.Simulation(self.device, {"cloths": []}), "cloths"),
            (lambda: weft.Simulation(self.device, "no scene"), "JSON"),
            (lambda: weft.Simulation.load(self.device, "none.json"), "none.json"),
            (lambda: self.cloth.advance(float("nan")), "nan"),
            (lambda: self.cloth.move_anchors([[0, 0]]), "3 numbers"),
            (lambda: self.cloth.move_anchors([[0, 0, float("inf")]]), "not finite"),
            (lambda: self.cloth.pin([-1]), "whole numbers"),
            (lambda: self.cloth.pin([0.5]), "whole numbers"),
            (lambda: self.cloth.pin([81]), "81"),
            (lambda: self.cloth.move_pins([0, 8], [[0, 0, 0]]), "1 targets for 2"),
            (lambda: self.cloth.restore(b"nothing"), "snapshot"),
            (lambda: self.cloth.set_wind((1, 0, 0)), "air"),
            (lambda: self.cloth.set_gravity([[0, 1, 0], [0, 1, 0]]), "3 numbers"),
            (lambda: self.cloth.set_pose(0, np.eye(4)), "not of matrices"),
            (lambda: self.cloth.set_pose(0, [np.eye(4)]), "skin"),
            (lambda: self.cloth.inflate(0, 2), "gas"),
            (lambda: self.cloth.take_reactions(), "reactions"),
            (lambda: self.cloth.write_particles(np.zeros((3, 4))), "there are 81"),
            (lambda: self.cloth.cache("cloth.txt", 1), "pc2"),
            (lambda: self.cloth.check_fits(b"nothing"), "snapshot"),
            (lambda: weft.Mesh([[0, 0, 0]], [[0, 0, 1]]), "past the last"),
            (lambda: weft.Mesh([[0, 0, 0]], [0, 0, 0]), "three vertices"),
            (lambda: weft.Mesh(np.eye(3), [[0, 1, 2]], attributes={"_A": [1, 2]}), "2 vertices"),
            (lambda: weft.Simulation(self.device, SCENE, meshes={"flag": weft.Mesh(np.eye(3), [[0, 1, 2]])}), "flag"),
        ):
            with self.assertRaises(weft.Error) as caught:
                wrong()
            self.assertIn(said, str(caught.exception))
        closed = weft.Simulation(self.device, SCENE)
        closed.close()
        closed.close()
        with self.assertRaises(weft.Error):
            closed.advance(1)

    def test_loads_a_scene_of_a_mesh(self) -> None:
        with weft.Simulation.load(self.device, ASSETS / "scenes" / "curtain.json") as curtain:
            curtain.advance(1 / 60)
            self.assertGreater(curtain.vertices, 7000)

    def test_the_example_runs_and_stiffer_fabrics_hang_less_far(self) -> None:
        import drape
        silk, leather = (drape.drape(self.device, fabric, 0.7) for fabric in ("silk", "leather"))
        self.assertLess(silk[0], leather[0])


if __name__ == "__main__":
    unittest.main(verbosity=2)
