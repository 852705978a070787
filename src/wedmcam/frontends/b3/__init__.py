"""3B text: records, and the reader that makes blocks of them."""

from wedmcam.frontends.b3.reader import decode

__all__ = ["decode"]
