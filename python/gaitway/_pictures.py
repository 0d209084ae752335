"""What Jupyter shows: pictures and videos."""

from __future__ import annotations

import base64
import os
from pathlib import Path
from typing import Any

import numpy as np

from . import _gaitway


class Picture:
    """A picture: ``pixels`` is an array ``(height, width, 4)`` of uint8, red, green, blue, alpha, sRGB, rows from the top."""

    def __init__(self, pixels: np.ndarray) -> None:
        self.pixels = pixels

    @property
    def shape(self) -> tuple[int, ...]:
        """Height, width and 4."""
        return self.pixels.shape

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        array = self.pixels if dtype is None else self.pixels.astype(dtype)
        return array.copy() if copy else array

    def _repr_png_(self) -> bytes:
        return _gaitway.png(self.pixels)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as PNG."""
        Path(path).write_bytes(self._repr_png_())

    def __repr__(self) -> str:
        return f"<gaitway.Picture: {self.shape[1]} x {self.shape[0]} pixels>"


class Video:
    """A video: ``data`` is an MP4 file (H.264)."""

    def __init__(self, data: bytes, size: tuple[int, int]) -> None:
        self.data = data
        self.size = size

    def _repr_html_(self) -> str:
        data = base64.b64encode(self.data).decode()
        width, height = self.size
        return f'<video controls width="{width}" height="{height}" src="data:video/mp4;base64,{data}"></video>'

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as ``.mp4``."""
        Path(path).write_bytes(self.data)

    def __repr__(self) -> str:
        return f"<gaitway.Video: {self.size[0]} x {self.size[1]} pixels, {len(self.data)} bytes>"
