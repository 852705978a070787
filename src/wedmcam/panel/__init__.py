"""Panels of simulated controllers, as text: keys or lines in, what is shown out.

`script` is what all have in common: lines of keys, what happens around a machine, transcripts. Of
the ZD-065, `keys` says which keys there are, `entry` what is keyed in digit by digit, `zd065` which
key does what in which state, and `machine` stands behind it. Of the DEM-15's microcomputer,
`terminal` reads command lines, and `microcomputer` stands behind it.
"""
