"""wedmcam: from a drawing to a proven wire-EDM program."""

__version__ = "0.1.0"
