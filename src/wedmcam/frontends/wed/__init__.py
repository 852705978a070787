"""The part language: ``read`` turns a ``.wed`` text into a `Part`, and says all that is wrong.

``grammars/wed.lark`` is the grammar; docs/language.md is the reference.
"""

from wedmcam.frontends.wed.reader import parse_transform, parse_transforms, read

__all__ = ["parse_transform", "parse_transforms", "read"]
