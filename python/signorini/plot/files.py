"""Write pictures to files."""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from signorini.base.files import replacing
from signorini.base.provenance import PROGRAM

_FAST = 1
"""Compression level of zlib for .png files: they are 20 % larger than at the default level, in a quarter of the time.
"""
DOTS = 120
"""Dots per inch of .png files."""
_COLOURS = 64
"""Number of colours of .png files with a palette, see `with_palette`."""


def save(figure: Figure, path: str | os.PathLike[str], metadata: Mapping[str, str] | None = None) -> None:
    """Write a figure to a file atomically; the suffix (``.png``, ``.svg``, ``.pdf``) selects the format.

    A .png file has a text chunk for each entry of the metadata. In .svg and .pdf files the program is the creator, and
    the metadata are joined to one text.
    """
    metadata = metadata or {"Software": PROGRAM}
    with replacing(path) as temporary:
        png = temporary.suffix.lower() == ".png"
        options = {"pil_kwargs": {"compress_level": _FAST}} if png else {}
        text = "; ".join(f"{name}: {value}" for name, value in metadata.items())
        key = "Subject" if temporary.suffix.lower() == ".pdf" else "Description"
        entries = dict(metadata) if png else {"Creator": metadata["Software"], key: text}
        figure.savefig(temporary, dpi=DOTS, metadata=entries, **options)  # type: ignore[arg-type]


def png_of(figure: Figure) -> bytes:
    """Draw a figure as pixels; return the content of a .png file."""
    figure.set_dpi(DOTS)
    canvas: Any = FigureCanvasAgg(figure)  # matplotlib has no type hints for the methods of a canvas
    canvas.draw()
    return as_png(canvas)


def as_png(canvas: Any) -> bytes:
    """Return the content of a .png file of a drawn canvas, which takes half as long as with matplotlib."""
    # The alpha channel is left out: pages do not need it, and a quarter less data is compressed.
    dots = np.asarray(canvas.buffer_rgba())[..., :3]
    height, width, _ = dots.shape
    lines = np.zeros((height, 1 + 3 * width), np.uint8)
    lines[:, 1:] = dots.reshape(height, -1)
    per_metre = round(DOTS / 0.0254)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
        (b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1)),
        (b"IDAT", zlib.compress(lines.tobytes(), _FAST)),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(*chunk) for chunk in chunks)


def with_palette(png: bytes) -> bytes:
    """Reduce a .png file to a palette of 64 colours, with which drawings look the same in a quarter of the bytes."""
    result = io.BytesIO()
    Image.open(io.BytesIO(png)).quantize(_COLOURS).save(result, "png", optimize=True)
    return result.getvalue()


_HEAD = 33
"""Number of bytes of a PNG file up to the end of its first chunk."""


def with_texts(png: bytes, metadata: Mapping[str, str]) -> bytes:
    """Insert a text chunk for each entry of the metadata into the content of a .png file."""
    return png[:_HEAD] + b"".join(_chunk(*_text(name, text)) for name, text in metadata.items()) + png[_HEAD:]


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _text(name: str, text: str) -> tuple[bytes, bytes]:
    """Chunk type and data of a text in a PNG file: tEXt in Latin-1 if possible, otherwise iTXt in UTF-8."""
    try:
        return b"tEXt", f"{name}\0{text}".encode("latin-1")
    except UnicodeEncodeError:
        return b"iTXt", f"{name}\0\0\0\0\0{text}".encode()
