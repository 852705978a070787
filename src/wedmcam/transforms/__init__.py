"""The passes between reading and writing, in the order in which they run.

`doubles`, `joints`, `chain`, `meetings`: loose segments to contours that bound material; `nest`:
which lies in which. `figures`: moved, copied, mirrored. `merge`, `corners`: pieces of one circle
are one arc, sharp corners are rounded. `compensate`: the wire beside them. `plan`: sides, leads and
order, all together a plan. `lower`: the plan in blocks of whole steps. `outlines`: the same as
outlines for a controller that offsets them (what it makes of them: `controllers.offsetting`).
"""
