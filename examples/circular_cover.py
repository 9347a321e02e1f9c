"""Second example of Bergmann, Carnicer and Sanzi: a circular cover, bolted down and then lifted by inner pressure.

A quarter of a plate of radius 390 mm and thickness 110 mm on two elastic rings at 298.75 and 340 mm that only push. Six
states: the bolts tightened to 60, 90, 120, 150 and 180 Kgm, then 180 Kgm and an inner pressure of 11.5 N/mm2.
Two figures, like the paper's Figures 7 and 8: the deflection along a radius and that of the centre, state by state.

The paper leaves out, and this example takes:
- steel, E = 206 000 N/mm2, nu = 0.3;
- 20 bolts M36 on a circle of radius 365 mm, midway between the outer ring and the rim;
- the bolt load as a torque T in kilogram-force metres, turned into the force T / (0.2 d) with d = 36 mm, the usual
  estimate for bolts not lubricated; the bolts are long, so pressure does not change their force;
- 20 000 N/mm per mm for each ring, the order of a metal-jacketed gasket;
- the pressure up to the outer ring, which is the seal; the inner one only carries, and may open.

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
KGM = 9806.65
"""A kilogram-force metre in N mm."""
TORQUES = (60, 90, 120, 150, 180)


def cover() -> signorini.Model:
    """State the quarter of the cover that lies between the x and y axes."""
    angles = (np.arange(BOLTS // 4) + 0.5) * 2 * np.pi / BOLTS
    bolts = BOLT_CIRCLE * np.column_stack([np.cos(angles), np.sin(angles)])
    ring = {"resists": "down", "stiffness": RING_STIFFNESS}
    states = [{"name": f"{torque} Kgm", "factors": {"bolts": torque}} for torque in TORQUES]
    last = {"name": f"{TORQUES[-1]} Kgm and pressure", "factors": {"bolts": TORQUES[-1], "pressure": 1.0}}
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
            {"case": "bolts", "force": KGM / (NUT_FACTOR * BOLT_DIAMETER), "at": bolts.tolist()},
            {"case": "pressure", "pressure": -PRESSURE, "area": {"circle": {"radius": OUTER_RING}}},
        ],
        combination=[*states, last],
    )


def along_radius(result: signorini.Result, radii: np.ndarray) -> np.ndarray:
    """Deflections along the radius at 45 degrees, which passes under a bolt."""
    points = radii[:, None] * np.array([np.cos(np.pi / 4), np.sin(np.pi / 4)])
    return np.array([probe.deflection for probe in result.probe(points)])


def main() -> None:
    directory = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    results = signorini.solve(cover())
    radii = np.linspace(0.0, RADIUS, 79)

    print("state                  centre [mm]   rim [mm]   inner ring [kN]   outer ring [kN]   (whole cover)")
    axes = None
    for name, result in results.items():
        deflection = along_radius(result, radii)
        axes = line(
            radii, deflection, ax=axes, label=name, xlabel="radius [mm]", ylabel="deflection [mm], positive down"
        )
        inner, outer = (
            f"{4e-3 * found.reaction:.0f}" if found.closed_count else "open" for found in result.supports[1:]
        )
        print(f"{name:<22}{deflection[0]:12.4f}{deflection[-1]:11.4f}{inner:>18}{outer:>18}")
    axes.set_title("Deflection along a radius")
    save(axes.figure, directory / "cover_radius.png")

    centre = [along_radius(result, radii[:1])[0] for result in results.values()]
    axes = line(range(1, 7), centre, xlabel="state", ylabel="deflection [mm], positive down")
    axes.lines[0].set_marker("o")
    axes.set_xticks(range(1, 7), [name.replace(" and ", "\nand ") for name in results])
    axes.set_title("Deflection of the centre")
    save(axes.figure, directory / "cover_centre.png")
    print(f"Drawn in {directory / 'cover_radius.png'} and {directory / 'cover_centre.png'}")


if __name__ == "__main__":
    main()
