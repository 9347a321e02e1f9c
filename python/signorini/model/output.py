"""What is written of each combination."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from signorini.model.base import Complaint, Table, Text
from signorini.model.words import as_list, describe

FEW = 12
"""Combinations up to which each is written by itself."""

_WORDS = ("governing", "all", "none")

EnvelopeField = Literal[
    "deflection",
    "mx",
    "my",
    "mxy",
    "qx",
    "qy",
    "m1",
    "m2",
    "mx_bottom",
    "my_bottom",
    "mx_top",
    "my_top",
    "sx_top",
    "sy_top",
    "txy_top",
    "sx_bottom",
    "sy_bottom",
    "txy_bottom",
    "von_mises",
    "txz",
    "tyz",
]
ENVELOPED: tuple[EnvelopeField, ...] = ("deflection", "mx", "my", "mxy", "qx", "qy")


def _chosen(value: object) -> object:
    if isinstance(value, str):
        if value not in _WORDS:
            raise ValueError(
                f"found {describe(value)}; it must be {', '.join(_WORDS)}, or a list of names of combinations."
            )
        return value
    value = as_list(value)
    if not isinstance(value, list | tuple) or not all(isinstance(name, str) for name in value):
        raise ValueError(f"found {describe(value)}; it must be {', '.join(_WORDS)}, or a list of names in quotes.")
    return tuple(value)


class Output(Table):
    """How much is computed and written of each combination."""

    combinations: Literal["auto", "each", "table"] = Field(
        default="auto",
        description=f"each: all results of every combination; table: a row of combinations.parquet for each, an "
        f"envelope over all, and all results of those in fields; auto: each up to {FEW} combinations, then table.",
    )
    fields: Annotated[
        Literal["governing", "all", "none"] | tuple[Text, ...],
        BeforeValidator(_chosen),
        WithJsonSchema({"anyOf": [{"enum": list(_WORDS)}, {"type": "array", "items": {"type": "string"}}]}),
    ] = Field(
        default="governing",
        description="For table: combinations with all results, .vtu file and picture: governing, all, none, or names.",
    )
    envelope: tuple[EnvelopeField, ...] = Field(
        default=ENVELOPED,
        description="For table: fields whose largest and smallest values at every node are sought; [] for none.",
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.combinations == "each":
            for key in ("fields", "envelope"):
                if getattr(self, key) != type(self).model_fields[key].default:
                    yield (key,), f'{key} goes with combinations = "table"; with "each" every combination has all.'
        repeated = next((f for i, f in enumerate(self.envelope) if f in self.envelope[:i]), None)
        if repeated is not None:
            yield ("envelope",), f'"{repeated}" is listed twice.'
