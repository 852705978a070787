"""The microcomputer of an AGIECUT DEM-15 (Eindhoven, 1982): paths from integer vectors.

``arithmetic`` is what its 8085 computes for one vector; ``vectors`` makes steps of that.
``terminal`` holds the routines of its command line.
"""
