"""A slab on six columns that only push, and a machine on its corner, in ten lines."""

import signorini

model = signorini.Model(
    material={"E": 30e9, "nu": 0.2},
    plate={"shape": "rectangle", "size": [10, 6], "thickness": 0.16},
    support=[{"name": "columns", "at": [[1, 1], [5, 1], [9, 1], [1, 5], [5, 5], [9, 5]], "resists": "down"}],
    load=[{"pressure": 4e3}, {"force": 400e3, "at": [0.5, 0.5]}],
)
result = signorini.solve(model)["all"]
columns = result.supports[0]
for (x, y), reaction, gap in zip(columns.positions, columns.reactions, columns.gaps, strict=True):
    print(f"column at [{x:g}, {y:g}]: {reaction / 1e3:6.1f} kN, open by {1e3 * gap:.3f} mm")
print(f"deflection of the middle: {1e3 * result.probe((5, 3))[0].deflection:.3f} mm; certificate {result.certificate}")
result.plot("deflection").figure.savefig("slab.png")
