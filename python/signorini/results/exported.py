"""Results for pandas and xarray, which are read when they are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from signorini.base.packages import package
from signorini.results.quantities import FIELDS
from signorini.results.result import Result
from signorini.results.rows import Column


def dataframe(table: Mapping[str, Column], key: str) -> Any:
    """Give a table as a `pandas.DataFrame`, its rows by one of its columns."""
    return package("pandas").DataFrame({name: np.asarray(values) for name, values in table.items()}).set_index(key)


def dataset(results: Mapping[str, Result]) -> Any:
    """Give fields and reactions of results on one mesh as an `xarray.Dataset`.

    Fields are by combination and node of stresses, whose places are the coordinates x and y; reactions by combination
    and support. Every variable says what it is (``long_name``) and its unit (``units``).
    """
    first = next(iter(results.values()))
    units, nodes = first.model.units, first.stress_nodes
    variables: dict[str, Any] = {}
    for name, quantity in FIELDS.items():
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
