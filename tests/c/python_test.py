"""weft.py, as its users use it. Run by CTest, with WEFT_LIBRARY and PYTHONPATH set."""
import pathlib
import sys
import unittest

import numpy as np

import weft

SCENE = {
    "pins": 2,
    "grabs": 1,
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
