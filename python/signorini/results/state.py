"""The class `ResultState`: fields, supports, numbers and certificate of a plate under one combination."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np

from signorini.base.on_demand import Listed, Named, OnDemand
from signorini.base.remade import Remade
from signorini.contact.certificate import Certificate
from signorini.contact.selection import NotUnique
from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.model import Combination, Model
from signorini.results.checks import completed, utilisations
from signorini.results.extremes import FieldExtremes, Means, extremes, of_plates
from signorini.results.local_results import ProbeResult, ProfileResult, SectionResult, StripResult, profile_results
from signorini.results.punching import ColumnResult
from signorini.results.quantities import (
    FIELDS,
    LINEAR,
    MEAN_SIDES,
    OF_BARS,
    PEAKING,
    SIDES,
    Catalogue,
    derived,
    in_model,
    with_extremes,
)
from signorini.results.support_result import SupportResult, areas_below
from signorini.singularities.singularity import Singularity, at_peaks

Status = Literal["solved", "no_equilibrium"]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ResultState(Remade):
    """Results of one combination; without equilibrium only overturning checks have values, other numbers are NaN.

    Parameters
    ----------
    deflection : (n,) array
        Deflection of the nodes, positive down.
    rotation : (n, 2) array
        Slopes θx, θy.
    stress_nodes : StressNodes
        The s nodes at which moments and shears are given, and elements (ne, 8) by numbers of these nodes. The first are
        the mesh's nodes. A node on a jump of thickness or stiffness has a further stress node for each further side of
        the jump.
    moment : (s, 3) array
        mx, my, mxy at stress nodes, sagging positive. Values at superconvergent points of elements are averaged at
        nodes, but not across jumps.
    shear : (s, 2) array
        qx, qy.
    nodal_reaction : (n,) array
        Upward force on every node by supports at points, along lines and along edges. Area supports are left out, since
        they have pressures, and so are footprints, which spread their reactions.
    supports, sections, strips : tuple of SupportResult, SectionResult, StripResult
        Results of supports, forces through sections, mean moments of strips. The index is a number from 0 or a name, as
        in ``supports["columns"]``.
    method : str
        Method that found the answer: "lemke", "active_set" or "saddle"; "given" for reactions passed to
        `signorini.recover`.
    unsettled : tuple of str
        Methods that were tried before ``method`` and gave no certified answer; almost always empty.
    iterations : int
        Pivots of Lemke's algorithm, or Newton steps of the active set.
    not_unique : tuple of NotUnique
        How the answer may differ, if supports are redundant or the plate may rest in other positions. The result then
        has the reactions of least norm and, for these, the deflection of least norm. Empty if the answer is unique.
    warnings : tuple of str
        Sentences on input or results that are probably a mistake.
    singular : tuple of Singularity
        Places at which results diverge as the mesh is refined, and the names of these results.
    thickness : (s,) array
        Thickness at stress nodes; NaN where a stiffness is given instead of a solid section.
    catalogue : Catalogue
        Names, units and paths of ``numbers``.
    combination : Combination or None
        The load as factors of the model's load cases; None if the load is not a combination of load cases.
    means : Means or None
        Means of moments and shears at singular points; None if there is no equilibrium.
    plates : mapping of Result
        If there are several plates, the result of each by name; contacts with other plates are among a plate's
        supports. The fields of this result are then the concatenated fields of the plates.
    """

    name: str
    status: Status
    message: str
    method: str
    unsettled: tuple[str, ...]
    iterations: int
    not_unique: tuple[NotUnique, ...]
    mesh: Mesh
    model: Model
    certificate: Certificate
    deflection: Floats
    rotation: Floats
    stress_nodes: StressNodes
    moment: Floats
    shear: Floats
    nodal_reaction: Floats
    supports: Listed[SupportResult]
    probes: tuple[ProbeResult, ...]
    sections: Listed[SectionResult]
    strips: Listed[StripResult]
    seconds: float
    warnings: tuple[str, ...]
    singular: tuple[Singularity, ...]
    thickness: Floats
    catalogue: Catalogue
    _read: Floats
    """Values (k,) of the catalogue's numbers; extremes of fields, and checks except overturning, are still NaN."""
    combination: Combination | None
    means: Means | None = None
    moment_of_bars: Floats | None = None
    """Moments (s, 3) for the design of bars, changed at columns by `Reinforcement.face`; None if all are ``moment``."""
    punching: Listed[ColumnResult] = field(default_factory=lambda: Listed((), "punching"))
    """Results of the columns of [[punching]], found by number from 0 or by name, as ``"columns[1]"``."""
    plates: Mapping[str, Self] = field(default_factory=dict)

    @property
    def members(self) -> Mapping[str, Self]:
        """Results of the plates by name; a single plate has the name ""."""
        return self.plates or {"": self}

    @property
    def counted(self) -> str:
        """Noun for ``iterations``: "pivots" or "Newton steps"."""
        return "pivots" if self.method == "lemke" else "Newton steps"

    @property
    def heading(self) -> str:
        """Title of the result's pictures: the title of the model and the name of the result."""
        return ", ".join(part for part in (self.model.title, self.name) if part)

    @property
    def reactions(self) -> Mapping[str, float]:
        """Total reaction of every support by name, positive when the support pushes the plate up."""
        return Named({support.name: support.reaction for support in self.supports}, "support", "This result")

    @cached_property
    def fields(self) -> Mapping[str, Floats]:
        """Every field by name, see `signorini.results.quantities.FIELDS`.

        deflection, rotation_x and rotation_y are at the nodes of the mesh (n,), all others at stress nodes (s,): mx,
        my, mxy, qx, qy; principal moments m1, m2; design moments such as mx_bottom; stresses such as sx_top, von_mises
        and txz; with [reinforcement] the required areas such as as_x_bottom. The utilisation of a check of a field is
        a field "utilisation:NAME"; it is NaN if the check does not include the combination.
        """
        names = [*(one.name for one in in_model(self.model, FIELDS.values())), *utilisations(self.model)]
        return OnDemand(names, self._field, None, "field", "This result")

    def _field(self, name: str) -> Floats:
        field: Floats
        if name in LINEAR:
            values = dict(zip(LINEAR, (self.deflection, *self.rotation.T, *self.moment.T, *self.shear.T), strict=True))
            field = values[name]
        elif name not in FIELDS:
            measured, check = utilisations(self.model)[name]
            checked = self.combination is None or check.applies_to(self.combination)
            field = check.used(self.fields[measured]) if checked else np.full_like(self.fields[measured], np.nan)
        else:
            moment = self.moment if self.moment_of_bars is None or name not in OF_BARS else self.moment_of_bars
            field = derived([name], moment, self.shear, self.thickness, self.model.bars)[:, 0]
        field.flags.writeable = False
        return field

    @cached_property
    def profiles(self) -> Mapping[str, ProfileResult]:
        """Deflection, moments, shears and pressure along the model's profiles, by name.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     support=[{"edge": ["left", "right"], "fix": "simple"}],
        ...     load=[{"pressure": 5e3}],
        ...     profile=[{"name": "middle", "line": [[0, 2], [4, 2]], "stations": 5}],
        ... )
        >>> solve(model)["all"].profiles["middle"].values["mx"].round().tolist()
        [7.0, 7386.0, 9852.0, 7386.0, 7.0]
        """
        found = dict[str, ProfileResult]()
        for one in self.members.values():
            profiles, areas = one.model.profile if one.status == "solved" else (), areas_below(one.supports)
            fields = {name: one.fields[name] for name in one.fields if name in FIELDS} if profiles else {}
            results = profile_results(profiles, fields, one.stress_nodes, areas) if profiles else ()
            found |= {result.name: result for result in results}
        in_order = {one.name: found[one.name] for one in self.model.profile if one.name in found}
        return Named(in_order, "profile", "This result")

    @cached_property
    def extremes(self) -> Mapping[str, FieldExtremes]:
        """Largest and smallest deflection, moments and shears, and fields derived from these, over the nodes.

        Nodes near singular places are excluded, except for the deflection.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     support=[{"edge": ["left", "right"], "fix": "simple"}],
        ...     load=[{"pressure": 5e3}],
        ... )
        >>> mx = solve(model)["all"].extremes["mx"]
        >>> round(mx.max), mx.max_at[0], mx.max_beside
        (10336, 2.0, '')
        """
        if self.plates:
            found = of_plates([one.extremes for one in self.plates.values()])
        else:
            found = extremes(with_extremes(self.model), self.fields, self.stress_nodes, self.singular, self.means)
        return Named(found, "field", "This mapping of extremes")

    def excluding(self, number: str) -> list[Singularity]:
        """Singularities around which nodes are excluded from extremes of "moment" or "shear".

        The list is empty if all nodes would be excluded.
        """
        result = []
        for name, of in self.members.items():
            those = [one for one in of.singular if one.excludes(number)]
            result += [] if at_peaks(of.mesh, those, number).all() else [replace(one, plate=name) for one in those]
        return result

    @cached_property
    def numbers(self) -> Floats:
        """Value (k,) of every number, in the order of the ``catalogue``; NaN for missing values."""
        if self.status != "solved":
            return self._read
        result, at = self._read.copy(), self.catalogue.at
        if self.plates:
            result = self.catalogue.of_members([one.numbers for one in self.plates.values()])
            result[at("check", "value")] = self._read[at("check", "value")]
        else:
            for side in SIDES:
                result[at("field", side)] = [getattr(ends, side) for ends in self.extremes.values()]
            for side in MEAN_SIDES:
                peaking = (ends for name, ends in self.extremes.items() if name in PEAKING)
                result[at("mean", side)] = [getattr(ends, side) for ends in peaking]
        combinations = None if self.combination is None else [self.combination]
        return np.ravel(completed(self.catalogue, result[None], combinations))

    def require_fields(self) -> None:
        """Raise `InputError` if the result is that of several plates, or has no equilibrium."""
        if self.plates:
            names = ", ".join(f'plates["{name}"]' for name in self.plates)
            raise InputError(f"There are several plates. Take the result of one plate: {names}.", place="plates")
        if self.status != "solved":
            raise InputError(f"There are no fields: {self.message}", place="field")
