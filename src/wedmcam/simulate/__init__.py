"""Simulated controllers: what a machine does with a program, and with everything that goes wrong.

A program is a `Route` of steps. A `Scenario` says what happens when; the `process` makes of both a
`Walk`, forward and back over the route; `motion` drives the motors along it, against tables that
have play. What one controller does otherwise than another stands in a module of its name.
"""
