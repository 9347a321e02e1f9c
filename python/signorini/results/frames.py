"""Results and tables for pandas and xarray."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from signorini.base.packages import package
from signorini.results.checks import quantity_of
from signorini.results.quantities import EXTREMES, Number
from signorini.results.rows import Column
from signorini.results.state import ResultState


def numbers_frame(result: ResultState) -> Any:
    """Return the numbers of a result as a `pandas.DataFrame` with a row for each number: value, unit, x and y."""
    units, places = result.model.units, [place_of_number(result, one) for one in result.catalogue]
    nowhere = np.nan, np.nan
    columns = {
        "value": result.numbers,
        "unit": [one.quantity.unit(units) for one in result.catalogue],
        **dict(zip("xy", np.array([at or nowhere for at in places]).reshape(-1, 2).T, strict=True)),
    }
    names = package("pandas").Index([one.name for one in result.catalogue], name="name")
    return package("pandas").DataFrame(columns, names)


def place_of_number(result: ResultState, one: Number) -> tuple[float, float] | None:
    """Position (x, y) of a number, such as that of its probe or extreme; None for a number without position."""
    own = result.plates[str(one.path[1])] if one.path[0] == "plates" else result
    places: Mapping[str, Callable[[], tuple[float, float] | None]] = {
        "point": lambda: tuple(own.supports[one.owner].positions[one.part].tolist()),
        "probe": lambda: own.probes[one.owner].at,
        "punching": lambda: own.punching[one.owner].at,
        "station": lambda: own.strips[one.owner].stations[one.part].at,
        "strip": lambda: getattr(own.strips[one.owner], "sagging" if one.what == "max_moment" else "hogging").at,
        **dict.fromkeys(EXTREMES, lambda: getattr(own.extremes[one.quantity.name], f"{one.what}_at")),
        "support": lambda: own.supports[one.owner].max_pressure_at if one.what == "max_pressure" else None,
    }
    return places[one.home]() if result.status == "solved" and one.home in places else None


def dataframe(table: Mapping[str, Column], key: str) -> Any:
    """Convert a table to a `pandas.DataFrame` indexed by the column ``key``."""
    return package("pandas").DataFrame({name: np.asarray(values) for name, values in table.items()}).set_index(key)


def dataset(results: Mapping[str, ResultState]) -> Any:
    """Return fields and reactions of results on one mesh as an `xarray.Dataset`.

    Fields have the dimensions combination and stress node, with coordinates x and y; reactions have combination and
    support. Every variable has its description (``long_name``) and unit (``units``).
    """
    first = next(iter(results.values()))
    units, nodes = first.model.units, first.stress_nodes
    variables: dict[str, Any] = {}
    for name in first.fields:
        quantity, _ = quantity_of(first.model, name)
        values = np.stack([nodes.spread(one.fields[name]) for one in results.values()])
        variables[name] = (
            ("combination", "node"),
            values,
            {"long_name": quantity.words, "units": quantity.unit(units)},
        )
    places = {axis: ("node", at, {"units": units.length}) for axis, at in zip("xy", nodes.points.T, strict=True)}
    names = [support.name for support in first.model.support]
    nothing = [np.nan] * len(names)
    reactions = [[support.reaction for support in one.supports] or nothing for one in results.values()]
    what = {"long_name": "reaction, positive up", "units": units.force}
    variables["reaction"] = (("combination", "support"), np.array(reactions).reshape(len(results), -1), what)
    coordinates = {"combination": list(results), "support": names, **places}
    return package("xarray").Dataset(variables, coordinates, {"title": first.model.title})
