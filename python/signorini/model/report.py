"""Title block of the report."""

from __future__ import annotations

from datetime import date
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from signorini.model.base import Table, Text


class Report(Table):
    """The title block and the language of the report."""

    project: Text = Field(default="", description="Name or number of the project.")
    number: Text = Field(default="", description="Number of the document.")
    client: Text = Field(default="", description="Client.")
    author: Text = Field(default="", description="Person who made the calculation.")
    checker: Text = Field(default="", description="Person who checked the calculation.")
    approver: Text = Field(default="", description="Person who approved the calculation.")
    date: Annotated[Text, BeforeValidator(lambda value: value.isoformat() if isinstance(value, date) else value)] = (
        Field(default="", description="Date of the report, as text or as a date of TOML.")
    )
    revision: Text = Field(default="", description="Revision.")
    logo: Text = Field(default="", description="Picture for the title block, .png or .svg; relative to the input file.")
    language: Literal["en", "de"] = Field(default="en", description="Language of the report.")
