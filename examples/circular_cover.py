"""Second example of Bergmann, Carnicer and Sanzi: a circular cover, bolted down and then lifted by inner pressure.

A quarter of a plate of radius 390 mm and thickness 110 mm on two elastic rings at 298.75 and 340 mm that only push. Six
states: the bolts tightened to 60, 90, 120, 150 and 180 Kgm, then 180 Kgm and an inner pressure of 11.5 N/mm2.
Two figures, like the paper's Figures 7 and 8: the deflection along a radius and that of the centre, state by state.

docs/theory.md, section 3, lists the data that the paper leaves out and the values taken here.

Deflections are positive down, towards the vessel.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import signorini
from signorini.plot import line, save

RADIUS, THICKNESS = 390.0, 110.0
INNER_RING, OUTER_RING, RING_STIFFNESS = 298.75, 340.0, 2e4
PRESSURE = 11.5
BOLTS, BOLT_CIRCLE, BOLT_DIAMETER, NUT_FACTOR = 20, 365.0, 36.0, 0.2
BOLT_RADIUS = BOLT_DIAMETER / 2
KGM = 9806.65
"""A kilogram-force metre in N mm."""
TORQUES = (60, 90, 120, 150, 180)


def cover() -> signorini.Model:
    """State the quarter of the cover that lies between the x and y axes."""
    angles = (np.arange(BOLTS // 4) + 0.5) * 2 * np.pi / BOLTS
    bolts = BOLT_CIRCLE * np.column_stack([np.cos(angles), np.sin(angles)])
    ring = {"resists": "down", "stiffness": RING_STIFFNESS}
    states = [{"name": f"{torque} Kgm", "group": "bolts", "factors": {"bolts": torque}} for torque in TORQUES]
    last = {"name": f"{TORQUES[-1]} Kgm and pressure", "group": "pressure"}
    last["factors"] = {"bolts": TORQUES[-1], "pressure": 1.0}
    return signorini.Model(
        title="Circular cover",
        units={"length": "mm", "force": "N"},
        material={"E": 206e3, "nu": 0.3},
        plate={"shape": "disc", "radius": RADIUS, "sector": 90, "thickness": THICKNESS},
        mesh={"size": 30.0},
        support=[
            {"name": "symmetry", "edge": ["start", "end"], "fix": "symmetry"},
            {"name": "inner ring", "circle": {"radius": INNER_RING}, **ring},
            {"name": "outer ring", "circle": {"radius": OUTER_RING}, **ring},
        ],
        load=[
            {"case": "bolts", "force": KGM / (NUT_FACTOR * BOLT_DIAMETER), "at": bolts.tolist(), "radius": BOLT_RADIUS},
            {"case": "pressure", "pressure": -PRESSURE, "area": {"circle": {"radius": OUTER_RING}}},
        ],
        combination=[*states, last],
        # Under a bolt.
        profile=[{"name": "radius", "line": [[0, 0], [RADIUS / np.sqrt(2), RADIUS / np.sqrt(2)]], "stations": 79}],
    )


def main() -> None:
    directory = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    results = signorini.solve(cover())
    print("state                  centre [mm]   rim [mm]   inner ring [kN]   outer ring [kN]   (whole cover)")
    axes = None
    for name, result in results.items():
        radius = result.profiles["radius"]
        deflection = radius.values["deflection"]
        axes = line(radius.distance, deflection, ax=axes, label=name)
        inner, outer = (
            f"{4e-3 * found.reaction:.0f}" if found.closed_count else "open" for found in result.supports[1:]
        )
        print(f"{name:<22}{deflection[0]:12.4f}{deflection[-1]:11.4f}{inner:>18}{outer:>18}")
    axes.set(title="Deflection along a radius", xlabel="radius [mm]", ylabel="deflection [mm], positive down")
    save(axes.figure, directory / "cover_radius.png")

    centre = [result.profiles["radius"].values["deflection"][0] for result in results.values()]
    axes = line(range(1, 7), centre, xlabel="state", ylabel="deflection [mm], positive down")
    axes.lines[0].set_marker("o")
    axes.set_xticks(range(1, 7), [name.replace(" and ", "\nand ") for name in results])
    axes.set_title("Deflection of the centre")
    save(axes.figure, directory / "cover_centre.png")
    print(f"Drawn in {directory / 'cover_radius.png'} and {directory / 'cover_centre.png'}")


if __name__ == "__main__":
    main()
