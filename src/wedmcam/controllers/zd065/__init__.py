"""The ZD-065's own data processing (数据处理), in 8-digit decimals.

A file in the rotation or the compensation format is no cutting program: the controller makes one of
it, with the copies and the gap that the operator enters. This is what the target does, so it stands
beside the interpolators: writers aim at it and the judge judges what comes out. The precision is
the paper's [S]; the order of the operations is ours [R].
"""
