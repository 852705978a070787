"""The AGIEMERIC NBY-15: circles from a table of degrees, and a radius corrector.

`base_circle` holds the table and what becomes of the fractions, `data` what the tape says and the
lines that it means, `corrector` which tapes may be corrected and by how much.
"""
