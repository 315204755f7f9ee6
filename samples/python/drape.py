"""How far down a sheet drapes, over its fabric: what a notebook would do with Weft.

    python3 samples/python/drape.py        # on whatever Vulkan device there is; takes seconds
"""
import numpy as np

import weft

# A round table's worth of cloth falls onto a ball.
SCENE = {
    "cloths": [{"grid": {"size": [1, 1], "cells": [32, 32]}, "transform": {"translate": [0, 0.35, 0]}}],
    "colliders": [{"shape": "sphere", "radius": 0.3, "centre": [0, 0, 0]}],
}


def drape(device: weft.Device, fabric: str, seconds: float = 1.5) -> tuple[float, float]:
    """Of the rim: its mean height (m), and how much its corners hang below the middles of its sides (m)."""
    scene = {**SCENE, "cloths": [{**SCENE["cloths"][0], "fabric": fabric}]}
    with weft.Simulation(device, scene) as cloth:
        rest = cloth.positions()
        for _ in range(round(60 * seconds)):
            cloth.advance(1 / 60)
        at = cloth.positions()
    rim = np.abs(rest[:, [0, 2]]).max(axis=1) > 0.499
    corner = rim & (np.abs(rest[:, [0, 2]]).min(axis=1) > 0.499)
    middle = rim & (np.abs(rest[:, [0, 2]]).min(axis=1) < 0.001)
    return float(at[rim, 1].mean()), float(at[middle, 1].mean() - at[corner, 1].mean())


def main() -> None:
    with weft.Device() as device:
        print(f"on {device.name}")
        for fabric in ("silk", "cotton", "denim", "leather"):
            height, corners = drape(device, fabric)
            print(f"{fabric:8} rim at {height:6.3f} m, corners {corners:6.3f} m below the sides")


if __name__ == "__main__":
    main()
