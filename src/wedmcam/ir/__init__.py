"""What the stages hand each other: Sketch, Contour, Plan, Program.

Floats in micrometres above lowering, integers in micrometres below it.
"""
